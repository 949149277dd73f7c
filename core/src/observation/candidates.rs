//! The map's points whose field is most like the measured one, within a search radius.

use serde::{Deserialize, Serialize};

use crate::map::FloorIndex;
use crate::observation::strength::{SURVEYED_M, StrengthParams};

/// Parameters of the candidates; their number `k` is the recipe's number of particles.
///
/// # Source
/// Song 2014, §3. The first search is as wide as the hint says (5 m in the paper); radius and reach after that are ours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateParams {
    /// The weight of a candidate's strength.
    pub strength: StrengthParams,
    /// Points are looked for within this distance of where a step from a candidate of the last round leads, in metres;
    /// without a reach, of where the steps from the start lead.
    pub radius_m: f32,
    /// The prior of reaching a point from a candidate of the last round is a normal density of the distance by which the
    /// step misses it, with this standard deviation, in metres. Without, every point within the radius is as likely, and
    /// the best candidate is the nearest neighbour.
    pub reach_sd_m: Option<f32>,
}

/// Where points are looked for, when not about the last candidates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SearchArea {
    /// Its centre, in metres.
    pub centre_m: [f32; 2],
    /// Its radius, in metres.
    pub radius_m: f32,
}

impl SearchArea {
    /// Everywhere on the floor.
    pub const EVERYWHERE: Self = Self { centre_m: [0.0; 2], radius_m: 1e6 };
}

/// A point of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Where, in metres.
    pub place_m: [f32; 2],
    /// How far its strength is from the measured one, in µT.
    pub off_ut: f32,
    node: usize,
}

/// The `k` points found so far, the nearest in strength first; allocates nothing once it is made.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    found: Vec<Candidate>,
    k: usize,
}

impl Candidates {
    /// Room for `k` points.
    pub fn with_capacity(k: usize) -> Self {
        Self { found: Vec::with_capacity(k), k }
    }

    /// The points found, the nearest in strength first; of equals the one of the lower node.
    pub fn found(&self) -> &[Candidate] {
        &self.found
    }

    /// Forgets the points found.
    pub fn clear(&mut self) {
        self.found.clear();
    }

    /// Looks through the surveyed points of `floor` within `area` for strengths near `observed_ut`.
    pub fn search(&mut self, floor: &FloorIndex, area: SearchArea, observed_ut: f32) {
        let (frame, layers) = (floor.map().frame, &floor.map().layers);
        let radius_m = f64::from(area.radius_m);
        let [x_m, y_m] = area.centre_m.map(f64::from);
        let span = |centre_m: f64, origin_m: f64, n: usize| {
            let first = ((centre_m - radius_m - origin_m) / frame.cell_m).ceil().max(0.0);
            let end = ((centre_m + radius_m - origin_m) / frame.cell_m).floor() + 1.0;
            first as usize..(end.max(0.0) as usize).min(n)
        };
        if !(x_m.is_finite() && y_m.is_finite() && observed_ut.is_finite()) {
            return;
        }
        for j in span(y_m, frame.origin.y_m, frame.ny) {
            for i in span(x_m, frame.origin.x_m, frame.nx) {
                let node = j * frame.nx + i;
                let Some(off_ut) = layers.strength_ut.get(node).map(|ut| (ut - observed_ut).abs()) else {
                    continue;
                };
                let is_surveyed = layers.route_distance_m.get(node).is_none_or(|&m| m <= SURVEYED_M);
                let place = frame.node(i, j);
                let (dx_m, dy_m) = (place.x_m - x_m, place.y_m - y_m);
                if is_surveyed && !off_ut.is_nan() && dx_m * dx_m + dy_m * dy_m <= radius_m * radius_m {
                    self.keep(Candidate { place_m: [place.x_m as f32, place.y_m as f32], off_ut, node });
                }
            }
        }
    }

    fn keep(&mut self, candidate: Candidate) {
        let order = |of: &Candidate| (of.off_ut, of.node);
        let at = self.found.partition_point(|found| order(found) < order(&candidate));
        if at >= self.k || self.found.get(at).is_some_and(|found| found.node == candidate.node) {
            return;
        }
        if self.found.len() == self.k {
            self.found.pop();
        }
        self.found.insert(at, candidate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorMap, GridFrame, Layers};
    use proptest::prelude::*;

    /// 20 × 10 m of points a metre apart; the field by `strength_ut` of x and y, surveyed up to y = 8.
    fn floor(strength_ut: impl Fn(f64, f64) -> f32) -> FloorIndex {
        let plan = FloorPlan { width_m: 20.0, height_m: 10.0, ..FloorPlan::default() };
        let frame = GridFrame::covering(20.0, 10.0, 1.0);
        let places = || (0..frame.len()).map(|node| frame.node(node % frame.nx, node / frame.nx));
        let layers = Layers {
            strength_ut: places().map(|p| strength_ut(p.x_m, p.y_m)).collect(),
            route_distance_m: places().map(|p| (p.y_m - 7.0).max(0.0) as f32).collect(),
            ..Layers::default()
        };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    #[test]
    fn the_nearest_in_strength_within_the_radius_by_hand() {
        let floor = floor(|x, _| 40.0 + x as f32);
        let mut candidates = Candidates::with_capacity(4);
        // Within 2 m of (5, 5): x from 3 to 7. 46 µT is at x = 6, where three points are near enough; 47 and 45 are as
        // far off, and (7, 5) comes after (5, 3) by its node.
        let area = SearchArea { centre_m: [5.0, 5.0], radius_m: 2.0 };
        candidates.search(&floor, area, 46.0);
        let places: Vec<[f32; 2]> = candidates.found().iter().map(|found| found.place_m).collect();
        assert_eq!(places, [[6.0, 4.0], [6.0, 5.0], [6.0, 6.0], [5.0, 3.0]]);
        assert_eq!(candidates.found()[3].off_ut, 1.0);
        // A second search elsewhere adds to the first, and finds nothing twice.
        candidates.search(&floor, area, 46.0);
        assert_eq!(candidates.found().len(), 4);
        candidates.clear();
        candidates.search(&floor, SearchArea { centre_m: [f32::NAN, 5.0], radius_m: 2.0 }, 46.0);
        candidates.search(&floor, SearchArea { centre_m: [-40.0, 5.0], radius_m: 2.0 }, 46.0);
        assert_eq!(candidates.found(), []);
    }

    #[test]
    fn places_that_nobody_surveyed_are_no_points_of_the_map() {
        let mut candidates = Candidates::with_capacity(300);
        candidates.search(&floor(|_, _| 40.0), SearchArea::EVERYWHERE, 46.0);
        assert_eq!(candidates.found().len(), 21 * 9);
    }

    proptest! {
        #[test]
        fn none_nearer_is_left_out(
            x in -3.0f32..23.0, y in -3.0f32..13.0, radius_m in 0.1f32..9.0, observed in 30.0f32..70.0, k in 1usize..12,
        ) {
            let field = |x: f64, y: f64| 50.0 + 10.0 * libm::sin(1.3 * x) as f32 + 5.0 * libm::cos(0.9 * y) as f32;
            let floor = floor(field);
            let mut candidates = Candidates::with_capacity(k);
            candidates.search(&floor, SearchArea { centre_m: [x, y], radius_m }, observed);
            let mut offs: Vec<f32> = (0..=20)
                .flat_map(|i| (0..=8).map(move |j| (f64::from(i), f64::from(j))))
                .filter(|(i, j)| {
                    let (dx, dy) = (i - f64::from(x), j - f64::from(y));
                    dx * dx + dy * dy <= f64::from(radius_m) * f64::from(radius_m)
                })
                .map(|(i, j)| (field(i, j) - observed).abs())
                .collect();
            offs.sort_by(f32::total_cmp);
            offs.truncate(k);
            prop_assert_eq!(candidates.found().iter().map(|found| found.off_ut).collect::<Vec<_>>(), offs);
        }
    }
}
