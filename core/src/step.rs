//! Steps: found in the vertical acceleration, and how long each one is.

use serde::{Deserialize, Serialize};

use crate::time::{Duration, Timestamp};

/// A step as the vertical acceleration shows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepCycle {
    /// The previous step's peak, or an assumed period before the peak for the first step of a walk.
    pub start: Timestamp,
    /// This step's peak.
    pub end: Timestamp,
    /// Steps a second, from the time between the peaks.
    pub frequency_hz: f32,
    /// Peak minus the trough before it, of the filtered vertical acceleration, in m/s².
    pub amplitude_m_s2: f32,
    /// Whether it starts a walk from standing.
    pub is_first: bool,
}

/// Parameters of [`PhoneStepDetector`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhoneStepParams {
    /// Cut-off of each of the two low-pass stages, in Hz; default 3.5: above the fastest stride rate.
    pub cutoff_hz: f32,
    /// Least peak-to-trough amplitude of a step, in m/s²; default 0.9 (a slow walk in hand gives about 2).
    pub min_amplitude_m_s2: f32,
    /// Least amplitude as a fraction of the recent mean; default 0.35.
    pub min_relative_amplitude: f32,
    /// Least time between steps, in seconds; default 0.28 (running reaches 3.5 Hz).
    pub min_period_s: f64,
    /// A longer gap ends the walk; default 1.4 s.
    pub max_period_s: f64,
    /// The period assumed for the first step of a walk, in seconds; default 0.55.
    pub first_period_s: f64,
}

impl Default for PhoneStepParams {
    fn default() -> Self {
        Self {
            cutoff_hz: 3.5,
            min_amplitude_m_s2: 0.9,
            min_relative_amplitude: 0.35,
            min_period_s: 0.28,
            max_period_s: 1.4,
            first_period_s: 0.55,
        }
    }
}

/// Finds steps as alternating peaks and troughs of the low-passed vertical acceleration, causally.
///
/// A peak counts once the signal has fallen from it by a part of the recent amplitude, so a step is known about a
/// tenth of a second after its peak.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhoneStepDetector {
    params: PhoneStepParams,
    last_time: Option<Timestamp>,
    stages_m_s2: [f32; 2],
    rising: bool,
    extremum: (Timestamp, f32),
    trough_m_s2: f32,
    last_peak: Option<Timestamp>,
    mean_amplitude_m_s2: f32,
}

impl PhoneStepDetector {
    /// A detector that has seen nothing.
    pub fn new(params: PhoneStepParams) -> Self {
        Self {
            params,
            last_time: None,
            stages_m_s2: [0.0; 2],
            rising: true,
            extremum: (Timestamp::MIN, f32::MIN),
            trough_m_s2: 0.0,
            last_peak: None,
            mean_amplitude_m_s2: 0.0,
        }
    }

    /// Feeds the vertical acceleration (gravity removed), in m/s²; returns the step that it completes, if any.
    pub fn push(&mut self, time: Timestamp, vertical_m_s2: f32) -> Option<StepCycle> {
        let value = self.filtered(time, vertical_m_s2)?;
        let hysteresis = (0.3 * self.mean_amplitude_m_s2).max(0.5 * self.params.min_amplitude_m_s2);
        if self.rising {
            if value > self.extremum.1 {
                self.extremum = (time, value);
            } else if value < self.extremum.1 - hysteresis {
                let (peak, height) = self.extremum;
                self.rising = false;
                self.extremum = (time, value);
                return self.step(peak, height - self.trough_m_s2);
            }
        } else if value < self.extremum.1 {
            self.extremum = (time, value);
        } else if value > self.extremum.1 + hysteresis {
            self.trough_m_s2 = self.extremum.1;
            self.rising = true;
            self.extremum = (time, value);
        }
        None
    }

    fn filtered(&mut self, time: Timestamp, input: f32) -> Option<f32> {
        let dt_s = match self.last_time.replace(time) {
            None => {
                self.extremum = (time, 0.0);
                return None;
            }
            Some(last) => time.secs_since(last) as f32,
        };
        if !(0.0..1.0).contains(&dt_s) {
            return None;
        }
        let tau_s = 1.0 / (core::f32::consts::TAU * self.params.cutoff_hz);
        let a = dt_s / (tau_s + dt_s);
        self.stages_m_s2[0] += a * (input - self.stages_m_s2[0]);
        self.stages_m_s2[1] += a * (self.stages_m_s2[0] - self.stages_m_s2[1]);
        Some(self.stages_m_s2[1])
    }

    fn step(&mut self, peak: Timestamp, amplitude: f32) -> Option<StepCycle> {
        let params = &self.params;
        // A peak in the future is from before the clock was set back.
        let since_last_s = self.last_peak.map(|last| peak.secs_since(last)).filter(|&s| s >= 0.0);
        let walking = since_last_s.is_some_and(|s| s <= params.max_period_s);
        if !walking {
            self.mean_amplitude_m_s2 = 0.0;
        }
        let least = params.min_amplitude_m_s2.max(params.min_relative_amplitude * self.mean_amplitude_m_s2);
        if amplitude < least || since_last_s.is_some_and(|s| s < params.min_period_s) {
            return None;
        }
        let period_s = since_last_s.filter(|_| walking).unwrap_or(params.first_period_s);
        self.mean_amplitude_m_s2 += if walking { 0.25 } else { 1.0 } * (amplitude - self.mean_amplitude_m_s2);
        self.last_peak = Some(peak);
        Some(StepCycle {
            start: peak - Duration::from_secs_f64(period_s),
            end: peak,
            frequency_hz: (1.0 / period_s) as f32,
            amplitude_m_s2: amplitude,
            is_first: !walking,
        })
    }
}

/// How long a step is, from what is known of it: pure models, per-walker scale left to the particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepLengthModel {
    /// Every step has the same length, in metres.
    ///
    /// # Source
    /// Mass-centred 2019, step-length experiment: 0.65 m.
    Static {
        /// The length, in metres.
        length_m: f32,
    },
    /// `length = offset + per_hz·f + per_root·(a_max − a_min)^¼`, in metres.
    ///
    /// # Source
    /// WILA 2016, Eq. 3 (the Weinberg fourth root), with a frequency term; coefficients are ours, by least squares
    /// over surveyed segments.
    FrequencyAmplitude {
        /// Constant term, in metres.
        offset_m: f32,
        /// Metres per Hz of step frequency.
        per_hz_m: f32,
        /// Metres per fourth root of the amplitude in m/s².
        per_root_m: f32,
    },
}

/// Share of a full step by which the body advances at the first step of a walk.
///
/// From standing with both feet together the first swing moves the body half a step (gait initiation).
const FIRST_STEP_SHARE: f32 = 0.5;

impl StepLengthModel {
    /// How far `cycle` carries the walker by this model, in metres.
    pub fn advance_m(&self, cycle: &StepCycle) -> f32 {
        let share = if cycle.is_first { FIRST_STEP_SHARE } else { 1.0 };
        share * self.length_m(cycle.frequency_hz, cycle.amplitude_m_s2)
    }

    /// The length of a step of this frequency and amplitude, in metres; between 0.2 and 1.2.
    pub fn length_m(&self, frequency_hz: f32, amplitude_m_s2: f32) -> f32 {
        let length_m = match *self {
            Self::Static { length_m } => length_m,
            Self::FrequencyAmplitude { offset_m, per_hz_m, per_root_m } => {
                offset_m + per_hz_m * frequency_hz + per_root_m * amplitude_m_s2.max(0.0).sqrt().sqrt()
            }
        };
        length_m.clamp(0.2, 1.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps_of(signal: impl Fn(f64) -> f64, seconds: f64) -> Vec<StepCycle> {
        let mut detector = PhoneStepDetector::new(PhoneStepParams::default());
        (0..(seconds * 100.0) as i64)
            .filter_map(|k| detector.push(Timestamp::from_millis(10 * k), signal(k as f64 * 0.01) as f32))
            .collect()
    }

    #[test]
    fn a_sine_of_two_hertz_is_two_steps_a_second() {
        let steps = steps_of(|t| 3.0 * libm::sin(core::f64::consts::TAU * 2.0 * t), 20.0);
        assert!((39..=40).contains(&steps.len()), "{}", steps.len());
        assert!(steps[5..].iter().all(|s| (s.frequency_hz - 2.0).abs() < 0.05));
    }

    #[test]
    fn standing_still_makes_no_step() {
        assert!(steps_of(|t| 0.2 * libm::sin(40.0 * t), 30.0).is_empty());
    }

    #[test]
    fn lengths_by_hand() {
        assert_eq!(StepLengthModel::Static { length_m: 0.65 }.length_m(2.0, 9.0), 0.65);
        let model = StepLengthModel::FrequencyAmplitude { offset_m: 0.1, per_hz_m: 0.05, per_root_m: 0.2 };
        // 0.1 + 0.05·2 + 0.2·16^¼ = 0.6
        assert!((model.length_m(2.0, 16.0) - 0.6).abs() < 1e-6);
        assert_eq!(model.length_m(2.0, f32::NAN.max(0.0)), 0.2);
    }
}
