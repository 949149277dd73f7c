//! The magnetic field along walks: simulated scenarios beside the mall's floors.

use std::error::Error;
use std::f64::consts::TAU;

use fieldwalk::geometry::Point2;
use fieldwalk::survey::{SurveyTrack, SurveyWalk};
use fieldwalk::time::Timestamp;
use fieldwalk_cli::plot::{Chart, Series};
use fieldwalk_cli::walks::ReadWalk;
use fieldwalk_formats::ilc::Floor;
use fieldwalk_sim::scenario::Scenario;
use fieldwalk_tests::recordings::ilc_floor;
use rayon::prelude::*;

use crate::page::Page;
use crate::spread::{Spread, boxes, mean, sd};

/// Distance of points to which a walk's field is interpolated, in metres.
const SPACING_M: f64 = 0.25;
/// Two steps are at one place when they are this near, in metres.
const NEAR_M: f64 = 0.5;

/// The field along one walk: where each step ended, metres along the walk, and µT.
struct Along {
    steps: Vec<(Point2, f64, f64)>,
}

impl Along {
    fn of(walk: &SurveyWalk) -> Option<Self> {
        Self::moved(walk, |_, position| position)
    }

    /// The same with every place moved by `place`, given its time.
    fn moved(walk: &SurveyWalk, place: impl Fn(Timestamp, Point2) -> Point2) -> Option<Self> {
        let track = SurveyTrack::of(walk)?;
        let (mut steps, mut at_m, mut last) = (Vec::new(), 0.0, None::<Point2>);
        for step in track.steps() {
            let Some(position) = track.position(step.event.cycle.end) else { continue };
            at_m += last.map_or(0.0, |last: Point2| last.distance_m(position));
            last = Some(position);
            if let Some(strength_ut) = step.event.end_strength_ut {
                steps.push((place(step.event.cycle.end, position), at_m, f64::from(strength_ut)));
            }
        }
        (at_m > 15.0 && steps.len() > 20).then_some(Self { steps })
    }

    fn strengths_ut(&self) -> Vec<f64> {
        self.steps.iter().map(|step| step.2).collect()
    }

    /// The strength at even distances, about its mean.
    fn even_ut(&self) -> Vec<f64> {
        let length_m = self.steps.last().map_or(0.0, |step| step.1);
        let at = |k: usize| {
            let at_m = k as f64 * SPACING_M;
            let next = self.steps.partition_point(|step| step.1 <= at_m).clamp(1, self.steps.len() - 1);
            let (from, to) = (&self.steps[next - 1], &self.steps[next]);
            let share = if to.1 > from.1 { ((at_m - from.1) / (to.1 - from.1)).clamp(0.0, 1.0) } else { 0.0 };
            from.2 + share * (to.2 - from.2)
        };
        let values: Vec<f64> = (0..(length_m / SPACING_M) as usize).map(at).collect();
        let middle = mean(values.iter().copied());
        values.into_iter().map(|value| value - middle).collect()
    }

    /// The correlation of the strength with itself so many spacings further on.
    fn correlation(&self, lag: usize) -> f64 {
        let values = self.even_ut();
        if values.len() < 2 * lag + 4 {
            return f64::NAN;
        }
        let zero = mean(values.iter().map(|v| v * v));
        mean(values.iter().zip(&values[lag..]).map(|(a, b)| a * b)) / zero
    }

    /// The spatial frequency under which 98 of 100 parts of the strength's energy lie, in cycles per metre.
    fn cycles_per_m(&self) -> f64 {
        let values = self.even_ut();
        let n = values.len();
        let energy: Vec<f64> = (1..=n / 2)
            .map(|k| {
                let (mut re, mut im) = (0.0, 0.0);
                for (i, value) in values.iter().enumerate() {
                    let window = 0.5 - 0.5 * libm::cos(TAU * (i as f64 + 0.5) / n as f64);
                    let (sin, cos) = libm::sincos(TAU * (k * i % n) as f64 / n as f64);
                    re += window * value * cos;
                    im += window * value * sin;
                }
                re * re + im * im
            })
            .collect();
        let all: f64 = energy.iter().sum();
        let mut sum = 0.0;
        let reached = energy.iter().position(|part| {
            sum += part;
            sum >= 0.98 * all
        });
        reached.map_or(f64::NAN, |k| (k + 1) as f64 / (n as f64 * SPACING_M))
    }

    /// How much two walks differ where they meet, after their mean difference is taken off, and that mean, in µT.
    fn differs_ut(&self, other: &Self) -> Option<(f64, f64)> {
        let differences: Vec<f64> = self
            .steps
            .iter()
            .filter_map(|(here, _, strength_ut)| {
                let near = |a: &&(Point2, f64, f64), b: &&(Point2, f64, f64)| {
                    here.distance_m(a.0).total_cmp(&here.distance_m(b.0))
                };
                let nearest = other.steps.iter().min_by(near)?;
                (here.distance_m(nearest.0) < NEAR_M).then(|| strength_ut - nearest.2)
            })
            .collect();
        (differences.len() >= 15).then(|| (sd(&differences), mean(differences.iter().copied()).abs()))
    }
}

fn mall(floor: &str) -> Result<Vec<Along>, Box<dyn Error>> {
    let Some(folder) = ilc_floor(floor) else { return Ok(Vec::new()) };
    let read = |path: std::path::PathBuf| Ok(Along::of(&ReadWalk::open(&path, None)?.walk));
    let walks: Result<Vec<_>, fieldwalk_formats::FormatError> =
        Floor::open(&folder)?.traces.into_par_iter().map(read).collect();
    Ok(walks?.into_iter().flatten().collect())
}

/// Walks as people take them, which the scenario's survey marks as a survey would.
fn simulated(name: &str) -> Vec<Along> {
    let mut all = Vec::new();
    for seed in 1..=2 {
        let Some(scenario) = Scenario::named(name, seed) else { continue };
        let walks = scenario.test_walks(20, 60.0);
        // Walks in different buildings and on different floors do not meet: each is put in a place of its own.
        let along = |walk| {
            let recorded = scenario.simulate(&walk);
            Along::moved(&recorded.survey_walk(), |time, position| {
                let floor = recorded.truth_at(time).map_or(0, |truth| truth.floor);
                position + Point2::new(1_000.0 * seed as f64, 1_000.0 * f64::from(floor))
            })
        };
        let made: Vec<Option<Along>> = walks.into_par_iter().map(along).collect();
        all.extend(made.into_iter().flatten());
    }
    all
}

pub fn write(page: &mut Page) -> Result<(), Box<dyn Error>> {
    page.heading("Magnetic field");
    page.say(
        "The strength at the end of each step, from phones as they are held, uncorrected for their own iron. Real: four floors \
         of a mall (indoor-location-competition-20), walks placed by their waypoints and steps. Simulated: walks by chance \
         in named scenarios, two buildings each, placed in the same way. *Again* compares two walks over one place: what \
         differs after the mean difference of the two is taken off, and that mean. The mass-centred paper prints anomalies \
         of 10 to 20 µT in an office, and 98 % of the energy below 0.765 samples a metre.",
    );
    let mut groups: Vec<(String, bool, Vec<Along>)> = Vec::new();
    for floor in ["F1", "F2", "F3", "F4"] {
        groups.push((format!("mall, {floor}"), true, mall(floor)?));
    }
    for name in Scenario::NAMES {
        groups.push((name.into(), false, simulated(name)));
    }
    groups.retain(|group| !group.2.is_empty());
    let head = [
        "",
        "walks",
        "spread along a walk (µT)",
        "again: what differs (µT)",
        "again: mean difference (µT)",
        "98 % of the energy below (cycles/m)",
        "correlation 1 m on",
        "5 m on",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    let (mut along_ut, mut again_ut) = (Vec::new(), Vec::new());
    let mut chart = Chart::new("Correlation of the strength along a walk", "distance (m)", "correlation");
    for (name, is_real, walks) in &groups {
        let spread = |values: Vec<f64>| Spread::new(name.clone(), *is_real, values);
        let pairs: Vec<(f64, f64)> = (0..walks.len())
            .into_par_iter()
            .flat_map_iter(|i| (0..i).filter_map(move |j| walks[i].differs_ut(&walks[j])))
            .collect();
        let sds = spread(walks.iter().map(|walk| sd(&walk.strengths_ut())).collect());
        let again = spread(pairs.iter().map(|pair| pair.0).collect());
        let apart = spread(pairs.iter().map(|pair| pair.1).collect());
        let cycles = spread(walks.iter().map(Along::cycles_per_m).collect());
        let correlation = |lag: usize| spread(walks.iter().map(|walk| walk.correlation(lag)).collect());
        rows.push(vec![
            format!("{}{name}", if *is_real { "**real** " } else { "" }),
            walks.len().to_string(),
            sds.text(),
            again.text(),
            apart.text(),
            format!("{:.2}", cycles.quantile(0.5)),
            format!("{:.2}", correlation(4).quantile(0.5)),
            format!("{:.2}", correlation(20).quantile(0.5)),
        ]);
        if ["mall, F1", "office", "hall", "mall"].contains(&name.as_str()) {
            let line = (0..=40).map(|lag| (SPACING_M * lag as f64, correlation(lag).quantile(0.5))).collect();
            let kind = if *is_real { "real" } else { "simulated" };
            chart = chart.with(Series::line(format!("{kind}: {name}"), line));
        }
        along_ut.push(sds);
        again_ut.push(again);
    }
    page.table(&rows);
    let svg = boxes("Spread of the strength along a walk", "standard deviation (µT)", &along_ut);
    page.picture("field-along", "spread of the strength along a walk", &svg)?;
    let svg = boxes("Two walks over one place, their means taken off", "standard deviation (µT)", &again_ut);
    page.picture("field-again", "difference of two walks over one place", &svg)?;
    page.picture("field-correlation", "correlation of the strength along a walk", &chart.to_svg())?;
    page.say(
        "One value a step resolves half a cycle a step, about 0.75 cycles a metre; what is finer is not seen \
         here. Stairs lead past the beams of the floor above, and the two flights between the storeys of `two- \
         floors` lie over each other.",
    );
    Ok(())
}
