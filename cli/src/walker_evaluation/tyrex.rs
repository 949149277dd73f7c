//! The attitude benchmark of Tyrex: attitudes and headings against motion capture.

pub mod attitude;
mod heading;
pub mod training;

use std::path::PathBuf;

use fieldwalk::attitude::EventTable;
use fieldwalk::sensor::Sample;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::tyrex::{Trial, Truth, find_trials};
use rayon::prelude::*;

use super::MetricScores;

/// The name in rows.
pub const DATASET: &str = "tyrex";

/// A trial with all that was recorded.
#[derive(Clone, Debug)]
pub struct CapturedTrial {
    /// Who, with which phone, how.
    pub trial: Trial,
    /// What the phone said, in order of time, on the clock of the capture.
    pub samples: Vec<Sample>,
    /// Where it was and how it was turned.
    pub truth: Truth,
}

/// Scores the recordings in `dirs`. A folder whose name is none of a trial's gives a warning.
///
/// # Errors
/// When a folder cannot be listed or holds no trial.
/// `table` is scored as a system of its own, beside the built-in ones.
pub fn score(dirs: &[PathBuf], table: Option<EventTable>) -> Result<MetricScores, FormatError> {
    let mut trials = Vec::new();
    let mut scores = MetricScores::default();
    for dir in dirs {
        let found = find_trials(dir)?;
        let foreign = found.foreign.iter();
        scores.warnings.extend(foreign.map(|folder| format!("{}: not a trial's name", folder.display())));
        trials.extend(found.trials);
    }
    let mut captured = Vec::new();
    for outcome in trials.into_par_iter().map(read).collect::<Vec<_>>() {
        match outcome {
            Ok(trial) => captured.push(trial),
            Err(error) => scores.errors.push(error),
        }
    }
    attitude::score(&captured, table, &mut scores);
    heading::score(&captured, &mut scores);
    Ok(scores)
}

fn read(trial: Trial) -> Result<CapturedTrial, FormatError> {
    Ok(CapturedTrial { samples: trial.samples()?.samples, truth: trial.truth()?, trial })
}
