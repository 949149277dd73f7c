//! The public surface of a language, kept in a file so that a change of it is seen in review.

use std::error::Error;
use std::path::Path;

const UPDATE: &str = "FIELDWALK_UPDATE_GOLDEN";

/// Compares the declarations found with those of the file at `path`, or writes them there when asked to update.
///
/// # Errors
/// When they differ, with every line that is gone or new.
pub fn compare(mut found: Vec<String>, path: &Path) -> Result<(), Box<dyn Error>> {
    found.sort();
    found.dedup();
    let found = found.join("\n") + "\n";
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        return Ok(std::fs::write(path, found)?);
    }
    let expected = std::fs::read_to_string(path).unwrap_or_default();
    if found == expected {
        return Ok(());
    }
    let lacks = |list: &str, line: &&str| !list.lines().any(|other| other == *line);
    let gone = expected.lines().filter(|line| lacks(&found, line)).map(|line| format!("\n- {line}"));
    let new = found.lines().filter(|line| lacks(&expected, line)).map(|line| format!("\n+ {line}"));
    let changes: String = gone.chain(new).collect();
    let name = path.display();
    Err(format!(
        "the public surface differs from {name}:{changes}\nIf that is meant: {UPDATE}=1 cargo xtask bindings, and say \
         in CHANGELOG.md what breaks"
    )
    .into())
}
