//! How well a survey covers its floor, and how well its map will position: each walk against the map of the others.

use std::sync::Arc;

use crate::floor_plan::FloorPlan;
use crate::geometry::Point2;
use crate::map::{FloorIndex, FloorMap};
use crate::metrics::ScoredFix;
use crate::survey::build::{Surveyed, grid_field, grid_routes};
use crate::survey::{SurveyParams, SurveyTrack, SurveyWalk};
use crate::system::Recipe;
use crate::tracker::Tracker;

/// A place counts as covered up to this distance from a surveyed line, in metres.
const COVERED_M: f32 = 3.0;
/// A left-out walk's surroundings are gridded anew up to this distance from it, in metres.
const REGRID_M: f64 = 10.0;
/// How far off the start of a left-out walk is taken to be known, in metres.
const START_RADIUS_M: f64 = 2.0;

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
    /// What `floor`'s survey covers.
    pub fn of(floor: &FloorIndex) -> Self {
        let map = floor.map();
        let cell_m2 = map.frame.cell_m * map.frame.cell_m;
        let mut coverage = Self { n_transmitters: map.transmitters.len(), ..Self::default() };
        for node in 0..map.frame.len() {
            let place = map.frame.node(node % map.frame.nx, node / map.frame.nx);
            if floor.is_open(place.x_m as f32, place.y_m as f32) {
                coverage.open_m2 += cell_m2;
                let is_covered = map.layers.route_distance_m.get(node).is_some_and(|&d| d <= COVERED_M);
                coverage.covered_m2 += if is_covered { cell_m2 } else { 0.0 };
            }
        }
        let lines = map.routes.iter().flat_map(|route| route.windows(2));
        coverage.route_m = lines.map(|w| w[0].distance_m(w[1])).sum();
        coverage
    }
}

/// Positions one walk on the map of all others and scores it at its waypoints but the first.
///
/// `map` is the map of all walks; the surroundings of walk `left_out` are gridded anew without it. The start is known
/// to ± 2 m about the first waypoint. Each score comes with the waypoint's place. Empty when the walk cannot be laid
/// out.
pub fn leave_one_walk_out(
    map: &FloorMap,
    plan: &FloorPlan,
    walks: &[SurveyWalk],
    left_out: usize,
    params: &SurveyParams,
    recipe: &Recipe,
    seed: u64,
) -> Vec<(Point2, ScoredFix)> {
    let Some(walk) = walks.get(left_out) else { return Vec::new() };
    let Some(track) = SurveyTrack::of(walk) else { return Vec::new() };
    let others = Surveyed::of(walks, Some(left_out));
    if others.readings.is_empty() {
        return Vec::new();
    }
    let mut map = FloorMap { plan: plan.clone(), ..map.clone() };
    map.routes = others.routes();
    grid_routes(&mut map, params);
    let near: Vec<Point2> = track.steps().iter().map(|step| step.position).collect();
    grid_field(&mut map, others.readings, params, |place| {
        near.iter().any(|p| p.distance_m(place) < REGRID_M)
    });
    let floor = Arc::new(FloorIndex::new(map));
    let mut tracker = Tracker::new(recipe.clone(), floor, seed);
    let waypoints = track.waypoints();
    tracker.place(waypoints[0].point, START_RADIUS_M);
    let mut steps = walk.steps().iter().filter(|step| step.cycle.end > waypoints[0].time).peekable();
    let mut scored = Vec::new();
    for waypoint in &waypoints[1..] {
        while let Some(step) = steps.next_if(|step| step.cycle.end <= waypoint.time) {
            tracker.step(step, &[]);
        }
        let Some(estimate) = tracker.estimate() else { continue };
        let error_m = Point2::new(estimate.x_m, estimate.y_m).distance_m(waypoint.point);
        let fix = ScoredFix { error_m, radius_68_m: estimate.radius_68_m, radius_95_m: estimate.radius_95_m };
        scored.push((waypoint.point, fix));
    }
    scored
}
