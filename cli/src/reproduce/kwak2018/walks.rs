//! Eleven walks through the office under every system.

use fieldwalk::card::CardReceiver;
use fieldwalk::geometry::wrap_rad;
use fieldwalk::positioner::Positioner;
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::system::Recipe;
use fieldwalk::time::Duration;
use fieldwalk_sim::scenario::Recorded;

use super::office;
use crate::evaluation::{Start, TestWalk};
use crate::plot::cdf;
use crate::reproduce::estimate::mean_of;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::test_bed::KWAK_PACES;
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run};
use crate::simulated::test_walk;

/// Offices, each with its own steel, walks and cards: so many that a tenth of a metre between two systems is seen, where
/// offices differ in it by 0.2 m.
const N_SEEDS: u64 = 48;
/// Errors count from this second on, when the start's filter ends; convergence counts from the first.
const SETTLED_S: usize = 10;
/// Walks that the warping of 3000 particles is run on: it is dear. The first trajectory at two speeds, and another.
const WARPED: [usize; 3] = [1, 2, 7];
/// Converged is who errs by less than this for as long.
const CONVERGED_M: f64 = 3.0;
const CONVERGED_S: usize = 5;

/// What one office gave.
struct Measured {
    /// Errors of the system as it is, in metres, by second; infinite before the first fix.
    usual_m: Vec<Vec<f64>>,
    warped_m: Vec<Vec<f64>>,
    few_m: Vec<Vec<f64>>,
    raw_m: Vec<Vec<f64>>,
    radar_m: Vec<Vec<f64>>,
    plain_m: Vec<Vec<f64>>,
    short_m: Vec<Vec<f64>>,
    unfiltered_m: Vec<Vec<f64>>,
    /// Share of time that the estimated heading, and the compass, is within 45° of the truth, in percent.
    followed: f64,
    compass_followed: f64,
    /// Steps that the card counted too many or too few, and those made, walk by walk.
    steps: Vec<[f64; 2]>,
}

/// A walk as recorded, and as it is scored.
struct Walked {
    recorded: Recorded,
    scored: TestWalk,
}

fn measure(seed: u64) -> Measured {
    let office = office::surveyed(seed);
    let walks: Vec<Walked> = (0..KWAK_PACES.len())
        .filter_map(|k| {
            let recorded = office.scenario.simulate(&office::walk(&office, k, seed));
            Some(Walked { scored: test_walk(recorded.clone(), 1)?, recorded })
        })
        .collect();
    let errors = |recipe: &Recipe| -> Vec<Vec<f64>> {
        walks.iter().map(|walk| office.errors_m(recipe, Start::Cold, seed, &walk.scored)).collect()
    };
    let warping = office::warping(3_000);
    let warped = WARPED.iter().filter_map(|&k| walks.get(k));
    let headings: Vec<[f64; 2]> = walks.iter().map(|walk| followed(&office, walk, seed)).collect();
    let of_headings = |k: usize| mean_of(&headings.iter().map(|shares| shares[k]).collect::<Vec<_>>());
    Measured {
        usual_m: errors(&office::euclidean(3_000)),
        warped_m: warped.map(|walk| office.errors_m(&warping, Start::Cold, seed, &walk.scored)).collect(),
        few_m: errors(&office::euclidean(500)),
        raw_m: errors(&office::raw_heading()),
        radar_m: errors(&Recipe::radar()),
        plain_m: errors(&office::plain()),
        short_m: errors(&office::remembering(5)),
        unfiltered_m: errors(&office::unfiltered()),
        followed: of_headings(0),
        compass_followed: of_headings(1),
        steps: walks.iter().map(|walk| counted(&walk.recorded)).collect(),
    }
}

/// Errors from the start's end on.
fn settled(errors_m: &[Vec<f64>]) -> Vec<f64> {
    let rest = errors_m.iter().flat_map(|walk| walk.iter().skip(SETTLED_S - 1));
    rest.copied().filter(|error_m| error_m.is_finite()).collect()
}

/// Seconds until the error is small for a while; the walk's length where it never is.
fn converged_s(errors_m: &[f64]) -> f64 {
    let is_small = |window: &[f64]| window.iter().all(|error_m| *error_m < CONVERGED_M);
    let first = errors_m.windows(CONVERGED_S).position(is_small);
    first.map_or(errors_m.len(), |k| k + 1) as f64
}

/// Percent of the walking time that the estimate's heading, and the compass alone, is within 45° of the truth.
fn followed(office: &Surveyed, walk: &Walked, seed: u64) -> [f64; 2] {
    const WITHIN_RAD: f64 = std::f64::consts::FRAC_PI_4;
    let mut positioner = Positioner::new(office.floor.clone(), office::euclidean(3_000), seed);
    let mut receiver = CardReceiver::default();
    let north_rad = f64::from(office.floor.mean_deviation_rad());
    let Some(first) = walk.recorded.truth.first() else { return [f64::NAN; 2] };
    let (mut n, mut n_followed, mut n_by_compass) = (0, 0, 0);
    for sample in &walk.recorded.samples {
        positioner.push(*sample);
        if let Reading::CardFrame(frame) = &sample.reading {
            receiver.push(sample.time, frame);
        }
        while let Some(round) = receiver.pop() {
            let is_settled = round.cycle.end - first.time > Duration::from_millis(1_000 * SETTLED_S as i64);
            if round.n_steps == 0 || !is_settled {
                continue;
            }
            // The middle of the round: its heading is its mean.
            let truth = walk.recorded.truth_at(round.cycle.start.midpoint(round.cycle.end));
            let (Some(truth), Some(fix), Some(azimuth_rad)) = (truth, positioner.fix(), round.azimuth_rad())
            else {
                continue;
            };
            let is_near = |heading_rad: f64| wrap_rad(heading_rad - truth.heading_rad).abs() < WITHIN_RAD;
            n += 1;
            n_followed += i32::from(is_near(fix.heading_rad));
            n_by_compass += i32::from(is_near(f64::from(azimuth_rad) + north_rad));
        }
    }
    [n_followed, n_by_compass].map(|n_right| 100.0 * f64::from(n_right) / f64::from(n.max(1)))
}

/// By how much the steps that the card's six numbers a second tell differ from those made, and these.
fn counted(recorded: &Recorded) -> [f64; 2] {
    let mut receiver = CardReceiver::default();
    let mut n_counted = 0.0;
    for Sample { time, reading } in &recorded.samples {
        let Reading::CardFrame(frame) = reading else { continue };
        receiver.push(*time, frame);
        while let Some(round) = receiver.pop() {
            n_counted += f64::from(round.n_steps);
        }
    }
    let n_made = recorded.steps.len() as f64;
    [(n_counted - n_made).abs(), n_made]
}

/// Percent of all steps that were counted right.
fn right_percent(steps: &[[f64; 2]]) -> f64 {
    let sum = |k: usize| steps.iter().map(|walk| walk[k]).sum::<f64>();
    100.0 * (1.0 - sum(0) / sum(1))
}

/// Surveys the offices, walks them under every system.
pub fn run(run: &Run) -> Findings {
    let measured = run.per_seed(N_SEEDS, measure);
    let n = measured.len();
    let per_seed = |of: fn(&Measured) -> &[Vec<f64>]| -> Vec<Vec<f64>> {
        measured.iter().map(|one| settled(of(one))).collect()
    };
    let means = |of: fn(&Measured) -> &[Vec<f64>]| -> Vec<f64> {
        per_seed(of).iter().map(|errors_m| mean_of(errors_m)).collect()
    };
    let each = |of: fn(&Measured) -> f64| measured.iter().map(of).collect::<Vec<f64>>();
    let usual = means(|one| &one.usual_m);
    let on_warped = |one: &Measured| -> f64 {
        let walks: Vec<Vec<f64>> = WARPED.iter().filter_map(|&k| one.usual_m.get(k).cloned()).collect();
        mean_of(&settled(&walks))
    };
    let usual_on_warped: Vec<f64> = measured.iter().map(on_warped).collect();
    let convergence = |of: fn(&Measured) -> &[Vec<f64>]| -> Vec<f64> {
        let mean =
            |walks: &[Vec<f64>]| mean_of(&walks.iter().map(|walk| converged_s(walk)).collect::<Vec<_>>());
        measured.iter().map(|one| mean(of(one))).collect()
    };
    let order = |id, more: fn(&Measured) -> &[Vec<f64>]| {
        Finding::new(id, n, [Estimate::paired(&usual, &means(more))])
    };
    let pooled = |of: fn(&Measured) -> &[Vec<f64>]| per_seed(of).concat();
    let (all, warped, few, radar, raw, plain) = (
        pooled(|one| &one.usual_m),
        pooled(|one| &one.warped_m),
        pooled(|one| &one.few_m),
        pooled(|one| &one.radar_m),
        pooled(|one| &one.raw_m),
        pooled(|one| &one.plain_m),
    );
    let curves: [(&str, &[f64]); 6] = [
        ("EUC3000", &all),
        ("DTW3000", &warped),
        ("EUC500", &few),
        ("PDR_RAW", &raw),
        ("no heuristics", &plain),
        ("BLE_RADAR", &radar),
    ];
    let (compass, motion) = (mean_of(&each(|one| one.compass_followed)), each(|one| one.followed));
    Findings::default()
        .with(Finding::new("kwak-median", n, [Estimate::pooled_quantile(&per_seed(|one| &one.usual_m), 0.5)]))
        .with(Finding::new("kwak-mean", n, [Estimate::mean(&usual)]))
        .with(Finding::new(
            "kwak-euc-as-dtw",
            n,
            [Estimate::paired(&means(|one| &one.warped_m), &usual_on_warped)],
        ))
        .with(order("kwak-euc500-worse", |one| &one.few_m))
        .with(
            Finding::new("kwak-motion-model", n, [Estimate::mean(&motion)])
                .because(format!("the compass alone is within 45° for {compass:.0} % of the time")),
        )
        .with(order("kwak-no-motion-model-worse", |one| &one.raw_m))
        .with(order("kwak-radar-worse", |one| &one.radar_m))
        .with(order("kwak-heuristics", |one| &one.plain_m))
        .with(Finding::new(
            "kwak-history",
            n,
            [Estimate::mean(&usual), Estimate::paired(&usual, &means(|one| &one.short_m))],
        ))
        .with(Finding::new(
            "kwak-ble-filter",
            n,
            [Estimate::paired(&convergence(|one| &one.usual_m), &convergence(|one| &one.unfiltered_m))],
        ))
        .with(Finding::new("kwak-steps", n, [Estimate::mean(&each(|one| right_percent(&one.steps)))]))
        .with_picture(Picture::of(
            format!(
                "{n} offices of 20.5 × 16 m, seven trajectories, eleven walks each; from the tenth second on. DTW3000 on \
                 three of the walks. The heading is within 45° of the truth for {:.0} % of the time, the compass alone for \
                 {compass:.0} %: less distorted than the paper's seems to be.",
                mean_of(&motion)
            ),
            cdf("The card in its office", "error (m)", &curves).to_svg(),
        ))
        .with_picture(Picture::of(
            "With and without the filter of the start.",
            cdf(
                "Convergence",
                "seconds",
                &[
                    ("with the filter", &convergence(|one| &one.usual_m)),
                    ("without", &convergence(|one| &one.unfiltered_m)),
                ],
            )
            .to_svg(),
        ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converged_is_who_stays_close() {
        let mut errors_m = vec![9.0, 1.0, 9.0, 1.0, 1.0, 1.0, 1.0, 1.0, 9.0];
        assert_eq!(converged_s(&errors_m), 4.0);
        errors_m[6] = 3.5;
        assert_eq!(converged_s(&errors_m), 9.0);
        assert_eq!(
            settled(&[vec![f64::INFINITY; 12], (1..=12).map(f64::from).collect()]),
            [10.0, 11.0, 12.0]
        );
    }
}
