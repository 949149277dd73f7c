//! Points, headings and segments in the floor frame.
//!
//! The floor frame has x to the right and y up on the plan, in metres. A heading is in radians, clockwise from +y:
//! north on a north-up plan is 0, east is +π/2.

use core::f64::consts::{PI, TAU};
use core::ops::{Add, Mul, Sub};

use serde::{Deserialize, Serialize};

/// A point, or a displacement, in the floor frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point2 {
    /// Metres to the right on the plan.
    pub x_m: f64,
    /// Metres up on the plan.
    pub y_m: f64,
}

impl Point2 {
    /// The point `x_m` right of and `y_m` above the origin.
    pub const fn new(x_m: f64, y_m: f64) -> Self {
        Self { x_m, y_m }
    }

    /// Straight-line distance to `other`, in metres.
    pub fn distance_m(self, other: Self) -> f64 {
        (other - self).norm_m()
    }

    /// Length of the displacement, in metres.
    pub fn norm_m(self) -> f64 {
        (self.x_m * self.x_m + self.y_m * self.y_m).sqrt()
    }

    /// The displacement's direction, clockwise from +y, in (-π, π]; 0 for no displacement.
    pub fn heading_rad(self) -> f64 {
        libm::atan2(self.x_m, self.y_m)
    }

    /// The displacement of `length_m` along `heading_rad`.
    pub fn from_polar(length_m: f64, heading_rad: f64) -> Self {
        Self::new(length_m * libm::sin(heading_rad), length_m * libm::cos(heading_rad))
    }

    /// The point a fraction `s` of the way from `self` (0) to `other` (1).
    pub fn lerp(self, other: Self, s: f64) -> Self {
        self + (other - self) * s
    }

    /// The point turned clockwise about the origin by `angle_rad`.
    pub fn turned(self, angle_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(angle_rad);
        Self::new(self.x_m * cos + self.y_m * sin, self.y_m * cos - self.x_m * sin)
    }

    /// Whether both coordinates are finite.
    pub fn is_finite(self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite()
    }
}

impl Add for Point2 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x_m + other.x_m, self.y_m + other.y_m)
    }
}

impl Sub for Point2 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x_m - other.x_m, self.y_m - other.y_m)
    }
}

impl Mul<f64> for Point2 {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        Self::new(self.x_m * s, self.y_m * s)
    }
}

/// `angle_rad` wrapped into [-π, π); NaN stays NaN.
pub fn wrap_rad(angle_rad: f64) -> f64 {
    let turns = ((angle_rad + PI) / TAU).floor();
    angle_rad - turns * TAU
}

/// A straight line between two points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// One end.
    pub a: Point2,
    /// The other end.
    pub b: Point2,
}

impl Segment {
    /// Whether the two segments share a point, touching ends included.
    pub fn crosses(&self, other: &Segment) -> bool {
        fn side(a: Point2, b: Point2, p: Point2) -> f64 {
            (b.x_m - a.x_m) * (p.y_m - a.y_m) - (b.y_m - a.y_m) * (p.x_m - a.x_m)
        }
        let (p, q, r, s) = (self.a, self.b, other.a, other.b);
        let (d1, d2) = (side(p, q, r), side(p, q, s));
        let (d3, d4) = (side(r, s, p), side(r, s, q));
        if d1 == 0.0 && d2 == 0.0 {
            let overlap =
                |a0: f64, a1: f64, b0: f64, b1: f64| a0.min(a1) <= b0.max(b1) && b0.min(b1) <= a0.max(a1);
            return overlap(p.x_m, q.x_m, r.x_m, s.x_m) && overlap(p.y_m, q.y_m, r.y_m, s.y_m);
        }
        d1 * d2 <= 0.0 && d3 * d4 <= 0.0
    }

    /// The point of the segment nearest to `p`.
    pub fn nearest(&self, p: Point2) -> Point2 {
        let d = self.b - self.a;
        let length2 = d.x_m * d.x_m + d.y_m * d.y_m;
        if length2 == 0.0 {
            return self.a;
        }
        let s = ((p.x_m - self.a.x_m) * d.x_m + (p.y_m - self.a.y_m) * d.y_m) / length2;
        self.a + d * s.clamp(0.0, 1.0)
    }

    /// Distance from `p` to the nearest point of the segment, in metres.
    pub fn distance_m(&self, p: Point2) -> f64 {
        self.nearest(p).distance_m(p)
    }
}

/// Whether `p` lies inside the closed ring of `vertices` (even-odd rule; the closing vertex may be repeated).
pub fn ring_contains(vertices: &[Point2], p: Point2) -> bool {
    let mut inside = false;
    let Some(mut a) = vertices.last().copied() else { return false };
    for &b in vertices {
        if (a.y_m > p.y_m) != (b.y_m > p.y_m)
            && p.x_m < (b.x_m - a.x_m) * (p.y_m - a.y_m) / (b.y_m - a.y_m) + a.x_m
        {
            inside = !inside;
        }
        a = b;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_2;

    #[test]
    fn headings_turn_clockwise_from_plan_north() {
        assert_eq!(Point2::new(0.0, 2.0).heading_rad(), 0.0);
        assert_eq!(Point2::new(3.0, 0.0).heading_rad(), FRAC_PI_2);
        let east = Point2::new(0.0, 1.0).turned(FRAC_PI_2);
        assert!((east.x_m - 1.0).abs() < 1e-12 && east.y_m.abs() < 1e-12);
        let p = Point2::from_polar(2.0, 0.7);
        assert!((p.norm_m() - 2.0).abs() < 1e-12 && (p.heading_rad() - 0.7).abs() < 1e-12);
    }

    #[test]
    fn angles_wrap_into_one_turn() {
        assert!((wrap_rad(3.5 * PI) + 0.5 * PI).abs() < 1e-12);
        assert_eq!(wrap_rad(PI), -PI);
        assert!(wrap_rad(f64::NAN).is_nan());
    }

    #[test]
    fn segments_cross_touch_and_miss() {
        let s = |x0, y0, x1, y1| Segment { a: Point2::new(x0, y0), b: Point2::new(x1, y1) };
        assert!(s(0.0, 0.0, 2.0, 2.0).crosses(&s(0.0, 2.0, 2.0, 0.0)));
        assert!(s(0.0, 0.0, 2.0, 0.0).crosses(&s(1.0, 0.0, 1.0, 5.0)));
        assert!(s(0.0, 0.0, 2.0, 0.0).crosses(&s(1.0, 0.0, 3.0, 0.0)));
        assert!(!s(0.0, 0.0, 1.0, 0.0).crosses(&s(2.0, 0.0, 3.0, 0.0)));
        assert!(!s(0.0, 0.0, 1.0, 1.0).crosses(&s(2.0, 0.0, 1.5, 5.0)));
        assert_eq!(s(0.0, 0.0, 4.0, 0.0).distance_m(Point2::new(7.0, 4.0)), 5.0);
    }

    #[test]
    fn a_ring_contains_its_inside_only() {
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Point2::new(x, y));
        assert!(ring_contains(&square, Point2::new(1.0, 1.0)));
        assert!(!ring_contains(&square, Point2::new(3.0, 1.0)));
        assert!(!ring_contains(&[], Point2::new(0.0, 0.0)));
    }
}
