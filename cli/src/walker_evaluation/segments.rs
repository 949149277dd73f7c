//! Step lengths against the distances between waypoints.
//!
//! A segment is straight when the steps between two waypoints make at least 95 % of their length along one direction, by
//! the gyroscope, and are three at least. Its error is `|modelled − true| / true`, in percent, where the modelled length
//! is the sum over its steps, those at its ends by their share. Counted are segments before which ten steps have been
//! made in the walk. Waypoints are tapped by hand, half a metre to a metre off: of a segment of six metres that alone
//! is a tenth.
//!
//! `learnt` is the fitted model times the walker's scale, learnt from the walk's segments before the one that is
//! predicted, and from nothing else.

use std::path::PathBuf;

use fieldwalk::geometry::Point2;
use fieldwalk::pedestrian::StepEvent;
use fieldwalk::step::{LengthScaleEstimator, LengthScaleParams, StepLengthModel};
use fieldwalk::survey::{SurveyWalk, Waypoint};
use fieldwalk::system::Recipe;
use fieldwalk_formats::FormatError;
use rayon::prelude::*;

use super::{ALL, Metric, MetricRow, MetricScores};
use crate::floors::{Floor, Layout, find_floors};
use crate::walks::ReadWalk;

/// What predicts a segment's length, by its name in rows.
pub const SYSTEMS: [&str; 3] = ["static", "fitted", "learnt"];

/// The model of the system `static`.
const STATIC: StepLengthModel = StepLengthModel::Static { length_m: 0.65 };
const MIN_STRAIGHTNESS: f64 = 0.95;
const MIN_STEPS: f64 = 3.0;
/// Shorter than this, in metres, a segment is a correction of the last tap.
const MIN_LENGTH_M: f64 = 0.5;
/// Steps made in a walk before its segments count.
const LEARNING_STEPS: usize = 10;

/// Errors of the systems on one segment, in percent.
type Errors = [f64; SYSTEMS.len()];

/// Scores the walks on the floors in `dirs`.
///
/// # Errors
/// When a folder cannot be read or holds no floor.
pub fn score(dirs: &[PathBuf], layout: Layout) -> Result<MetricScores, FormatError> {
    let mut scores = MetricScores::default();
    let mut all: Vec<Errors> = Vec::new();
    let mut rows = |subset: &str, segments: &[Errors]| {
        for (k, system) in SYSTEMS.into_iter().enumerate() {
            scores.rows.push(MetricRow {
                dataset: layout.name(),
                subset: subset.into(),
                system: system.into(),
                metric: Metric::SegmentLengthErrorPercent,
                value: segments.iter().map(|errors| errors[k]).sum::<f64>() / segments.len() as f64,
                n: segments.len(),
            });
        }
    };
    let mut failures = Vec::new();
    for found in find_floors(dirs, layout)? {
        let floor = match Floor::open(&found.dir, layout) {
            Ok(floor) => floor,
            Err(error) => {
                failures.push(error);
                continue;
            }
        };
        let outcomes: Vec<_> =
            floor.traces.par_iter().map(|path| ReadWalk::open(path, floor.plan.georeference)).collect();
        let mut segments = Vec::new();
        for outcome in outcomes {
            match outcome {
                Ok(read) => segments.extend(errors(&read.walk)),
                Err(error) => failures.push(error),
            }
        }
        rows(&found.label, &segments);
        all.extend(segments);
    }
    rows(ALL, &all);
    scores.errors = failures;
    Ok(scores)
}

/// The errors on the segments of `walk` that count.
fn errors(walk: &SurveyWalk) -> Vec<Errors> {
    let fitted = Recipe::fused().length;
    let mut learnt = LengthScaleEstimator::new(LengthScaleParams::default());
    let mut errors = Vec::new();
    for pair in walk.waypoints().windows(2) {
        let Some(segment) = Segment::of(walk.steps(), pair[0], pair[1]) else { continue };
        let fitted_m = segment.modelled_m(&fitted);
        let modelled_m = [segment.modelled_m(&STATIC), fitted_m, f64::from(learnt.scale()) * fitted_m];
        let n_before = walk.steps().iter().take_while(|step| step.cycle.end <= pair[0].time).count();
        if n_before >= LEARNING_STEPS {
            errors.push(modelled_m.map(|m| 100.0 * (m / segment.true_m - 1.0).abs()));
        }
        learnt.push(segment.true_m as f32, fitted_m as f32, segment.n_steps().round() as u32);
    }
    errors
}

/// A straight way between two waypoints.
struct Segment<'a> {
    true_m: f64,
    /// The steps, and which share of each falls into the segment.
    steps: Vec<(f64, &'a StepEvent)>,
}

impl<'a> Segment<'a> {
    fn of(steps: &'a [StepEvent], from: Waypoint, to: Waypoint) -> Option<Self> {
        let inside: Vec<(f64, &StepEvent)> = steps
            .iter()
            .filter_map(|step| {
                let (start, end) = (step.cycle.start, step.cycle.end);
                let overlap_s = to.time.min(end).secs_since(from.time.max(start));
                let share = overlap_s / end.secs_since(start);
                (share > 0.0).then_some((share, step))
            })
            .collect();
        let segment = Self { true_m: from.point.distance_m(to.point), steps: inside };
        let sum = segment.steps.iter().fold(Point2::default(), |sum, (share, step)| {
            sum + Point2::from_polar(*share, f64::from(step.level_heading_rad))
        });
        let n_steps = segment.n_steps();
        let is_straight = sum.norm_m() >= MIN_STRAIGHTNESS * n_steps;
        (segment.true_m >= MIN_LENGTH_M && n_steps >= MIN_STEPS && is_straight).then_some(segment)
    }

    fn n_steps(&self) -> f64 {
        self.steps.iter().map(|(share, _)| share).sum()
    }

    fn modelled_m(&self, model: &StepLengthModel) -> f64 {
        self.steps.iter().map(|(share, step)| share * f64::from(model.advance_m(&step.cycle))).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::step::StepCycle;
    use fieldwalk::time::Timestamp;

    fn step(start_ms: i64, heading_rad: f32) -> StepEvent {
        StepEvent {
            cycle: StepCycle {
                start: Timestamp::from_millis(start_ms),
                end: Timestamp::from_millis(start_ms + 500),
                frequency_hz: 2.0,
                amplitude_m_s2: 4.0,
                is_first: false,
            },
            n_steps: 1,
            reads: [None; 3],
            level_heading_rad: heading_rad,
            forward_field: None,
            end_strength_ut: None,
            field_bias_reset: false,
            attitude: fieldwalk::attitude::AttitudeEstimate::default(),
        }
    }

    fn waypoint(time_ms: i64, y_m: f64) -> Waypoint {
        Waypoint { time: Timestamp::from_millis(time_ms), point: Point2::new(0.0, y_m) }
    }

    #[test]
    fn a_segment_has_its_steps_those_at_its_ends_by_their_share() {
        let steps: Vec<StepEvent> = (0..8).map(|k| step(500 * k, 0.1)).collect();
        // Half of the second step, the third to the sixth, and a fifth of the seventh.
        let segment = Segment::of(&steps, waypoint(750, 1.0), waypoint(3_100, 4.0)).unwrap();
        assert!((segment.n_steps() - 4.7).abs() < 1e-9);
        assert!((segment.modelled_m(&STATIC) - 4.7 * 0.65).abs() < 1e-6 && segment.true_m == 3.0);
        // Too few steps, too short, not straight.
        assert!(Segment::of(&steps, waypoint(0, 1.0), waypoint(1_000, 4.0)).is_none());
        assert!(Segment::of(&steps, waypoint(0, 1.0), waypoint(3_000, 1.4)).is_none());
        let corner: Vec<StepEvent> = (0..8).map(|k| step(500 * k, if k < 4 { 0.0 } else { 1.6 })).collect();
        assert!(Segment::of(&corner, waypoint(0, 1.0), waypoint(4_000, 4.0)).is_none());
    }
}
