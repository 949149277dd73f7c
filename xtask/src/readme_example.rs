//! The README's examples as sources, so that tests compile them.

use std::fs;
use std::path::Path;

/// The examples are to be taken in at a glance.
const MAX_LINES: usize = 10;

/// Writes README.md's example in `language` to `file`, behind `head`.
///
/// # Errors
/// When there is none, it is longer than ten lines, or the file cannot be written.
pub fn write(root: &Path, language: &str, head: &str, file: &Path) -> Result<(), String> {
    let text = fs::read_to_string(root.join("README.md")).map_err(|error| format!("README.md: {error}"))?;
    let example = example_in(&text, language)?;
    fs::create_dir_all(file.parent().unwrap_or(root))
        .and_then(|()| fs::write(file, format!("{head}{example}")))
        .map_err(|error| format!("{}: {error}", file.display()))
}

/// The example in `language`.
fn example_in<'a>(readme: &'a str, language: &str) -> Result<&'a str, String> {
    let example = readme.split_once(&format!("```{language}\n")).and_then(|(_, rest)| rest.split_once("```"));
    let (example, _) = example.ok_or(format!("README.md has no example in {language}"))?;
    match example.lines().count() {
        0..=MAX_LINES => Ok(example),
        n => Err(format!("README.md: the example in {language} has {n} lines, {MAX_LINES} are allowed")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_example_is_found_by_its_language_and_short() {
        let readme = format!("a\n```kotlin\nval a = 1\n```\n```swift\n{}```\n", "let a = 1\n".repeat(11));
        assert_eq!(example_in(&readme, "kotlin").unwrap(), "val a = 1\n");
        assert!(example_in(&readme, "swift").unwrap_err().contains("11 lines"));
        assert!(example_in(&readme, "python").is_err());
    }
}
