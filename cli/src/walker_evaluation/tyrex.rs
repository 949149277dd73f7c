//! The attitude benchmark of Tyrex: attitudes and headings against motion capture.

use std::path::PathBuf;

use fieldwalk_formats::FormatError;

use super::MetricScores;

/// Scores the recordings in `dirs`.
///
/// # Errors
/// Always, until a reader of its recordings is there.
pub fn score(dirs: &[PathBuf]) -> Result<MetricScores, FormatError> {
    let error = FormatError::malformed("this build reads no recording of the benchmark", "update Fieldwalk");
    Err(dirs.iter().fold(error, FormatError::at_path))
}
