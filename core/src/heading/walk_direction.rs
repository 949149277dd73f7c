//! The angle between the device and the walk.

use serde::{Deserialize, Serialize};

/// The line along which a walker's trunk speeds up and slows down at every step: the principal axis of the horizontal
/// acceleration, found over some strides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WalkAxis {
    /// Heading of the axis in the frame of the accelerations, clockwise from y, in [-π/2, π/2] radians towards the
    /// end that [`WalkAxis::sense_weight`] prefers, else of either end.
    pub heading_rad: f64,
    /// How much longer the axis is than what lies across it: `1 − λ₂/λ₁`, 0 (round: no axis) to 1 (a line).
    pub distinctness: f64,
    /// Which end is ahead: positive where it is this one, negative where it is the other, near 0 where unknown.
    pub sense_weight: f64,
}

/// Collects horizontal accelerations and gives their principal axis.
///
/// Push two or more whole strides: over a single step the trunk also sways to the side of one foot.
///
/// An axis has two ends. Ahead is where the trunk is driven while it rises: in the second half of a step the foot
/// pushes off, and forward and upward acceleration go together, while at the landing the trunk is braked and has just
/// begun to be caught. The sum of `along · rate of the vertical acceleration` decides, since the vertical acceleration
/// leads the forward one by about a quarter of a step; without it the end nearer to a known heading should be taken
/// ([`WalkAxis::towards`]).
///
/// # Source
/// Ours; the principal axis of horizontal acceleration is common in the field. The paper of the pathway model, Kwak
/// 2018, has a card that hangs in a known way and needs none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WalkAxisEstimator {
    n: u32,
    mean: [f64; 2],
    /// Sums of products about the mean: xx, xy, yy.
    products: [f64; 3],
    last_vertical_m_s2: Option<f64>,
    /// Sum of horizontal acceleration times change of the vertical one.
    sense: [f64; 2],
}

impl WalkAxisEstimator {
    /// Adds an acceleration of a frame with z up whose yaw does not turn with the device, gravity removed, in m/s².
    pub fn push(&mut self, level_acceleration_m_s2: [f32; 3]) {
        let [x, y, z] = level_acceleration_m_s2.map(f64::from);
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            return;
        }
        // Welford's update: exact for long walks.
        self.n += 1;
        let n = f64::from(self.n);
        let before = [x - self.mean[0], y - self.mean[1]];
        self.mean = [self.mean[0] + before[0] / n, self.mean[1] + before[1] / n];
        let after = [x - self.mean[0], y - self.mean[1]];
        self.products[0] += before[0] * after[0];
        self.products[1] += before[0] * after[1];
        self.products[2] += before[1] * after[1];
        if let Some(last) = self.last_vertical_m_s2.replace(z) {
            self.sense[0] += x * (z - last);
            self.sense[1] += y * (z - last);
        }
    }

    /// The axis of what was pushed, by the closed form of a symmetric 2 × 2 matrix; nothing when nothing moved.
    pub fn axis(&self) -> Option<WalkAxis> {
        let [xx, xy, yy] = self.products;
        let (half_sum, half_difference) = (0.5 * (xx + yy), 0.5 * (yy - xx));
        let root = (half_difference * half_difference + xy * xy).sqrt();
        let (longest, shortest) = (half_sum + root, half_sum - root);
        if self.n < 2 || longest <= 1e-9 * f64::from(self.n) {
            return None;
        }
        // Clockwise from y, the axis has tan 2θ = 2·xy / (yy − xx).
        let heading_rad = 0.5 * libm::atan2(2.0 * xy, yy - xx);
        let (sin, cos) = libm::sincos(heading_rad);
        let along = self.sense[0] * sin + self.sense[1] * cos;
        let size = (self.sense[0] * self.sense[0] + self.sense[1] * self.sense[1]).sqrt();
        Some(WalkAxis {
            heading_rad,
            distinctness: (1.0 - shortest / longest).clamp(0.0, 1.0),
            sense_weight: if size > 0.0 { along / size } else { 0.0 },
        })
    }

    /// Forgets what was pushed.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

impl WalkAxis {
    /// The end that [`WalkAxis::sense_weight`] says is ahead, clockwise from y, in (-π, π].
    pub fn ahead_rad(&self) -> f64 {
        if self.sense_weight < 0.0 { opposite(self.heading_rad) } else { self.heading_rad }
    }

    /// The end nearer to `heading_rad`, in (-π, π]: for a walker whose way is roughly known.
    pub fn towards(&self, heading_rad: f64) -> f64 {
        if libm::cos(self.heading_rad - heading_rad) < 0.0 {
            opposite(self.heading_rad)
        } else {
            self.heading_rad
        }
    }
}

fn opposite(heading_rad: f64) -> f64 {
    use core::f64::consts::PI;
    if heading_rad > 0.0 { heading_rad - PI } else { heading_rad + PI }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_4, PI, TAU};
    use proptest::prelude::*;

    /// A walk ahead along `heading_rad`, two steps a second: the forward acceleration follows the vertical one by a
    /// quarter of a step, and the trunk sways across once a stride.
    fn walked(heading_rad: f64) -> WalkAxis {
        let mut estimator = WalkAxisEstimator::default();
        let (sin, cos) = libm::sincos(heading_rad);
        for k in 0..400 {
            let phase = TAU * 2.0 * 0.01 * f64::from(k);
            let (forward, across, up) =
                (1.5 * libm::cos(phase), 0.6 * libm::sin(0.5 * phase), 3.0 * libm::sin(phase));
            let acceleration = [forward * sin + across * cos, forward * cos - across * sin, up];
            estimator.push(acceleration.map(|c| c as f32));
        }
        estimator.axis().unwrap()
    }

    #[test]
    fn the_axis_of_four_points_by_hand() {
        // Points on the line x = y, and half as far on x = −y: products xx = yy = 2.5·2, xy = 1.5·2.
        let mut estimator = WalkAxisEstimator::default();
        for [x, y] in [[1.0, 1.0], [-1.0, -1.0], [0.5, -0.5], [-0.5, 0.5]] {
            estimator.push([x, y, 0.0]);
        }
        let axis = estimator.axis().unwrap();
        assert!((axis.heading_rad - FRAC_PI_4).abs() < 1e-9, "{axis:?}");
        // Eigenvalues 4 and 1.
        assert!((axis.distinctness - 0.75).abs() < 1e-9);
        assert_eq!(axis.sense_weight, 0.0);
        assert!((axis.towards(-3.0) + 0.75 * PI).abs() < 1e-9);
    }

    #[test]
    fn standing_has_no_axis() {
        let mut estimator = WalkAxisEstimator::default();
        assert_eq!(estimator.axis(), None);
        for _ in 0..100 {
            estimator.push([0.1, -0.2, 0.0]);
            estimator.push([f32::NAN; 3]);
        }
        assert_eq!(estimator.axis(), None);
        estimator.push([1.0, 0.0, 0.0]);
        // The line from the mean of the others, (0.1, −0.2), to (1, 0).
        assert!((estimator.axis().unwrap().heading_rad - libm::atan2(0.9, 0.2)).abs() < 1e-6);
        estimator.reset();
        assert_eq!(estimator, WalkAxisEstimator::default());
    }

    proptest! {
        #[test]
        fn any_direction_of_walking_is_found_with_its_sense(heading in -3.1f64..3.1) {
            let axis = walked(heading);
            let off = axis.ahead_rad() - heading;
            prop_assert!((1.0 - libm::cos(off)) < 1e-3, "{axis:?}");
            prop_assert!(axis.distinctness > 0.7);
        }
    }
}
