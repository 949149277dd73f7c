//! Ranges, trilateration and fingerprints on the position-annotated BLE collection, whose emitter is taken for a card
//! and whose twelve receivers for access points.
//!
//! What is fitted never saw what is scored: the path loss of each receiver and the fingerprints come from one half of
//! the fixed points (every other one along each row of them) for the other half, both ways, and from all fixed points
//! for the tracks, which were recorded months later. Rounds are of a second. Ranges and places are made from the mean
//! power of the last second (`…_1s`) and of the last five (`…_5s`); RADAR and the card's filter from rounds, as the
//! systems do. The truth is the emitter's place at the end of the round.
//!
//! *Near* (subsets ending in `_near`): three receivers hang within [`NEAR_M`] of the emitter's true place. Neighbouring
//! receivers hang 4 to 7 m apart, so this is the inside of a triangle whose side is the range, as iBILL hangs clusters.

mod methods;
mod rounds;

use std::path::{Path, PathBuf};

use fieldwalk_formats::FormatError;
use fieldwalk_formats::ble_annotated::{Area, find_points, find_tracks, open_area};
use rayon::prelude::*;

use self::methods::{Fitted, Outcome, System, score_capture};
use self::rounds::Capture;
use super::{Metric, MetricRow, MetricScores};

/// The name in rows.
pub const DATASET: &str = "ble-annotated";

/// A place is near when three receivers are at most this far, in metres.
pub const NEAR_M: f64 = 6.0;

/// Scores the collections in `dirs`.
///
/// # Errors
/// When a folder is not the collection's.
pub fn score(dirs: &[PathBuf]) -> Result<MetricScores, FormatError> {
    let mut scores = MetricScores::default();
    let (mut fixed, mut tracks) = (Vec::new(), Vec::new());
    for dir in dirs {
        let area = open_area(dir)?;
        let points = find_points(dir)?;
        let points = read(&points, &mut scores, |point| Capture::of_point(&area, point));
        let ways = read(&find_tracks(dir)?, &mut scores, |track| Capture::of_track(&area, track));
        match score_area(&area, &points, &ways) {
            Ok((of_points, of_tracks)) => {
                fixed.extend(of_points);
                tracks.extend(of_tracks);
            }
            Err(why) => scores.warnings.push(format!("{}: {why}, so it is not scored", dir.display())),
        }
    }
    for (subset, outcomes) in [("fixed", fixed), ("tracks", tracks)] {
        let near: Vec<Outcome> = outcomes.iter().filter(|outcome| outcome.is_near).copied().collect();
        scores.rows.extend(rows(subset, &outcomes));
        scores.rows.extend(rows(&format!("{subset}_near"), &near));
    }
    Ok(scores)
}

/// Reads the captures of `sources`; what cannot be read, or only in part, is told in `scores`.
fn read<T: Sync>(
    sources: &[T],
    scores: &mut MetricScores,
    read: impl Fn(&T) -> Result<Capture, FormatError> + Sync,
) -> Vec<Capture> {
    let read: Vec<_> = sources.par_iter().map(&read).collect();
    let mut captures = Vec::new();
    for capture in read {
        match capture {
            Ok(capture) => {
                scores.warnings.extend(capture.warnings.iter().cloned());
                captures.push(capture);
            }
            Err(error) => scores.errors.push(error),
        }
    }
    captures
}

/// The outcomes on the fixed points and on the tracks; why there are none where nothing can be fitted.
fn score_area(
    area: &Area,
    points: &[Capture],
    tracks: &[Capture],
) -> Result<(Vec<Outcome>, Vec<Outcome>), String> {
    let half = |of: usize| points.iter().skip(of).step_by(2).collect::<Vec<_>>();
    let mut fixed = Vec::new();
    for (scored, fitted_to) in [(0, 1), (1, 0)] {
        let fitted = Fitted::of(area, &half(fitted_to))?;
        fixed.extend(score_all(area, &fitted, &half(scored)));
    }
    let fitted = Fitted::of(area, &points.iter().collect::<Vec<_>>())?;
    let tracks = score_all(area, &fitted, &tracks.iter().collect::<Vec<_>>());
    Ok((fixed, tracks))
}

fn score_all(area: &Area, fitted: &Fitted, captures: &[&Capture]) -> Vec<Outcome> {
    captures.par_iter().flat_map_iter(|capture| score_capture(area, fitted, capture)).collect()
}

/// The rows of a subset, system by system.
fn rows(subset: &str, outcomes: &[Outcome]) -> Vec<MetricRow> {
    let mut rows = Vec::new();
    for system in System::ALL {
        let of_system: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.system == system).collect();
        for metric in system.metrics() {
            let (value, n) = measure(*metric, &of_system);
            let subset = subset.to_owned();
            rows.push(MetricRow {
                dataset: DATASET,
                subset,
                system: system.name().into(),
                metric: *metric,
                value,
                n,
            });
        }
    }
    rows
}

/// The value of a metric over outcomes, and how many are behind it.
fn measure(metric: Metric, outcomes: &[&Outcome]) -> (f64, usize) {
    let share = |is: fn(&Outcome) -> bool| {
        let n = outcomes.iter().filter(|outcome| is(outcome)).count();
        (100.0 * n as f64 / outcomes.len() as f64, outcomes.len())
    };
    let mut errors_m: Vec<f64> = outcomes.iter().filter_map(|outcome| outcome.error_m).collect();
    let n = errors_m.len();
    match metric {
        Metric::RangeBiasM => (errors_m.iter().sum::<f64>() / n as f64, n),
        Metric::PlacedPercent => share(|outcome| outcome.error_m.is_some()),
        Metric::ReliablePercent => share(|outcome| outcome.is_reliable),
        Metric::TruthNearMatchPercent => {
            share(|outcome| outcome.error_m.is_some_and(|m| m <= methods::FILTER_M))
        }
        Metric::TruthDroppedPercent => share(|outcome| outcome.is_dropped),
        metric => {
            errors_m.iter_mut().for_each(|m| *m = m.abs());
            errors_m.sort_by(f64::total_cmp);
            let p = if metric == Metric::PlaceErrorP80M { 0.8 } else { 0.5 };
            (fieldwalk::metrics::quantile(&errors_m, p), n)
        }
    }
}

/// A file's name for warnings.
fn shown(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(error_m: Option<f64>) -> Outcome {
        Outcome { system: System::Radar, error_m, is_near: true, is_reliable: false, is_dropped: false }
    }

    #[test]
    fn metrics_by_hand() {
        let outcomes = [outcome(Some(-2.0)), outcome(Some(7.0)), outcome(None), outcome(Some(1.0))];
        let of = |metric| measure(metric, &outcomes.iter().collect::<Vec<_>>());
        assert_eq!(of(Metric::RangeBiasM), (2.0, 3));
        assert_eq!(of(Metric::RangeErrorMedianM), (2.0, 3));
        assert_eq!(of(Metric::PlaceErrorMedianM), (2.0, 3));
        assert_eq!(of(Metric::PlaceErrorP80M), (5.0, 3));
        assert_eq!(of(Metric::PlacedPercent), (75.0, 4));
        assert_eq!(of(Metric::TruthNearMatchPercent), (50.0, 4));
        assert!(measure(Metric::RangeBiasM, &[]).0.is_nan());
    }
}
