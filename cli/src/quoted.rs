//! Paths in commands that are printed to be typed again.

use std::path::Path;

/// `path` as a shell takes it for one word.
pub fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/\\._-+:,@%=".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) && (cfg!(windows) || !text.contains('\\')) {
        text
    } else if cfg!(windows) {
        format!("\"{text}\"")
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_shell_would_split_is_quoted() {
        let quoted = |text: &str| quoted(Path::new(text));
        assert_eq!(quoted("/tmp/office-2.map"), "/tmp/office-2.map");
        assert_eq!(quoted("my office/test"), "'my office/test'");
        assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
    }
}
