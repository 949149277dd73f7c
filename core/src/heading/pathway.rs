//! The pathway motion model: people walk along the ways, whatever their compass says.

mod grid;

pub use grid::WayGrid;

use serde::{Deserialize, Serialize};

use crate::floor_plan::FloorPlan;
use crate::geometry::{Point2, Segment, wrap_rad};
use crate::map::FloorMap;

/// Ways are as near as the nearest one within this distance, in metres: the pieces that meet at a corner, and parallel
/// lines of one corridor.
const CORNER_M: f64 = 0.5;

/// Parameters of [`pathway_heading_rad`].
///
/// # Source
/// Kwak 2018, Alg. 1: shares of 40, 40 and 20 %, and 90°. `reach_m` is ours: the paper's ways are corridors whose
/// cells are known to belong to them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathwayParams {
    /// Share of the particles that take the direction of their pathway closest to the raw heading; default 0.4.
    pub by_compass: f32,
    /// Share that takes the direction of their pathway closest to their own last heading; default 0.4. The rest takes
    /// the raw heading.
    pub by_last_heading: f32,
    /// A direction of the pathway that differs by this or more is not taken, in radians; default π/2.
    pub max_turn_rad: f64,
    /// A particle farther from any pathway than this is on none, in metres; default 3.
    pub reach_m: f64,
}

impl Default for PathwayParams {
    fn default() -> Self {
        Self {
            by_compass: 0.4,
            by_last_heading: 0.4,
            max_turn_rad: core::f64::consts::FRAC_PI_2,
            reach_m: 3.0,
        }
    }
}

/// The ways of a floor as straight pieces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pathways {
    segments: Vec<Segment>,
}

impl Pathways {
    /// The plan's pathways where it has any, else the lines that the survey walked.
    pub fn of_map(map: &FloorMap) -> Self {
        let drawn = Self::of_plan(&map.plan);
        if drawn.segments.is_empty() { Self::of_lines(&map.routes) } else { drawn }
    }

    /// The plan's pathways.
    pub fn of_plan(plan: &FloorPlan) -> Self {
        Self::of_lines(&plan.pathways)
    }

    /// Polylines; pieces without length are left out.
    pub fn of_lines(lines: &[Vec<Point2>]) -> Self {
        let pieces = lines.iter().flat_map(|line| line.windows(2));
        let pieces = pieces.filter_map(|pair| match pair {
            &[a, b] if a.is_finite() && b.is_finite() && a.distance_m(b) > 1e-6 => Some(Segment { a, b }),
            _ => None,
        });
        Self { segments: pieces.collect() }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// The direction, of all pieces within `reach_m` of the nearest one's distance of `place`, closest to
    /// `heading_rad`; a piece can be walked both ways. Nothing where no piece is within `reach_m`.
    ///
    /// At a crossing several pieces are as near, and each offers its two directions.
    pub fn closest_direction_rad(&self, place: Point2, heading_rad: f64, reach_m: f64) -> Option<f64> {
        let nearest_m = self.segments.iter().map(|s| s.distance_m(place)).fold(f64::INFINITY, f64::min);
        if nearest_m.is_nan() || nearest_m > reach_m {
            return None;
        }
        let here = self.segments.iter().filter(|s| s.distance_m(place) <= nearest_m + CORNER_M);
        let directions = here.flat_map(|s| [(s.b - s.a).heading_rad(), (s.a - s.b).heading_rad()]);
        let turn = |direction: f64| wrap_rad(direction - heading_rad).abs();
        directions.fold(None, |best: Option<f64>, d| match best {
            Some(b) if turn(b) <= turn(d) => best,
            _ => Some(d),
        })
    }
}

/// The heading that a particle takes: along its pathway, or raw.
///
/// `share` in [0, 1) is the particle's draw; `raw_rad` the device's heading, `last_rad` the particle's own at its last
/// move, both clockwise from the plan's y. The heading is raw when the pathway differs by
/// [`max_turn_rad`](PathwayParams::max_turn_rad) or more, and on no pathway.
///
/// # Source
/// Kwak 2018, Alg. 1. A pathway can be walked both ways, so one of its directions is always within 90° of any
/// heading and the paper's fallback never fires; it is here for one-way ways and smaller angles.
pub fn pathway_heading_rad(
    params: &PathwayParams,
    pathways: &Pathways,
    place: Point2,
    raw_rad: f64,
    last_rad: f64,
    share: f32,
) -> f64 {
    let wanted_rad = if share < params.by_compass {
        raw_rad
    } else if share < params.by_compass + params.by_last_heading {
        last_rad
    } else {
        return raw_rad;
    };
    pathways
        .closest_direction_rad(place, wanted_rad, params.reach_m)
        .filter(|&direction| wrap_rad(direction - wanted_rad).abs() < params.max_turn_rad)
        .unwrap_or(raw_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};
    use proptest::prelude::*;

    /// A corridor along x and one along y that meet at (10, 0).
    fn corner() -> Pathways {
        let line = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)].map(|(x, y)| Point2::new(x, y));
        Pathways::of_lines(&[line.to_vec()])
    }

    fn heading(place: (f64, f64), raw_rad: f64, last_rad: f64, share: f32) -> f64 {
        let place = Point2::new(place.0, place.1);
        pathway_heading_rad(&PathwayParams::default(), &corner(), place, raw_rad, last_rad, share)
    }

    #[test]
    fn kwak_algorithm_1_by_hand() {
        // In the corridor along x: the compass says 50°, the last heading was west.
        let (raw, last) = (50f64.to_radians(), -FRAC_PI_2);
        assert!((heading((5.0, 0.4), raw, last, 0.0) - FRAC_PI_2).abs() < 1e-12);
        assert!((heading((5.0, 0.4), raw, last, 0.39) - FRAC_PI_2).abs() < 1e-12);
        assert!((heading((5.0, 0.4), raw, last, 0.41) + FRAC_PI_2).abs() < 1e-12);
        assert_eq!(heading((5.0, 0.4), raw, last, 0.81), raw);
        // At the corner the way north is closer to 20° than the way east.
        assert!(heading((10.0, 0.0), 20f64.to_radians(), last, 0.1).abs() < 1e-12);
        // Far from any way nothing is known.
        assert_eq!(heading((30.0, 30.0), raw, last, 0.1), raw);
    }

    #[test]
    fn a_smaller_limit_falls_back_to_the_raw_heading() {
        let params = PathwayParams { max_turn_rad: 0.5, ..PathwayParams::default() };
        let place = Point2::new(5.0, 0.0);
        let raw = 50f64.to_radians();
        assert_eq!(pathway_heading_rad(&params, &corner(), place, raw, 0.0, 0.0), raw);
    }

    #[test]
    fn the_plan_comes_before_the_surveyed_lines() {
        let line = |x: f64| vec![Point2::new(x, 0.0), Point2::new(x, 9.0), Point2::new(x, 9.0)];
        let mut map = FloorMap { routes: vec![line(1.0)], ..FloorMap::default() };
        assert_eq!(Pathways::of_map(&map), Pathways::of_lines(&[line(1.0)]));
        map.plan.pathways = vec![line(2.0)];
        assert_eq!(Pathways::of_map(&map).segments.len(), 1);
        assert_eq!(Pathways::of_map(&map), Pathways::of_lines(&[line(2.0)]));
        assert!(Pathways::of_map(&FloorMap::default()).is_empty());
    }

    #[test]
    fn a_distorted_compass_is_straightened() {
        // Kwak 2018 reports 84 % of headings right over 11 turns with a distorted compass. Eleven turns round a block,
        // the compass off by 35° and back: the share of particles along the true way.
        let square = [(0.0, 0.0), (0.0, 20.0), (20.0, 20.0), (20.0, 0.0), (0.0, 0.0)];
        let ways = Pathways::of_lines(&[square.map(|(x, y)| Point2::new(x, y)).to_vec()]);
        let params = PathwayParams::default();
        let (mut n_right, mut n) = (0, 0);
        for leg in 0..12 {
            let true_rad = wrap_rad(FRAC_PI_2 * f64::from(leg));
            let (from, to) = (square[leg as usize % 4], square[leg as usize % 4 + 1]);
            let (from, to) = (Point2::new(from.0, from.1), Point2::new(to.0, to.1));
            for step in 1..30 {
                let place = from.lerp(to, f64::from(step) / 30.0);
                let raw_rad = true_rad + 35f64.to_radians() * libm::sin(0.9 * f64::from(step + 7 * leg));
                for particle in 0..100 {
                    let share = (particle as f32 + 0.5) / 100.0;
                    let taken = pathway_heading_rad(&params, &ways, place, raw_rad, true_rad, share);
                    n += 1;
                    n_right += i32::from(wrap_rad(taken - true_rad).abs() < 5f64.to_radians());
                }
            }
        }
        let share = f64::from(n_right) / f64::from(n);
        assert!(share > 0.8, "{share}");
    }

    proptest! {
        #[test]
        fn a_direction_is_one_of_the_way_s(heading in -PI..PI, x in 0.0f64..8.0) {
            let found = corner().closest_direction_rad(Point2::new(x, 1.0), heading, 3.0).unwrap();
            prop_assert!((found.abs() - FRAC_PI_2).abs() < 1e-12);
            prop_assert!(wrap_rad(found - heading).abs() <= FRAC_PI_2 + 1e-12);
            prop_assert_eq!(corner().closest_direction_rad(Point2::new(x, f64::NAN), heading, 3.0), None);
        }
    }
}
