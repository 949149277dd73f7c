//! How likely a fix is where somebody truly is.
//!
//! # Source
//! Ours, in the place of iBILL 2017, Fig. 4, by which a fix is the place.

use crate::geometry::Point2;

/// Of so many fixes nothing is true but that the cluster was heard well, which is possible from so far, in metres.
///
/// # Source
/// Ours: where shadows favour a place, all beacons of a cluster seem near from afar. On twelve simulated walks past
/// clusters 19 of 126 fixes were made 4 to 11 m away and lay within the cluster.
const ASTRAY: f64 = 0.2;
pub(crate) const ASTRAY_M: f64 = 12.0;
/// Two opinions on a place farther apart than this contradict each other: the square of three standard deviations.
const CONTRADICTION_SQUARE: f64 = 9.0;
/// No fix is better than this along an axis: its variance, in m².
const MIN_VARIANCE_M2: f64 = 0.01;

/// The density of the walker's place about a fix: a normal one, or anywhere near by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixDensity {
    /// The inverse of the covariance [xx, xy, yy], in 1/m².
    inverse: [f64; 3],
    /// The normal part at the fix, in 1/m².
    at_fix: f64,
}

impl FixDensity {
    /// About a fix with covariance [xx, xy, yy], in m².
    pub fn new(covariance_m2: [f64; 3]) -> Self {
        let [xx, xy, yy] = sound(covariance_m2);
        let determinant = xx * yy - xy * xy;
        Self {
            inverse: [yy / determinant, -xy / determinant, xx / determinant],
            at_fix: (1.0 - ASTRAY) / (core::f64::consts::TAU * determinant.sqrt()),
        }
    }

    /// The density's logarithm at `off` from the fix, in metres.
    pub fn log_at(&self, off: Point2) -> f64 {
        let astray = ASTRAY / (core::f64::consts::PI * ASTRAY_M * ASTRAY_M);
        libm::log(self.at_fix * libm::exp(-0.5 * self.square(off)) + astray)
    }

    fn square(&self, off: Point2) -> f64 {
        let [xx, xy, yy] = self.inverse;
        xx * off.x_m * off.x_m + 2.0 * xy * off.x_m * off.y_m + yy * off.y_m * off.y_m
    }
}

/// Whether two places `off` apart contradict each other, by the sum of their covariances [xx, xy, yy], in m².
pub(crate) fn contradict(off: Point2, covariance_m2: [f64; 3]) -> bool {
    FixDensity::new(covariance_m2).square(off) > CONTRADICTION_SQUARE
}

/// A covariance that can be inverted: no variance below the least, no correlation where it would be perfect.
fn sound([xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    let (xx, yy) = (xx.max(MIN_VARIANCE_M2), yy.max(MIN_VARIANCE_M2));
    let is_sound = xy * xy < 0.999 * xx * yy;
    [xx, if is_sound { xy } else { 0.0 }, yy]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_by_hand() {
        let density = FixDensity::new([4.0, 0.0, 1.0]);
        // 0.8/(2π·2) + 0.2/(π·144) at the fix; two standard deviations off along either axis the first falls by exp(−2).
        let astray = 0.2 / (core::f64::consts::PI * 144.0);
        assert!((density.log_at(Point2::default()) - (0.063_662 + astray).ln()).abs() < 1e-5);
        let off = (0.063_662 * (-2.0f64).exp() + astray).ln();
        assert!((density.log_at(Point2::new(4.0, 0.0)) - off).abs() < 1e-4);
        assert!((density.log_at(Point2::new(0.0, -2.0)) - off).abs() < 1e-4);
        // Far off only the other part is left.
        assert!((density.log_at(Point2::new(300.0, 0.0)) - astray.ln()).abs() < 1e-9);
    }

    #[test]
    fn correlation_counts() {
        // Along the diagonal of [2, 1, 2] the variance is 3, across it 1.
        assert!(!contradict(Point2::new(3.5, 3.5), [2.0, 1.0, 2.0]));
        assert!(contradict(Point2::new(3.5, -3.5), [2.0, 1.0, 2.0]));
    }

    #[test]
    fn what_cannot_be_inverted_is_mended() {
        for covariance_m2 in [[0.0; 3], [1.0, 1.0, 1.0], [f64::NAN, 0.0, f64::NAN], [1.0, f64::NAN, 1.0]] {
            let density = FixDensity::new(covariance_m2);
            assert!(density.log_at(Point2::new(1.0, 0.5)).is_finite(), "{covariance_m2:?}");
        }
    }
}
