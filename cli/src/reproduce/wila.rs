//! WILA 2016: steps, distance and turns at the waist.

use fieldwalk::front_end::WaistFrontEnd;
use fieldwalk::geometry::{Point2, wrap_rad};
use fieldwalk::gravity::STANDARD_GRAVITY_M_S2;
use fieldwalk::metrics::quantile;
use fieldwalk::pedestrian::StepEvent;
use fieldwalk::step::{StepCycle, StepDetector as _, StepLengthModel, WilaStepDetector, WilaStepParams};
use fieldwalk::time::Timestamp;
use fieldwalk_sim::scenario::{Recorded, Scenario, Walk};
use fieldwalk_sim::walker::{Course, Gait, WalkerProfile};

use crate::plot::{Chart, Series};
use crate::reproduce::estimate::mean_of;
use crate::reproduce::{Estimate, Experiment, Finding, Findings, Picture, Run};

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment { name: "steps", claims: &["wila-steps"], is_timed: false, run: steps },
    Experiment { name: "thirty metres", claims: &["wila-distance"], is_timed: false, run: distance },
    Experiment { name: "right angles", claims: &["wila-turns"], is_timed: false, run: turns },
    Experiment { name: "half a circle", claims: &["wila-bend"], is_timed: false, run: bend },
];

const N_WALKERS: u64 = 10;
/// A walker's slow, usual and fast pace, over the usual one.
///
/// # Source
/// Ours; the paper says low, normal and high.
const PACES: [f64; 3] = [0.65, 1.0, 1.35];

/// What the wearable makes of the vertical motion of a walker's waist, read 50 times a second.
fn cycles(gait: &Gait) -> Vec<StepCycle> {
    const H_S: f64 = 1.0 / 512.0;
    let height_m = |t: f64| {
        let body = gait.body(t);
        body.height_m + body.offset_m[2] + body.bounced_m() + body.jolt_m[2]
    };
    let mut detector = WilaStepDetector::new(WilaStepParams::default());
    let readings = (0..(50.0 * gait.duration_s()) as i64).filter_map(|k| {
        let t = k as f64 / 50.0;
        let up = (height_m(t - H_S) - 2.0 * height_m(t) + height_m(t + H_S)) / (H_S * H_S);
        let force = [0.0, 0.0, STANDARD_GRAVITY_M_S2 + up as f32];
        detector.push(Timestamp::from_millis(20 * k), force).map(|finding| finding.cycle)
    });
    readings.collect()
}

fn straight(walker: &WalkerProfile, pace: f64, length_m: f64, seed: u64) -> Gait {
    let walker = WalkerProfile { speed_m_s: pace * walker.speed_m_s, ..*walker };
    Gait::new(&walker, Course::new(&[Point2::new(0.0, 0.0), Point2::new(0.0, length_m)]), &[], 3.0, seed)
}

fn worst(values: impl Iterator<Item = f64>) -> Estimate {
    let worst = values.fold(f64::NEG_INFINITY, f64::max);
    Estimate { value: worst, low: f64::NAN, high: f64::NAN }
}

/// Number of the steps made, by the rising times of their middles, that have no peak of their own among those found: a step
/// found twice makes up for no other.
///
/// Peaks lie elsewhere in a step than its middle, all by about as much: the median is taken off first.
fn n_missed(made_s: &[f64], found_s: &[f64]) -> usize {
    let [Some(&first_s), Some(&last_s)] = [made_s.first(), made_s.last()] else { return 0 };
    let period_s = (last_s - first_s) / (made_s.len() - 1).max(1) as f64;
    let nearest_s = |found_s: &f64| {
        made_s.iter().map(|made_s| found_s - made_s).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    };
    let lag_s = median(found_s.iter().map(nearest_s).collect());
    let mut found = found_s.iter().map(|found_s| found_s - lag_s).peekable();
    let is_missed = |made_s: &&f64| {
        // A step takes the first found near it that no step before took.
        while found.next_if(|found_s| *found_s < **made_s - 0.5 * period_s).is_some() {}
        found.next_if(|found_s| *found_s <= **made_s + 0.5 * period_s).is_none()
    };
    made_s.iter().filter(is_missed).count()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    if values.is_empty() { 0.0 } else { quantile(&values, 0.5) }
}

/// Table 2: fifty steps at three paces; the worst of all walkers.
fn steps(run: &Run) -> Findings {
    let missed = run.per_seed(N_WALKERS, |seed| {
        let walker = WalkerProfile::drawn(seed);
        PACES.map(|pace| {
            let length_m = 49.5 * walker.step_length_m(pace * walker.speed_m_s);
            let gait = straight(&walker, pace, length_m, seed);
            let made_s: Vec<f64> = gait.steps().iter().map(|s| 0.5 * (s.start_s + s.end_s)).collect();
            let peak_s = |cycle: &StepCycle| cycle.end.secs_since(Timestamp::default());
            let found_s: Vec<f64> = cycles(&gait).iter().map(peak_s).collect();
            n_missed(&made_s, &found_s) as f64
        })
    });
    let estimates: Vec<Estimate> = (0..3).map(|k| worst(missed.iter().map(|missed| missed[k]))).collect();
    Findings::default().with(Finding::new("wila-steps", missed.len(), estimates))
}

/// Table 3: thirty metres at three paces, `K` trained on another walk of thirty at the usual one; the worst of all.
fn distance(run: &Run) -> Findings {
    let model = StepLengthModel::Weinberg { k_m: 0.45 };
    let walked_m = |model: &StepLengthModel, gait: &Gait| {
        cycles(gait).iter().map(|cycle| model.advance_m(cycle)).sum::<f32>()
    };
    let errors = run.per_seed(N_WALKERS, |seed| {
        let walker = WalkerProfile::drawn(seed);
        let trained = model.trained(30.0, walked_m(&model, &straight(&walker, 1.0, 30.0, 100 + seed)));
        PACES.map(|pace| {
            let walked_m = walked_m(&trained, &straight(&walker, pace, 30.0, 200 + seed));
            100.0 * f64::from(walked_m / 30.0 - 1.0)
        })
    });
    let worst = worst(errors.iter().flatten().map(|percent| percent.abs()));
    Findings::default().with(
        Finding::new("wila-distance", errors.len(), [worst])
            .because("the fourth root follows a walker's pace only about: fast walks come out short"),
    )
}

/// A walk over the open hall, by a device that keeps its place on the body, and what the front end makes of it.
fn walked(path: Vec<Point2>, seed: u64) -> Option<(Recorded, Vec<StepEvent>)> {
    let hall = Scenario::named("hall", seed)?;
    let walk = Walk { walker: WalkerProfile::drawn(seed), ..Walk::along("wila", path, seed) };
    let recorded = hall.simulate(&walk);
    let mut waist = WaistFrontEnd::default();
    let events = recorded.samples.iter().filter_map(|sample| waist.push(sample)).collect();
    Some((recorded, events))
}

/// The mean of headings, the short way round.
fn mean_heading_rad(headings: &[f64]) -> f64 {
    let sum = |part: fn(f64) -> f64| headings.iter().map(|&heading| part(heading)).sum::<f64>();
    sum(f64::sin).atan2(sum(f64::cos))
}

/// Fig. 7: ten right angles, five steps apart; a turn is seen when the mean headings on both sides of it differ by a right
/// angle to 15°.
fn turns(run: &Run) -> Findings {
    const N_TURNS: usize = 10;
    let seen = run.per_seed(N_WALKERS, |seed| {
        let walker = WalkerProfile::drawn(seed);
        let leg_m = 5.0 * walker.step_length_m(walker.speed_m_s);
        let corner = |k: usize| {
            let (x, y) = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)][k % 4];
            Point2::new(20.0 + leg_m * x, 15.0 + leg_m * y)
        };
        let path: Vec<Point2> = (0..N_TURNS + 2).map(corner).collect();
        let Some((recorded, events)) = walked(path.clone(), seed) else { return f64::NAN };
        let mut legs = vec![Vec::new(); N_TURNS + 1];
        let mut leg = 0;
        for event in &events {
            let at = event.cycle.start.midpoint(event.cycle.end);
            let Some(truth) = recorded.truth_at(at) else { continue };
            let ahead_rad = |leg: usize| (path[leg + 1] - path[leg]).heading_rad();
            while leg < N_TURNS && truth.position.distance_m(path[leg + 1]) < 0.25 * leg_m {
                leg += 1;
            }
            // Round a corner a step belongs to neither side.
            if wrap_rad(truth.heading_rad - ahead_rad(leg)).abs() < 0.3 {
                legs[leg].push(f64::from(event.level_heading_rad));
            }
        }
        let means: Vec<f64> = legs.iter().map(|headings| mean_heading_rad(headings)).collect();
        let is_seen = |pair: &&[f64]| {
            let off = wrap_rad(pair[1] - pair[0]) - std::f64::consts::FRAC_PI_2;
            off.abs() <= 15f64.to_radians()
        };
        means.windows(2).filter(is_seen).count() as f64
    });
    Findings::default().with(
        Finding::new("wila-turns", seen.len(), [Estimate::mean(&seen)]).because(
            "a walker rounds corners five steps apart, and the compass is drawn by steel between them",
        ),
    )
}

/// Fig. 8: half a circle of 20 m; the turn from its first steps to its last against the truth.
fn bend(run: &Run) -> Findings {
    const RADIUS_M: f64 = 10.0;
    let runs = run.per_seed(N_WALKERS, |seed| {
        let path = (0..=36).map(|k| {
            let angle_rad = std::f64::consts::PI * f64::from(k) / 36.0;
            Point2::new(25.0, 15.0) + Point2::from_polar(RADIUS_M, angle_rad - std::f64::consts::FRAC_PI_2)
        });
        let Some((recorded, events)) = walked(path.collect(), seed) else { return (f64::NAN, Vec::new()) };
        let mut turned_deg = Vec::new();
        let mut sums = [0.0; 2];
        for pair in events.windows(2) {
            let at = |event: &StepEvent| event.cycle.start.midpoint(event.cycle.end);
            let truths = [0, 1].map(|k| recorded.truth_at(at(&pair[k])).map(|truth| truth.heading_rad));
            let [Some(before), Some(after)] = truths else { continue };
            sums[0] += wrap_rad(f64::from(pair[1].level_heading_rad) - f64::from(pair[0].level_heading_rad));
            sums[1] += wrap_rad(after - before);
            turned_deg.push((turned_deg.len() as f64, f64::to_degrees(sums[0])));
        }
        ((sums[0] - sums[1]).abs().to_degrees(), turned_deg)
    });
    let errors_deg: Vec<f64> = runs.iter().map(|(error, _)| *error).collect();
    let mut chart = Chart::new("Half a circle", "step", "turned (°)");
    for (k, (_, turned)) in runs.iter().take(3).enumerate() {
        chart = chart.with(Series::line(["one walker", "another", "a third"][k], turned.clone()));
    }
    Findings::default()
        .with(Finding::new("wila-bend", errors_deg.len(), [Estimate::mean(&errors_deg)]))
        .with_picture(Picture::of(
            format!("Mean error {:.1}° over {} walkers.", mean_of(&errors_deg), errors_deg.len()),
            chart.to_svg(),
        ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_found_twice_makes_up_for_none_that_is_missed() {
        let made_s: Vec<f64> = (0..10).map(f64::from).collect();
        // All peaks lie 0.3 s after the middles, the fourth is missing, and the eighth is there twice.
        let mut found_s: Vec<f64> = made_s.iter().map(|s| s + 0.3).collect();
        assert_eq!(n_missed(&made_s, &found_s), 0);
        found_s.remove(3);
        found_s.insert(7, 7.4);
        assert_eq!((found_s.len(), n_missed(&made_s, &found_s)), (10, 1));
        assert_eq!((n_missed(&made_s, &[]), n_missed(&[], &found_s)), (10, 0));
    }
}
