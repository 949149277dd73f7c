//! Surveying: walks with waypoints become a floor map.
//!
//! A waypoint's coordinates enter a map only through the line that it ends: they place the steps between two
//! waypoints, and nothing else ever sees them.

mod build;
mod carrying;
mod coverage;
mod kriging;
mod leave_one_out;
mod radio;
mod track;

use serde::{Deserialize, Serialize};

pub use build::{MAX_NODES, SurveyError, SurveyParams, build_floor, check_extent};
pub use carrying::CarryFault;
pub use coverage::{Cover, Coverage, LiveCoverage, OpenFloor};
pub use kriging::KrigingParams;
pub use leave_one_out::LeaveOneOut;
pub use track::{SurveyTrack, TrackStep};

use crate::attitude::AttitudeEstimate;
use crate::geometry::Point2;
use crate::pedestrian::{Pedestrian, PedestrianParams, StepEvent};
use crate::reorder::{DEFAULT_REORDER_WINDOW, Rejections, ReorderWindow};
use crate::sensor::{RadioSighting, Reading, Sample};
use crate::time::Timestamp;

/// Farther from the floor's origin than this no waypoint is, in metres.
const MAX_PLACE_M: f64 = 1e6;

/// A place that the surveyor said to be at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Waypoint {
    /// When.
    pub time: Timestamp,
    /// Where, in the floor frame.
    pub point: Point2,
}

/// When a step became known: a positioner hears of it then, and not before.
#[derive(Clone, Copy, Debug)]
struct Completion {
    /// Time of the latest sample by then.
    time: Timestamp,
    /// Sightings consumed by then.
    n_sightings: usize,
}

/// One walk, condensed while it is recorded: its steps, its waypoints and what radio was heard.
#[derive(Clone, Debug)]
pub struct SurveyWalk {
    name: String,
    pedestrian: Pedestrian,
    reorder: ReorderWindow,
    steps: Vec<StepEvent>,
    /// Per step, when it became known.
    completions: Vec<Completion>,
    waypoints: Vec<Waypoint>,
    n_refused_waypoints: u64,
    sightings: Vec<(Timestamp, RadioSighting)>,
}

impl SurveyWalk {
    /// An empty walk called `name` (of its recording, for messages).
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            pedestrian: Pedestrian::new(PedestrianParams::default()),
            reorder: ReorderWindow::new(DEFAULT_REORDER_WINDOW),
            steps: Vec::new(),
            completions: Vec::new(),
            waypoints: Vec::new(),
            n_refused_waypoints: 0,
            sightings: Vec::new(),
        }
    }

    /// The walk's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Takes a sample in; bad ones are counted in [`SurveyWalk::rejections`].
    pub fn push(&mut self, sample: &Sample) {
        self.reorder.push(sample);
        while let Some(next) = self.reorder.pop() {
            self.consume(&next, sample.time);
        }
    }

    /// Takes a waypoint in; one that is no place on Earth, or not after the last one, is counted and dropped.
    pub fn push_waypoint(&mut self, waypoint: Waypoint) {
        let is_place = waypoint.point.norm_m() <= MAX_PLACE_M;
        if !is_place || self.waypoints.last().is_some_and(|last| last.time >= waypoint.time) {
            self.n_refused_waypoints += 1;
        } else {
            self.waypoints.push(waypoint);
        }
    }

    /// Takes the last waypoint back: it was tapped in the wrong place.
    pub fn pop_waypoint(&mut self) -> Option<Waypoint> {
        self.waypoints.pop()
    }

    /// Consumes what still waits for late samples: the walk has ended.
    pub fn finish(&mut self) {
        while let Some(next) = self.reorder.pop_all() {
            self.consume(&next, next.time + DEFAULT_REORDER_WINDOW);
        }
    }

    /// The steps so far.
    pub fn steps(&self) -> &[StepEvent] {
        &self.steps
    }

    /// How the phone is held now.
    pub fn attitude(&self) -> AttitudeEstimate {
        self.pedestrian.attitude()
    }

    /// What is wrong with the way in which the phone was carried during most of the last eight steps.
    pub fn carry_fault(&self) -> Option<CarryFault> {
        CarryFault::of_last(&self.steps)
    }

    /// The waypoints so far, in order of time.
    pub fn waypoints(&self) -> &[Waypoint] {
        &self.waypoints
    }

    /// The radio sightings so far.
    pub fn sightings(&self) -> &[(Timestamp, RadioSighting)] {
        &self.sightings
    }

    /// Samples refused so far, by cause.
    pub fn rejections(&self) -> Rejections {
        self.reorder.rejections()
    }

    /// Waypoints refused so far.
    pub fn n_refused_waypoints(&self) -> u64 {
        self.n_refused_waypoints
    }

    fn consume(&mut self, sample: &Sample, known_at: Timestamp) {
        if let Reading::Radio(sighting) = sample.reading {
            self.sightings.push((sample.time, sighting));
        }
        if let Some(step) = self.pedestrian.push(sample) {
            self.steps.push(step);
            self.completions.push(Completion { time: known_at, n_sightings: self.sightings.len() });
        }
    }
}
