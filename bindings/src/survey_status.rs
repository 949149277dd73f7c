//! How a survey fares, and what became of its walks.

use crate::carrying::CarryWarning;
use crate::fix::{Attitude, CarryMode};
use crate::missing::Missing;
use crate::recorder::Waypoint;
use crate::status::{BatchFaults, Rejections};

/// What became of a walk.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct WalkReport {
    /// Whether the map can use it; a walk that it cannot use is dropped.
    pub is_used: bool,
    /// What to do otherwise next time, in English; empty for a walk that is used.
    pub remedy: String,
    /// Waypoints tapped.
    pub n_waypoints: u32,
    /// Steps between waypoints.
    pub n_steps: u32,
    /// Length of its lines, in metres.
    pub route_m: f64,
    /// Samples refused, by cause.
    pub rejections: Rejections,
    /// Why the map cannot use it; nothing for a walk that is used.
    pub refusal: Option<WalkRefusal>,
}

/// Why a map cannot use a walk; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
#[non_exhaustive]
pub enum WalkRefusal {
    /// It has fewer than two waypoints.
    NoWaypoints,
    /// No step was seen between two of its waypoints.
    NoSteps,
}

/// How a survey fares.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct SurveyStatus {
    /// Walks that have ended and are used.
    pub n_walks: u32,
    /// Whether a walk has begun and not ended.
    pub is_walking: bool,
    /// Whether it is paused.
    pub is_paused: bool,
    /// Steps seen in it since it began or was resumed.
    pub n_steps: u32,
    /// The last waypoint of it, which `undo_waypoint` would take back.
    pub last_waypoint: Option<Waypoint>,
    /// Records of batches that gave no sample, by cause.
    pub batch_faults: BatchFaults,
    /// What is missing now, and how to mend it.
    pub missing: Vec<Missing>,
    /// How the phone is held; unknown outside of a walk.
    pub attitude: Attitude,
    /// Where the phone is carried; unknown outside of a walk.
    pub carry_mode: CarryMode,
    /// What was wrong with the way in which the phone was carried during most of the last eight steps: a glance at the screen
    /// says nothing, and who takes the phone out of the pocket still reads it.
    pub carry_warning: Option<CarryWarning>,
}

impl WalkRefusal {
    /// What to do otherwise next time.
    pub(crate) fn remedy(self) -> &'static str {
        match self {
            Self::NoWaypoints => "tap a waypoint at both ends of every line",
            Self::NoSteps => "walk between the waypoints, with the accelerometer and the gyroscope recorded",
        }
    }
}
