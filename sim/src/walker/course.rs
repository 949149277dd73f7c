//! A polyline as a body walks it: corners rounded, the heading turning through them.

use std::f64::consts::PI;

use fieldwalk::geometry::{Point2, wrap_rad};

/// Half the length over which a corner is rounded, in metres, at most.
const ROUNDING_M: f64 = 0.8;
/// And at most this share of the stretches before and after it.
const ROUNDING_SHARE: f64 = 0.45;
/// Half the length of path over which a walker turns back, in metres.
const TURNING_BACK_M: f64 = 0.35;

/// A smooth path along a polyline: the polyline averaged over a raised cosine around each corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    start: Point2,
    start_along: Point2,
    start_heading_rad: f64,
    corners: Vec<Corner>,
    length_m: f64,
    /// Places along the polyline and the floor's height at each, in metres; between them the height is linear.
    heights_m: Vec<(f64, f64)>,
}

/// A flight of stairs on a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Where it begins, in metres along the course.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
    /// How far it leads up, in metres; down where negative.
    pub rise_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    at_m: f64,
    half_m: f64,
    /// Change of the direction of unit length.
    change: Point2,
    turn_rad: f64,
}

impl Course {
    /// The course along `points` on the ground floor; points that repeat count once.
    pub fn new(points: &[Point2]) -> Self {
        Self::with_heights(points, &[])
    }

    /// The course along `points`, the floor at each as high as `heights_m` says, in metres; where there are fewer
    /// heights the last holds on, and none means 0. A stretch whose ends differ in height is a flight of stairs.
    pub fn with_heights(points: &[Point2], heights_m: &[f64]) -> Self {
        let mut line: Vec<Point2> = Vec::with_capacity(points.len());
        let mut heights: Vec<f64> = Vec::with_capacity(points.len());
        for (k, &point) in points.iter().enumerate() {
            if line.last().is_none_or(|last| last.distance_m(point) > 1e-6) {
                line.push(point);
                heights.push(heights_m.get(k).or(heights_m.last()).copied().unwrap_or(0.0));
            }
        }
        let start = line.first().copied().unwrap_or_default();
        let stretches: Vec<(Point2, f64)> = line
            .windows(2)
            .map(|pair| {
                let length_m = pair[0].distance_m(pair[1]);
                ((pair[1] - pair[0]) * (1.0 / length_m), length_m)
            })
            .collect();
        let mut along_m = 0.0;
        let ends_m = [0.0].into_iter().chain(stretches.iter().map(|stretch| {
            along_m += stretch.1;
            along_m
        }));
        let heights_m = ends_m.zip(heights).collect();
        let mut at_m = 0.0;
        let corners = stretches
            .windows(2)
            .map(|pair| {
                let ((before, before_m), (after, after_m)) = (pair[0], pair[1]);
                at_m += before_m;
                let turn_rad = wrap_rad(after.heading_rad() - before.heading_rad());
                let widest_m = if turn_rad.abs() > 2.6 { TURNING_BACK_M } else { ROUNDING_M };
                let half_m = widest_m.min(ROUNDING_SHARE * before_m.min(after_m));
                Corner { at_m, half_m, change: after - before, turn_rad }
            })
            .collect();
        let start_along = stretches.first().map_or(Point2::new(0.0, 1.0), |stretch| stretch.0);
        Self {
            start,
            start_along,
            start_heading_rad: start_along.heading_rad(),
            corners,
            length_m: stretches.iter().map(|stretch| stretch.1).sum(),
            heights_m,
        }
    }

    /// Height of the floor or of the stairs' slope `at_m` along, in metres over the ground floor.
    pub fn height_m(&self, at_m: f64) -> f64 {
        let k = self.heights_m.partition_point(|(place_m, _)| *place_m <= at_m);
        match (k.checked_sub(1).and_then(|k| self.heights_m.get(k)), self.heights_m.get(k)) {
            (Some((from_m, low_m)), Some((to_m, high_m))) => {
                low_m + (high_m - low_m) * (at_m - from_m) / (to_m - from_m)
            }
            (Some((_, height_m)), None) | (None, Some((_, height_m))) => *height_m,
            (None, None) => 0.0,
        }
    }

    /// The flights of stairs on the way, in order.
    pub fn flights(&self) -> impl Iterator<Item = Flight> {
        self.heights_m.windows(2).filter(|pair| (pair[1].1 - pair[0].1).abs() > 1e-6).map(|pair| Flight {
            from_m: pair[0].0,
            to_m: pair[1].0,
            rise_m: pair[1].1 - pair[0].1,
        })
    }

    /// Length of the polyline, in metres; the course itself cuts the corners a little.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// The place `at_m` along the polyline.
    pub fn position(&self, at_m: f64) -> Point2 {
        let straight = self.start + self.start_along * at_m;
        self.corners.iter().fold(straight, |p, corner| p + corner.change * corner.bent_m(at_m))
    }

    /// Heading of the body `at_m` along, in radians, unwrapped.
    pub fn heading_rad(&self, at_m: f64) -> f64 {
        self.corners
            .iter()
            .fold(self.start_heading_rad, |sum, corner| sum + corner.turn_rad * corner.passed(at_m))
    }

    /// The fastest turn between `from_m` and `to_m` along, in radians per metre.
    pub fn sharpest_rad_m(&self, from_m: f64, to_m: f64) -> f64 {
        self.corners
            .iter()
            .map(|corner| {
                let apart_m = corner.at_m - corner.at_m.clamp(from_m, to_m);
                if apart_m.abs() < corner.half_m {
                    let share = 0.5 * (1.0 + libm::cos(PI * apart_m / corner.half_m));
                    corner.turn_rad.abs() / corner.half_m * share
                } else {
                    0.0
                }
            })
            .fold(0.0, f64::max)
    }
}

impl Corner {
    /// The share of the turn that is done: the raised cosine's integral.
    fn passed(&self, at_m: f64) -> f64 {
        let x = (at_m - self.at_m) / self.half_m;
        if x.abs() >= 1.0 {
            return if x > 0.0 { 1.0 } else { 0.0 };
        }
        0.5 * (1.0 + x) + libm::sin(PI * x) / (2.0 * PI)
    }

    /// That share's integral: metres walked in the new direction.
    fn bent_m(&self, at_m: f64) -> f64 {
        let after_m = at_m - self.at_m;
        let x = after_m / self.half_m;
        if x >= 1.0 {
            after_m
        } else if x <= -1.0 {
            0.0
        } else {
            let bent = 0.5 * (x + 1.0) + 0.25 * (x * x - 1.0) - (libm::cos(PI * x) + 1.0) / (2.0 * PI * PI);
            self.half_m * bent
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_corner_is_rounded_and_the_rest_is_straight() {
        let corner = [Point2::new(0.0, 0.0), Point2::new(0.0, 10.0), Point2::new(6.0, 10.0)];
        let course = Course::new(&corner);
        assert_eq!(course.length_m(), 16.0);
        assert_eq!(course.position(5.0), Point2::new(0.0, 5.0));
        assert!(course.position(16.0).distance_m(corner[2]) < 1e-9);
        let cut_m = course.position(10.0).distance_m(corner[1]);
        assert!((0.1..0.25).contains(&cut_m), "{cut_m}");
        assert_eq!(course.heading_rad(5.0), 0.0);
        assert!((course.heading_rad(12.0) - FRAC_PI_2).abs() < 1e-12);
        assert!((course.heading_rad(10.0) - 0.5 * FRAC_PI_2).abs() < 1e-12);
        // The body looks where it goes.
        let ahead = course.position(10.31) - course.position(10.29);
        assert!((ahead.heading_rad() - course.heading_rad(10.3)).abs() < 0.15);
        let h = 1e-5;
        let rate = (course.heading_rad(10.0 + h) - course.heading_rad(10.0 - h)) / (2.0 * h);
        assert!((rate - course.sharpest_rad_m(9.0, 11.0)).abs() < 1e-3);
    }

    #[test]
    fn turning_back_is_a_turn_of_half_a_circle() {
        let there_and_back = [Point2::new(0.0, 0.0), Point2::new(8.0, 0.0), Point2::new(1.0, 0.0)];
        let course = Course::new(&there_and_back);
        let turned_rad = course.heading_rad(15.0) - course.heading_rad(0.0);
        assert!((turned_rad.abs() - PI).abs() < 1e-9);
        assert!(course.position(15.0).distance_m(there_and_back[2]) < 1e-9);
    }
}
