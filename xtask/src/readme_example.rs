//! The README's examples as sources, so that tests compile them.

use std::fs;
use std::path::Path;

/// Writes README.md's example in `language` to `file`, behind `head`.
///
/// # Errors
/// When there is none, or the file cannot be written.
pub fn write(root: &Path, language: &str, head: &str, file: &Path) -> Result<(), String> {
    let text = fs::read_to_string(root.join("README.md")).map_err(|error| format!("README.md: {error}"))?;
    let example = text.split_once(&format!("```{language}\n")).and_then(|(_, rest)| rest.split_once("```"));
    let (example, _) = example.ok_or(format!("README.md has no example in {language}"))?;
    fs::create_dir_all(file.parent().unwrap_or(root))
        .and_then(|()| fs::write(file, format!("{head}{example}")))
        .map_err(|error| format!("{}: {error}", file.display()))
}
