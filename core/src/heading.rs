//! Which way the device points: compass, gyroscope, the scalar Kalman filter, and our own fusion of all sensors.
//!
//! The *earth frame* here has z up and y towards magnetic north. An estimator says how the device is turned in it as
//! a whole, `earth_from_device`; a heading is the direction of one chosen axis of the device. That keeps the pocket,
//! where the top edge points at the ceiling, as well defined as the hand.
//!
//! What the systems use of this is data in their recipes. `fused` and `dead-reckoning` carry the level frame of
//! [`gravity`](crate::gravity) by the gyroscope and leave north to their particles; `mass-centered` takes each step's
//! compass azimuth, adds the surveyed deviation of the place and lets the gyroscope smooth the sum; `card` lets most particles follow the ways of the
//! plan, by that azimuth or by their own last heading. The estimators here give a heading without a map:
//! at a start, for a display, or for an engineer who compares them. The axis of the walk is a part
//! for the systems that ask for it.

mod compass;
mod fused;
mod gyroscope;
mod pathway;
mod scalar_kalman;
mod walk_direction;

pub use compass::{Compass, CompassParams, LevelCompass, earth_from_device};
pub use fused::{FusedHeading, FusedHeadingParams};
pub use gyroscope::GyroscopeHeading;
pub use pathway::{PathwayParams, Pathways, WayGrid, pathway_heading_rad};
pub use scalar_kalman::{ScalarKalman, ScalarKalmanParams, WilaHeading};
pub use walk_direction::{WalkAxis, WalkAxisEstimator};

use serde::{Deserialize, Serialize};

use crate::rotation::Quaternion;
use crate::sensor::{Reading, Sample};

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

/// The field as the phone corrects it: from the uncalibrated stream, once there is one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct FieldStream {
    has_uncalibrated: bool,
}

impl FieldStream {
    /// The field in the device frame without the phone's bias, in µT, if `reading` tells it.
    fn corrected_ut(&mut self, reading: &Reading) -> Option<[f32; 3]> {
        match *reading {
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                self.has_uncalibrated = true;
                Some([0, 1, 2].map(|c| field_ut[c] - bias_ut[c]))
            }
            Reading::MagneticField(field_ut) if !self.has_uncalibrated => Some(field_ut),
            _ => None,
        }
    }
}

#[cfg(test)]
mod simulated;
