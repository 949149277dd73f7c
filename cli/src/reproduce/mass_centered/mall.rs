//! The system in a mall, whose ways are wide and whose survey is one line a way.

use fieldwalk::geometry::Point2;
use fieldwalk::system::Recipe;
use fieldwalk_sim::scenario::{Scenario, Walk};

use super::office::{self, FIRST_SCORED_S, START, walked_by};
use crate::evaluation::TestWalk;
use crate::plot::cdf;
use crate::reproduce::estimate::quantile_of;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::trace::traces;
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run, test_bed};

/// Malls and offices.
const N_SEEDS: u64 = 10;
/// About the paper's 524 steps, in metres.
const WALK_M: f64 = 350.0;
/// The user who surveys and walks, and the phone.
const SURVEYOR: usize = 3;

/// What a mall and an office gave.
#[derive(Default)]
struct Measured {
    /// Errors in the mall and in the office, in metres.
    errors_m: [Vec<f64>; 2],
    /// The first walk in the first mall, drawn.
    trace: String,
}

fn measure(seed: u64) -> Measured {
    let Some(mall) = Scenario::named("mall", seed) else { return Measured::default() };
    let once = |(k, corridor): (usize, &fieldwalk_sim::building::Corridor)| {
        let line =
            Walk::along(format!("way {k}"), vec![corridor.line.a, corridor.line.b], 100 * seed + k as u64);
        walked_by(line, SURVEYOR, 0, seed)
    };
    let lines: Vec<Walk> = mall.building.corridors.iter().enumerate().map(once).collect();
    let mall = Surveyed::by_walks(mall, &lines);
    let recipe = Recipe::mass_centered();
    let office = office::surveyed(test_bed::mass_centered_office(seed), seed);
    let walked = |surveyed: &Surveyed| -> Vec<TestWalk> {
        let walks = surveyed.scenario.test_walks(2, WALK_M).into_iter();
        let walks = walks.map(|walk| walked_by(walk, SURVEYOR, 0, seed));
        walks.filter_map(|walk| surveyed.walked(&walk, FIRST_SCORED_S)).collect()
    };
    let errors_m = [&mall, &office].map(|surveyed| {
        let of = |walk: TestWalk| surveyed.errors_m(&recipe, START, seed, &walk);
        walked(surveyed).into_iter().flat_map(of).collect()
    });
    let drawn = if seed == 1 { walked(&mall) } else { Vec::new() };
    let trace = drawn.first().map(|walk| {
        let truth: Vec<Point2> = walk.truth.iter().map(|truth| truth.point).collect();
        let fixes: Vec<Point2> = mall.fixes(&recipe, START, seed, walk).into_iter().flatten().collect();
        let plan = &mall.scenario.building.plan;
        traces("A walk in a mall", plan, &[("truth", &truth), ("mass-centered", &fixes)])
    });
    Measured { errors_m, trace: trace.unwrap_or_default() }
}

/// Walks malls and offices alike.
pub fn run(run: &Run) -> Findings {
    let measured = run.per_seed(N_SEEDS, measure);
    let p80_m = |k: usize| -> Vec<f64> {
        measured.iter().map(|one| quantile_of(one.errors_m[k].iter().copied(), 0.8)).collect()
    };
    let pooled =
        |k: usize| -> Vec<f64> { measured.iter().flat_map(|one| one.errors_m[k].iter().copied()).collect() };
    let findings = Findings::default()
        .with(Finding::new("mc-mall-worse", measured.len(), [Estimate::paired(&p80_m(1), &p80_m(0))]))
        .with_picture(Picture::of(
            "Walks of about 524 steps in malls, surveyed once along each way, and in offices.",
            cdf("A mall and an office", "error (m)", &[("mall", &pooled(0)), ("office", &pooled(1))])
                .to_svg(),
        ));
    match measured.into_iter().next() {
        Some(first) => findings.with_picture(Picture::of("The first of these walks in a mall.", first.trace)),
        None => findings,
    }
}
