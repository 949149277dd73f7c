//! `docs/equations.md`: where each of the papers' equations stands in the code.
//!
//! A table of four columns:
//!
//! ```text
//! | Paper | Equation | What | Where |
//! |---|---|---|---|
//! | Kwak 2018 | Eq. 1 | low-pass of gravity | `core/src/gravity.rs` `LowPass::update` |
//! ```
//!
//! *Where* holds backticked paths, each followed by the items in it. A path must exist, name its items, and cite the
//! equation in a doc comment as "Kwak 2018, Eq. 1"; the files of a row together cite all of the row's numbers. The table
//! is complete: every equation and algorithm that the papers number has a row.

use std::collections::{BTreeMap, BTreeSet};

use super::architecture::backticked;
use super::citations::{self, Citation};
use super::repository::{Finding, Repository};

const EQUATIONS: &str = "docs/equations.md";

/// What must have a row. Of iBILL 2017, Eqs 19 to 22 derive 23, and of WILA 2016, Eq. 2 defines a symbol.
const COMPLETE: [(&str, &str); 5] = [
    ("Kwak 2018", "Eqs 1–5 and Alg. 1"),
    ("Mass-centred 2019", "Eqs 1–15 and Algs 1–2"),
    ("iBILL 2017", "Eqs 1–18, 23, 24–32 and Alg. 1"),
    ("WILA 2016", "Eqs 1, 3–10"),
    ("Song 2014", "Eq. 1, §3"),
];

pub fn every_equation_is_in_the_code_named(repository: &Repository) -> Vec<Finding> {
    check(repository, &COMPLETE)
}

fn check(repository: &Repository, complete: &[(&str, &str)]) -> Vec<Finding> {
    let Some(text) = repository.text(EQUATIONS) else {
        return vec![Finding::in_file(EQUATIONS, "is missing: list the papers' equations and their code")];
    };
    let mut findings = Vec::new();
    let mut n_rows = 0;
    let mut listed: BTreeMap<String, BTreeSet<Citation>> = BTreeMap::new();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| line.trim_start().starts_with('|')) {
        let line = line.replace("\\|", "¦");
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let is_header =
            cells[0] == "Paper" || cells.iter().all(|cell| cell.chars().all(|c| c == '-' || c == ':'));
        if is_header {
            continue;
        }
        n_rows += 1;
        if let [paper, equation, ..] = cells[..] {
            listed.entry(paper.into()).or_default().extend(citations::parse(equation));
        }
        if let Err(message) = check_row(repository, &cells) {
            findings.push(Finding::at(EQUATIONS, index + 1, message));
        }
    }
    if n_rows == 0 {
        findings.push(Finding::in_file(EQUATIONS, "has no row: | Paper | Equation | What | Where |"));
    }
    for (paper, wanted) in complete {
        let of_paper = listed.get(*paper).cloned().unwrap_or_default();
        let missing: Vec<Citation> = citations::parse(wanted).difference(&of_paper).cloned().collect();
        if !missing.is_empty() {
            findings.push(Finding::in_file(EQUATIONS, format!("has no row for {paper}, {missing:?}")));
        }
    }
    findings
}

fn check_row(repository: &Repository, cells: &[&str]) -> Result<(), String> {
    let &[paper, equation, what, place] = cells else {
        return Err(format!("has {} columns instead of 4: Paper, Equation, What, Where", cells.len()));
    };
    let wanted = citations::parse(equation);
    if paper.is_empty() || what.is_empty() || wanted.is_empty() {
        return Err(format!(
            "`{paper}`, `{equation}`: write it like `Kwak 2018`, `Eqs 4–5`, and say what it is"
        ));
    }
    let mut missing = wanted.clone();
    for (path, items) in places(place)? {
        let source = repository.text(path).ok_or(format!("`{path}` does not exist"))?;
        if let Some(item) = items.iter().find(|item| !names_item(source, item)) {
            return Err(format!("`{path}` does not name `{item}`"));
        }
        let cited = citations::of_paper(source, paper);
        if cited.is_disjoint(&wanted) {
            return Err(format!("no doc comment of `{path}` cites \"{paper}, {equation}\""));
        }
        missing.retain(|citation| !cited.contains(citation));
    }
    if missing.is_empty() {
        return Ok(());
    }
    let spelt = |(kind, number): &Citation| match *kind {
        "§" => format!("§{number}"),
        "Table" => format!("Table {number}"),
        kind => format!("{kind}. {number}"),
    };
    let missing: Vec<String> = missing.iter().map(spelt).collect();
    Err(format!("no doc comment of the files named cites \"{paper}, {}\"", missing.join(", ")))
}

/// The paths of a cell, each with its items.
fn places(cell: &str) -> Result<Vec<(&str, Vec<&str>)>, String> {
    let mut places: Vec<(&str, Vec<&str>)> = Vec::new();
    for (_, span) in backticked(cell) {
        match places.last_mut() {
            _ if span.contains('/') => places.push((span, Vec::new())),
            Some((_, items)) => items.push(span),
            None => return Err(format!("`{span}` stands before any path")),
        }
    }
    match places.iter().find(|(_, items)| items.is_empty()) {
        Some((path, _)) => Err(format!("`{path}` is followed by no item in backticks")),
        None if places.is_empty() => Err("Where holds no backticked path".into()),
        None => Ok(places),
    }
}

/// True when every part of `Type::method` is a word of the source.
fn names_item(source: &str, item: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let item = item.split(['(', '<']).next().unwrap_or(item);
    item.split("::").all(|part| source.split(|c| !is_word(c)).any(|word| word == part))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAVITY: &str =
        "/// Kwak 2018, Eqs 1–2.\npub struct LowPass;\nimpl LowPass { pub fn update() {} }\n";

    fn findings(row: &str) -> Vec<String> {
        findings_of(row, &[])
    }

    fn findings_of(row: &str, complete: &[(&str, &str)]) -> Vec<String> {
        let table = format!("# Equations\n\n| Paper | Equation | What | Where |\n|---|:--|---|---|\n{row}\n");
        let repository = Repository::of(&[(EQUATIONS, &table), ("core/src/gravity.rs", GRAVITY)]);
        check(&repository, complete).into_iter().map(|f| f.to_string()).collect()
    }

    #[test]
    fn rows_that_hold_pass() {
        let rows = "| Kwak 2018 | Eq. 1 | low-pass of \\|B\\| | `core/src/gravity.rs` `LowPass::update` |\n\
                    | Kwak 2018 | Eqs 1–2 | both | `core/src/gravity.rs` `LowPass`, `update()` |";
        assert_eq!(findings(rows), [""; 0]);
    }

    #[test]
    fn rows_that_do_not_hold_are_found() {
        let rows = [
            ("| Kwak 2018 | Eq. 1 | x | `core/src/gone.rs` `LowPass` |", "does not exist"),
            ("| Kwak 2018 | Eq. 1 | x | `core/src/gravity.rs` `LowPas` |", "does not name"),
            ("| Kwak 2018 | Eq. 1 | x | `core/src/gravity.rs` |", "no item"),
            ("| Kwak 2018 | Eq. 3 | x | `core/src/gravity.rs` `LowPass` |", "cites"),
            ("| Kwak 2018 | Eqs 2–3 | x | `core/src/gravity.rs` `LowPass` |", "Eq. 3"),
            ("| Wu 2017 | Eq. 1 | x | `core/src/gravity.rs` `LowPass` |", "cites"),
            ("| Kwak 2018 | Eq. 1 | x | somewhere |", "no backticked"),
            ("| Kwak 2018 | first | x | y |", "write it like"),
            ("| Kwak 2018 | Eq. 1 | y |", "columns"),
            ("", "no row"),
        ];
        for (row, expected) in rows {
            let found = findings(row);
            assert!(found.len() == 1 && found[0].contains(expected), "{row}: {found:?}");
        }
    }

    #[test]
    fn a_paper_s_equation_without_a_row_is_found() {
        let row = |paper: &str| format!("| {paper} | Eq. 1 | x | `core/src/gravity.rs` `LowPass` |");
        let found = findings_of(&row("Kwak 2018"), &COMPLETE).join("\n");
        assert!(found.contains("has no row for Kwak 2018, [(\"Alg\", \"1\"), (\"Eq\", \"2\")"), "{found}");
        assert!(found.contains("has no row for Song 2014, [(\"Eq\", \"1\"), (\"§\", \"3\")]"), "{found}");
    }

    #[test]
    fn the_list_must_be_there() {
        assert_eq!(every_equation_is_in_the_code_named(&Repository::of(&[])).len(), 1);
    }
}
