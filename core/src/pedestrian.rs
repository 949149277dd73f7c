//! From samples to steps: gravity, magnetic features, step detection and heading in one pass.

use serde::{Deserialize, Serialize};

use crate::attitude::{AttitudeDetector, AttitudeEstimate, AttitudeParams, Stride};
use crate::calibration::{FieldJumpDetector, FieldJumpParams};
use crate::gravity::{LevelEstimator, LevelParams};
use crate::magnetic::feature::{FieldRead, LevelField};
use crate::magnetic::trace::FieldTrace;
use crate::sensor::{Reading, Sample};
use crate::step::{PhoneStepDetector, PhoneStepParams, StepCycle, StepDetector as _, StepQueue};
use crate::time::Timestamp;

/// A step, or the round of a card, with all that the sensors said during it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepEvent {
    /// When, how fast, how strong.
    pub cycle: StepCycle,
    /// Steps made: 1 on a phone, 0 to 3 in a card's round.
    pub n_steps: u8,
    /// Mean heading of the device's forward axis, in the level frame, in radians.
    pub level_heading_rad: f32,
    /// Mean field in the forward frame (x right of the device's forward axis, y along it, z up); nothing without a
    /// magnetometer.
    pub forward_field: Option<LevelField>,
    /// Field strength at the end of the step (smoothed over about 0.1 s), in µT; nothing without a magnetometer.
    pub end_strength_ut: Option<f32>,
    /// The field in each third of the move, first to last; nothing where it was not read.
    pub reads: [Option<FieldRead>; 3],
    /// How the phone was held.
    pub attitude: AttitudeEstimate,
    /// Whether the field jumped during the step, as it does when the operating system recalibrates a stream that it
    /// corrects: what was learnt of the bias no longer holds.
    #[serde(default)]
    pub field_bias_reset: bool,
}

impl StepEvent {
    /// Compass azimuth of the device's forward axis, clockwise from magnetic north, in radians.
    pub fn azimuth_rad(&self) -> Option<f32> {
        self.forward_field.map(|field| -field.heading_rad())
    }
}

/// Parameters of [`Pedestrian`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PedestrianParams {
    /// The vertical and the level frame.
    pub level: LevelParams,
    /// The step detector.
    pub step: PhoneStepParams,
    /// How the phone is held.
    pub attitude: AttitudeParams,
}

/// The walker's half of the pipeline: keeps the level frame, cuts steps and averages the features over each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pedestrian {
    level: LevelEstimator,
    detector: PhoneStepDetector,
    attitude: AttitudeDetector,
    magnetometer: Magnetometer,
    jumps: FieldJumpDetector,
    sums: StepSums,
    /// Steps held back, and those that count and have not been handed out.
    steps: StepQueue<StepFeatures>,
    last_forward: [f32; 2],
}

/// Which magnetometer stream is used: the uncalibrated one, once seen, with the bias that it came with first.
///
/// The operating system's later estimates of that bias are ignored: the raw field does not change with them, and the
/// filter learns what remains of the bias itself. A phone that offers the corrected stream alone jumps at every
/// recalibration; then the step says that the bias is new.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Magnetometer {
    bias_ut: Option<[f32; 3]>,
    last_time: Option<Timestamp>,
    smoothed_strength_ut: Option<f32>,
}

/// Time constant of the strength at a step's end, in seconds.
const STRENGTH_TAU_S: f64 = 0.1;

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct StepSums {
    n_forward: u32,
    forward: [f32; 2],
    n_field: u32,
    forward_field_ut: [f32; 3],
    trace: FieldTrace,
    field_bias_reset: bool,
}

/// What was measured during a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct StepFeatures {
    level_heading_rad: f32,
    forward_field: Option<LevelField>,
    end_strength_ut: Option<f32>,
    reads: [Option<FieldRead>; 3],
    attitude: AttitudeEstimate,
    field_bias_reset: bool,
}

impl Pedestrian {
    /// A pedestrian of whom nothing is known.
    pub fn new(params: PedestrianParams) -> Self {
        Self {
            level: LevelEstimator::new(params.level),
            detector: PhoneStepDetector::new(params.step),
            attitude: AttitudeDetector::new(params.attitude),
            magnetometer: Magnetometer::default(),
            jumps: FieldJumpDetector::new(FieldJumpParams::default()),
            sums: StepSums::default(),
            steps: StepQueue::new(),
            last_forward: [0.0, 1.0],
        }
    }

    /// Consumes a sample (in order of time); returns the next step that counts, if any.
    ///
    /// When a walk begins, its first steps are held back until it is one: they come together then, one with each specific
    /// force.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        match sample.reading {
            Reading::AngularRate(rate) => {
                self.level.push_angular_rate(sample.time, rate);
                self.attitude.push_rate(sample.time, rate);
            }
            Reading::SpecificForce(force) => {
                self.push_force(sample.time, force);
                return self.steps.pop().map(|(cycle, features)| features.of_step(cycle));
            }
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                let bias = *self.magnetometer.bias_ut.get_or_insert(bias_ut);
                self.push_field(sample.time, [0, 1, 2].map(|c| field_ut[c] - bias[c]));
            }
            Reading::MagneticField(field_ut) if self.magnetometer.bias_ut.is_none() => {
                self.push_field(sample.time, field_ut);
            }
            _ => {}
        }
        None
    }

    /// How the phone is held now.
    pub fn attitude(&self) -> AttitudeEstimate {
        self.attitude.estimate()
    }

    /// The latest stride that was cut; nothing before the first.
    pub fn last_stride(&self) -> Option<&Stride> {
        self.attitude.last_stride()
    }

    /// Heading of the device's forward axis now, in the level frame, in radians.
    pub fn level_heading_rad(&self) -> f32 {
        libm::atan2f(self.last_forward[0], self.last_forward[1])
    }

    /// An event without steps, of what was measured since the last step; `start` and `end` say which time it stands for.
    pub(crate) fn standing(&self, start: Timestamp, end: Timestamp) -> StepEvent {
        let cycle = StepCycle { start, end, frequency_hz: 0.0, amplitude_m_s2: 0.0, is_first: false };
        let strength_ut = self.magnetometer.smoothed_strength_ut;
        let features = self.sums.features(self.last_forward, strength_ut, self.attitude.estimate());
        StepEvent { n_steps: 0, ..features.of_step(cycle) }
    }

    fn push_force(&mut self, time: Timestamp, force: [f32; 3]) {
        let level_force = self.level.push_specific_force(time, force);
        if let Some(forward) = self.level.forward() {
            self.last_forward = forward;
            self.sums.n_forward += 1;
            self.sums.forward[0] += forward[0];
            self.sums.forward[1] += forward[1];
        }
        self.attitude.push_force(time, force, level_force[2]);
        let Some(finding) = self.detector.push(time, level_force) else { return };
        self.attitude.push_step(&finding);
        let attitude = self.attitude.estimate();
        let features =
            self.sums.features(self.last_forward, self.magnetometer.smoothed_strength_ut, attitude);
        self.sums = StepSums::default();
        self.steps.push(&finding, features, self.detector.params().first_period_s);
    }

    fn push_field(&mut self, time: Timestamp, field_ut: [f32; 3]) {
        let dt_s = self.magnetometer.last_time.replace(time).map_or(0.0, |last| time.secs_since(last));
        self.level.push_field(time, field_ut, dt_s);
        let (Some(level), Some(forward)) = (self.level.to_level(field_ut), self.level.forward()) else {
            return;
        };
        if self.magnetometer.bias_ut.is_none() {
            self.sums.field_bias_reset |= self.jumps.push(time, level);
        }
        self.sums.n_field += 1;
        self.sums.forward_field_ut[0] += level[0] * forward[1] - level[1] * forward[0];
        self.sums.forward_field_ut[1] += level[0] * forward[0] + level[1] * forward[1];
        self.sums.forward_field_ut[2] += level[2];
        let level = LevelField { field_ut: level };
        self.sums.trace.push(FieldRead::of(&level));
        let strength_ut = level.strength_ut();
        let a = (dt_s / (STRENGTH_TAU_S + dt_s)) as f32;
        let smoothed =
            self.magnetometer.smoothed_strength_ut.map_or(strength_ut, |s| s + a * (strength_ut - s));
        self.magnetometer.smoothed_strength_ut = Some(smoothed);
    }
}

impl StepSums {
    fn features(
        &self,
        last_forward: [f32; 2],
        strength_ut: Option<f32>,
        attitude: AttitudeEstimate,
    ) -> StepFeatures {
        let forward = if self.n_forward > 0 { self.forward } else { last_forward };
        let mean = |sum: f32| sum / self.n_field as f32;
        let has_field = self.n_field > 0;
        StepFeatures {
            level_heading_rad: libm::atan2f(forward[0], forward[1]),
            forward_field: has_field.then(|| LevelField { field_ut: self.forward_field_ut.map(mean) }),
            end_strength_ut: strength_ut.filter(|_| has_field),
            reads: self.trace.thirds(),
            attitude,
            field_bias_reset: self.field_bias_reset,
        }
    }
}

impl StepFeatures {
    fn of_step(self, cycle: StepCycle) -> StepEvent {
        let Self { level_heading_rad, forward_field, end_strength_ut, reads, attitude, field_bias_reset } =
            self;
        StepEvent {
            cycle,
            n_steps: 1,
            level_heading_rad,
            forward_field,
            end_strength_ut,
            reads,
            attitude,
            field_bias_reset,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gravity::STANDARD_GRAVITY_M_S2;

    /// Steps of a walk at 2 Hz during which the stream that `reading` makes of a field is recalibrated by 15 µT.
    fn resets(reading: impl Fn([f32; 3], [f32; 3]) -> Reading) -> usize {
        let mut pedestrian = Pedestrian::new(PedestrianParams::default());
        let mut n_resets = 0;
        for k in 0..1_000i64 {
            let time = Timestamp::from_millis(20 * k);
            let bob = 2.5 * libm::sinf(2.0 * core::f32::consts::TAU * 0.02 * k as f32);
            let bias_ut = if k < 500 { [0.0; 3] } else { [15.0, 0.0, 0.0] };
            for reading in [
                Reading::AngularRate([0.0; 3]),
                Reading::SpecificForce([0.0, 0.0, STANDARD_GRAVITY_M_S2 + bob]),
                reading([3.0, 22.0, -40.0], bias_ut),
            ] {
                let event = pedestrian.push(&Sample { time, reading });
                n_resets += usize::from(event.is_some_and(|event| event.field_bias_reset));
            }
        }
        n_resets
    }

    #[test]
    fn a_recalibration_of_the_corrected_stream_is_told_once() {
        let corrected =
            |field: [f32; 3], bias: [f32; 3]| Reading::MagneticField([0, 1, 2].map(|c| field[c] - bias[c]));
        assert_eq!(resets(corrected), 1);
    }

    #[test]
    fn the_raw_stream_does_not_change_with_the_system_s_mind() {
        let raw = |field_ut, bias_ut| Reading::UncalibratedMagneticField { field_ut, bias_ut };
        assert_eq!(resets(raw), 0);
    }
}
