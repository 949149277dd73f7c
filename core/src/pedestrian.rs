//! From samples to steps: gravity, magnetic features, step detection and heading in one pass.

use serde::{Deserialize, Serialize};

use crate::gravity::{LevelEstimator, LevelParams};
use crate::magnetic::feature::LevelField;
use crate::sensor::{Reading, Sample};
use crate::step::{PhoneStepDetector, PhoneStepParams, StepCycle, StepDetector as _, StepQueue};
use crate::time::Timestamp;

/// A step with all that the sensors said during it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepEvent {
    /// When, how fast, how strong.
    pub cycle: StepCycle,
    /// Mean heading of the device's forward axis, in the level frame, in radians.
    pub level_heading_rad: f32,
    /// Mean field in the forward frame (x right of the device's forward axis, y along it, z up); nothing without a
    /// magnetometer.
    pub forward_field: Option<LevelField>,
    /// Field strength at the end of the step (smoothed over about 0.1 s), in µT; nothing without a magnetometer.
    pub end_strength_ut: Option<f32>,
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
}

/// The walker's half of the pipeline: keeps the level frame, cuts steps and averages the features over each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pedestrian {
    level: LevelEstimator,
    detector: PhoneStepDetector,
    magnetometer: Magnetometer,
    sums: StepSums,
    /// Steps held back, and those that count and have not been handed out.
    steps: StepQueue<StepFeatures>,
    last_forward: [f32; 2],
}

/// Which magnetometer stream is used: the uncalibrated one, once seen, with the bias that it came with first.
///
/// Later changes of the operating system's bias would look like a jump of the field; they are ignored, since the
/// filter learns the remaining bias itself.
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
}

/// What was measured during a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct StepFeatures {
    level_heading_rad: f32,
    forward_field: Option<LevelField>,
    end_strength_ut: Option<f32>,
}

impl Pedestrian {
    /// A pedestrian of whom nothing is known.
    pub fn new(params: PedestrianParams) -> Self {
        Self {
            level: LevelEstimator::new(params.level),
            detector: PhoneStepDetector::new(params.step),
            magnetometer: Magnetometer::default(),
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
            Reading::AngularRate(rate) => self.level.push_angular_rate(sample.time, rate),
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

    /// Heading of the device's forward axis now, in the level frame, in radians.
    pub fn level_heading_rad(&self) -> f32 {
        libm::atan2f(self.last_forward[0], self.last_forward[1])
    }

    fn push_force(&mut self, time: Timestamp, force: [f32; 3]) {
        let level_force = self.level.push_specific_force(time, force);
        if let Some(forward) = self.level.forward() {
            self.last_forward = forward;
            self.sums.n_forward += 1;
            self.sums.forward[0] += forward[0];
            self.sums.forward[1] += forward[1];
        }
        let Some(finding) = self.detector.push(time, level_force) else { return };
        let features = self.sums.features(self.last_forward, self.magnetometer.smoothed_strength_ut);
        self.sums = StepSums::default();
        self.steps.push(&finding, features, self.detector.params().first_period_s);
    }

    fn push_field(&mut self, time: Timestamp, field_ut: [f32; 3]) {
        let dt_s = self.magnetometer.last_time.replace(time).map_or(0.0, |last| time.secs_since(last));
        self.level.push_field(time, field_ut, dt_s);
        let (Some(level), Some(forward)) = (self.level.to_level(field_ut), self.level.forward()) else {
            return;
        };
        self.sums.n_field += 1;
        self.sums.forward_field_ut[0] += level[0] * forward[1] - level[1] * forward[0];
        self.sums.forward_field_ut[1] += level[0] * forward[0] + level[1] * forward[1];
        self.sums.forward_field_ut[2] += level[2];
        let strength_ut = LevelField { field_ut: level }.strength_ut();
        let a = (dt_s / (STRENGTH_TAU_S + dt_s)) as f32;
        let smoothed =
            self.magnetometer.smoothed_strength_ut.map_or(strength_ut, |s| s + a * (strength_ut - s));
        self.magnetometer.smoothed_strength_ut = Some(smoothed);
    }
}

impl StepSums {
    fn features(&self, last_forward: [f32; 2], strength_ut: Option<f32>) -> StepFeatures {
        let forward = if self.n_forward > 0 { self.forward } else { last_forward };
        let mean = |sum: f32| sum / self.n_field as f32;
        let has_field = self.n_field > 0;
        StepFeatures {
            level_heading_rad: libm::atan2f(forward[0], forward[1]),
            forward_field: has_field.then(|| LevelField { field_ut: self.forward_field_ut.map(mean) }),
            end_strength_ut: strength_ut.filter(|_| has_field),
        }
    }
}

impl StepFeatures {
    fn of_step(self, cycle: StepCycle) -> StepEvent {
        let Self { level_heading_rad, forward_field, end_strength_ut } = self;
        StepEvent { cycle, level_heading_rad, forward_field, end_strength_ut }
    }
}
