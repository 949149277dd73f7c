//! What a positioner says: the estimate, carried forward to the asked time and stated with its accuracy.

use serde::{Deserialize, Serialize};

use crate::attitude::{Attitude, AttitudeEstimate, CarryMode};
use crate::geometry::{Point2, wrap_rad};
use crate::map::FloorMap;
use crate::particle::CloudEstimate;
use crate::step::StepCycle;
use crate::system::AccuracyParams;
use crate::time::Timestamp;
use crate::tracker::{TrackerMode, UNSEEN_WALK_M_S};

/// An open step later than its period by more than this is no step: the walker has stopped, in seconds.
const STOP_AFTER_S: f64 = 0.4;
/// A fix whose last sample is older than this is stale, in seconds.
const STALE_AFTER_S: f64 = 5.0;
/// A stale fix's radii grow as the cloud will when samples come again, in m/s.
const STALE_GROWTH_M_S: f64 = UNSEEN_WALK_M_S;
/// A paused fix's radii grow with every step that nothing was made of, in metres.
const PAUSED_GROWTH_M: f64 = 0.65;
/// Ratio of the 95 % to the 68 % radius of a circular normal: sqrt(ln 0.05 / ln 0.32).
const RATIO_95_TO_68: f64 = 1.621;

/// What a fix rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Mode {
    /// A start is known, no step has been seen since.
    Started,
    /// The particle filter follows the steps.
    ParticleFilter,
    /// Ranges to a cluster of beacons tell the place.
    Beacon,
    /// The phone is in a pocket or shaken, and the system pauses then: the position is the last one known, its radius
    /// grows.
    Paused,
    /// No sample for more than five seconds: the position is the last one known, its radius grows.
    Stale,
}

/// A position with its accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fix {
    /// The instant that the fix speaks of.
    pub time: Timestamp,
    /// The floor's ordinal.
    pub floor: i32,
    /// The position, in the floor frame.
    pub position: Point2,
    /// Latitude and longitude in degrees, where the map is georeferenced.
    pub latitude_longitude_deg: Option<(f64, f64)>,
    /// Walking direction, clockwise from +y, in radians.
    pub heading_rad: f64,
    /// Walking speed, in m/s; 0 when standing.
    pub speed_m_s: f64,
    /// Covariance of (x, y), in m².
    pub covariance_m2: [[f64; 2]; 2],
    /// The truth is within this distance 68 times of 100, in metres.
    pub radius_68_m: f64,
    /// The truth is within this distance 95 times of 100, in metres.
    pub radius_95_m: f64,
    /// What the fix rests on.
    pub mode: Mode,
    /// How the phone is held; unknown when stale.
    pub attitude: Attitude,
    /// Where the phone is carried; unknown when stale.
    pub carry_mode: CarryMode,
}

/// What a fix is made from.
pub(crate) struct Inputs<'a> {
    pub map: &'a FloorMap,
    pub accuracy: AccuracyParams,
    pub estimate: &'a CloudEstimate,
    pub mode: TrackerMode,
    pub step_length_m: f64,
    pub last_step: Option<StepCycle>,
    /// How far the device has turned since the last step, in radians.
    pub turned_rad: f64,
    pub attitude: AttitudeEstimate,
    /// The last consumed sample that the position rests on, or the hint.
    pub last_heard: Option<Timestamp>,
    pub time: Timestamp,
}

pub(crate) fn assemble(inputs: &Inputs<'_>) -> Fix {
    let Inputs { map, accuracy, estimate, step_length_m, last_step, turned_rad, last_heard, time, .. } =
        *inputs;
    let silent_s = last_heard.map_or(0.0, |last| time.secs_since(last)).max(0.0);
    let is_stale = silent_s > STALE_AFTER_S;
    let paused_steps = match inputs.mode {
        TrackerMode::Paused { n_steps } => Some(n_steps),
        _ => None,
    };
    let heading_rad = wrap_rad(estimate.heading_rad + turned_rad);
    let mut position = Point2::new(estimate.x_m, estimate.y_m);
    let mut speed_m_s = 0.0;
    if let Some(step) = last_step.filter(|_| !is_stale && paused_steps.is_none()) {
        let period_s = step.end.secs_since(step.start);
        let open_s = time.secs_since(step.end);
        if open_s < period_s + STOP_AFTER_S {
            let share = (open_s / period_s).clamp(0.0, 1.0);
            position = position + Point2::from_polar(share * step_length_m, heading_rad);
            speed_m_s = step_length_m / period_s;
        }
    }
    let stale_m = if is_stale { STALE_GROWTH_M_S * (silent_s - STALE_AFTER_S) } else { 0.0 };
    let growth_m = stale_m + PAUSED_GROWTH_M * f64::from(paused_steps.unwrap_or(0));
    let radius_m = |cloud_m: f64, floor_m: f64| {
        let scaled_m = f64::from(accuracy.scale) * cloud_m;
        (scaled_m * scaled_m + floor_m * floor_m).sqrt() + growth_m
    };
    let floor_m = f64::from(accuracy.floor_m);
    Fix {
        time,
        floor: map.ordinal,
        position,
        latitude_longitude_deg: map.plan.georeference.map(|g| g.latitude_longitude_deg(position)),
        heading_rad,
        speed_m_s,
        covariance_m2: estimate.covariance_m2,
        radius_68_m: radius_m(estimate.radius_68_m, floor_m),
        radius_95_m: f64::from(accuracy.tail) * radius_m(estimate.radius_95_m, RATIO_95_TO_68 * floor_m),
        mode: match (inputs.mode, last_step) {
            _ if is_stale => Mode::Stale,
            (TrackerMode::Paused { .. }, _) => Mode::Paused,
            (TrackerMode::Beacons, _) => Mode::Beacon,
            (TrackerMode::Particles, None) => Mode::Started,
            (TrackerMode::Particles, Some(_)) => Mode::ParticleFilter,
        },
        attitude: if is_stale { Attitude::Unknown } else { inputs.attitude.attitude },
        carry_mode: if is_stale { CarryMode::Unknown } else { inputs.attitude.carry_mode },
    }
}
