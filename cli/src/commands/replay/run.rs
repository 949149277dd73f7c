//! One recording through a positioner, record by record.

use std::path::Path;
use std::sync::Arc;

use fieldwalk::Rejections;
use fieldwalk::front_end::FrontEndRule;
use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::positioner::{Fix, PositionError, PositionHint, Positioner};
use fieldwalk::sensor::Reading;
use fieldwalk::system::Recipe;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::{LineRejections, floor_ordinal};
use fieldwalk_formats::recording::{InOrder, Losses, Record, open_recording_on};

use crate::arguments::ReplayStart;
use crate::stop::Stop;
use crate::walks::check_frame;

/// What to run, and from where.
#[derive(Debug)]
pub struct Replay {
    pub floor: Arc<FloorIndex>,
    pub recipe: Recipe,
    pub seed: u64,
    pub start: ReplayStart,
    /// How far off the start may be, in metres.
    pub start_radius_m: f64,
}

/// Takes what a replay gives, in order of time.
pub trait Sink {
    /// A step was made; `time_s` counts from the recording's first record.
    fn fix(&mut self, time_s: f64, fix: &Fix) -> Result<(), Stop>;

    /// The walker stood at a known place.
    fn waypoint(&mut self, time_s: f64, passed: &PassedWaypoint) -> Result<(), Stop>;

    /// The recording has ended.
    fn end(&mut self, ending: &Ending<'_>) -> Result<(), Stop>;
}

/// A waypoint and what was said there.
#[derive(Debug)]
pub struct PassedWaypoint {
    /// Where the walker stood.
    pub truth: Point2,
    /// What the positioner said at that time.
    pub fix: Result<Fix, PositionError>,
    /// Whether it is the recording's first: the place where the start may come from.
    pub is_first: bool,
}

/// What is known at the end of a recording.
#[derive(Debug)]
pub struct Ending<'a> {
    /// From the first record to the last consumed, in seconds.
    pub duration_s: f64,
    /// Samples rejected, by cause.
    pub samples: Rejections,
    /// What the log did not give.
    pub losses: Losses,
    /// Of a text log, the lines rejected, by cause.
    pub lines: Option<&'a LineRejections>,
    /// Times that every particle died and the cloud was spread anew.
    pub n_recoveries: u32,
    /// Whether the system was told of a start.
    pub is_started: bool,
    /// Why the system made no step of any sample, where that is known from their kinds.
    pub unused: Option<&'static str>,
}

/// Refuses a recording that says of itself, with `floor_name`, that it was made on another floor than the map's.
///
/// Floors of a building share one frame, so its fixes would look plausible and be wrong.
pub fn check_floor(map: &FloorMap, floor_name: Option<&str>, path: &Path) -> Result<(), Stop> {
    match floor_name {
        Some(name) if floor_ordinal(name) != map.ordinal => Err(Stop::Failed(format!(
            "{}: recorded on floor {name}, but the map is of {} (choose that floor's map with --floor)",
            path.display(),
            map.name
        ))),
        _ => Ok(()),
    }
}

/// Says that a start is not on the plan.
pub fn off_plan(map: &FloorMap, point: Point2, trace: &Path) -> Stop {
    let Point2 { x_m, y_m } = point;
    let message = format!(
        "the start, {x_m:.1}, {y_m:.1}, is not on the plan of floor {}, {:.0} m by {:.0} m",
        map.name, map.plan.width_m, map.plan.height_m
    );
    FormatError::malformed(message, "check --floor and --start, and that the map is of the same building")
        .at_path(trace)
        .into()
}

/// The kinds of readings of which steps are made.
#[derive(Clone, Copy, Debug, Default)]
struct Kinds {
    has_force: bool,
    has_card_frames: bool,
}

impl Kinds {
    fn count(&mut self, reading: &Reading) {
        self.has_force |= matches!(reading, Reading::SpecificForce(_));
        self.has_card_frames |= matches!(reading, Reading::CardFrame(_));
    }
}

impl Replay {
    /// Runs the recording at `trace`, in order of time and never holding more than a part of it.
    pub fn run(&self, trace: &Path, sink: &mut impl Sink) -> Result<(), Stop> {
        let mut positioner = Positioner::new(Arc::clone(&self.floor), self.recipe.clone(), self.seed);
        let mut log = InOrder::new(open_recording_on(trace, self.floor.map().plan.georeference)?);
        let mut began: Option<Timestamp> = None;
        let mut last = Timestamp::MIN;
        let (mut is_started, mut has_waypoint) = (false, false);
        let mut kinds = Kinds::default();
        while let Some(record) = log.next() {
            // A log may name its floor as late as at a waypoint.
            check_floor(self.floor.map(), log.source().floor_name(), trace)?;
            let record = record?;
            let time = record.time();
            let first = *began.get_or_insert(time);
            if matches!(record, Record::Waypoint { .. }) {
                check_frame(&**log.source(), trace)?;
            }
            last = last.max(time);
            let hint = match (self.start, &record) {
                (ReplayStart::At(point), _) => Some(point),
                (ReplayStart::Waypoint, Record::Waypoint { point, .. }) => Some(*point),
                _ => None,
            };
            if let Some(point) = hint.filter(|_| !is_started) {
                self.hint(&mut positioner, point, time, trace)?;
                is_started = true;
            }
            match record {
                Record::Sample(sample) => {
                    kinds.count(&sample.reading);
                    if let Some(fix) = positioner.push(sample) {
                        sink.fix(fix.time.secs_since(first), &fix)?;
                    }
                }
                Record::Waypoint { time, point } => {
                    let fix = positioner.fix_at(time);
                    let passed = PassedWaypoint { truth: point, fix, is_first: !has_waypoint };
                    sink.waypoint(time.secs_since(first), &passed)?;
                    has_waypoint = true;
                }
            }
        }
        positioner.flush();
        let first = began.unwrap_or(last);
        if let Some(fix) = positioner.fix() {
            sink.fix(fix.time.secs_since(first), &fix)?;
        }
        sink.end(&Ending {
            duration_s: last.secs_since(first),
            samples: positioner.rejections(),
            losses: log.source().losses(),
            lines: log.source().line_rejections(),
            n_recoveries: positioner.n_recoveries(),
            is_started,
            unused: self.unused(&kinds),
        })
    }

    /// Why the system could make no step of a recording that holds `kinds` of readings.
    fn unused(&self, kinds: &Kinds) -> Option<&'static str> {
        match (self.recipe.front_end, kinds) {
            (_, Kinds { has_force: true, .. })
            | (FrontEndRule::Card, Kinds { has_card_frames: true, .. }) => None,
            (_, Kinds { has_card_frames: true, .. }) => Some(
                "it holds the frames of an ID card, of which this system makes nothing: give --system card",
            ),
            _ => Some("no accelerometer is in it, without which there are no steps: record it too"),
        }
    }

    fn hint(
        &self,
        positioner: &mut Positioner,
        point: Point2,
        time: Timestamp,
        trace: &Path,
    ) -> Result<(), Stop> {
        let map = self.floor.map();
        let hint =
            PositionHint { point, radius_m: self.start_radius_m, floor: map.ordinal, time, direction: None };
        positioner.hint(hint).map_err(|_| off_plan(map, point, trace))
    }
}
