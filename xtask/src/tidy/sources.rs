//! Source files are short and named for what is inside; no file is heavy.

use super::repository::{Finding, Repository};

/// The aim is 400 lines; beyond this a file certainly holds two ideas.
const MAX_LINES: usize = 500;
const MAX_BYTES: u64 = 1_500_000;

const SOURCES: [&str; 4] = [".rs", ".kt", ".swift", ".py"];
const EMPTY_NAMES: [&str; 9] =
    ["utils", "util", "helpers", "helper", "manager", "managers", "common", "data", "misc"];

pub fn files_are_short(repository: &Repository) -> Vec<Finding> {
    sources(repository)
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|(_, n_lines)| *n_lines > MAX_LINES)
        .map(|(path, n)| {
            Finding::in_file(path, format!("has {n} lines, more than {MAX_LINES}: split it by idea"))
        })
        .collect()
}

pub fn names_say_what_is_inside(repository: &Repository) -> Vec<Finding> {
    let empty_name = |path: &str| {
        let stem = path.rsplit_once('.').map_or(path, |(stem, _)| stem);
        stem.split('/').find(|name| EMPTY_NAMES.contains(name)).map(str::to_owned)
    };
    sources(repository)
        .filter_map(|(path, _)| Some((path, empty_name(path)?)))
        .map(|(path, name)| Finding::in_file(path, format!("`{name}` does not say what is inside")))
        .collect()
}

pub fn files_are_light(repository: &Repository) -> Vec<Finding> {
    repository
        .sizes()
        .filter(|(_, n_bytes)| *n_bytes > MAX_BYTES)
        .map(|(path, n)| Finding::in_file(path, format!("weighs {n} bytes, more than {MAX_BYTES}")))
        .collect()
}

fn sources(repository: &Repository) -> impl Iterator<Item = (&str, &str)> {
    repository.texts().filter(|(path, _)| SOURCES.iter().any(|ending| path.ends_with(ending)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_file_is_found() {
        let (short, long) = ("x\n".repeat(MAX_LINES), "x\n".repeat(MAX_LINES + 1));
        let repository = Repository::of(&[("a.rs", &short), ("b.rs", &long), ("c.md", &long)]);
        let paths: Vec<_> = files_are_short(&repository).into_iter().map(|f| f.path).collect();
        assert_eq!(paths, ["b.rs"]);
    }

    #[test]
    fn a_name_without_meaning_is_found() {
        let files =
            ["core/src/utils.rs", "core/src/common/mod.rs", "core/src/database.rs", "tests/data/walk.txt"];
        let repository = Repository::of(&files.map(|path| (path, "")));
        let paths: Vec<_> = names_say_what_is_inside(&repository).into_iter().map(|f| f.path).collect();
        assert_eq!(paths, ["core/src/common/mod.rs", "core/src/utils.rs"]);
    }

    #[test]
    fn a_heavy_file_is_found() {
        let heavy = "x".repeat(MAX_BYTES as usize + 1);
        let repository = Repository::of(&[("map.bin", &heavy), ("light.bin", &heavy[1..])]);
        let paths: Vec<_> = files_are_light(&repository).into_iter().map(|f| f.path).collect();
        assert_eq!(paths, ["map.bin"]);
    }
}
