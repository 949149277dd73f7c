//! The time of a step: the mass-centred weight beside dynamic time warping of all that a magnetometer reads in it.

use std::hint::black_box;
use std::time::Instant;

use fieldwalk::geometry::Point2;
use fieldwalk::magnetic::feature::LevelField;
use fieldwalk::observation::history::dynamic_time_warping_ut;
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams, StepEvent};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::system::{MagneticRule, Recipe};
use fieldwalk::tracker::Tracker;

use super::office;
use crate::plot::{Rows, Shape};
use crate::reproduce::estimate::{mean_of, quantile_of};
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run, test_bed};

/// Particles, here alone.
///
/// # Source
/// Mass-centred 2019, the text about Fig. 28.
const N_PARTICLES: usize = 300;
/// Measured so often.
const N_REPEATS: usize = 7;
/// Steps of each repeat.
const N_STEPS: usize = 60;

/// A step with all strengths that were read in it, in µT.
struct ReadStep {
    event: StepEvent,
    strengths_ut: Vec<f32>,
}

/// The steps of `samples`; the phone reads the field a hundred times a second, as in the paper.
fn steps(samples: &[Sample]) -> Vec<ReadStep> {
    let mut pedestrian = Pedestrian::new(PedestrianParams::default());
    let mut reads: Vec<(fieldwalk::time::Timestamp, f32)> = Vec::new();
    let mut steps = Vec::new();
    for sample in samples {
        if let Reading::UncalibratedMagneticField { field_ut, bias_ut } = sample.reading {
            let field_ut = [0, 1, 2].map(|c| field_ut[c] - bias_ut[c]);
            reads.push((sample.time, LevelField { field_ut }.strength_ut()));
        }
        if let Some(event) = pedestrian.push(sample) {
            let within = |time| event.cycle.start < time && time <= event.cycle.end;
            let strengths_ut = reads.iter().filter(|read| within(read.0)).map(|read| read.1).collect();
            steps.push(ReadStep { event, strengths_ut });
        }
    }
    steps.retain(|step| step.strengths_ut.len() > 10);
    steps.truncate(N_STEPS);
    steps
}

/// Median time of a step of `recipe`, in ms; `also` is done with the particles, from before the step and after it.
fn step_ms(
    office: &Surveyed,
    recipe: &Recipe,
    start: Point2,
    steps: &[ReadStep],
    mut also: impl FnMut(&ReadStep, &[[f32; 2]], &Tracker),
) -> f64 {
    let recipe = Recipe { n_particles: N_PARTICLES, ..recipe.clone() };
    let mut tracker = Tracker::new(recipe, office.floor.clone(), 1);
    tracker.place(start, 2.0);
    let places = |tracker: &Tracker| -> Vec<[f32; 2]> {
        let particles = tracker.particles();
        particles.x_m.iter().zip(&particles.y_m).map(|(&x_m, &y_m)| [x_m, y_m]).collect()
    };
    let times_ms = steps.iter().map(|step| {
        let before = places(&tracker);
        let began = Instant::now();
        tracker.step(&step.event, &[]);
        also(step, &before, &tracker);
        1e3 * began.elapsed().as_secs_f64()
    });
    quantile_of(times_ms.collect::<Vec<_>>(), 0.5)
}

/// Warps what every particle would have read along its move, a reading for each of the step's, onto what was read.
fn warp(step: &ReadStep, before: &[[f32; 2]], tracker: &Tracker) {
    let floor = tracker.floor();
    let strengths = &floor.map().layers.strength_ut;
    let particles = tracker.particles();
    let n = step.strengths_ut.len();
    let mut along_ut = vec![0.0; n];
    for (from, to) in before.iter().zip(particles.x_m.iter().zip(&particles.y_m)) {
        for (k, read_ut) in along_ut.iter_mut().enumerate() {
            let share = (k + 1) as f32 / n as f32;
            let (x_m, y_m) = (from[0] + share * (to.0 - from[0]), from[1] + share * (to.1 - from[1]));
            *read_ut = floor.layer(strengths, x_m, y_m).unwrap_or(0.0);
        }
        black_box(dynamic_time_warping_ut(&along_ut, &step.strengths_ut, None));
    }
}

/// Times both on one walk.
pub fn run(_run: &Run) -> Findings {
    let office = office::surveyed(test_bed::mass_centered_office(1), 1);
    let recorded = office::walks(&office.scenario, 1).first().map(|walk| office.scenario.simulate(walk));
    let Some(recorded) = recorded else { return Findings::default() };
    let steps = steps(&recorded.samples);
    let start = recorded.truth.first().map_or(Point2::default(), |truth| truth.position);
    let mass_centered = Recipe::mass_centered();
    let warped = Recipe { magnetic: MagneticRule::Ignore, ..mass_centered.clone() };
    let (ours_ms, warped_ms): (Vec<f64>, Vec<f64>) = (0..N_REPEATS)
        .map(|_| {
            let ours_ms = step_ms(&office, &mass_centered, start, &steps, |_, _, _| {});
            (ours_ms, step_ms(&office, &warped, start, &steps, warp))
        })
        .unzip();
    let ratios: Vec<f64> = warped_ms.iter().zip(&ours_ms).map(|(warped, ours)| warped / ours).collect();
    let bars = Rows::new("Time of a step, 300 particles", "ms")
        .with("mass-centred", Shape::Bar(mean_of(&ours_ms)))
        .with("time warping", Shape::Bar(mean_of(&warped_ms)));
    Findings::default().with(Finding::new("mc-time", 1, [Estimate::mean(&ratios)])).with_picture(
        Picture::of(
            "All that a magnetometer at 100 Hz reads in a step, warped for each particle, and the mass-centred weight.",
            bars.to_svg(),
        ),
    )
}
