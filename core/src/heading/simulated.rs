//! A device that turns as it is told, and what its sensors say: for the tests of the estimators.

use super::HeadingEstimator;
use crate::rotation::Quaternion;
use crate::sensor::{Reading, Sample};
use crate::time::{Duration, Timestamp};

/// A device in a field that points north and down.
pub(super) struct Simulated {
    pub(super) now: Timestamp,
    pub(super) earth_from_device: Quaternion,
    pub(super) gyroscope_bias_rad_s: [f64; 3],
    pub(super) hard_iron_ut: [f64; 3],
    pub(super) system_iron_ut: [f64; 3],
    pub(super) field_ut: [f64; 3],
}

impl Simulated {
    pub(super) fn new(earth_from_device: Quaternion) -> Self {
        Self {
            now: Timestamp::from_millis(0),
            earth_from_device,
            gyroscope_bias_rad_s: [0.0; 3],
            hard_iron_ut: [0.0; 3],
            system_iron_ut: [0.0; 3],
            field_ut: [0.0, 22.0, -40.0],
        }
    }

    /// Turns for `seconds` at a rate of the device frame, sampled at 100 Hz, and tells the estimator.
    pub(super) fn turn(
        &mut self,
        estimator: &mut impl HeadingEstimator,
        seconds: f64,
        rate_rad_s: impl Fn(f64) -> [f64; 3],
    ) {
        for k in 0..(seconds * 100.0) as i64 {
            let rate = rate_rad_s(k as f64 * 0.01);
            self.now = self.now + Duration::from_nanos(10_000_000);
            self.earth_from_device = self.earth_from_device.turned(rate.map(|c| c * 0.01));
            let force = self.earth_from_device.rotate_back([0.0, 0.0, 9.806_65]);
            let field = self.earth_from_device.rotate_back(self.field_ut);
            let single = |v: [f64; 3]| v.map(|c| c as f32);
            let readings = [
                Reading::AngularRate(single([0, 1, 2].map(|c| rate[c] + self.gyroscope_bias_rad_s[c]))),
                Reading::SpecificForce(single(force)),
                Reading::UncalibratedMagneticField {
                    field_ut: single([0, 1, 2].map(|c| field[c] + self.hard_iron_ut[c])),
                    bias_ut: single(self.system_iron_ut),
                },
            ];
            for reading in readings {
                estimator.push(&Sample { time: self.now, reading });
            }
        }
    }

    /// By how much the estimate is turned too far clockwise, in degrees.
    pub(super) fn error_deg(&self, estimator: &impl HeadingEstimator) -> f64 {
        let estimate = estimator.earth_from_device().expect("a heading");
        super::heading_error_rad(estimate, self.earth_from_device).to_degrees()
    }
}
