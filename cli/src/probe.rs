//! Whether a file can be written, asked before what goes into it has cost minutes.

use std::fs::{self, OpenOptions};
use std::path::Path;

use fieldwalk_formats::FormatError;

/// Opens `file` to write and leaves it as it was; `action`, such as `write the report`, stands in the error.
///
/// # Errors
/// When it cannot be written.
pub fn writable(action: &str, file: &Path) -> Result<(), FormatError> {
    let was_there = file.exists();
    OpenOptions::new()
        .append(true)
        .create(true)
        .open(file)
        .map_err(|error| FormatError::io(action, file, error))?;
    if !was_there {
        let _ = fs::remove_file(file);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_stays_and_what_is_not_does_not_come() {
        let dir = std::env::temp_dir().join(format!("fieldwalk-probe-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        let file = dir.join("page.html");
        writable("write the page", &file).unwrap();
        assert!(!file.exists());
        fs::write(&file, "old").unwrap();
        writable("write the page", &file).unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "old");
        let error = writable("write the page", &dir.join("none/page.html")).unwrap_err();
        assert!(error.to_string().contains("cannot write the page"), "{error}");
        fs::remove_dir_all(dir).unwrap();
    }
}
