//! Rotations of three-dimensional space as unit quaternions, with square roots and arithmetic alone.

use serde::{Deserialize, Serialize};

/// A unit quaternion `[w, x, y, z]`; `a_from_b` takes the coordinates of a vector in frame b to those in frame a.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion(pub [f64; 4]);

impl Quaternion {
    /// The rotation that changes nothing.
    pub const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0]);

    /// The rotation whose matrix has the rows `x`, `y` and `z`: the axes of frame a, in the coordinates of frame b.
    pub fn from_rows(x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> Self {
        quaternion_of_rows(x, y, z)
    }

    /// The rotation clockwise about z, seen from above, by `heading_rad`: it takes +y to that heading.
    pub fn from_heading(heading_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(-0.5 * heading_rad);
        Self([cos, 0.0, 0.0, sin])
    }

    /// The rotation that takes the direction `up` (of unit length, device frame) to z and keeps the device's y axis
    /// (its -z where y is nearly vertical) towards y.
    pub fn upright(up: [f64; 3]) -> Self {
        let top = if up[1].abs() < 0.85 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] };
        let right = normalised(cross(top, up));
        let forward = cross(up, right);
        // Rows of the rotation matrix: the level axes in the device frame.
        Self::from_rows(right, forward, up)
    }

    /// `v` of frame b, in frame a.
    pub fn rotate(self, v: [f64; 3]) -> [f64; 3] {
        let Self(q) = self;
        let u = [q[1], q[2], q[3]];
        let t = cross(u, v).map(|c| 2.0 * c);
        let s = cross(u, t);
        [0, 1, 2].map(|c| v[c] + q[0] * t[c] + s[c])
    }

    /// `v` of frame a, in frame b.
    pub fn rotate_back(self, v: [f64; 3]) -> [f64; 3] {
        self.inverse().rotate(v)
    }

    /// The opposite rotation: `b_from_a` of `a_from_b`.
    #[must_use]
    pub fn inverse(self) -> Self {
        let Self(q) = self;
        Self([q[0], -q[1], -q[2], -q[3]])
    }

    /// `self` after `first`: `a_from_b.after(b_from_c)` is `a_from_c`, not renormalised.
    #[must_use]
    pub fn after(self, first: Self) -> Self {
        let (Self(q), Self(r)) = (self, first);
        Self([
            q[0] * r[0] - q[1] * r[1] - q[2] * r[2] - q[3] * r[3],
            q[0] * r[1] + q[1] * r[0] + q[2] * r[3] - q[3] * r[2],
            q[0] * r[2] - q[1] * r[3] + q[2] * r[0] + q[3] * r[1],
            q[0] * r[3] + q[1] * r[2] - q[2] * r[1] + q[3] * r[0],
        ])
    }

    /// The rotation after frame b has turned by `angle_rad` about its own axes: renormalised, unchanged if that fails.
    #[must_use]
    pub fn turned(self, angle_rad: [f64; 3]) -> Self {
        self.after(small(angle_rad)).renormalised().unwrap_or(self)
    }

    /// The rotation after what it rotates has turned by `angle_rad` about the axes of frame a: renormalised, unchanged
    /// if that fails.
    #[must_use]
    pub fn turned_outside(self, angle_rad: [f64; 3]) -> Self {
        small(angle_rad).after(self).renormalised().unwrap_or(self)
    }

    /// The heading part of the rotation, clockwise about z, in (-π, π]: what is left when the tilt is undone by the
    /// shortest way (swing-twist decomposition). Undefined, and 0, for a half turn about a horizontal axis.
    pub fn heading_part_rad(self) -> f64 {
        let Self(q) = self;
        // The twist about z is (w, z); of ±q, the same rotation, take the one with w ≥ 0.
        let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
        -2.0 * libm::atan2(sign * q[3], sign * q[0])
    }

    /// The same rotation at exactly unit length; nothing when a number is not finite or the length is far from 1.
    pub fn renormalised(self) -> Option<Self> {
        let norm = self.0.iter().map(|c| c * c).sum::<f64>().sqrt();
        (norm > 0.5 && norm.is_finite()).then(|| Self(self.0.map(|c| c / norm)))
    }
}

/// The rotation by `angle_rad` about an axis: cos x ≈ 1 − x²/2 + x⁴/24 and sin x / x ≈ 1 − x²/6 + x⁴/120 are exact
/// to 1e-8 at half of half a radian.
fn small(angle_rad: [f64; 3]) -> Quaternion {
    let half = angle_rad.map(|c| 0.5 * c);
    let square = half[0] * half[0] + half[1] * half[1] + half[2] * half[2];
    let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0));
    let sinc = 1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0));
    Quaternion([cos, half[0] * sinc, half[1] * sinc, half[2] * sinc])
}

#[expect(clippy::disallowed_types, reason = "this constructor needs square roots alone")]
fn quaternion_of_rows(x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> Quaternion {
    use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
    let rotation = Matrix3::new(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    Quaternion([q.w, q.i, q.j, q.k])
}

/// The vector product.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length of a vector.
pub fn norm(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

fn normalised(v: [f64; 3]) -> [f64; 3] {
    let norm = norm(v);
    v.map(|c| c / norm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};
    use proptest::prelude::*;

    fn assert_close(a: [f64; 3], b: [f64; 3]) {
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-9), "{a:?} {b:?}");
    }

    #[test]
    fn a_heading_of_a_quarter_turn_takes_north_to_east() {
        let east = Quaternion::from_heading(FRAC_PI_2);
        assert_close(east.rotate([0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_close(east.rotate_back([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
        assert!((east.heading_part_rad() - FRAC_PI_2).abs() < 1e-12);
        // The other sign of the same rotation.
        assert!((Quaternion(east.0.map(|c| -c)).heading_part_rad() - FRAC_PI_2).abs() < 1e-12);
        assert!((east.after(east).heading_part_rad().abs() - PI).abs() < 1e-12);
    }

    #[test]
    fn rows_are_the_axes() {
        // A device on its left side: its x points up, its y north.
        let q = Quaternion::from_rows([0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        assert_close(q.rotate([1.0, 0.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_close(q.rotate([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn small_turns_add_up_inside_and_outside() {
        let (mut inside, mut outside) = (Quaternion::IDENTITY, Quaternion::IDENTITY);
        for _ in 0..1_000 {
            inside = inside.turned([0.0, 0.0, -0.001]);
            outside = outside.turned_outside([0.0, 0.0, -0.001]);
        }
        assert!((inside.heading_part_rad() - 1.0).abs() < 1e-9);
        assert!((outside.heading_part_rad() - 1.0).abs() < 1e-9);
        assert_eq!(inside.turned([f64::NAN; 3]), inside);
    }

    proptest! {
        #[test]
        fn tilting_by_the_shortest_way_leaves_the_heading(
            heading in -3.0f64..3.0, x in -1.0f64..1.0, y in -1.0f64..1.0,
        ) {
            let turned = Quaternion::from_heading(heading);
            let tilted = turned.turned_outside([x, y, 0.0]);
            prop_assert!((tilted.heading_part_rad() - heading).abs() < 1e-6);
        }

        #[test]
        fn rotating_there_and_back_changes_nothing(v in prop::array::uniform3(-9.0f64..9.0), heading in -3.0f64..3.0) {
            let q = Quaternion::from_heading(heading).turned([0.3, -0.7, 0.1]);
            let back = q.rotate_back(q.rotate(v));
            prop_assert!((0..3).all(|c| (back[c] - v[c]).abs() < 1e-9));
            prop_assert!((norm(q.rotate(v)) - norm(v)).abs() < 1e-9);
        }
    }
}
