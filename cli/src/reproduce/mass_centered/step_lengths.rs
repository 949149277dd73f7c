//! Step lengths and directions without the field's strength: a loop of 600 steps, a third each slow, normal and fast.

use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorMap;
use fieldwalk::step::StepLengthModel;
use fieldwalk::system::{LengthRule, MagneticRule, MotionParams, Recipe};
use fieldwalk_sim::scenario::Walk;
use fieldwalk_sim::walker::{Pace, WalkerProfile};

use super::office::{FIRST_SCORED_S, walked_by};
use crate::evaluation::Start;
use crate::plot::cdf;
use crate::reproduce::estimate::quantile_of;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::test_bed::{MASS_CENTERED_LOOP, SLOW_NORMAL_FAST};
use crate::reproduce::{Estimate, Finding, Findings, Picture};

/// Steps at each speed.
const N_STEPS: f64 = 200.0;
/// The users who walk the loop in each building, by their numbers: the smallest, a middling one, the tallest.
const USERS: [usize; 3] = [0, 2, 5];
/// What is told of the start: the loop's first corner.
const START: Start = Start::Known { radius_m: 2.0 };
/// The static length, in metres.
///
/// # Source
/// Mass-centred 2019, step-length experiment.
const STATIC_M: f32 = 0.65;
/// Standard deviation of a length over its mean where lengths vary by chance.
///
/// # Source
/// The paper leaves it open; 0.2 is what particle filters of its time take.
const NORMAL_SD: f32 = 0.2;
/// Length by step frequency for people at large, in metres and metres per Hz: the frequency model, and the genes' means.
///
/// # Source
/// Chen, Pei and Chen 2011, *A smart phone based PDR solution for indoor navigation*, for a height of 1.75 m:
/// `0.7 + 0.227·(f − 1.79)`. The paper takes its own from others too, and does not give it.
const GENERIC: (f32, f32) = (0.7 - 0.227 * 1.79, 0.227);
/// The models' names, in the paper's order from worst to best.
const NAMES: [&str; 4] = ["static", "normal", "frequency", "genetic"];

/// What one building gave: errors in metres.
pub struct Measured {
    /// By length model.
    models: Vec<Vec<f64>>,
    /// With static lengths, and without compensation of the azimuth.
    uncompensated: Vec<f64>,
}

/// Only moves and walls, with the length model of that number.
fn recipe(model: usize) -> Recipe {
    let base = Recipe { magnetic: MagneticRule::Ignore, ..Recipe::mass_centered() };
    let mut genes = base.motion.length;
    if let LengthRule::Genetic { a_m, b_m, .. } = &mut genes {
        (*b_m, *a_m) = GENERIC;
    }
    let varied = |step_sd: f32| LengthRule::Scaled { scale_sd: 0.0, scale_walk_sd: 0.0, step_sd };
    let constant = StepLengthModel::Static { length_m: STATIC_M };
    let (length, rule) = match model {
        0 => (constant, varied(0.0)),
        1 => (constant, varied(NORMAL_SD)),
        2 => (StepLengthModel::Frequency { offset_m: GENERIC.0, per_hz_m: GENERIC.1 }, varied(NORMAL_SD)),
        _ => (constant, genes),
    };
    Recipe { length, motion: MotionParams { length: rule, ..base.motion }, ..base }
}

/// The loop as far as `walker` comes, with the changes of speed.
fn loop_of(walker: &WalkerProfile) -> (Vec<Point2>, Vec<Pace>) {
    let mut paces = Vec::new();
    let mut length_m = 0.0;
    for factor in SLOW_NORMAL_FAST {
        paces.push(Pace { from_m: length_m, factor });
        length_m += N_STEPS * walker.step_length_m(walker.speed_m_s * factor);
    }
    let mut path = vec![MASS_CENTERED_LOOP[0]];
    let mut left_m = length_m;
    for k in 1.. {
        let (from, to) = (path[k - 1], MASS_CENTERED_LOOP[k % MASS_CENTERED_LOOP.len()]);
        let side_m = from.distance_m(to);
        path.push(from.lerp(to, (left_m / side_m).min(1.0)));
        left_m -= side_m;
        if left_m <= 0.0 {
            break;
        }
    }
    (path, paces)
}

/// The map's compass deviation replaced by its mean: the floor is turned rightly, and no place is compensated.
fn uncompensated(mut map: FloorMap) -> FloorMap {
    let known =
        || map.layers.compass_deviation_rad.iter().map(|&rad| f64::from(rad)).filter(|rad| rad.is_finite());
    let sums = known().map(f64::sin_cos).fold((0.0, 0.0), |sum, (sin, cos)| (sum.0 + sin, sum.1 + cos));
    let mean_rad = sums.0.atan2(sums.1) as f32;
    map.layers.compass_deviation_rad.iter_mut().for_each(|rad| *rad = mean_rad);
    map
}

/// Walks the loop in `office`.
pub fn measure(office: &Surveyed, seed: u64) -> Measured {
    let flat = office.with_map(uncompensated);
    let mut measured = Measured { models: vec![Vec::new(); NAMES.len()], uncompensated: Vec::new() };
    for user in USERS {
        let walk = walked_by(Walk::along("loop", Vec::new(), 100 * seed + user as u64), user, 0, seed);
        let (path, paces) = loop_of(&walk.walker);
        let Some(walked) = office.walked(&Walk { path, paces, ..walk }, FIRST_SCORED_S) else { continue };
        for (model, errors_m) in measured.models.iter_mut().enumerate() {
            errors_m.extend(office.errors_m(&recipe(model), START, seed, &walked));
        }
        measured.uncompensated.extend(flat.errors_m(&recipe(0), START, seed, &walked));
    }
    measured
}

/// Adds what the loops say.
pub fn conclude(findings: Findings, seeds: &[&Measured]) -> Findings {
    let n = seeds.len();
    // The middle of each building's errors: one walk that has lost its way would outweigh all others in a mean.
    let medians = |of: &dyn Fn(&Measured) -> &[f64]| -> Vec<f64> {
        seeds.iter().map(|one| quantile_of(of(one).iter().copied(), 0.5)).collect()
    };
    let models: Vec<Vec<f64>> = (0..NAMES.len()).map(|k| medians(&|one| &one.models[k])).collect();
    let orders: Vec<Estimate> = models.windows(2).map(|pair| Estimate::paired(&pair[1], &pair[0])).collect();
    let azimuth = Estimate::paired(&models[0], &medians(&|one| &one.uncompensated));
    let pooled = |of: &dyn Fn(&Measured) -> &[f64]| -> Vec<f64> {
        seeds.iter().flat_map(|one| of(one).iter().copied()).collect()
    };
    let by_model: Vec<Vec<f64>> = (0..NAMES.len()).map(|k| pooled(&|one| &one.models[k])).collect();
    let lines: Vec<(&str, &[f64])> = NAMES.into_iter().zip(by_model.iter().map(Vec::as_slice)).collect();
    let without = pooled(&|one| &one.uncompensated);
    findings
        .with(Finding::new("mc-steps-order", n, orders))
        .with(
            Finding::new("mc-azimuth", n, [azimuth])
                .because("static lengths err by metres along the way, beside which directions show little"),
        )
        .with_picture(Picture::of(
            "Moves and walls alone, on a loop of 20 × 40 m: 600 steps, a third each slow, normal and fast.",
            cdf("Step lengths", "error (m)", &lines).to_svg(),
        ))
        .with_picture(Picture::of(
            "The same walks with static lengths, the azimuth compensated or not.",
            cdf("Azimuth", "error (m)", &[("compensated", &by_model[0]), ("not compensated", &without)])
                .to_svg(),
        ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::test_bed;

    #[test]
    fn the_loop_takes_six_hundred_steps() {
        let walker = WalkerProfile::default();
        let (path, paces) = loop_of(&walker);
        let office = test_bed::mass_centered_office(1);
        let recorded = office.simulate(&Walk { walker, paces, ..Walk::along("loop", path, 1) });
        let n = recorded.steps.len();
        assert!((580..=640).contains(&n), "{n} steps");
        let third_s = |k: usize| recorded.steps[200 * (k + 1) - 1].end_s - recorded.steps[200 * k].start_s;
        assert!(third_s(0) > 1.15 * third_s(1) && third_s(1) > 1.1 * third_s(2));
    }
}
