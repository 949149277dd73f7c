//! One test walk under one system and one seed.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use fieldwalk::floor_plan::Georeference;
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::metrics::ScoredFix;
use fieldwalk::positioner::{HintedDirection, PositionHint, Positioner};
use fieldwalk::random::CounterRng;
use fieldwalk::sensor::Sample;
use fieldwalk::survey::{SurveyTrack, Waypoint};
use fieldwalk::system::Recipe;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::error::FormatError;
use fieldwalk_formats::recording::Record;
use rand::RngExt;

use crate::evaluation::cut_offs::cut_offs;
use crate::evaluation::{PointKind, Start};
use crate::report::{Truth, Walk, WalkRecorder};
use crate::walks::ReadWalk;

/// A place and time at which the truth is known.
#[derive(Clone, Copy, Debug)]
pub struct TruthPoint {
    /// How it is known.
    pub kind: PointKind,
    /// When.
    pub time: Timestamp,
    /// Where.
    pub point: Point2,
}

/// A walk that the map has not seen, in memory.
#[derive(Debug)]
pub struct TestWalk {
    /// Its samples, in order of time.
    pub samples: Vec<Sample>,
    /// The first place that is known: the start.
    pub start: Waypoint,
    /// What is scored, in order of time.
    pub truth: Vec<TruthPoint>,
    /// The truth at all times for which it is known.
    pub line: Truth,
}

/// What a log is to a floor that is scored.
#[derive(Debug)]
pub enum ReadTest {
    /// A walk with known places.
    Walk(TestWalk),
    /// It has no two waypoints.
    WithoutWaypoints,
    /// It says that it was taken on this other floor.
    OfOtherFloor(String),
}

/// The scores of one walk.
#[derive(Debug, Default)]
pub struct WalkScore {
    /// Each truth point with its fix's score; nothing where there was no fix.
    pub points: Vec<(PointKind, Option<ScoredFix>)>,
    /// Time of each call that consumed a step, in µs.
    pub step_us: Vec<f64>,
    /// Whether the start was refused, because it lies off the plan; the walk was then scored without.
    pub is_start_refused: bool,
}

impl TestWalk {
    /// Reads a log of any format for the floor called `floor`, its waypoints in degrees placed at `georeference`.
    ///
    /// Where `nodes` are given, the walk is also scored at five moments away from them: its cut-offs.
    ///
    /// # Errors
    /// When the file cannot be read or is no log, or its waypoints cannot be placed.
    pub fn read(
        path: &Path,
        floor: &str,
        georeference: Option<Georeference>,
        nodes: Option<&[Point2]>,
    ) -> Result<ReadTest, FormatError> {
        let mut samples = Vec::new();
        let read = ReadWalk::open_with(path, georeference, |record| {
            if let Record::Sample(sample) = record {
                samples.push(*sample);
            }
        })?;
        if let Some(name) = read.other_floor(floor) {
            return Ok(ReadTest::OfOtherFloor(name.into()));
        }
        let Some(track) = SurveyTrack::of(&read.walk) else { return Ok(ReadTest::WithoutWaypoints) };
        let start = track.waypoints()[0];
        let mut truth = truth_points(&track);
        truth.extend(nodes.into_iter().flat_map(|nodes| cut_offs(path, track.waypoints(), nodes)));
        truth.sort_by_key(|truth| truth.time);
        // The reader has ordered them but for the odd record that came very late: scoring stops at instants.
        samples.sort_by_key(|sample| sample.time);
        let line = Truth::of_track(&track);
        Ok(ReadTest::Walk(Self { samples, start, truth, line }))
    }
}

/// The points to score on a walk laid out along its waypoints: all but the first, and midway between them.
pub fn truth_points(track: &SurveyTrack) -> Vec<TruthPoint> {
    let mut truth = Vec::new();
    for pair in track.waypoints().windows(2) {
        let middle = pair[0].time.midpoint(pair[1].time);
        if let Some(point) = track.position(middle) {
            truth.push(TruthPoint { kind: PointKind::Midpoint, time: middle, point });
        }
        truth.push(TruthPoint { kind: PointKind::Waypoint, time: pair[1].time, point: pair[1].point });
    }
    truth
}

/// Runs `recipes` over `walk` once more and keeps what a page shows of them, under the name `name`.
pub fn record(
    floor: &Arc<FloorIndex>,
    recipes: &[Recipe],
    start: Start,
    seed: u64,
    walk: &TestWalk,
    name: &str,
) -> Walk {
    let mut recorder = WalkRecorder::new(floor, recipes, seed);
    if let Some(hint) = hint(start, seed, floor.map().ordinal, walk) {
        // A start off the plan is refused; the walk is then played as it was scored, without.
        let _ = recorder.hint(hint);
    }
    let mut samples = walk.samples.iter().peekable();
    let began = walk.samples.first().map_or(walk.start.time, |sample| sample.time);
    for truth in &walk.truth {
        while let Some(sample) = samples.next_if(|sample| sample.time <= truth.time) {
            recorder.push(sample);
        }
        recorder.pass(truth);
    }
    samples.for_each(|sample| recorder.push(sample));
    Walk::new(name, seed, began, &recorder.finish(), &walk.line)
}

/// Runs `recipe` over `walk` and scores it at every truth point, with what came before that and no more.
pub fn score(
    floor: &Arc<FloorIndex>,
    recipe: &Recipe,
    start: Start,
    seed: u64,
    walk: &TestWalk,
) -> WalkScore {
    let mut positioner = Positioner::new(Arc::clone(floor), recipe.clone(), seed);
    let hint = hint(start, seed, floor.map().ordinal, walk);
    let is_start_refused = hint.is_some_and(|hint| positioner.hint(hint).is_err());
    let mut result = WalkScore { is_start_refused, ..WalkScore::default() };
    let mut samples = walk.samples.iter().peekable();
    for truth in &walk.truth {
        while let Some(sample) = samples.next_if(|sample| sample.time <= truth.time) {
            let before = Instant::now();
            if positioner.push(*sample).is_some() {
                result.step_us.push(before.elapsed().as_secs_f64() * 1e6);
            }
        }
        let scored = positioner.fix_at(truth.time).map(|fix| ScoredFix {
            error_m: fix.position.distance_m(truth.point),
            radius_68_m: fix.radius_68_m,
            radius_95_m: fix.radius_95_m,
        });
        result.points.push((truth.kind, scored.ok()));
    }
    result
}

/// Where `recipe` puts the walker at every truth point of `walk`; nothing where there was no fix.
pub fn fixes(
    floor: &Arc<FloorIndex>,
    recipe: &Recipe,
    start: Start,
    seed: u64,
    walk: &TestWalk,
) -> Vec<Option<Point2>> {
    let mut positioner = Positioner::new(Arc::clone(floor), recipe.clone(), seed);
    if let Some(hint) = hint(start, seed, floor.map().ordinal, walk) {
        // As in `score`: a start off the plan is refused.
        let _ = positioner.hint(hint);
    }
    let mut samples = walk.samples.iter().peekable();
    let at = |truth: &TruthPoint| {
        while let Some(sample) = samples.next_if(|sample| sample.time <= truth.time) {
            positioner.push(*sample);
        }
        positioner.fix_at(truth.time).ok().map(|fix| fix.position)
    };
    walk.truth.iter().map(at).collect()
}

/// The direction of a walk's start is that to the first truth point so far away, in metres: three steps.
const FIRST_WAY_M: f64 = 2.0;

/// The truth, off by up to the radius along each axis, and the first way, off by up to the angle.
fn hint(start: Start, seed: u64, floor: i32, walk: &TestWalk) -> Option<PositionHint> {
    let truth = walk.start;
    let radius_m = match start {
        Start::Known { radius_m } | Start::Facing { radius_m, .. } => radius_m,
        Start::Cold => return None,
    };
    let mut rng = CounterRng::new(seed, truth.time.as_nanos() as u64);
    let mut off_m = || rng.random_range(-radius_m..=radius_m);
    let off = Point2::new(off_m(), off_m());
    let direction = match start {
        Start::Facing { off_deg, .. } => {
            let off_rad = off_deg.to_radians();
            let angle_rad = rng.random_range(-off_rad..=off_rad);
            // That of a number uniform to either side.
            let sd_rad = off_rad / 3.0_f64.sqrt();
            let way =
                walk.truth.iter().map(|t| t.point - truth.point).find(|way| way.norm_m() >= FIRST_WAY_M);
            way.map(|way| HintedDirection { heading_rad: way.heading_rad() + angle_rad, sd_rad })
        }
        _ => None,
    };
    Some(PositionHint { point: truth.point + off, radius_m, floor, time: truth.time, direction })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_start_is_off_by_the_radius_at_most_and_differs_by_seed() {
        let start = Waypoint { time: Timestamp::from_millis(7), point: Point2::new(10.0, 20.0) };
        let walk = TestWalk { samples: Vec::new(), start, truth: Vec::new(), line: Truth::default() };
        let points: Vec<Point2> = (0..100)
            .filter_map(|seed| hint(Start::Known { radius_m: 2.0 }, seed, 0, &walk))
            .map(|hint| hint.point - start.point)
            .collect();
        assert!(points.iter().all(|off| off.x_m.abs() <= 2.0 && off.y_m.abs() <= 2.0));
        // Uniform: the spread along an axis is 2/√3 = 1.15 m.
        let spread_m = (points.iter().map(|off| off.x_m * off.x_m).sum::<f64>() / 100.0).sqrt();
        assert!((1.0..1.3).contains(&spread_m), "{spread_m}");
        assert!(points[0] != points[1]);
        assert_eq!(hint(Start::Cold, 1, 0, &walk), None);
    }

    #[test]
    fn a_told_direction_is_that_of_the_first_two_metres_within_its_angle() {
        let start = Waypoint { time: Timestamp::from_millis(7), point: Point2::new(10.0, 20.0) };
        // A step to the left, then on along x.
        let truth = [Point2::new(9.0, 20.0), Point2::new(13.0, 20.0)].map(|point| TruthPoint {
            kind: PointKind::Waypoint,
            time: start.time,
            point,
        });
        let walk = TestWalk { samples: Vec::new(), start, truth: truth.into(), line: Truth::default() };
        let facing = Start::Facing { radius_m: 1.0, off_deg: 10.0 };
        let told: Vec<HintedDirection> =
            (0..100).filter_map(|seed| hint(facing, seed, 0, &walk)?.direction).collect();
        let off_deg = |told: &HintedDirection| (told.heading_rad - core::f64::consts::FRAC_PI_2).to_degrees();
        assert!(told.len() == 100 && told.iter().all(|told| off_deg(told).abs() <= 10.0), "{told:?}");
        assert!(told.iter().any(|told| off_deg(told) < -5.0) && told.iter().any(|told| off_deg(told) > 5.0));
        // 10°/√3
        assert!((told[0].sd_rad.to_degrees() - 5.774).abs() < 0.001);
        assert_eq!(hint(Start::Known { radius_m: 1.0 }, 1, 0, &walk).unwrap().direction, None);
    }
}
