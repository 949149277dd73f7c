//! The files that are or could be committed.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::process::Command;

/// Paths from the root, with `/`, and what stands there.
#[derive(Debug, Default)]
pub struct Repository {
    files: BTreeMap<String, Content>,
}

#[derive(Debug)]
struct Content {
    n_bytes: u64,
    /// `None` for a file that is not UTF-8.
    text: Option<String>,
}

/// Something to mend.
#[derive(Debug)]
pub struct Finding {
    pub path: String,
    /// Counted from one.
    pub line: Option<usize>,
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.path, self.message),
            None => write!(f, "{}: {}", self.path, self.message),
        }
    }
}

impl Finding {
    pub fn in_file(path: &str, message: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line: None, message: message.into() }
    }

    pub fn at(path: &str, line: usize, message: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line: Some(line), message: message.into() }
    }
}

impl Repository {
    /// Tracked files and new ones that are not ignored.
    ///
    /// # Errors
    /// A reason when git cannot list the files, for instance in an unpacked source archive.
    pub fn read(root: &Path) -> Result<Self, String> {
        let arguments = ["ls-files", "--cached", "--others", "--exclude-standard", "-z"];
        let listed = crate::process::output_of(Command::new("git").args(arguments).current_dir(root))
            .ok_or("git cannot list the files here: run it in a git checkout (git clone)")?;
        let mut files = BTreeMap::new();
        for path in listed.split('\0').filter(|path| !path.is_empty()) {
            // A deleted file stays listed until the deletion is committed.
            let Ok(bytes) = std::fs::read(root.join(path)) else { continue };
            let n_bytes = bytes.len() as u64;
            files.insert(path.to_owned(), Content { n_bytes, text: String::from_utf8(bytes).ok() });
        }
        Ok(Self { files })
    }

    /// Every file that is text, with its path.
    pub fn texts(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files.iter().filter_map(|(path, content)| Some((path.as_str(), content.text.as_deref()?)))
    }

    pub fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path)?.text.as_deref()
    }

    pub fn sizes(&self) -> impl Iterator<Item = (&str, u64)> {
        self.files.iter().map(|(path, content)| (path.as_str(), content.n_bytes))
    }

    /// True for a file and for a folder that holds one.
    pub fn has(&self, path: &str) -> bool {
        let folder = format!("{}/", path.trim_end_matches('/'));
        self.files.contains_key(path)
            || self.files.range(folder.clone()..).next().is_some_and(|(first, _)| first.starts_with(&folder))
    }

    /// The folders of packages: those with a manifest that has `[package]`.
    pub fn packages(&self) -> impl Iterator<Item = &str> {
        self.texts()
            .filter(|(_, text)| text.lines().any(|line| line.trim() == "[package]"))
            .filter_map(|(path, _)| path.strip_suffix("/Cargo.toml"))
    }
}

#[cfg(test)]
impl Repository {
    /// A repository of these files.
    pub fn of(files: &[(&str, &str)]) -> Self {
        let content = |text: &str| Content { n_bytes: text.len() as u64, text: Some(text.to_owned()) };
        Self { files: files.iter().map(|(path, text)| ((*path).to_owned(), content(text))).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_exists_when_a_file_is_in_it() {
        let repository = Repository::of(&[("core/src/lib.rs", ""), ("core-old.md", "")]);
        for path in ["core", "core/", "core/src", "core/src/lib.rs"] {
            assert!(repository.has(path), "{path}");
        }
        for path in ["cor", "core/src/lib", "core/src/lib.rs/x"] {
            assert!(!repository.has(path), "{path}");
        }
    }
}
