//! Steps: how they are found in the acceleration, and how long each one is.
//!
//! A [`StepDetector`] hears the specific force in the level frame (z up) and gives a [`StepFinding`] at a time. The
//! phone's detector holds findings back until a few in a row look like walking; a [`StepQueue`] keeps them meanwhile
//! and gives out steps.

mod card;
mod extrema;
mod fixed_array;
mod fixed_rate;
mod length;
mod length_scale;
mod low_pass_fir;
mod phone;
mod queue;
mod rhythm;
mod wila;

use serde::{Deserialize, Serialize};

pub use card::{CardStepCounter, CardStepDetector, MaxMin};
pub use length::{StepLengthModel, turned_length_m};
pub use length_scale::{LengthScaleEstimator, LengthScaleParams};
pub use low_pass_fir::LowPassFir;
pub use phone::{PhoneStepDetector, PhoneStepParams};
pub use queue::StepQueue;
pub use rhythm::RhythmParams;
pub use wila::{WilaStepDetector, WilaStepParams};

use crate::time::{Duration, Timestamp};

/// A step as the acceleration shows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepCycle {
    /// The previous step's peak, or an assumed period before the peak for the first step of a walk.
    pub start: Timestamp,
    /// This step's peak.
    pub end: Timestamp,
    /// Steps a second, from the time between the peaks.
    pub frequency_hz: f32,
    /// Peak minus the trough before it, of the filtered acceleration, in m/s².
    pub amplitude_m_s2: f32,
    /// Whether it starts a walk from standing.
    pub is_first: bool,
}

/// What a detector has found: a step, two of them, or what will be one if walking follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepFinding {
    /// From peak to peak; of two steps when [`StepFinding::is_stride`].
    pub cycle: StepCycle,
    /// Whether the peaks are those of a swinging limb, one in two steps: the cycle then counts for two.
    pub is_stride: bool,
    /// Whether it is the first of a recording that began amid a walk: its cycle then lasts since the recording began.
    pub is_under_way: bool,
    /// Steps before this one that were held back and still may count; older ones do not.
    pub n_held: u8,
    /// Whether this step, and those held back before it, count.
    pub is_confirmed: bool,
    /// Whether the oldest of the steps that it confirms starts a walk from standing.
    pub starts_walk: bool,
}

/// Finds steps in the specific force.
pub trait StepDetector {
    /// Feeds the specific force in the level frame (z up, gravity included), in m/s²; returns what that completes.
    ///
    /// What is not finite or beyond any accelerometer (2 kN/kg) is passed over, as is a time that goes backwards; a
    /// silence ends the walk.
    fn push(&mut self, time: Timestamp, level_force_m_s2: [f32; 3]) -> Option<StepFinding>;
}

impl StepCycle {
    /// The cycle from `start` to `end`.
    fn between(start: Timestamp, end: Timestamp, amplitude_m_s2: f32) -> Self {
        let frequency_hz = (1.0 / end.secs_since(start)) as f32;
        Self { start, end, frequency_hz, amplitude_m_s2, is_first: false }
    }

    /// The same step as the first of a walk: what came before it was none, so its duration is assumed.
    fn as_first(self, period_s: f64) -> Self {
        let start = self.end - Duration::from_secs_f64(period_s);
        Self { is_first: true, ..Self::between(start, self.end, self.amplitude_m_s2) }
    }
}

impl StepFinding {
    /// A step that counts at once.
    fn immediate(cycle: StepCycle) -> Self {
        let (is_stride, is_under_way, is_confirmed) = (false, false, true);
        Self { cycle, is_stride, is_under_way, n_held: 0, is_confirmed, starts_walk: cycle.is_first }
    }
}

/// Whether a detector can make anything of `force`.
fn is_usable(force_m_s2: [f32; 3]) -> bool {
    force_m_s2.iter().all(|c| c.abs() <= 2_000.0)
}
