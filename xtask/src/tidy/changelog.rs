//! CHANGELOG.md has a section for what is not yet released.

use super::repository::{Finding, Repository};

const CHANGELOG: &str = "CHANGELOG.md";

pub fn has_unreleased_section(repository: &Repository) -> Vec<Finding> {
    let Some(text) = repository.text(CHANGELOG) else {
        return vec![Finding::in_file(CHANGELOG, "is missing")];
    };
    if text.lines().any(|line| matches!(line.trim(), "## Unreleased" | "## [Unreleased]")) {
        Vec::new()
    } else {
        vec![Finding::in_file(CHANGELOG, "has no section `## Unreleased`")]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changelog_without_the_section_is_found() {
        assert_eq!(has_unreleased_section(&Repository::of(&[])).len(), 1);
        assert_eq!(has_unreleased_section(&Repository::of(&[(CHANGELOG, "## 0.1.0\n")])).len(), 1);
        assert!(has_unreleased_section(&Repository::of(&[(CHANGELOG, "# x\n\n## Unreleased\n")])).is_empty());
    }
}
