//! Which way the device points: compass, gyroscope, the scalar Kalman filter, and our own fusion of all sensors.
//!
//! The *earth frame* here has z up and y towards magnetic north. An estimator says how the device is turned in it as
//! a whole, `earth_from_device`; a heading is the direction of one chosen axis of the device. That keeps the pocket,
//! where the top edge points at the ceiling, as well defined as the hand.

mod compass;
mod fused;
mod gyroscope;
mod scalar_kalman;

pub use compass::{Compass, CompassParams, LevelCompass, earth_from_device};
pub use fused::{FusedHeading, FusedHeadingParams};
pub use gyroscope::GyroscopeHeading;
pub use scalar_kalman::{ScalarKalman, ScalarKalmanParams, WilaHeading};

use crate::rotation::Quaternion;
use crate::sensor::Sample;

/// Turns samples into the device's rotation against magnetic north.
pub trait HeadingEstimator {
    /// Consumes a sample; samples come in order of time, those that do not are of no use and do no harm.
    fn push(&mut self, sample: &Sample);

    /// The rotation from the device frame into the earth frame (z up, y to magnetic north), once it is known.
    fn earth_from_device(&self) -> Option<Quaternion>;
}

/// Heading of the device axis `axis` (device frame) clockwise from the earth frame's y, in radians; 0 where that axis
/// is vertical.
pub fn axis_heading_rad(earth_from_device: Quaternion, axis: [f64; 3]) -> f64 {
    let [east, north, _] = earth_from_device.rotate(axis);
    libm::atan2(east, north)
}

/// By how much `estimate` is turned too far clockwise about the vertical, against `truth`, in (-π, π].
///
/// The heading part of `estimate · truth⁻¹`: no device axis has to be chosen, and a tilt error does not count.
pub fn heading_error_rad(estimate: Quaternion, truth: Quaternion) -> f64 {
    estimate.after(truth.inverse()).heading_part_rad()
}

#[cfg(test)]
mod simulated;
