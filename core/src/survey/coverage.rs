//! How well a survey covers its floor.

use crate::map::FloorIndex;

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
