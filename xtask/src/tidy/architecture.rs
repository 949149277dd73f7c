//! ARCHITECTURE.md names every module by its path, and documents name only paths that exist.
//!
//! A module is a `.rs` file under a package's `src/`, other than `lib.rs`, `main.rs` and `mod.rs`. It is named by its
//! backticked path from the root: `core/src/step.rs`, or several at once: `core/src/{step,heading}.rs`.

use std::collections::BTreeSet;

use super::repository::{Finding, Repository};

const ARCHITECTURE: &str = "ARCHITECTURE.md";

pub fn every_module_is_named(repository: &Repository) -> Vec<Finding> {
    let Some(text) = repository.text(ARCHITECTURE) else {
        return vec![Finding::in_file(ARCHITECTURE, "is missing: write it, naming every module")];
    };
    let named: BTreeSet<String> = backticked(text).flat_map(|(_, span)| expand_braces(span)).collect();
    let is_module = |path: &str| {
        let file = path.rsplit('/').next().unwrap_or(path);
        file.ends_with(".rs") && !["lib.rs", "main.rs", "mod.rs"].contains(&file)
    };
    let sources: Vec<String> = repository.packages().map(|package| format!("{package}/src/")).collect();
    repository
        .texts()
        .map(|(path, _)| path)
        .filter(|path| is_module(path) && sources.iter().any(|source| path.starts_with(source)))
        .filter(|path| !named.contains(*path))
        .map(|path| Finding::in_file(ARCHITECTURE, format!("does not name the module `{path}`")))
        .collect()
}

pub fn every_named_path_exists(repository: &Repository) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (document, text) in repository.texts().filter(|(path, _)| is_document(path)) {
        for (line, span) in backticked(text) {
            for path in expand_braces(span).iter().filter(|path| looks_like_path(repository, path)) {
                if !repository.has(path) {
                    findings.push(Finding::at(document, line, format!("`{path}` does not exist")));
                }
            }
        }
    }
    findings
}

/// Documents at the root and under `docs/`, except the changelog, which speaks of the past too.
fn is_document(path: &str) -> bool {
    path.ends_with(".md") && path != "CHANGELOG.md" && (!path.contains('/') || path.starts_with("docs/"))
}

/// The text between single backticks with its line number; fenced blocks are left out.
pub fn backticked(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_fenced = false;
    text.lines().enumerate().flat_map(move |(index, line)| {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        }
        let n_ticks = line.matches('`').count();
        let spans = if is_fenced { 0 } else { n_ticks / 2 };
        line.split('`').skip(1).step_by(2).take(spans).map(move |span| (index + 1, span))
    })
}

/// `a/{b,c}.rs` is `a/b.rs` and `a/c.rs`.
fn expand_braces(span: &str) -> Vec<String> {
    match span.split_once('{').and_then(|(head, rest)| Some((head, rest.split_once('}')?))) {
        Some((head, (choices, tail))) => {
            choices.split(',').map(|choice| format!("{head}{}{tail}", choice.trim())).collect()
        }
        None => vec![span.to_owned()],
    }
}

/// A path from the root, not a command, a unit, a pattern or a path in somebody's data.
fn looks_like_path(repository: &Repository, span: &str) -> bool {
    let is_plain = span.chars().all(|c| c.is_ascii_alphanumeric() || "._-/".contains(c));
    let Some((first, rest)) = span.split_once('/') else { return false };
    let is_unknown_dot_folder = first.starts_with('.') && !repository.has(first);
    if !is_plain || first.is_empty() || is_unknown_dot_folder || is_made(repository, span) {
        return false;
    }
    // `core/…` is ours; so is a folder that is gone (`bindings/`), and a source or document anywhere.
    repository.has(first)
        || rest.is_empty()
        || [".rs", ".toml", ".md"].iter().any(|ending| span.ends_with(ending))
}

/// True for what builds and checks write: git ignores it from the root (`/target`).
fn is_made(repository: &Repository, path: &str) -> bool {
    let ignored = repository.text(".gitignore").unwrap_or_default();
    ignored
        .lines()
        .filter_map(|line| line.trim_end_matches('/').strip_prefix('/'))
        .any(|folder| path.strip_prefix(folder).is_some_and(|rest| rest.is_empty() || rest.starts_with('/')))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repository(architecture: &str) -> Repository {
        Repository::of(&[
            (ARCHITECTURE, architecture),
            (".gitignore", "/target\n/core/made/\n"),
            ("core/Cargo.toml", "[package]"),
            ("core/src/lib.rs", ""),
            ("core/src/step.rs", ""),
            ("core/src/particle/mod.rs", ""),
            ("core/src/particle/motion.rs", ""),
            ("core/tests/replay.rs", ""),
        ])
    }

    #[test]
    fn a_module_left_out_is_found() {
        let findings = every_module_is_named(&repository("Steps: `core/src/step.rs`"));
        assert_eq!(findings.len(), 1);
        assert!(findings[0].message.contains("core/src/particle/motion.rs"));
        assert!(every_module_is_named(&repository("`core/src/{step,particle/motion}.rs`")).is_empty());
        assert_eq!(every_module_is_named(&Repository::of(&[])).len(), 1);
    }

    #[test]
    fn a_path_that_is_gone_is_found() {
        let text = "`core/src/stride.rs`, `bindings/`,\n`core/src/step/`, `sim/src/walker.rs`, `core/{tests,benches}/`";
        let findings = every_named_path_exists(&repository(text));
        let lines: Vec<_> = findings.iter().map(|finding| finding.line).collect();
        assert_eq!(lines, [Some(1), Some(1), Some(2), Some(2), Some(2)]);
    }

    #[test]
    fn commands_units_and_data_are_not_paths() {
        let text = "`core/src/step.rs` `m/s` `cargo run --bin x/y` `site/floor/floor_info.json` `traces/*.txt`\n\
                    `target/fieldwalk/` `core/made/x.rs` `step/s` `../shared/` `core`\n```\ncore/src/`gone/one.rs`\n```\n`odd";
        let findings = every_named_path_exists(&repository(text));
        assert!(findings.is_empty(), "{findings:?}");
    }
}
