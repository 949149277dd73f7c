//! Step detectors against foot switches, on the Oxford step-counting collection.
//!
//! The truth of a walk is the number of contacts, left and right. A detector hears the accelerometer alone; its steps
//! are all that it reports from the first sample to the last. Errors are relative to a walk's truth, and a subset's
//! value is the mean over its walks.

use std::path::PathBuf;

use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::oxford_steps::{AccelerometerReader, ContactReader, Placement, RunFolder, find_runs};
use rayon::prelude::*;

use super::{ALL, Metric, MetricRow, MetricScores};

/// The name in rows.
pub const DATASET: &str = "oxford-steps";

/// The detectors, by their names in rows.
const SYSTEMS: [&str; 1] = ["phone"];

/// Fewer contacts than this are no truth: the switches of some walks were not connected.
const MIN_CONTACTS: usize = 10;

/// Steps counted and steps made in one walk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunCounts {
    /// The walk.
    pub name: String,
    /// How the phone was carried.
    pub placement: Placement,
    /// Contacts of both feet.
    pub n_true: usize,
    /// Steps that each detector found, in the order of the detectors.
    pub n_counted: [usize; SYSTEMS.len()],
}

/// Scores the walks in `dirs`.
///
/// A walk without an accelerometer or without contacts gives a warning.
///
/// # Errors
/// When a folder cannot be listed or holds no walk.
pub fn score(dirs: &[PathBuf]) -> Result<MetricScores, FormatError> {
    let mut runs = Vec::new();
    for dir in dirs {
        runs.extend(find_runs(dir)?);
    }
    let counted: Vec<_> = runs.par_iter().map(counts).collect();
    let mut scores = MetricScores::default();
    let mut counts = Vec::new();
    for outcome in counted {
        match outcome {
            Ok(Ok(run)) => counts.push(run),
            Ok(Err(warning)) => scores.warnings.push(warning),
            Err(error) => scores.errors.push(error),
        }
    }
    scores.rows = rows(&counts);
    Ok(scores)
}

/// The counts of a walk, or why it has none.
fn counts(run: &RunFolder) -> Result<Result<RunCounts, String>, FormatError> {
    if !run.accelerometer().is_file() {
        return Ok(Err(format!("{}: has no accelerometer.csv, so it is not scored", run.name)));
    }
    let mut n_true = 0;
    for contact in ContactReader::open(&run.contacts())? {
        contact?;
        n_true += 1;
    }
    if n_true < MIN_CONTACTS {
        return Ok(Err(format!(
            "{}: its foot switches saw {n_true} contacts, so it is not scored",
            run.name
        )));
    }
    let mut pedestrian = Pedestrian::new(PedestrianParams::default());
    let mut n_counted = [0; SYSTEMS.len()];
    for sample in AccelerometerReader::open(&run.accelerometer())? {
        n_counted[0] += usize::from(pedestrian.push(&sample?).is_some());
    }
    Ok(Ok(RunCounts { name: run.name.clone(), placement: run.placement, n_true, n_counted }))
}

/// The rows of each placement, then of all walks.
fn rows(runs: &[RunCounts]) -> Vec<MetricRow> {
    let subset = |name: &str, runs: &[&RunCounts]| -> Vec<MetricRow> {
        let of_system = |(k, system): (usize, &&str)| {
            let errors: Vec<f64> = runs.iter().map(|run| signed_error_percent(run, k)).collect();
            let row = |metric, sum: f64| MetricRow {
                dataset: DATASET,
                subset: name.into(),
                system: (*system).into(),
                metric,
                value: sum / errors.len() as f64,
                n: errors.len(),
            };
            [
                row(Metric::CountErrorAbsPercent, errors.iter().map(|error| error.abs()).sum()),
                row(Metric::CountErrorSignedPercent, errors.iter().sum()),
            ]
        };
        if runs.is_empty() { Vec::new() } else { SYSTEMS.iter().enumerate().flat_map(of_system).collect() }
    };
    let of_placement = |placement: Placement| {
        let of_it: Vec<&RunCounts> = runs.iter().filter(|run| run.placement == placement).collect();
        subset(placement.name(), &of_it)
    };
    let all: Vec<&RunCounts> = runs.iter().collect();
    Placement::ALL.into_iter().flat_map(of_placement).chain(subset(ALL, &all)).collect()
}

fn signed_error_percent(run: &RunCounts, system: usize) -> f64 {
    100.0 * (run.n_counted[system] as f64 - run.n_true as f64) / run.n_true as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(placement: Placement, n_true: usize, n_counted: usize) -> RunCounts {
        RunCounts { name: "walk".into(), placement, n_true, n_counted: [n_counted] }
    }

    #[test]
    fn errors_are_means_over_walks() {
        let runs = [
            run(Placement::Purse, 100, 110),
            run(Placement::InHand, 200, 190),
            run(Placement::InHand, 100, 101),
        ];
        let rows = rows(&runs);
        let value = |subset: &str, metric| {
            let row = rows.iter().find(|row| row.subset == subset && row.metric == metric);
            row.map(|row| (row.value, row.n))
        };
        use Metric::{CountErrorAbsPercent as Abs, CountErrorSignedPercent as Signed};
        // In hand: −5 % and 1 %; purse: 10 %.
        assert_eq!((value("in_hand", Abs), value("in_hand", Signed)), (Some((3.0, 2)), Some((-2.0, 2))));
        assert_eq!((value("purse", Abs), value("purse", Signed)), (Some((10.0, 1)), Some((10.0, 1))));
        assert_eq!(value(ALL, Abs), Some((16.0 / 3.0, 3)));
        assert_eq!(value(ALL, Signed), Some((2.0, 3)));
        assert_eq!(rows.len(), 3 * 2);
        assert!(rows[4].subset == ALL && super::rows(&[]).is_empty());
    }
}
