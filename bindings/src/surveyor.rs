//! Surveying a floor: walks with waypoints, seen covering it while they are walked.

use std::path::Path;
use std::sync::{Arc, Mutex};

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry;
use fieldwalk::survey::{
    self, Cover, LiveCoverage, OpenFloor, SurveyParams, SurveyTrack, SurveyWalk, check_extent,
};
use fieldwalk::time::Timestamp;
use fieldwalk_batch::SampleBatch;
use fieldwalk_formats::ilc::floor_ordinal;
use fieldwalk_formats::{Record, read_plan};

use crate::carrying::CarryWarning;
use crate::error::{ApiError, api_error, locked};
use crate::fix::{Attitude, CarryMode};
use crate::floor_drawing::FloorDrawing;
use crate::missing::InputWatch;
use crate::recorder::Waypoint;
use crate::recording_reader::for_each_record;
use crate::samples::take_each;
use crate::status::{BatchFaults, Rejections};
use crate::survey_status::{SurveyStatus, WalkRefusal, WalkReport};
use crate::surveyed_floor::{CoverageTotals, SurveyedFloor};

/// Surveys one floor.
///
/// Begin a walk, tap a waypoint where it starts, walk in a straight line, tap where it ends or turns, and so on; end the
/// walk. Samples are pushed all the while. The coverage shows what is left; build when it is good enough.
#[derive(Debug, uniffi::Object)]
pub struct Surveyor {
    name: String,
    ordinal: i32,
    plan: FloorPlan,
    open_floor: OpenFloor,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// The parts of every walk that has ended.
    ended: Vec<Vec<SurveyWalk>>,
    walking: Option<Walking>,
    watch: InputWatch,
    batch_faults: BatchFaults,
}

/// The walk that is being walked.
#[derive(Debug)]
struct Walking {
    name: String,
    /// What was walked between pauses; the last is open, and nothing joins it to the one before.
    parts: Vec<SurveyWalk>,
    is_paused: bool,
}

/// How far the floor is covered, with a grid to draw.
///
/// The grid is coarser than the map's, whose nodes are half a metre apart: it is drawn while a walk goes on, and a line covers
/// three metres to each side.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct SurveyCoverage {
    /// The sums.
    pub totals: CoverageTotals,
    /// Distance between the grid's nodes, in metres, 1 in this version; the first lies at the origin.
    pub cell_m: f64,
    /// Nodes along x.
    pub n_columns: u32,
    /// Nodes along y.
    pub n_rows: u32,
    /// A byte a node, along x first, from the lowest y: 0 nobody can stand there, 1 open and not covered, 2 covered.
    pub nodes: Vec<u8>,
}

#[uniffi::export]
impl Surveyor {
    /// A survey of the floor called `name` with that ordinal, 0 being the ground floor, on `plan`: a floor plan in
    /// GeoJSON.
    ///
    /// # Errors
    /// When the plan cannot be read, or is too large for a map.
    #[uniffi::constructor]
    pub fn new(plan: &[u8], name: String, ordinal: i32) -> Result<Arc<Self>, ApiError> {
        let plan = read_plan(plan).map_err(|error| ApiError::of_plan(&error))?;
        check_extent(&plan, &SurveyParams::default())?;
        let open_floor = OpenFloor::of(&plan);
        Ok(Arc::new(Self { name, ordinal, plan, open_floor, state: Mutex::default() }))
    }

    /// What to draw of the plan.
    pub fn drawing(&self) -> FloorDrawing {
        FloorDrawing::from(&self.plan)
    }

    /// Begins a walk; its name is for messages.
    ///
    /// # Errors
    /// When another walk has not ended.
    pub fn begin_walk(&self, name: String) -> Result<(), ApiError> {
        let mut state = locked(&self.state)?;
        if state.walking.is_some() {
            return Err(api_error!(OutOfTurn, "a walk has begun already", "end it first"));
        }
        let parts = vec![SurveyWalk::new(name.clone())];
        state.walking = Some(Walking { name, parts, is_paused: false });
        Ok(())
    }

    /// Takes a batch of samples in; those that come during a pause are dropped.
    ///
    /// # Errors
    /// When `batch` is no sample batch, is torn or is too new, and when no walk has begun; nothing of it is taken in
    /// then.
    pub fn push_samples(&self, batch: &[u8]) -> Result<(), ApiError> {
        let batch = SampleBatch::new(batch)?;
        let mut state = locked(&self.state)?;
        let State { walking, watch, batch_faults, .. } = &mut *state;
        let Walking { parts, is_paused, .. } = walking.as_mut().ok_or_else(no_walk)?;
        let mut part = parts.last_mut().filter(|_| !*is_paused);
        take_each(&batch, batch_faults, |sample| {
            watch.note(&sample);
            if let Some(part) = &mut part {
                part.push(&sample);
            }
            Ok(())
        })
    }

    /// The surveyor stands at a place of the plan; the line from the last waypoint to here is surveyed.
    ///
    /// # Errors
    /// When the place is not on the plan, or the time not after the last waypoint's; when no walk has begun, or it is
    /// paused.
    pub fn push_waypoint(&self, waypoint: Waypoint) -> Result<(), ApiError> {
        let Waypoint { time_ns, point } = waypoint;
        let point = geometry::Point2::from(point);
        let mut state = locked(&self.state)?;
        let walking = state.walking.as_mut().ok_or_else(no_walk)?;
        if walking.is_paused {
            return Err(api_error!(OutOfTurn, "the walk is paused", "resume it first"));
        }
        let is_on_plan =
            (0.0..=self.plan.width_m).contains(&point.x_m) && (0.0..=self.plan.height_m).contains(&point.y_m);
        if !is_on_plan {
            return Err(api_error!(
                BadWaypoint,
                "the waypoint is not on the plan",
                "give metres in the floor's frame, from 0 to the plan's width and height"
            ));
        }
        let Some(part) = walking.parts.last_mut() else { return Err(ApiError::broken()) };
        let n_refused = part.n_refused_waypoints();
        part.push_waypoint(survey::Waypoint { time: Timestamp::from_nanos(time_ns), point });
        if part.n_refused_waypoints() > n_refused {
            return Err(api_error!(
                BadWaypoint,
                "the waypoint is not after the last one",
                "stamp it with the clock of the samples"
            ));
        }
        Ok(())
    }

    /// Takes the last waypoint since the walk began or was resumed back, and gives it; nothing when there is none.
    ///
    /// # Errors
    /// When no walk has begun.
    pub fn undo_waypoint(&self) -> Result<Option<Waypoint>, ApiError> {
        let mut state = locked(&self.state)?;
        let walking = state.walking.as_mut().ok_or_else(no_walk)?;
        Ok(walking.parts.last_mut().and_then(SurveyWalk::pop_waypoint).map(Waypoint::from))
    }

    /// Pauses the walk: the surveyor is held up, or goes elsewhere. What comes after the last waypoint is not surveyed.
    ///
    /// # Errors
    /// When no walk has begun, and when it is paused already.
    pub fn pause(&self) -> Result<(), ApiError> {
        let mut state = locked(&self.state)?;
        let walking = state.walking.as_mut().ok_or_else(no_walk)?;
        if walking.is_paused {
            return Err(api_error!(OutOfTurn, "the walk is paused already", "resume it first"));
        }
        walking.is_paused = true;
        Ok(())
    }

    /// Goes on with the walk, from wherever the surveyor is now: tap a waypoint there. No line joins it to the last
    /// waypoint before the pause.
    ///
    /// # Errors
    /// When no walk has begun, and when it is not paused.
    pub fn resume(&self) -> Result<(), ApiError> {
        let mut state = locked(&self.state)?;
        let walking = state.walking.as_mut().ok_or_else(no_walk)?;
        if !walking.is_paused {
            return Err(api_error!(OutOfTurn, "the walk is not paused", "go on with it"));
        }
        walking.is_paused = false;
        walking.parts.push(SurveyWalk::new(walking.name.clone()));
        Ok(())
    }

    /// Ends the walk, and tells whether the map can use it.
    ///
    /// # Errors
    /// When no walk has begun.
    pub fn end_walk(&self) -> Result<WalkReport, ApiError> {
        let mut state = locked(&self.state)?;
        let Walking { parts, .. } = state.walking.take().ok_or_else(no_walk)?;
        Ok(state.end(parts))
    }

    /// Drops the walk that is being walked, and gives its name.
    ///
    /// # Errors
    /// When no walk has begun.
    pub fn discard_walk(&self) -> Result<String, ApiError> {
        let Walking { name, .. } = locked(&self.state)?.walking.take().ok_or_else(no_walk)?;
        Ok(name)
    }

    /// Drops the last of the walks that have ended, and gives its name; nothing when there is none.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn undo_walk(&self) -> Result<Option<String>, ApiError> {
        let parts = locked(&self.state)?.ended.pop();
        Ok(parts.and_then(|parts| parts.first().map(|part| part.name().to_owned())))
    }

    /// Adds the walk of a recording, such as those that a `Recorder` wrote before the app was killed; `name` is for
    /// messages.
    ///
    /// # Errors
    /// When the recording does not exist, cannot be read or is none, and when it says that it was made on another
    /// floor. Nothing has changed then.
    pub fn add_recording(&self, path: &str, name: String) -> Result<WalkReport, ApiError> {
        let mut walk = SurveyWalk::new(name);
        let ordinal = for_each_record(Path::new(path), self.plan.georeference, |record| match record {
            Record::Sample(sample) => walk.push(&sample),
            Record::Waypoint { time, point } => walk.push_waypoint(survey::Waypoint { time, point }),
        })?;
        // By its name, as the recording's; a name that says no number is on any floor.
        if ordinal.is_some_and(|ordinal| ordinal != floor_ordinal(&self.name)) {
            return Err(api_error!(
                WrongFloor,
                "the recording says that it was made on another floor",
                "add it to that floor's survey"
            ));
        }
        Ok(locked(&self.state)?.end(vec![walk]))
    }

    /// How the survey fares, and what it lacks.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn status(&self) -> Result<SurveyStatus, ApiError> {
        let state = locked(&self.state)?;
        let State { ended, walking, watch, batch_faults } = &*state;
        let part = walking.as_ref().and_then(|walking| walking.parts.last());
        Ok(SurveyStatus {
            n_walks: ended.len() as u32,
            is_walking: walking.is_some(),
            is_paused: walking.as_ref().is_some_and(|walking| walking.is_paused),
            n_steps: part.map_or(0, |part| part.steps().len() as u32),
            last_waypoint: part.and_then(|part| part.waypoints().last()).copied().map(Waypoint::from),
            batch_faults: *batch_faults,
            missing: if walking.is_some() { watch.missing(false) } else { Vec::new() },
            attitude: part.map_or(Attitude::Unknown, |part| part.attitude().attitude.into()),
            carry_mode: part.map_or(CarryMode::Unknown, |part| part.attitude().carry_mode.into()),
            carry_warning: part.and_then(SurveyWalk::carry_fault).map(CarryWarning::of),
        })
    }

    /// What the lines walked so far cover, the walk that is being walked included.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn coverage(&self) -> Result<SurveyCoverage, ApiError> {
        let lines: Vec<Vec<geometry::Point2>> = {
            let state = locked(&self.state)?;
            let walking = state.walking.iter().flat_map(|walking| &walking.parts);
            let line = |part: &SurveyWalk| part.waypoints().iter().map(|waypoint| waypoint.point).collect();
            state.ended.iter().flatten().chain(walking).map(line).collect()
        };
        Ok(self.open_floor.covered(&lines).into())
    }

    /// Builds the map of all walks that have ended. This takes seconds: call it on a thread that nobody waits for.
    ///
    /// # Errors
    /// When no walk has steps between two waypoints, or none has a magnetic field.
    pub fn build(&self) -> Result<Arc<SurveyedFloor>, ApiError> {
        // Copied, so that the survey may go on meanwhile.
        let walks = locked(&self.state)?.ended.concat();
        SurveyedFloor::build(&self.name, self.ordinal, &self.plan, walks)
    }
}

impl State {
    /// Keeps the parts that a map can use, and reports.
    fn end(&mut self, mut parts: Vec<SurveyWalk>) -> WalkReport {
        parts.iter_mut().for_each(SurveyWalk::finish);
        let mut rejections = Rejections::default();
        let (mut n_waypoints, mut n_steps, mut route_m) = (0, 0, 0.0);
        parts.retain(|part| {
            let Rejections { implausible, late, duplicate, jumped } = part.rejections().into();
            rejections.implausible += implausible;
            rejections.late += late;
            rejections.duplicate += duplicate;
            rejections.jumped += jumped;
            n_waypoints += part.waypoints().len() as u32;
            let n = SurveyTrack::of(part).map_or(0, |track| track.steps().len());
            n_steps += n as u32;
            let lines = part.waypoints().windows(2);
            route_m += lines.map(|w| w[0].point.distance_m(w[1].point)).sum::<f64>();
            n > 0
        });
        let refusal = match (parts.is_empty(), n_waypoints) {
            (false, _) => None,
            (true, 0..2) => Some(WalkRefusal::NoWaypoints),
            (true, _) => Some(WalkRefusal::NoSteps),
        };
        let is_used = refusal.is_none();
        if is_used {
            self.ended.push(parts);
        }
        let remedy = refusal.map_or("", WalkRefusal::remedy).into();
        WalkReport { is_used, remedy, n_waypoints, n_steps, route_m, rejections, refusal }
    }
}

fn no_walk() -> ApiError {
    api_error!(OutOfTurn, "no walk has begun", "begin one first")
}

impl From<survey::Waypoint> for Waypoint {
    fn from(waypoint: survey::Waypoint) -> Self {
        let survey::Waypoint { time, point } = waypoint;
        Self { time_ns: time.as_nanos(), point: point.into() }
    }
}

impl From<LiveCoverage> for SurveyCoverage {
    fn from(live: LiveCoverage) -> Self {
        let LiveCoverage { coverage, frame, nodes } = live;
        let byte = |cover| match cover {
            Cover::Closed => 0,
            Cover::Open => 1,
            Cover::Covered => 2,
        };
        Self {
            totals: coverage.into(),
            cell_m: frame.cell_m,
            n_columns: frame.nx as u32,
            n_rows: frame.ny as u32,
            nodes: nodes.into_iter().map(byte).collect(),
        }
    }
}
