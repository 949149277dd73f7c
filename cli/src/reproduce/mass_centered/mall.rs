//! The system in a mall, whose ways are wide and whose survey is one line a way.

use fieldwalk::system::Recipe;
use fieldwalk_sim::scenario::{Scenario, Walk};

use super::office::{self, FIRST_SCORED_S, START, walked_by};
use crate::plot::cdf;
use crate::reproduce::estimate::quantile_of;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run, test_bed};

/// Malls and offices.
const N_SEEDS: u64 = 10;
/// About the paper's 524 steps, in metres.
const WALK_M: f64 = 350.0;
/// The user who surveys and walks, and the phone.
const SURVEYOR: usize = 3;

/// Errors in the mall and in the office, in metres.
fn measure(seed: u64) -> [Vec<f64>; 2] {
    let Some(mall) = Scenario::named("mall", seed) else { return [Vec::new(), Vec::new()] };
    let once = |(k, corridor): (usize, &fieldwalk_sim::building::Corridor)| {
        let line =
            Walk::along(format!("way {k}"), vec![corridor.line.a, corridor.line.b], 100 * seed + k as u64);
        walked_by(line, SURVEYOR, 0, seed)
    };
    let lines: Vec<Walk> = mall.building.corridors.iter().enumerate().map(once).collect();
    let mall = Surveyed::by_walks(mall, &lines);
    let recipe = Recipe::mass_centered();
    let errors_m = |surveyed: &Surveyed, walk: Walk| -> Vec<f64> {
        let walked = surveyed.walked(&walk, FIRST_SCORED_S);
        walked.map_or(Vec::new(), |walked| surveyed.errors_m(&recipe, START, seed, &walked))
    };
    let walks = |scenario: &Scenario| -> Vec<Walk> {
        let walks = scenario.test_walks(2, WALK_M).into_iter();
        walks.map(|walk| walked_by(walk, SURVEYOR, 0, seed)).collect()
    };
    let office = office::surveyed(test_bed::mass_centered_office(seed), seed);
    [&mall, &office].map(|surveyed| {
        walks(&surveyed.scenario).into_iter().flat_map(|walk| errors_m(surveyed, walk)).collect()
    })
}

/// Walks malls and offices alike.
pub fn run(run: &Run) -> Findings {
    let measured = run.per_seed(N_SEEDS, measure);
    let p80_m = |k: usize| -> Vec<f64> {
        measured.iter().map(|one| quantile_of(one[k].iter().copied(), 0.8)).collect()
    };
    let pooled = |k: usize| -> Vec<f64> { measured.iter().flat_map(|one| one[k].iter().copied()).collect() };
    Findings::default()
        .with(Finding::new("mc-mall-worse", measured.len(), [Estimate::paired(&p80_m(1), &p80_m(0))]))
        .with_picture(Picture::of(
            "Walks of about 524 steps in malls, surveyed once along each way, and in offices.",
            cdf("A mall and an office", "error (m)", &[("mall", &pooled(0)), ("office", &pooled(1))])
                .to_svg(),
        ))
}
