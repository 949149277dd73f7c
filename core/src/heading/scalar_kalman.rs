//! The scalar Kalman filter over the heading.

use serde::{Deserialize, Serialize};

use super::{FieldStream, HeadingEstimator, axis_heading_rad, earth_from_device};
use crate::geometry::wrap_rad;
use crate::gravity::{LevelEstimator, LevelParams};
use crate::rotation::Quaternion;
use crate::sensor::{Reading, Sample};
use crate::time::Timestamp;

/// Parameters of [`ScalarKalman`]; the paper gives neither.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScalarKalmanParams {
    /// `Q`, the variance that one prediction adds, in rad²; default (0.0005)²: a gyroscope's drift of 10° in 100 s
    /// (the paper's) is 0.000 035 rad every 20 ms, its noise and the neglected tilt are the rest.
    pub prediction_variance_rad2: f64,
    /// `R`, the variance of one compass azimuth, in rad²; default (0.35)², 20°: what steel in a building does to it.
    pub azimuth_variance_rad2: f64,
}

impl Default for ScalarKalmanParams {
    fn default() -> Self {
        Self { prediction_variance_rad2: 0.0005 * 0.0005, azimuth_variance_rad2: 0.35 * 0.35 }
    }
}

/// A heading that the gyroscope predicts and the compass corrects.
///
/// # Source
/// WILA 2016, Eqs 5–10. We wrap the innovation, which the paper does not mention.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScalarKalman {
    params: ScalarKalmanParams,
    /// `X`, the heading, clockwise from north, in [-π, π) radians.
    pub heading_rad: f64,
    /// `P`, its variance, in rad².
    pub variance_rad2: f64,
}

impl ScalarKalman {
    /// A filter that starts at the first azimuth, with its variance.
    pub fn new(params: ScalarKalmanParams, azimuth_rad: f64) -> Self {
        Self { params, heading_rad: wrap_rad(azimuth_rad), variance_rad2: params.azimuth_variance_rad2 }
    }

    /// Predicts over `dt_s` at `rate_rad_s`, clockwise: `X⁻ = X + T_s·U`, `P⁻ = P + Q`.
    ///
    /// # Source
    /// WILA 2016, Eqs 5–7.
    pub fn predict(&mut self, rate_rad_s: f64, dt_s: f64) {
        let turn_rad = rate_rad_s * dt_s;
        if turn_rad.is_finite() {
            self.heading_rad = wrap_rad(self.heading_rad + turn_rad);
        }
        self.variance_rad2 += self.params.prediction_variance_rad2;
    }

    /// Corrects by a compass azimuth: `K = P⁻/(P⁻ + R)`, `X = X⁻ + K·(Z − X⁻)`, `P = P⁻·(1 − K)`.
    ///
    /// # Source
    /// WILA 2016, Eqs 8–10.
    pub fn correct(&mut self, azimuth_rad: f64) {
        if !azimuth_rad.is_finite() {
            return;
        }
        let gain = self.variance_rad2 / (self.variance_rad2 + self.params.azimuth_variance_rad2);
        self.heading_rad = wrap_rad(self.heading_rad + gain * wrap_rad(azimuth_rad - self.heading_rad));
        self.variance_rad2 *= 1.0 - gain;
    }
}

/// WILA's filter on a device that is held anyhow: the level frame's own direction is the heading that it keeps.
///
/// The paper's wearable sits upright at the waist, so one axis of the gyroscope turns about the vertical. Here the
/// rate is how fast the gyroscope turns the device's most horizontal axis, and the azimuth is that axis's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WilaHeading {
    params: ScalarKalmanParams,
    level: LevelEstimator,
    field: FieldStream,
    filter: Option<ScalarKalman>,
    /// The axis whose heading is kept: 0, 1 or 2; and that heading in the level frame at the last prediction.
    axis: usize,
    level_heading_rad: f64,
    last_rate: Option<Timestamp>,
}

impl WilaHeading {
    /// An estimator that has seen nothing.
    pub fn new(params: ScalarKalmanParams, level: LevelParams) -> Self {
        Self {
            params,
            level: LevelEstimator::new(level),
            field: FieldStream::default(),
            filter: None,
            axis: 1,
            level_heading_rad: 0.0,
            last_rate: None,
        }
    }

    /// The level frame that it keeps.
    pub(crate) fn level(&self) -> &LevelEstimator {
        &self.level
    }

    /// Sine and cosine of the heading of the device's forward axis, clockwise from magnetic north: the level frame's own
    /// direction as long as no field was read.
    pub(crate) fn forward(&self) -> Option<[f32; 2]> {
        let [x, y] = self.level.forward()?;
        let offset_rad = self.filter.map_or(0.0, |filter| filter.heading_rad - self.level_heading_rad);
        let heading_rad = libm::atan2(f64::from(x), f64::from(y)) + offset_rad;
        let (sin, cos) = libm::sincos(heading_rad);
        Some([sin as f32, cos as f32])
    }

    fn push_field(&mut self, time: Timestamp, field_ut: [f32; 3]) {
        let Some(level_from_device) = self.level.level_from_device() else { return };
        let up = level_from_device.rotate_back([0.0, 0.0, 1.0]);
        let Some(measured) = earth_from_device(up, field_ut.map(f64::from)) else { return };
        // Without a gyroscope nothing predicts, and the compass alone is the heading.
        match self.filter.as_mut().filter(|_| self.level.has_gyroscope(time)) {
            Some(filter) => filter.correct(axis_heading_rad(measured, unit(self.axis))),
            None => {
                self.axis = most_horizontal(level_from_device);
                self.level_heading_rad = axis_heading_rad(level_from_device, unit(self.axis));
                let azimuth_rad = axis_heading_rad(measured, unit(self.axis));
                self.filter = Some(ScalarKalman::new(self.params, azimuth_rad));
            }
        }
    }

    fn push_rate(&mut self, time: Timestamp, rate_rad_s: [f32; 3]) {
        self.level.push_angular_rate(time, rate_rad_s);
        let dt_s = self.last_rate.replace(time).map_or(0.0, |last| time.secs_since(last));
        let (Some(filter), Some(level_from_device)) = (&mut self.filter, self.level.level_from_device())
        else {
            return;
        };
        if dt_s <= 0.0 {
            return;
        }
        let now_rad = axis_heading_rad(level_from_device, unit(self.axis));
        filter.predict(wrap_rad(now_rad - self.level_heading_rad) / dt_s, dt_s);
        self.level_heading_rad = now_rad;
        let axis = most_horizontal(level_from_device);
        if axis != self.axis {
            // The heading goes over to the other axis by the angle between them.
            let other_rad = axis_heading_rad(level_from_device, unit(axis));
            filter.heading_rad = wrap_rad(filter.heading_rad + other_rad - now_rad);
            (self.axis, self.level_heading_rad) = (axis, other_rad);
        }
    }
}

impl HeadingEstimator for WilaHeading {
    fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            return;
        }
        match sample.reading {
            Reading::AngularRate(rate) => self.push_rate(sample.time, rate),
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
        let heading_rad = self.filter?.heading_rad;
        let level_from_device = self.level.level_from_device()?;
        let level_heading_rad = axis_heading_rad(level_from_device, unit(self.axis));
        Some(Quaternion::from_heading(heading_rad - level_heading_rad).after(level_from_device))
    }
}

fn unit(axis: usize) -> [f64; 3] {
    let mut unit = [0.0; 3];
    if let Some(c) = unit.get_mut(axis) {
        *c = 1.0;
    }
    unit
}

/// The device axis that is nearest to the horizontal.
fn most_horizontal(level_from_device: Quaternion) -> usize {
    let up = level_from_device.rotate_back([0.0, 0.0, 1.0]).map(f64::abs);
    (0..3).fold(1, |best, axis| if up[axis] < up[best] { axis } else { best })
}

#[cfg(test)]
mod tests {
    use super::super::simulated::Simulated;
    use super::*;
    use core::f64::consts::PI;

    #[test]
    fn wila_equations_5_to_10_by_hand() {
        let params = ScalarKalmanParams { prediction_variance_rad2: 0.01, azimuth_variance_rad2: 0.04 };
        let mut filter = ScalarKalman::new(params, 0.0);
        filter.predict(0.5, 0.1);
        // X⁻ = 0 + 0.1·0.5, P⁻ = 0.04 + 0.01
        assert!((filter.heading_rad - 0.05).abs() < 1e-15 && (filter.variance_rad2 - 0.05).abs() < 1e-15);
        filter.correct(0.14);
        // K = 0.05/0.09, X = 0.05 + K·0.09 = 0.1, P = 0.05·(1 − 5/9)
        assert!((filter.heading_rad - 0.1).abs() < 1e-15, "{filter:?}");
        assert!((filter.variance_rad2 - 0.05 * 4.0 / 9.0).abs() < 1e-15);
    }

    #[test]
    fn the_innovation_goes_the_short_way_round() {
        let params = ScalarKalmanParams { prediction_variance_rad2: 0.0, azimuth_variance_rad2: 0.04 };
        let mut filter = ScalarKalman::new(params, PI - 0.1);
        filter.correct(-PI + 0.1);
        // P = R, so the gain is a half of the 0.2 rad between.
        assert!((filter.heading_rad.abs() - PI).abs() < 1e-12, "{filter:?}");
    }

    #[test]
    fn nonsense_moves_nothing() {
        let mut filter = ScalarKalman::new(ScalarKalmanParams::default(), 1.0);
        filter.predict(f64::NAN, 0.01);
        filter.correct(f64::INFINITY);
        assert_eq!(filter.heading_rad, 1.0);
    }

    #[test]
    fn ten_turns_of_a_quarter_are_seen() {
        // WILA 2016, Fig. 9: ten turns of 90°, here by an upright device (top edge up).
        let upright = Quaternion::from_rows([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
        let mut device = Simulated::new(upright);
        let mut wila = WilaHeading::new(ScalarKalmanParams::default(), LevelParams::default());
        device.turn(&mut wila, 2.0, |_| [0.0; 3]);
        for _ in 0..10 {
            device.turn(&mut wila, 1.0, |_| [0.0, PI / 2.0, 0.0]);
            device.turn(&mut wila, 2.0, |_| [0.0; 3]);
            assert!(device.error_deg(&wila).abs() < 1.0, "{}", device.error_deg(&wila));
        }
    }

    #[test]
    fn rolling_over_hands_the_heading_to_another_axis() {
        let mut device = Simulated::new(Quaternion::IDENTITY);
        let mut wila = WilaHeading::new(ScalarKalmanParams::default(), LevelParams::default());
        device.turn(&mut wila, 2.0, |_| [0.0; 3]);
        // Top edge up, then half round.
        device.turn(&mut wila, 1.0, |_| [1.5, 0.0, 0.0]);
        device.turn(&mut wila, 3.0, |_| [0.0, 1.0, 0.0]);
        assert!(device.error_deg(&wila).abs() < 2.0, "{}", device.error_deg(&wila));
    }
}
