//! How well a survey covers its floor.

use crate::floor_plan::FloorPlan;
use crate::geometry::Point2;
use crate::map::{FloorIndex, FloorMap, GridFrame};
use crate::survey::build::route_distances_m;

/// What a survey covers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Area where one may stand by the plan, in m².
    pub open_m2: f64,
    /// Part of it within 3 m of a surveyed line, in m².
    pub covered_m2: f64,
    /// Total length of the surveyed lines, in metres.
    pub route_m: f64,
    /// Number of transmitters in the map.
    pub n_transmitters: usize,
}

impl Coverage {
    /// A place counts as covered up to this distance from a surveyed line, in metres.
    pub const REACH_M: f32 = 3.0;

    /// What `floor`'s survey covers.
    pub fn of(floor: &FloorIndex) -> Self {
        let map = floor.map();
        let cell_m2 = map.frame.cell_m * map.frame.cell_m;
        let mut coverage = Self { n_transmitters: map.transmitters.len(), ..Self::default() };
        for node in 0..map.frame.len() {
            let place = map.frame.node(node % map.frame.nx, node / map.frame.nx);
            if floor.is_open(place.x_m as f32, place.y_m as f32) {
                coverage.open_m2 += cell_m2;
                let is_covered = map.layers.route_distance_m.get(node).is_some_and(|&d| d <= Self::REACH_M);
                coverage.covered_m2 += if is_covered { cell_m2 } else { 0.0 };
            }
        }
        let lines = map.routes.iter().flat_map(|route| route.windows(2));
        coverage.route_m = lines.map(|w| w[0].distance_m(w[1])).sum();
        coverage
    }
}

/// Where one may stand on a plan, on a coarse grid: what a survey has to cover.
#[derive(Clone, Debug)]
pub struct OpenFloor {
    frame: GridFrame,
    is_open: Vec<bool>,
}

/// How far a floor is covered by the lines walked so far.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveCoverage {
    /// The sums; no transmitter is known before a map is built.
    pub coverage: Coverage,
    /// The grid.
    pub frame: GridFrame,
    /// What each node of the grid is, row-major.
    pub nodes: Vec<Cover>,
}

/// What a place is to a survey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Nobody can stand here by the plan.
    Closed,
    /// Open floor that no line came near.
    Open,
    /// Open floor within [`Coverage::REACH_M`] of a line.
    Covered,
}

impl OpenFloor {
    /// Distance between the grid's nodes, in metres.
    pub const CELL_M: f64 = 1.0;

    /// The open floor of `plan`, whose extent [`check_extent`](crate::survey::check_extent) has found fit.
    pub fn of(plan: &FloorPlan) -> Self {
        let frame = GridFrame::covering(plan.width_m, plan.height_m, Self::CELL_M);
        let floor = FloorIndex::new(FloorMap { plan: plan.clone(), ..FloorMap::default() });
        let place = |node: usize| frame.node(node % frame.nx, node / frame.nx);
        let is_open = |place: Point2| floor.is_open(place.x_m as f32, place.y_m as f32);
        Self { frame, is_open: (0..frame.len()).map(|node| is_open(place(node))).collect() }
    }

    /// What `lines`, each a polyline, cover of it.
    pub fn covered(&self, lines: &[Vec<Point2>]) -> LiveCoverage {
        let reach_m = f64::from(Coverage::REACH_M);
        let distances_m = route_distances_m(&self.frame, lines, reach_m + self.frame.cell_m);
        let cover = |(&is_open, &distance_m): (&bool, &f32)| match is_open {
            false => Cover::Closed,
            true if distance_m <= Coverage::REACH_M => Cover::Covered,
            true => Cover::Open,
        };
        let nodes: Vec<Cover> = self.is_open.iter().zip(&distances_m).map(cover).collect();
        let cell_m2 = self.frame.cell_m * self.frame.cell_m;
        let area_m2 = |wanted: Cover| nodes.iter().filter(|&&node| node == wanted).count() as f64 * cell_m2;
        let covered_m2 = area_m2(Cover::Covered);
        let parts = lines.iter().flat_map(|line| line.windows(2));
        let coverage = Coverage {
            open_m2: area_m2(Cover::Open) + covered_m2,
            covered_m2,
            route_m: parts.map(|w| w[0].distance_m(w[1])).sum(),
            n_transmitters: 0,
        };
        LiveCoverage { coverage, frame: self.frame, nodes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::{Polygon, Unit};

    #[test]
    fn a_line_covers_three_metres_to_each_side_of_what_is_open() {
        let corners = |points: [(f64, f64); 4]| points.map(|(x, y)| Point2::new(x, y)).to_vec();
        let room = corners([(-1.0, 10.5), (31.0, 10.5), (31.0, 21.0), (-1.0, 21.0)]);
        let plan = FloorPlan {
            width_m: 30.0,
            height_m: 20.0,
            units: vec![Unit { polygon: Polygon { rings: vec![room] }, ..Unit::default() }],
            ..FloorPlan::default()
        };
        let floor = OpenFloor::of(&plan);
        let nothing = floor.covered(&[]);
        // Nodes 0 to 30 along x and 0 to 10 along y are open.
        assert_eq!(nothing.coverage, Coverage { open_m2: 31.0 * 11.0, ..Coverage::default() });
        let line = vec![Point2::new(0.0, 8.0), Point2::new(30.0, 8.0)];
        let walked = floor.covered(&[line]);
        // Rows 5 to 10, the room's beyond them being closed.
        assert_eq!(walked.coverage.covered_m2, 31.0 * 6.0);
        assert_eq!((walked.coverage.open_m2, walked.coverage.route_m), (31.0 * 11.0, 30.0));
        let at = |i: usize, j: usize| walked.nodes[j * walked.frame.nx + i];
        assert_eq!((at(15, 4), at(15, 5), at(15, 11)), (Cover::Open, Cover::Covered, Cover::Closed));
    }
}
