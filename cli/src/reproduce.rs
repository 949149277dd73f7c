//! The five papers' results run again on simulated test beds, and every claim judged.
//!
//! # How to add claims
//!
//! [`claims::CLAIMS`] lists what the papers claim and what each claim must pass; nothing else decides a verdict. A paper's
//! module offers `EXPERIMENTS`: functions that measure, and say which claims they answer. One looks like this:
//!
//! ```
//! use fieldwalk_cli::plot::cdf;
//! use fieldwalk_cli::reproduce::{Estimate, Experiment, Finding, Findings, Picture, Run};
//!
//! pub const EXPERIMENTS: &[Experiment] =
//!     &[Experiment { name: "nearest neighbour", claims: &["song-nn", "song-order"], is_timed: false, run: nearest }];
//!
//! fn nearest(run: &Run) -> Findings {
//!     // In parallel; `--seeds` may lower the number. A seed decides about building, walker, phone and filter alike.
//!     let measured: Vec<[f64; 3]> = run.per_seed(10, |seed| [1.4, 1.1, 0.9].map(|m| m + 0.01 * seed as f64));
//!     let of = |k: usize| measured.iter().map(|means_m| means_m[k]).collect::<Vec<f64>>();
//!     Findings::default()
//!         .with(Finding::new("song-nn", measured.len(), [Estimate::mean(&of(0))]))
//!         // One estimate for each part of the claim, in the table's order.
//!         .with(
//!             Finding::new(
//!                 "song-order",
//!                 measured.len(),
//!                 [Estimate::paired(&of(1), &of(2)), Estimate::paired(&of(0), &of(1))],
//!             )
//!             .because("said only if it fails: the likely cause"),
//!         )
//!         .with_picture(Picture::of("errors of all seeds", cdf("Errors", "error (m)", &[("nearest", &of(0))]).to_svg()))
//! }
//! # assert_eq!(EXPERIMENTS[0].claims.len(), nearest(&Run::with_seeds(2)).findings.len());
//! ```
//!
//! What claims share is measured once, in one experiment. What measures time says `is_timed`: it runs after all others,
//! one at a time, on one thread. Everything else gives the same numbers on every run: randomness comes from seeds alone.
//! Buildings, users, phones and routes stand in [`test_bed`], fixed for all claims; [`surveyed`] surveys and walks them.

pub mod claim;
pub mod claims;
pub mod estimate;
mod ibill;
pub(crate) mod kwak2018;
mod mass_centered;
mod outcome;
pub mod page;
mod song;
pub mod surveyed;
pub mod test_bed;
pub mod trace;
mod wila;

use indicatif::ProgressBar;
use rayon::prelude::*;

pub use claim::{Claim, Paper, Part, Test};
pub use estimate::Estimate;
pub use outcome::{Outcome, PartOutcome};

use crate::progress;

/// A measurement that answers some claims.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// What it is called.
    pub name: &'static str,
    /// The claims that it answers; no other experiment answers them.
    pub claims: &'static [&'static str],
    /// Whether it measures time, and so must be alone on the machine.
    pub is_timed: bool,
    /// Measures.
    pub run: fn(&Run) -> Findings,
}

/// How much is measured.
#[derive(Debug)]
pub struct Run {
    max_seeds: u64,
    bar: ProgressBar,
}

/// What an experiment found.
#[derive(Debug, Default)]
pub struct Findings {
    /// For claims.
    pub findings: Vec<Finding>,
    /// For the page.
    pub pictures: Vec<Picture>,
}

/// What was measured for one claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The claim's id.
    pub id: &'static str,
    /// Number of seeds behind it.
    pub n_seeds: usize,
    /// One for each part of the claim, in order.
    pub estimates: Vec<Estimate>,
    /// Why it would fail, as far as is known; told only where it does.
    pub likely_cause: String,
}

/// A picture for the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What it shows and under which conditions.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

/// All that was asked for, judged.
#[derive(Debug)]
pub struct Reproduction {
    /// One for each claim of the papers asked for, in the table's order.
    pub outcomes: Vec<Outcome>,
    /// The pictures of each paper.
    pub pictures: Vec<(Paper, Vec<Picture>)>,
}

impl Run {
    /// With as many seeds as each experiment needs.
    pub fn complete() -> Self {
        Self::with_seeds(u64::MAX)
    }

    /// With this many seeds at most.
    pub fn with_seeds(max_seeds: u64) -> Self {
        Self { max_seeds, bar: progress::bar("seeds", 0) }
    }

    /// What `measure` gives for the seeds 1, 2, … `n`, in parallel; fewer where fewer were asked for.
    pub fn per_seed<M: Send>(&self, n: u64, measure: impl Fn(u64) -> M + Sync) -> Vec<M> {
        let n = n.min(self.max_seeds);
        self.bar.inc_length(n);
        let measured = (1..=n).into_par_iter().map(|seed| {
            let measured = measure(seed);
            self.bar.inc(1);
            measured
        });
        measured.collect()
    }
}

impl Findings {
    /// With one more finding.
    #[must_use]
    pub fn with(mut self, finding: Finding) -> Self {
        self.findings.push(finding);
        self
    }

    /// With one more picture.
    #[must_use]
    pub fn with_picture(mut self, picture: Picture) -> Self {
        self.pictures.push(picture);
        self
    }
}

impl Finding {
    /// What was measured for the claim `id`: an estimate for each of its parts, in order.
    pub fn new(id: &'static str, n_seeds: usize, estimates: impl Into<Vec<Estimate>>) -> Self {
        Self { id, n_seeds, estimates: estimates.into(), likely_cause: String::new() }
    }

    /// With the likely cause of a failure; it is told only if the claim fails.
    #[must_use]
    pub fn because(self, likely_cause: impl Into<String>) -> Self {
        Self { likely_cause: likely_cause.into(), ..self }
    }
}

impl Picture {
    /// A picture with its caption.
    pub fn of(caption: impl Into<String>, svg: impl Into<String>) -> Self {
        Self { caption: caption.into(), svg: svg.into() }
    }
}

impl Paper {
    fn experiments(self) -> Vec<Experiment> {
        match self {
            Self::Kwak2018 => kwak2018::EXPERIMENTS.to_vec(),
            Self::MassCentered => mass_centered::EXPERIMENTS.to_vec(),
            Self::Ibill => ibill::experiments(),
            Self::Wila => wila::EXPERIMENTS.to_vec(),
            Self::Song => song::EXPERIMENTS.to_vec(),
        }
    }
}

/// Measures and judges the claims of `papers`; with `only`, no others than those.
pub fn reproduce(papers: &[Paper], only: &[String], run: &Run) -> Reproduction {
    let is_asked = |id: &str| only.is_empty() || only.iter().any(|asked| asked == id);
    let experiments: Vec<(Paper, Experiment)> = papers
        .iter()
        .flat_map(|paper| paper.experiments().into_iter().map(|experiment| (*paper, experiment)))
        .filter(|(_, experiment)| experiment.claims.iter().any(|id| is_asked(id)))
        .collect();
    let (timed, untimed): (Vec<_>, Vec<_>) =
        experiments.into_iter().partition(|(_, experiment)| experiment.is_timed);
    let mut found: Vec<(Paper, Findings)> =
        untimed.into_par_iter().map(|(paper, experiment)| (paper, (experiment.run)(run))).collect();
    found.extend(timed.into_iter().map(|(paper, experiment)| (paper, (experiment.run)(run))));
    run.bar.finish_and_clear();
    let finding = |id: &str| found.iter().flat_map(|(_, found)| &found.findings).find(|found| found.id == id);
    let claims = claims::CLAIMS.iter().filter(|claim| papers.contains(&claim.paper) && is_asked(claim.id));
    let outcomes = claims.map(|claim| Outcome::of(claim, finding(claim.id))).collect();
    let pictures_of = |paper: Paper| {
        let of_paper = found.iter().filter(move |(of, _)| *of == paper);
        (paper, of_paper.flat_map(|(_, found)| found.pictures.iter().cloned()).collect())
    };
    Reproduction { outcomes, pictures: papers.iter().map(|&paper| pictures_of(paper)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_experiment_answers_claims_of_its_paper_and_no_claim_is_answered_twice() {
        let mut answered: Vec<&str> = Vec::new();
        for paper in Paper::ALL {
            for experiment in paper.experiments() {
                assert!(!experiment.claims.is_empty(), "{}", experiment.name);
                for id in experiment.claims {
                    let claim = claims::CLAIMS.iter().find(|claim| claim.id == *id);
                    assert_eq!(claim.map(|claim| claim.paper), Some(paper), "{id}");
                    assert!(!answered.contains(id), "{id}");
                    answered.push(id);
                }
            }
        }
    }

    #[test]
    fn seeds_begin_at_one_and_can_be_fewer() {
        assert_eq!(Run::complete().per_seed(3, |seed| seed), [1, 2, 3]);
        assert_eq!(Run::with_seeds(2).per_seed(3, |seed| seed), [1, 2]);
    }
}
