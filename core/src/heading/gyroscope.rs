//! The gyroscope from the compass's first word.

use super::{FieldStream, HeadingEstimator};
use crate::gravity::{LevelEstimator, LevelParams};
use crate::rotation::Quaternion;
use crate::sensor::{Reading, Sample};
use crate::time::Timestamp;

/// Time over which the compass is averaged before it is heard no more, in seconds.
const START_S: f64 = 1.0;

/// Gyroscope integration: the level frame, turned once to where the compass said north was during the first second.
///
/// Its drift is the gyroscope's: WILA 2016 measured about 10° in 100 s.
#[derive(Clone, Debug, PartialEq)]
pub struct GyroscopeHeading {
    level: LevelEstimator,
    field: FieldStream,
    first_field: Option<Timestamp>,
    /// Sum of horizontal fields over the first second, level frame.
    north: [f64; 2],
}

impl GyroscopeHeading {
    /// An estimator that has seen nothing.
    pub fn new(params: LevelParams) -> Self {
        Self {
            level: LevelEstimator::new(params),
            field: FieldStream::default(),
            first_field: None,
            north: [0.0; 2],
        }
    }

    fn push_field(&mut self, time: Timestamp, field_ut: [f32; 3]) {
        let Some(level) = self.level.to_level(field_ut) else { return };
        let first = *self.first_field.get_or_insert(time);
        if (0.0..START_S).contains(&time.secs_since(first)) {
            self.north[0] += f64::from(level[0]);
            self.north[1] += f64::from(level[1]);
        }
    }
}

impl HeadingEstimator for GyroscopeHeading {
    fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            return;
        }
        match sample.reading {
            Reading::AngularRate(rate) => self.level.push_angular_rate(sample.time, rate),
            Reading::SpecificForce(force) => {
                self.level.push_specific_force(sample.time, force);
            }
            reading => {
                if let Some(field_ut) = self.field.corrected_ut(&reading) {
                    self.push_field(sample.time, field_ut);
                }
            }
        }
    }

    fn earth_from_device(&self) -> Option<Quaternion> {
        self.first_field?;
        let north_heading_rad = libm::atan2(self.north[0], self.north[1]);
        Some(Quaternion::from_heading(-north_heading_rad).after(self.level.level_from_device()?))
    }
}

#[cfg(test)]
mod tests {
    use super::super::simulated::Simulated;
    use super::*;

    #[test]
    fn it_starts_at_the_compass_and_then_hears_the_gyroscope_alone() {
        let mut device = Simulated::new(Quaternion::from_heading(-2.0));
        let mut gyroscope = GyroscopeHeading::new(LevelParams::default());
        device.turn(&mut gyroscope, 2.0, |_| [0.0; 3]);
        assert!(device.error_deg(&gyroscope).abs() < 0.01);
        device.field_ut = [90.0, 0.0, 0.0];
        device.turn(&mut gyroscope, 20.0, |_| [0.0, 0.0, 0.5]);
        assert!(device.error_deg(&gyroscope).abs() < 0.1, "{}", device.error_deg(&gyroscope));
    }

    #[test]
    fn its_drift_is_the_bias() {
        let mut device = Simulated::new(Quaternion::IDENTITY);
        let mut gyroscope = GyroscopeHeading::new(LevelParams::default());
        device.turn(&mut gyroscope, 2.0, |_| [0.0; 3]);
        let before_deg = device.error_deg(&gyroscope);
        // 0.1 rad in 100 s, anticlockwise: 5.73°.
        device.gyroscope_bias_rad_s = [0.0, 0.0, 0.001];
        device.turn(&mut gyroscope, 100.0, |_| [0.0; 3]);
        assert!((device.error_deg(&gyroscope) - before_deg + 5.73).abs() < 0.02);
    }
}
