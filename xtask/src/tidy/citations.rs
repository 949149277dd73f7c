//! Citations of a paper's equations, algorithms, tables and sections: "Kwak 2018, Eqs 4–5 and Alg. 1".

use std::collections::BTreeSet;

/// What is cited: its kind ("Eq", "Alg", "Table", "Fig" or "§") and its number.
pub type Citation = (&'static str, String);

const KINDS: [(&str, &str); 9] = [
    ("Eq", "Eq"),
    ("Eqs", "Eq"),
    ("Alg", "Alg"),
    ("Algs", "Alg"),
    ("Table", "Table"),
    ("Tables", "Table"),
    ("Fig", "Fig"),
    ("Figs", "Fig"),
    ("§", "§"),
];

/// Reads "Eqs 4–5, Alg. 1" up to the first word that belongs to no citation.
pub fn parse(text: &str) -> BTreeSet<Citation> {
    let mut citations = BTreeSet::new();
    let mut kind = None;
    for word in text.split_whitespace() {
        let mut core = word.trim_matches(|c: char| "(),;:.".contains(c));
        if let Some((_, name)) = KINDS.iter().find(|(spelling, _)| *spelling == core) {
            kind = Some(*name);
            continue;
        }
        if core == "and" {
            continue;
        }
        if let Some(section) = core.strip_prefix('§') {
            (kind, core) = (Some("§"), section);
        }
        let Some(kind) = kind.filter(|_| core.starts_with(|c: char| c.is_ascii_digit())) else { break };
        citations.extend(numbers(core).into_iter().map(|number| (kind, number)));
        if word.ends_with(['.', ';', ')', ':']) {
            break;
        }
    }
    citations
}

/// Everything that a source file's doc comments cite from `paper`.
pub fn of_paper(source: &str, paper: &str) -> BTreeSet<Citation> {
    let docs = doc_text(source);
    docs.match_indices(paper)
        .filter_map(|(start, _)| docs[start + paper.len()..].strip_prefix(','))
        .flat_map(parse)
        .collect()
}

/// The doc comments, each block on one line: a citation may run over two lines of a comment.
fn doc_text(source: &str) -> String {
    let mut text = String::new();
    for line in source.lines().map(str::trim_start) {
        match line.strip_prefix("///").or_else(|| line.strip_prefix("//!")) {
            Some(doc) => text.extend([doc.trim(), " "]),
            None if text.ends_with(' ') => text.push('\n'),
            None => {}
        }
    }
    text
}

/// "4–6" is 4, 5 and 6; "3.2" is itself.
fn numbers(word: &str) -> Vec<String> {
    let range = word.split_once(['–', '-']).and_then(|(first, last)| {
        let (first, last): (u32, u32) = (first.parse().ok()?, last.parse().ok()?);
        (first <= last && last - first < 100).then_some(first..=last)
    });
    match range {
        Some(range) => range.map(|number| number.to_string()).collect(),
        None => vec![word.to_owned()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cited(text: &str) -> Vec<String> {
        parse(text).into_iter().map(|(kind, number)| format!("{kind} {number}")).collect()
    }

    #[test]
    fn ranges_and_lists_are_read() {
        assert_eq!(cited("Eq. 1"), ["Eq 1"]);
        assert_eq!(cited("Eqs 4–6; and more 7"), ["Eq 4", "Eq 5", "Eq 6"]);
        assert_eq!(cited("Eqs 4, 7 and 9 and Alg. 1 with 3 steps"), ["Alg 1", "Eq 4", "Eq 7", "Eq 9"]);
        assert_eq!(cited("§3.2, Table 1."), ["Table 1", "§ 3.2"]);
        assert_eq!(cited("Eq. 1. 3 samples"), ["Eq 1"]);
        assert!(cited("a paper without a number").is_empty());
    }

    #[test]
    fn only_doc_comments_cite() {
        let source =
            "/// Source: Kwak 2018,\n/// Eq. 3 (moved).\n// Kwak 2018, Eq. 9\nfn f() {}\n/// Kwak 2018\n";
        assert_eq!(of_paper(source, "Kwak 2018"), BTreeSet::from([("Eq", "3".to_owned())]));
        assert!(of_paper(source, "Wu 2017").is_empty());
    }
}
