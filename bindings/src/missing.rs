//! What a positioner or a survey lacks, and how an app mends it.

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;

/// Something that is missing now.
#[derive(Clone, Debug, PartialEq, Eq, uniffi::Record)]
pub struct Missing {
    /// What it is.
    pub what: MissingInput,
    /// What that means, in English.
    pub explanation: String,
    /// What to do about it, in English.
    pub remedy: String,
}

/// What may be missing; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
#[non_exhaustive]
pub enum MissingInput {
    /// No sample has come at all.
    Samples,
    /// A place to start from.
    Start,
    /// Specific force, for more than five seconds or ever.
    Accelerometer,
    /// Specific force often enough: fewer than 20 samples a second come.
    AccelerometerRate,
    /// Angular rate, for more than five seconds or ever.
    Gyroscope,
    /// A magnetic field, for more than five seconds or ever.
    Magnetometer,
    /// Anything that the map's transmitters send, for more than 30 seconds or ever.
    Radio,
    /// Frames of a card that was heard before, for more than five seconds.
    CardFrames,
}

/// When each kind of sample came last.
#[derive(Clone, Debug, Default)]
pub(crate) struct InputWatch {
    newest: Option<Timestamp>,
    force: Option<Timestamp>,
    rate: Option<Timestamp>,
    field: Option<Timestamp>,
    radio: Option<Timestamp>,
    card: Option<Timestamp>,
    /// Mean time between samples of specific force, in seconds, and how many it rests on.
    force_interval_s: f64,
    n_intervals: u32,
}

/// A sensor that has been silent for longer is missing, in seconds.
const SILENT_S: f64 = 5.0;
/// Radio is scanned in turns: what has been silent for longer is missing, in seconds.
const RADIO_SILENT_S: f64 = 30.0;
/// Steps need so many samples of specific force a second.
const MIN_FORCE_HZ: f64 = 20.0;
/// The rate is told after so many of them, and averaged over about as many.
const N_RATE: u32 = 40;

impl InputWatch {
    /// Notes that `sample` has come.
    pub fn note(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            return;
        }
        let time = Some(sample.time);
        self.newest = time;
        match sample.reading {
            Reading::SpecificForce(_) => {
                let last = std::mem::replace(&mut self.force, time);
                if let Some(interval_s) = last.map(|last| sample.time.secs_since(last))
                    && (0.0..SILENT_S).contains(&interval_s)
                {
                    self.n_intervals = (self.n_intervals + 1).min(N_RATE);
                    self.force_interval_s +=
                        (interval_s - self.force_interval_s) / f64::from(self.n_intervals);
                }
            }
            Reading::AngularRate(_) => self.rate = time,
            Reading::MagneticField(_) | Reading::UncalibratedMagneticField { .. } => self.field = time,
            Reading::Radio(_) => self.radio = time,
            Reading::CardFrame(_) => self.card = time,
            _ => {}
        }
    }

    /// What is missing at the newest sample; radio only where it is of use.
    pub fn missing(&self, uses_radio: bool) -> Vec<Missing> {
        let mut missing = Vec::new();
        let mut add = |what| missing.push(Missing::of(what));
        let Some(newest) = self.newest else {
            add(MissingInput::Samples);
            return missing;
        };
        let is_silent = |last: Option<Timestamp>, after_s: f64| {
            last.is_none_or(|last| newest.secs_since(last).abs() > after_s)
        };
        // Where a card is worn its own sensors count.
        if self.card.is_some() {
            if is_silent(self.card, SILENT_S) {
                add(MissingInput::CardFrames);
            }
            return missing;
        }
        if is_silent(self.force, SILENT_S) {
            add(MissingInput::Accelerometer);
        } else if self.n_intervals == N_RATE && self.force_interval_s * MIN_FORCE_HZ > 1.0 {
            add(MissingInput::AccelerometerRate);
        }
        if is_silent(self.rate, SILENT_S) {
            add(MissingInput::Gyroscope);
        }
        if is_silent(self.field, SILENT_S) {
            add(MissingInput::Magnetometer);
        }
        if uses_radio && is_silent(self.radio, RADIO_SILENT_S) {
            add(MissingInput::Radio);
        }
        missing
    }
}

impl Missing {
    /// `what` with its texts.
    pub fn of(what: MissingInput) -> Self {
        let (explanation, remedy) = match what {
            MissingInput::Samples => {
                ("no sample has come yet", "push batches of samples as sensors give them")
            }
            MissingInput::Start => (
                "no start is known: there is no fix",
                "give a hint, such as a tap on the plan, or let the wearer walk ten steps",
            ),
            MissingInput::Accelerometer => (
                "no specific force: no step is seen",
                "register the accelerometer, and keep it while the screen is off",
            ),
            MissingInput::AccelerometerRate => (
                "specific force comes fewer than 20 times a second: steps are missed",
                "ask the operating system for 50 samples a second or more",
            ),
            MissingInput::Gyroscope => (
                "no angular rate: turns are not followed",
                "register the gyroscope, and keep it while the screen is off",
            ),
            MissingInput::Magnetometer => (
                "no magnetic field: the map says nothing",
                "register the magnetometer, uncalibrated where there is such a one",
            ),
            MissingInput::Radio => (
                "no radio was heard: a start takes longer without a hint",
                "have Bluetooth and location on, WiFi where the map has access points, and the permission to scan",
            ),
            MissingInput::CardFrames => (
                "the card has fallen silent",
                "scan without pause, and see whether the card is near and its battery good",
            ),
        };
        Self { what, explanation: explanation.into(), remedy: remedy.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whats(watch: &InputWatch, uses_radio: bool) -> Vec<MissingInput> {
        watch.missing(uses_radio).into_iter().map(|missing| missing.what).collect()
    }

    fn push(watch: &mut InputWatch, ms: i64, reading: Reading) {
        watch.note(&Sample { time: Timestamp::from_millis(ms), reading });
    }

    #[test]
    fn what_never_came_and_what_fell_silent_is_missing() {
        let mut watch = InputWatch::default();
        assert_eq!(whats(&watch, true), [MissingInput::Samples]);
        push(&mut watch, 0, Reading::SpecificForce([0.0, 0.0, 9.8]));
        push(&mut watch, 0, Reading::AngularRate([f32::NAN; 3]));
        use MissingInput::{Accelerometer, Gyroscope, Magnetometer, Radio};
        assert_eq!(whats(&watch, false), [Gyroscope, Magnetometer]);
        push(&mut watch, 10, Reading::AngularRate([0.0; 3]));
        push(&mut watch, 20, Reading::MagneticField([20.0, 0.0, -40.0]));
        assert_eq!(whats(&watch, false), []);
        assert_eq!(whats(&watch, true), [Radio]);
        push(&mut watch, 5_001, Reading::AngularRate([0.0; 3]));
        assert_eq!(whats(&watch, false), [Accelerometer]);
    }

    #[test]
    fn of_a_card_nothing_is_missing_but_its_frames() {
        let mut watch = InputWatch::default();
        push(&mut watch, 0, Reading::CardFrame([0; 31]));
        assert_eq!(whats(&watch, true), []);
        push(&mut watch, 5_001, Reading::MagneticField([20.0, 0.0, -40.0]));
        assert_eq!(whats(&watch, true), [MissingInput::CardFrames]);
    }

    #[test]
    fn a_slow_accelerometer_is_told_and_a_fast_one_forgives() {
        let mut watch = InputWatch::default();
        let mut at_ms = 0;
        let mut run = |watch: &mut InputWatch, every_ms: i64, n: i64| {
            for _ in 0..n {
                at_ms += every_ms;
                push(watch, at_ms, Reading::SpecificForce([0.0, 0.0, 9.8]));
            }
        };
        run(&mut watch, 60, 40);
        assert!(!whats(&watch, false).contains(&MissingInput::AccelerometerRate), "too early to tell");
        run(&mut watch, 60, 1);
        assert!(whats(&watch, false).contains(&MissingInput::AccelerometerRate));
        run(&mut watch, 10, 200);
        assert!(!whats(&watch, false).contains(&MissingInput::AccelerometerRate));
    }
}
