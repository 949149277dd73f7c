//! The one error of this crate: where, what, and what to do about it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file could not be read or written.
///
/// Prints as `path:line: message (remedy)`, leaving out what is unknown.
#[derive(Debug)]
pub struct FormatError {
    inner: Box<Inner>,
}

#[derive(Debug)]
struct Inner {
    kind: Kind,
    path: Option<PathBuf>,
    line: Option<u64>,
    message: String,
    remedy: &'static str,
    source: Option<io::Error>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Io,
    NotFound,
    NewerVersion,
    Malformed,
    Corrupt,
}

impl FormatError {
    /// The content is not what the format asks for.
    pub fn malformed(message: impl Into<String>, remedy: &'static str) -> Self {
        Self::new(Kind::Malformed, message.into(), remedy)
    }

    /// The content has changed since it was written: a digest does not match.
    pub fn corrupt(message: impl Into<String>, remedy: &'static str) -> Self {
        Self::new(Kind::Corrupt, message.into(), remedy)
    }

    /// The content was written by a version of the format that this build does not know.
    pub fn newer_version(found: u64, known: u64) -> Self {
        let message = format!("written in format version {found}; this build reads up to version {known}");
        Self::new(Kind::NewerVersion, message, "update Fieldwalk, or write the file with the older version")
    }

    /// The operating system refused to `action` the file at `path`.
    pub fn io(action: &str, path: &Path, source: io::Error) -> Self {
        let (kind, remedy) = match source.kind() {
            io::ErrorKind::NotFound => (Kind::NotFound, "check the path"),
            io::ErrorKind::PermissionDenied => (Kind::Io, "check the permissions"),
            io::ErrorKind::StorageFull => (Kind::Io, "free some space and try again"),
            _ => (Kind::Io, ""),
        };
        let mut error = Self::new(kind, format!("cannot {action}: {source}"), remedy).at_path(path);
        error.inner.source = Some(source);
        error
    }

    /// The same error, naming the file that it is about.
    #[must_use]
    pub fn at_path(mut self, path: impl Into<PathBuf>) -> Self {
        self.inner.path = Some(path.into());
        self
    }

    /// The same error, naming the line that it is about; lines count from 1.
    #[must_use]
    pub fn at_line(mut self, line: u64) -> Self {
        self.inner.line = Some(line);
        self
    }

    /// The file concerned, if known.
    pub fn path(&self) -> Option<&Path> {
        self.inner.path.as_deref()
    }

    /// The line concerned, counted from 1, if known.
    pub fn line(&self) -> Option<u64> {
        self.inner.line
    }

    /// What is wrong.
    pub fn message(&self) -> &str {
        &self.inner.message
    }

    /// What to do about it; empty where nothing can be said.
    pub fn remedy(&self) -> &str {
        self.inner.remedy
    }

    /// Whether a file or folder does not exist.
    pub fn is_not_found(&self) -> bool {
        self.inner.kind == Kind::NotFound
    }

    /// Whether the operating system refused, a missing file included.
    pub fn is_io(&self) -> bool {
        matches!(self.inner.kind, Kind::Io | Kind::NotFound)
    }

    /// Whether the file is of a version that only a newer build reads.
    pub fn is_newer_version(&self) -> bool {
        self.inner.kind == Kind::NewerVersion
    }

    /// Whether the file was once valid and has changed since: its digest does not match.
    pub fn is_corrupt(&self) -> bool {
        self.inner.kind == Kind::Corrupt
    }

    fn new(kind: Kind, message: String, remedy: &'static str) -> Self {
        Self { inner: Box::new(Inner { kind, path: None, line: None, message, remedy, source: None }) }
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Inner { path, line, message, remedy, .. } = &*self.inner;
        match (path, line) {
            (Some(path), Some(line)) => write!(f, "{}:{line}: ", path.display())?,
            (Some(path), None) => write!(f, "{}: ", path.display())?,
            (None, Some(line)) => write!(f, "line {line}: ")?,
            (None, None) => {}
        }
        f.write_str(message)?;
        if !remedy.is_empty() {
            write!(f, " ({remedy})")?;
        }
        Ok(())
    }
}

impl std::error::Error for FormatError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.inner.source.as_ref().map(|source| source as _)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error as _;

    #[test]
    fn an_error_says_where_what_and_what_to_do() {
        let error = FormatError::malformed("no outline", "add one");
        assert_eq!(error.to_string(), "no outline (add one)");
        assert_eq!(
            error.at_path("a/plan.json").at_line(7).to_string(),
            "a/plan.json:7: no outline (add one)"
        );
    }

    #[test]
    fn a_missing_file_is_told_apart_and_keeps_its_cause() {
        let error = FormatError::io("open", Path::new("x"), io::Error::from(io::ErrorKind::NotFound));
        assert!(error.is_not_found() && error.is_io() && !error.is_corrupt());
        assert!(error.source().is_some());
        assert!(FormatError::newer_version(2, 1).is_newer_version());
    }
}
