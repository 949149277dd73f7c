//! A simulated building with the map that its survey gave, and systems scored on walks through it.

use std::sync::Arc;

use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::survey::{SurveyParams, SurveyWalk, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk_sim::scenario::{Scenario, Walk};

use crate::evaluation::{Start, TestWalk, fixes, score};
use crate::simulated::{floor_name, test_walk};

/// A building and its map.
#[derive(Clone, Debug)]
pub struct Surveyed {
    /// The building, its field, its radio.
    pub scenario: Scenario,
    /// Its ground floor as surveyed.
    pub floor: Arc<FloorIndex>,
}

impl Surveyed {
    /// Surveys `scenario`'s ground floor on all its lines; `change` may put another surveyor or phone in a walk's place.
    pub fn of(scenario: Scenario, change: impl Fn(Walk) -> Walk) -> Self {
        let walks: Vec<Walk> = scenario.survey_walks().into_iter().map(change).collect();
        Self::by_walks(scenario, &walks)
    }

    /// Surveys `scenario`'s ground floor by `walks`. A survey that gives no map leaves an empty one, on which no system
    /// has a place.
    pub fn by_walks(scenario: Scenario, walks: &[Walk]) -> Self {
        let walks: Vec<SurveyWalk> = walks.iter().map(|walk| scenario.simulate(walk).survey_walk()).collect();
        let map = build_floor(&floor_name(0), 0, &scenario.building.plan, &walks, &SurveyParams::default());
        let floor = Arc::new(FloorIndex::new(map.unwrap_or_default()));
        Self { scenario, floor }
    }

    /// The same building with another map, such as one that lacks something.
    #[must_use]
    pub fn with_map(&self, change: impl FnOnce(FloorMap) -> FloorMap) -> Self {
        let map = change(self.floor.map().clone());
        Self { scenario: self.scenario.clone(), floor: Arc::new(FloorIndex::new(map)) }
    }

    /// What the phone of `walk` records, its fixes to be scored once a second from `first_scored_s` on, against where the
    /// walker truly was.
    pub fn walked(&self, walk: &Walk, first_scored_s: i64) -> Option<TestWalk> {
        test_walk(self.scenario.simulate(walk), first_scored_s)
    }

    /// Errors of `recipe` on `walk` in metres, at its truth points in order; infinite where there was no fix.
    pub fn errors_m(&self, recipe: &Recipe, start: Start, seed: u64, walk: &TestWalk) -> Vec<f64> {
        let scored = score(&self.floor, recipe, start, seed, walk);
        scored.points.iter().map(|(_, fix)| fix.map_or(f64::INFINITY, |fix| fix.error_m)).collect()
    }

    /// Where `recipe` puts the walker of `walk` at its truth points, in order; where there was no fix, nothing.
    pub fn fixes(&self, recipe: &Recipe, start: Start, seed: u64, walk: &TestWalk) -> Vec<Option<Point2>> {
        fixes(&self.floor, recipe, start, seed, walk)
    }
}
