//! The tilt-compensated compass.

use serde::{Deserialize, Serialize};

use super::{FieldStream, HeadingEstimator};
use crate::gravity::{LevelEstimator, LevelParams, VectorLowPass};
use crate::rotation::{Quaternion, cross, norm};
use crate::sensor::{Reading, Sample};
use crate::time::Timestamp;

/// The rotation into the earth frame (z up, y to magnetic north) that `force` (which points up at rest, any unit) and
/// `field` (any unit), both in the device frame, imply; nothing when one of them is absent or they are parallel.
///
/// The azimuth of the device is this rotation's: the field's horizontal part is north, whatever the tilt.
pub fn earth_from_device(force: [f64; 3], field: [f64; 3]) -> Option<Quaternion> {
    let (force_norm, field_norm) = (norm(force), norm(field));
    let east = cross(field, force);
    let east_norm = norm(east);
    // Within half a degree of the vertical a field has no direction.
    if !(east_norm > 0.01 * force_norm * field_norm && east_norm.is_finite()) {
        return None;
    }
    let up = force.map(|c| c / force_norm);
    let east = east.map(|c| c / east_norm);
    Quaternion::from_rows(east, cross(up, east), up).renormalised()
}

/// Parameters of [`Compass`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompassParams {
    /// Cut-off of the low-pass that makes gravity of the specific force, in Hz; default 0.5: below the rate of steps.
    pub gravity_cutoff_hz: f32,
}

impl Default for CompassParams {
    fn default() -> Self {
        Self { gravity_cutoff_hz: 0.5 }
    }
}

/// Accelerometer and magnetometer alone: low-passed gravity, and every field as it comes.
#[derive(Clone, Debug, PartialEq)]
pub struct Compass {
    params: CompassParams,
    gravity: VectorLowPass,
    last_force: Option<Timestamp>,
    field: FieldStream,
    earth_from_device: Option<Quaternion>,
}

impl Compass {
    /// A compass that has seen nothing.
    pub fn new(params: CompassParams) -> Self {
        Self {
            params,
            gravity: VectorLowPass::default(),
            last_force: None,
            field: FieldStream::default(),
            earth_from_device: None,
        }
    }

    fn push_field(&mut self, field_ut: [f32; 3]) {
        if let Some(gravity) = self.gravity.output() {
            let measured = earth_from_device(gravity.map(f64::from), field_ut.map(f64::from));
            self.earth_from_device = measured.or(self.earth_from_device);
        }
    }
}

impl HeadingEstimator for Compass {
    fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            return;
        }
        match sample.reading {
            Reading::SpecificForce(force) => {
                let dt_s = self.last_force.map_or(0.0, |last| sample.time.secs_since(last));
                if dt_s < 0.0 {
                    return;
                }
                self.last_force = Some(sample.time);
                self.gravity.update(force, VectorLowPass::factor(self.params.gravity_cutoff_hz, dt_s as f32));
            }
            reading => {
                if let Some(field_ut) = self.field.corrected_ut(&reading) {
                    self.push_field(field_ut);
                }
            }
        }
    }

    fn earth_from_device(&self) -> Option<Quaternion> {
        self.earth_from_device
    }
}

/// The compass that a gyroscope levels: every field as it comes, in the level frame.
///
/// What is left of the compass's errors here is the field's own.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelCompass {
    level: LevelEstimator,
    field: FieldStream,
    earth_from_device: Option<Quaternion>,
}

impl LevelCompass {
    /// A compass that has seen nothing.
    pub fn new(params: LevelParams) -> Self {
        Self { level: LevelEstimator::new(params), field: FieldStream::default(), earth_from_device: None }
    }

    fn push_field(&mut self, field_ut: [f32; 3]) {
        if let Some(level_from_device) = self.level.level_from_device() {
            let up = level_from_device.rotate_back([0.0, 0.0, 1.0]);
            let measured = earth_from_device(up, field_ut.map(f64::from));
            self.earth_from_device = measured.or(self.earth_from_device);
        }
    }
}

impl HeadingEstimator for LevelCompass {
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
                    self.push_field(field_ut);
                }
            }
        }
    }

    fn earth_from_device(&self) -> Option<Quaternion> {
        self.earth_from_device
    }
}

#[cfg(test)]
mod tests {
    use super::super::simulated::Simulated;
    use super::super::{axis_heading_rad, heading_error_rad};
    use super::*;
    use core::f64::consts::FRAC_PI_2;
    use proptest::prelude::*;

    #[test]
    fn a_level_device_that_points_east_by_hand() {
        // North is to its left (−x), the field dips.
        let q = earth_from_device([0.0, 0.0, 9.81], [-20.0, 0.0, -40.0]).unwrap();
        assert!((axis_heading_rad(q, [0.0, 1.0, 0.0]) - FRAC_PI_2).abs() < 1e-12);
        // Tilted top up by the angle whose sine is 0.6: force (0, 0.6, 0.8)·g; its top still points east.
        let tilted = earth_from_device([0.0, 0.6, 0.8], [-20.0, -24.0, -32.0]).unwrap();
        assert!((axis_heading_rad(tilted, [0.0, 1.0, 0.0]) - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn a_field_along_the_vertical_has_no_direction() {
        assert_eq!(earth_from_device([0.0, 0.0, 9.81], [0.0, 0.0, -40.0]), None);
        assert_eq!(earth_from_device([0.0, 0.0, 9.81], [0.0; 3]), None);
        assert_eq!(earth_from_device([0.0; 3], [1.0, 2.0, 3.0]), None);
        assert_eq!(earth_from_device([f64::NAN; 3], [1.0, 2.0, 3.0]), None);
    }

    #[test]
    fn the_compass_follows_a_slow_turn() {
        let mut device = Simulated::new(Quaternion::from_heading(1.0));
        let mut compass = Compass::new(CompassParams::default());
        device.turn(&mut compass, 10.0, |_| [0.0, 0.0, 0.2]);
        assert!(device.error_deg(&compass).abs() < 1e-3);
    }

    #[test]
    fn levelled_by_the_gyroscope_it_withstands_a_shaken_accelerometer() {
        let mut device = Simulated::new(Quaternion::from_heading(-1.0));
        let mut compass = LevelCompass::new(LevelParams::default());
        device.turn(&mut compass, 10.0, |t| [libm::sin(9.0 * t), 0.0, 0.5]);
        assert!(device.error_deg(&compass).abs() < 0.5, "{}", device.error_deg(&compass));
    }

    proptest! {
        #[test]
        fn any_attitude_is_found(heading in -3.1f64..3.1, tilt in prop::array::uniform3(-0.9f64..0.9)) {
            let truth = Quaternion::from_heading(heading).turned(tilt);
            let (force, field) = (truth.rotate_back([0.0, 0.0, 9.81]), truth.rotate_back([0.0, 21.0, -43.0]));
            let found = earth_from_device(force, field).unwrap();
            prop_assert!(heading_error_rad(found, truth).abs() < 1e-9);
            prop_assert!((0..3).all(|c| (found.rotate(force)[c] - [0.0, 0.0, 9.81][c]).abs() < 1e-9));
        }
    }
}
