//! What the surveyed lines say of how people walk: which way at a place, and how far from any line.

use crate::geometry::Segment;
use crate::map::{FloorMap, GridFrame};

/// A line counts for the direction at a place up to this distance, in metres.
const REACH_M: f64 = 2.0;
/// Lines that a place must have beside its own for its direction to be believed half.
const PRIOR_LINES: f64 = 0.5;
/// The band is never narrower than this, in metres: how far one walks beside a line and still along it.
const MIN_BAND_M: f64 = 0.5;
/// Share of surveyed lines that have another within the band.
const BAND_SHARE: f64 = 0.95;

/// The surveyed lines, summed up.
#[derive(Clone, Debug, Default)]
pub(super) struct SurveyedWays {
    /// Per node: cosine and sine of twice the lines' direction and 1, all times how much the lines agree, 0 to 1.
    directions: Vec<[f32; 3]>,
    band_m: f32,
}

impl SurveyedWays {
    /// The ways of `map`, from its routes.
    pub fn of(map: &FloorMap) -> Self {
        let lines: Vec<(usize, Segment)> = map
            .routes
            .iter()
            .enumerate()
            .flat_map(|(route, points)| points.windows(2).map(move |w| (route, Segment { a: w[0], b: w[1] })))
            .filter(|(_, line)| line.a.is_finite() && line.b.is_finite())
            .collect();
        Self { directions: directions(&map.frame, &lines), band_m: band_m(&lines) }
    }

    /// The distance within which nearly all surveyed lines have another, in metres; infinite for fewer than two routes.
    pub fn band_m(&self) -> f32 {
        self.band_m
    }

    /// How far a direction lies across the lines at `node`: 0 along them, or where they do not agree, to 1 right across
    /// lines that all run one way.
    #[inline]
    pub fn across(&self, node: usize, sin: f32, cos: f32) -> f32 {
        let Some(&[cos_twice, sin_twice, agreement]) = self.directions.get(node) else { return 0.0 };
        0.5 * (agreement - cos_twice * (cos * cos - sin * sin) - sin_twice * (2.0 * sin * cos))
    }
}

/// Directions summed with their angles doubled, so that there and back are one.
///
/// The length of the mean, 0 to 1, to the fourth power is how much lines agree: few lines, a bend or a crossing count
/// little.
fn directions(frame: &GridFrame, lines: &[(usize, Segment)]) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0f64; 3]; frame.len()];
    for (_, line) in lines {
        let along = line.b - line.a;
        let square_m2 = along.x_m * along.x_m + along.y_m * along.y_m;
        if square_m2 <= 0.0 {
            continue;
        }
        let cos_twice = (along.y_m * along.y_m - along.x_m * along.x_m) / square_m2;
        let sin_twice = 2.0 * along.x_m * along.y_m / square_m2;
        for (node, place) in frame.nodes_near(line, REACH_M) {
            let apart = (line.distance_m(place) / REACH_M).min(1.0);
            let weight = (1.0 - apart * apart) * (1.0 - apart * apart);
            for (sum, part) in sums[node].iter_mut().zip([cos_twice, sin_twice, 1.0]) {
                *sum += weight * part;
            }
        }
    }
    let summed_up = |[cos_twice, sin_twice, weight]: [f64; 3]| {
        let (x, y) = (cos_twice / (weight + PRIOR_LINES), sin_twice / (weight + PRIOR_LINES));
        let square = x * x + y * y;
        let length = square.sqrt();
        // The mean's own length is in x and y once.
        [x * square * length, y * square * length, square * square].map(|c| c as f32)
    };
    sums.into_iter().map(summed_up).collect()
}

/// The distance from the middle of a line to the nearest line of another route that nearly all keep within.
fn band_m(lines: &[(usize, Segment)]) -> f32 {
    let mut distances_m: Vec<f64> = lines
        .iter()
        .map(|(route, line)| {
            let middle = line.a.lerp(line.b, 0.5);
            let others = lines.iter().filter(|(other, _)| other != route);
            others.map(|(_, other)| other.distance_m(middle)).fold(f64::INFINITY, f64::min)
        })
        .collect();
    distances_m.sort_by(f64::total_cmp);
    let rank = (BAND_SHARE * distances_m.len() as f64) as usize;
    let band_m = distances_m.get(rank.min(distances_m.len().saturating_sub(1))).copied();
    band_m.unwrap_or(f64::INFINITY).max(MIN_BAND_M) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point2;

    fn ways(routes: &[&[[f64; 2]]]) -> (SurveyedWays, GridFrame) {
        let frame = GridFrame::covering(20.0, 10.0, 1.0);
        let points = |route: &&[[f64; 2]]| route.iter().map(|p| Point2::new(p[0], p[1])).collect();
        let map = FloorMap { frame, routes: routes.iter().map(points).collect(), ..FloorMap::default() };
        (SurveyedWays::of(&map), frame)
    }

    #[test]
    fn one_way_is_across_to_the_other() {
        // Three walks east and west along y = 5.
        let (east, west): (&[_], &[_]) = (&[[0.0, 5.0], [20.0, 5.0]], &[[20.0, 5.0], [0.0, 5.0]]);
        let (ways, frame) = ways(&[east, west, east]);
        let node = 5 * frame.nx + 10;
        // Weight 3 and half a line of prior: (3/3.5)^4 = 0.5398.
        let agreement = 0.539_77;
        assert!((ways.across(node, 0.0, 1.0) - agreement).abs() < 1e-4, "north");
        assert!(ways.across(node, 1.0, 0.0).abs() < 1e-6 && ways.across(node, -1.0, 0.0).abs() < 1e-6);
        let sin = core::f32::consts::FRAC_1_SQRT_2;
        assert!((ways.across(node, sin, sin) - 0.5 * agreement).abs() < 1e-4, "north-east");
        // Three metres off no line says anything, nor does any node that there is not.
        assert_eq!(
            (ways.across(node + 3 * frame.nx, 0.0, 1.0), ways.across(1_000_000, 0.0, 1.0)),
            (0.0, 0.0)
        );
    }

    #[test]
    fn where_ways_cross_any_is_along() {
        let (ways, frame) = ways(&[&[[0.0, 5.0], [20.0, 5.0]], &[[10.0, 0.0], [10.0, 10.0]]]);
        for (sin, cos) in [(0.0, 1.0), (1.0, 0.0), (0.6, 0.8)] {
            assert!(ways.across(5 * frame.nx + 10, sin, cos).abs() < 1e-6);
        }
    }

    #[test]
    fn the_band_is_where_other_lines_are() {
        let twice: &[[f64; 2]] = &[[0.0, 5.0], [20.0, 5.0]];
        assert_eq!(ways(&[twice, twice]).0.band_m(), 0.5);
        assert_eq!(ways(&[twice, &[[0.0, 8.0], [20.0, 8.0]]]).0.band_m(), 3.0);
        assert_eq!(ways(&[twice]).0.band_m(), f32::INFINITY);
        assert_eq!(ways(&[]).0.band_m(), f32::INFINITY);
        assert_eq!(ways(&[&[[f64::NAN, 0.0], [1.0, 1.0]]]).0.band_m(), f32::INFINITY);
    }
}
