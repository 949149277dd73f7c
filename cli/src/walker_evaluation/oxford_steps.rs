//! Step detectors against foot switches, on the Oxford step-counting collection.
//!
//! The truth of a walk is the number of contacts, left and right, as they stand in the file: of two walks (with the arm
//! band) a few are bounces or were missed. A detector hears the accelerometer alone; its steps are all that it reports
//! from the first sample to the last. Errors are relative to a walk's truth, and a subset's value is the mean over its
//! walks.

use std::path::PathBuf;

use fieldwalk::gravity::{LevelEstimator, LevelParams};
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk::sensor::Reading;
use fieldwalk::step::{CardStepDetector, StepDetector, StepQueue, WilaStepDetector, WilaStepParams};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::oxford_steps::{AccelerometerReader, ContactReader, Placement, RunFolder, find_runs};
use rayon::prelude::*;

use super::{ALL, Metric, MetricRow, MetricScores};

/// The name in rows.
pub const DATASET: &str = "oxford-steps";

/// The detectors, by their names in rows; the first is the one that systems use.
pub const SYSTEMS: [&str; 3] = ["phone", "card", "wila"];

/// Fewer contacts than this are no truth: the switches of some walks were not connected.
const MIN_CONTACTS: usize = 10;

/// Steps found and steps made in one walk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountedRun {
    /// The walk.
    pub run: RunFolder,
    /// When a foot came down, either one.
    pub contacts: Vec<Timestamp>,
    /// When each detector found a step, in the order of [`SYSTEMS`].
    pub steps: [Vec<Timestamp>; SYSTEMS.len()],
}

/// The walks of some folders, counted.
#[derive(Debug, Default)]
pub struct CountedRuns {
    /// Those with truth, by name.
    pub runs: Vec<CountedRun>,
    /// Why others have none.
    pub warnings: Vec<String>,
    /// Files that should have been readable and were not.
    pub errors: Vec<FormatError>,
}

impl CountedRun {
    /// Error of the detector `system` (an index of [`SYSTEMS`]), in percent of the truth.
    pub fn signed_error_percent(&self, system: usize) -> f64 {
        let n_true = self.contacts.len() as f64;
        100.0 * (self.steps[system].len() as f64 - n_true) / n_true
    }
}

/// Scores the walks in `dirs`.
///
/// A walk without an accelerometer or without contacts gives a warning.
///
/// # Errors
/// When a folder cannot be listed or holds no walk.
pub fn score(dirs: &[PathBuf]) -> Result<MetricScores, FormatError> {
    Ok(count(dirs)?.into_scores())
}

/// Counts the steps of the walks in `dirs`.
///
/// # Errors
/// When a folder cannot be listed or holds no walk.
pub fn count(dirs: &[PathBuf]) -> Result<CountedRuns, FormatError> {
    let mut runs = Vec::new();
    for dir in dirs {
        runs.extend(find_runs(dir)?);
    }
    let outcomes: Vec<_> = runs.into_par_iter().map(counted).collect();
    let mut counted = CountedRuns::default();
    for outcome in outcomes {
        match outcome {
            Ok(Ok(run)) => counted.runs.push(run),
            Ok(Err(warning)) => counted.warnings.push(warning),
            Err(error) => counted.errors.push(error),
        }
    }
    Ok(counted)
}

impl CountedRuns {
    /// The rows of each placement, then of all walks.
    pub fn into_scores(self) -> MetricScores {
        MetricScores {
            rows: rows(&self.runs),
            warnings: self.warnings,
            errors: self.errors,
            plots: Vec::new(),
        }
    }
}

/// The steps of a walk, or why it has no truth.
fn counted(run: RunFolder) -> Result<Result<CountedRun, String>, FormatError> {
    if !run.accelerometer().is_file() {
        return Ok(Err(format!("{}: has no accelerometer.csv, so it is not scored", run.name)));
    }
    let mut contacts = Vec::new();
    for contact in ContactReader::open(&run.contacts())? {
        contacts.push(contact?.time);
    }
    if contacts.len() < MIN_CONTACTS {
        let n = contacts.len();
        return Ok(Err(format!("{}: its foot switches saw {n} contacts, so it is not scored", run.name)));
    }
    let mut phone = Pedestrian::new(PedestrianParams::default());
    let mut level = LevelEstimator::new(LevelParams::default());
    let mut card = Counter::new(CardStepDetector::default());
    let mut wila = Counter::new(WilaStepDetector::new(WilaStepParams::default()));
    let mut phone_steps = Vec::new();
    for sample in AccelerometerReader::open(&run.accelerometer())? {
        let sample = sample?;
        phone_steps.extend(phone.push(&sample).map(|event| event.cycle.end));
        if let Reading::SpecificForce(force) = sample.reading {
            let level_force = level.push_specific_force(sample.time, force);
            card.push(sample.time, level_force);
            wila.push(sample.time, level_force);
        }
    }
    Ok(Ok(CountedRun { run, contacts, steps: [phone_steps, card.steps, wila.steps] }))
}

/// A detector and the times of the steps that it found.
struct Counter<D> {
    detector: D,
    queue: StepQueue<()>,
    steps: Vec<Timestamp>,
}

impl<D: StepDetector> Counter<D> {
    fn new(detector: D) -> Self {
        Self { detector, queue: StepQueue::new(), steps: Vec::new() }
    }

    fn push(&mut self, time: Timestamp, level_force_m_s2: [f32; 3]) {
        if let Some(finding) = self.detector.push(time, level_force_m_s2) {
            let period_s = finding.cycle.end.secs_since(finding.cycle.start);
            self.queue.push(&finding, (), period_s);
        }
        while let Some((cycle, ())) = self.queue.pop() {
            self.steps.push(cycle.end);
        }
    }
}

fn rows(runs: &[CountedRun]) -> Vec<MetricRow> {
    let subset = |name: &str, runs: &[&CountedRun]| -> Vec<MetricRow> {
        let of_system = |(k, system): (usize, &&str)| {
            let errors: Vec<f64> = runs.iter().map(|run| run.signed_error_percent(k)).collect();
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
        let of_it: Vec<&CountedRun> = runs.iter().filter(|run| run.run.placement == placement).collect();
        subset(placement.name(), &of_it)
    };
    let all: Vec<&CountedRun> = runs.iter().collect();
    Placement::ALL.into_iter().flat_map(of_placement).chain(subset(ALL, &all)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(placement: Placement, n_true: usize, n_phone: usize, n_card: usize) -> CountedRun {
        let times = |n: usize| vec![Timestamp::from_millis(0); n];
        CountedRun {
            run: RunFolder { name: "walk".into(), dir: PathBuf::new(), placement },
            contacts: times(n_true),
            steps: [times(n_phone), times(n_card), Vec::new()],
        }
    }

    #[test]
    fn errors_are_means_over_walks() {
        let runs = [
            run(Placement::Purse, 100, 110, 100),
            run(Placement::InHand, 200, 190, 100),
            run(Placement::InHand, 100, 101, 150),
        ];
        let rows = rows(&runs);
        let value = |subset: &str, system: &str, metric| {
            let is_it =
                |row: &&MetricRow| row.subset == subset && row.metric == metric && row.system == system;
            rows.iter().find(is_it).map(|row| (row.value, row.n))
        };
        use Metric::{CountErrorAbsPercent as Abs, CountErrorSignedPercent as Signed};
        // In hand: −5 % and 1 %; purse: 10 %.
        assert_eq!(value("in_hand", "phone", Abs), Some((3.0, 2)));
        assert_eq!(value("in_hand", "phone", Signed), Some((-2.0, 2)));
        assert_eq!(value("purse", "phone", Abs), Some((10.0, 1)));
        assert_eq!(value(ALL, "phone", Abs), Some((16.0 / 3.0, 3)));
        assert_eq!(value(ALL, "phone", Signed), Some((2.0, 3)));
        // −50 % and 50 %.
        assert_eq!(value("in_hand", "card", Abs), Some((50.0, 2)));
        assert_eq!(value("in_hand", "card", Signed), Some((0.0, 2)));
        assert_eq!(rows.len(), 3 * SYSTEMS.len() * 2);
        assert!(rows.last().is_some_and(|row| row.subset == ALL) && super::rows(&[]).is_empty());
    }
}
