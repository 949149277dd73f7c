//! What accuracy to expect on a map: each walk positioned on the map of all others.

use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorMap;
use fieldwalk::metrics::ScoredFix;
use fieldwalk::survey::{LeaveOneOut, SurveyParams};
use fieldwalk::system::Recipe;
use rayon::prelude::*;

use crate::commands::survey::walks::Walks;
use crate::progress;

/// The seed of these runs; another one changes the result by a few centimetres.
const SEED: u64 = 1;

/// The scores of the default system at the waypoints of all walks, each with its place; empty when no walk could be left
/// out.
pub fn scores(map: &FloorMap, walks: &Walks, params: &SurveyParams) -> Vec<(Point2, ScoredFix)> {
    let recipe = Recipe::fused();
    let survey = LeaveOneOut::new(map, &walks.used, params);
    let bar = progress::bar(format!("{}: walks on the map of the others", map.name), walks.used.len());
    let scored: Vec<Vec<(Point2, ScoredFix)>> = (0..walks.used.len())
        .into_par_iter()
        .map(|k| {
            let scored = survey.score(k, &recipe, SEED);
            bar.inc(1);
            scored
        })
        .collect();
    bar.finish_and_clear();
    scored.concat()
}
