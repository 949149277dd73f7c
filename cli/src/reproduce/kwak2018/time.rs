//! What a round costs.

use fieldwalk::system::Recipe;

use super::office;
use crate::evaluation::{Start, score};
use crate::reproduce::estimate::mean_of;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::{Estimate, Finding, Findings, Run};

/// Offices; their walks cost about the same.
const N_SEEDS: u64 = 3;
/// The walk, and the rounds that are left out: histories are full after half a minute.
const WALK: usize = 1;
const FULL_AFTER: usize = 31;

/// Mean time of a round with full histories, in µs.
fn round_us(surveyed: &Surveyed, recipe: &Recipe, seed: u64) -> f64 {
    let walk = office::walk(surveyed, WALK, seed);
    let scored =
        surveyed.walked(&walk, 1).map(|walk| score(&surveyed.floor, recipe, Start::Cold, seed, &walk));
    mean_of(
        scored
            .iter()
            .flat_map(|scored| scored.step_us.get(FULL_AFTER..))
            .flatten()
            .copied()
            .collect::<Vec<_>>()
            .as_slice(),
    )
}

/// Times rounds one after another.
pub fn run(run: &Run) -> Findings {
    let offices = run.per_seed(N_SEEDS, |seed| (seed, office::surveyed(seed)));
    let times = |recipe: &Recipe| -> Vec<f64> {
        offices.iter().map(|(seed, office)| round_us(office, recipe, *seed)).collect()
    };
    let (euclidean, warping, few) =
        (times(&office::euclidean(3_000)), times(&office::warping(3_000)), times(&office::warping(500)));
    let ratios = |of: &[f64]| of.iter().zip(&euclidean).map(|(more, less)| more / less).collect::<Vec<f64>>();
    let cards: Vec<f64> = euclidean.iter().map(|us| 1e6 / us).collect();
    let n = offices.len();
    let cause = format!(
        "a round of EUC3000 takes {:.0} µs here, where the paper's takes 30 ms; both measures are vectorised, and what a \
         round costs beside its distances counts for more",
        mean_of(&euclidean)
    );
    Findings::default()
        .with(Finding::new("kwak-time-ratio", n, [Estimate::mean(&ratios(&warping))]).because(cause))
        .with(Finding::new("kwak-dtw500-slower", n, [Estimate::mean(&ratios(&few))]))
        .with(Finding::new("kwak-cards", n, [Estimate::mean(&cards)]))
}
