//! Every workspace member inherits the workspace's lints.

use super::repository::{Finding, Repository};

pub fn members_inherit_the_lints(repository: &Repository) -> Vec<Finding> {
    let root = repository.text("Cargo.toml").unwrap_or_default();
    let members = members(root);
    if members.is_empty() {
        return vec![Finding::in_file("Cargo.toml", "has no workspace members")];
    }
    members
        .iter()
        .map(|member| format!("{member}/Cargo.toml"))
        .filter(|manifest| !repository.text(manifest).is_some_and(inherits_lints))
        .map(|manifest| Finding::in_file(&manifest, "does not inherit the lints: [lints] workspace = true"))
        .collect()
}

/// The quoted names in `members = […]`.
fn members(manifest: &str) -> Vec<&str> {
    let list = manifest.split_once("\nmembers = [").and_then(|(_, rest)| rest.split_once(']'));
    list.map_or(Vec::new(), |(list, _)| list.split('"').skip(1).step_by(2).collect())
}

fn inherits_lints(manifest: &str) -> bool {
    let lines: Vec<&str> = manifest.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines.windows(2).any(|pair| pair == ["[lints]", "workspace = true"])
        || lines.contains(&"lints.workspace = true")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_with_its_own_lints_is_found() {
        let repository = Repository::of(&[
            ("Cargo.toml", "[workspace]\nmembers = [\n  \"core\",\n  \"firmware/codec\",\n  \"gone\"\n]\n"),
            ("core/Cargo.toml", "[package]\n[lints]\nworkspace = true\n"),
            ("firmware/codec/Cargo.toml", "[package]\n[dependencies]\n[features]\nworkspace = true\n"),
            ("fuzz/Cargo.toml", "[package]\n"),
        ]);
        let paths: Vec<_> = members_inherit_the_lints(&repository).into_iter().map(|f| f.path).collect();
        assert_eq!(paths, ["firmware/codec/Cargo.toml", "gone/Cargo.toml"]);
        assert_eq!(members_inherit_the_lints(&Repository::of(&[])).len(), 1);
    }
}
