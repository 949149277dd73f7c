//! Gait: simulated walks beside the Oxford collection and the mall's.

use std::collections::BTreeMap;
use std::error::Error;

use fieldwalk::sensor::Sample;
use fieldwalk::survey::Waypoint;
use fieldwalk_cli::plot::{Chart, Series};
use fieldwalk_cli::walks::ReadWalk;
use fieldwalk_formats::ilc::Floor;
use fieldwalk_formats::oxford_steps::{AccelerometerReader, Placement, find_runs};
use fieldwalk_formats::recording::Record;
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_sim::scenario::{Scenario, Walk};
use fieldwalk_tests::recordings::{collection, ilc_floor};
use rayon::prelude::*;

use crate::motion::{Force, HARMONICS, Walking};
use crate::page::Page;
use crate::spread::{Spread, boxes, mean};

/// Simulated ways to carry beside the collection's placements.
const ALIKE: [(Placement, CarryMode, &str); 4] = [
    (Placement::InHand, CarryMode::HeldLevel, "in hand"),
    (Placement::FrontPocket, CarryMode::FrontPocket, "front pocket"),
    (Placement::BackPocket, CarryMode::BackPocket, "back pocket"),
    (Placement::SwingingArm, CarryMode::SwingingHand, "swinging arm"),
];

/// Walks of the office by 24 people who carry the phone so.
pub fn simulated(mode: CarryMode) -> Vec<(Vec<Sample>, Vec<Waypoint>)> {
    let office = Scenario::office(1);
    let walks: Vec<Walk> = office.test_walks(24, 90.0);
    let record = |walk: Walk| {
        let recorded = office.simulate(&Walk { carrying: vec![(0.0, mode)], ..walk });
        (recorded.samples, recorded.waypoints)
    };
    walks.into_par_iter().map(record).collect()
}

/// Walks, each by its windows of ten seconds.
type Walks = Vec<Vec<Walking>>;
/// A quantity's name, and where it is read.
type Quantity<T> = (&'static str, fn(&T) -> f64);

/// A straight stretch between two waypoints: its step length in metres, and the gait.
struct Stretch {
    length_m: f64,
    walking: Walking,
}

fn stretches(samples: &[Sample], waypoints: &[Waypoint]) -> Vec<Stretch> {
    let Some(force) = Force::of(samples) else { return Vec::new() };
    let stretch = |pair: &[Waypoint]| {
        let (far_m, long_s) =
            (pair[0].point.distance_m(pair[1].point), pair[1].time.secs_since(pair[0].time));
        if far_m < 6.0 || long_s < 5.0 {
            return None;
        }
        let walking = Walking::of(force.between(pair[0].time, pair[1].time))?;
        Some(Stretch { length_m: far_m / (walking.step_hz * long_s), walking })
    };
    waypoints.windows(2).filter_map(stretch).filter(|s| (0.35..1.0).contains(&s.length_m)).collect()
}

fn real_stretches() -> Result<Vec<Stretch>, Box<dyn Error>> {
    let mut paths = Vec::new();
    for floor in ["F1", "F2"] {
        if let Some(folder) = ilc_floor(floor) {
            paths.extend(Floor::open(&folder)?.traces.into_iter().step_by(2));
        }
    }
    let read = |path: std::path::PathBuf| {
        let mut samples = Vec::new();
        let walk = ReadWalk::open_with(&path, None, |record| {
            if let Record::Sample(sample) = record {
                samples.push(*sample);
            }
        })?;
        Ok::<_, fieldwalk_formats::FormatError>(stretches(&samples, walk.walk.waypoints()))
    };
    let read: Result<Vec<_>, _> = paths.into_par_iter().map(read).collect();
    Ok(read?.into_iter().flatten().collect())
}

fn oxford() -> Result<BTreeMap<Placement, Walks>, Box<dyn Error>> {
    let mut placements: BTreeMap<Placement, Walks> = BTreeMap::new();
    let Some(folder) = collection("oxford-steps") else { return Ok(placements) };
    for run in find_runs(&folder)? {
        let file = run.accelerometer();
        if !file.is_file() {
            continue;
        }
        let samples: Result<Vec<Sample>, _> = AccelerometerReader::open(&file)?.collect();
        let windows = Force::of(&samples?).map(|force| force.windows()).unwrap_or_default();
        placements.entry(run.placement).or_default().push(windows);
    }
    Ok(placements)
}

/// One value a walk: the median over its windows.
fn by_walk(walks: &[Vec<Walking>], value: impl Fn(&Walking) -> f64) -> Vec<f64> {
    let median = |walk: &Vec<Walking>| Spread::new("", true, walk.iter().map(&value).collect()).quantile(0.5);
    walks.iter().filter(|walk| !walk.is_empty()).map(median).collect()
}

pub fn write(page: &mut Page) -> Result<(), Box<dyn Error>> {
    page.heading("Gait");
    let real = oxford()?;
    let none = Vec::new();
    let mut compared = Vec::new();
    for (placement, mode, name) in ALIKE {
        let made: Walks = simulated(mode)
            .into_par_iter()
            .filter_map(|(samples, _)| Some(Force::of(&samples)?.windows()))
            .collect();
        compared.push((name, real.get(&placement).unwrap_or(&none), made));
    }
    let pouch = real.get(&Placement::NeckPouch).unwrap_or(&none);
    page.say(
        "By placement, beside the Oxford collection (a handful of people, at a brisk pace; a \
         walk gives one value, the median of its windows of ten seconds). Amplitudes are those of the vertical acceleration \
         at multiples of the step frequency. Horizontal acceleration counts what the phone's tilting adds.",
    );
    let values: [Quantity<Walking>; 7] = [
        ("step frequency (Hz)", |w| w.step_hz),
        ("vertical acceleration, rms (m/s²)", |w| w.vertical_rms),
        ("horizontal acceleration, rms (m/s²)", |w| w.horizontal_rms),
        ("amplitude at the step (m/s²)", |w| w.amplitudes[1]),
        ("amplitude at twice the step over it", |w| w.amplitudes[3] / w.amplitudes[1]),
        ("step regularity", |w| w.step_regularity),
        ("stride regularity", |w| w.stride_regularity),
    ];
    let head = ["", "placement", "real", "simulated"].map(String::from).to_vec();
    let mut rows = vec![head];
    for (quantity, value) in values {
        for (name, real, made) in &compared {
            let (real, made) = (
                Spread::new(*name, true, by_walk(real, value)),
                Spread::new(*name, false, by_walk(made, value)),
            );
            let real = if real.values.is_empty() { "–".into() } else { real.text() };
            rows.push(vec![quantity.into(), (*name).into(), real, made.text()]);
        }
    }
    page.table(&rows);
    let mut spreads = Vec::new();
    for (name, real, made) in &compared {
        spreads.push(Spread::new(*name, true, by_walk(real, |w| w.vertical_rms)));
        spreads.push(Spread::new(*name, false, by_walk(made, |w| w.vertical_rms)));
    }
    spreads.push(Spread::new("neck pouch (the trunk)", true, by_walk(pouch, |w| w.vertical_rms)));
    spreads.retain(|spread| !spread.values.is_empty());
    let svg = boxes("Vertical acceleration by placement", "root mean square (m/s²)", &spreads);
    page.picture("vertical-acceleration", "vertical acceleration by placement", &svg)?;
    spectra(page, &compared)?;
    lengths(page)?;
    page.say(
        "The surveyors of the mall lift the phone higher than walkers elsewhere: about twice what the pendulum gives \
         a trunk at their step length. The walker under motion capture equals the pendulum; Oxford's walkers reach half \
         to one and a half of what it gives a usual step at their frequency. The simulated population (a trunk of \
         0.73 to 1.53 times the pendulum, an arm that resonates between 2.6 and 6 Hz) lies between. Simulated strides \
         are as regular as the mall's, and more so than Oxford's.",
    );
    Ok(())
}

fn spectra(page: &mut Page, compared: &[(&str, &Walks, Walks)]) -> Result<(), Box<dyn Error>> {
    let mean_spectrum = |walks: &[Vec<Walking>]| -> Vec<(f64, f64)> {
        let n = walks.iter().flatten().map(|w| w.spectrum.len()).min().unwrap_or(0);
        let at = |k: usize| {
            let multiple = 0.05 * (k + 4) as f64;
            (
                multiple,
                mean(walks.iter().filter(|w| !w.is_empty()).map(|w| mean(w.iter().map(|w| w.spectrum[k])))),
            )
        };
        (0..n).map(at).collect()
    };
    for (name, real, made) in compared.iter().take(2) {
        let title = format!("Spectrum of the vertical acceleration, {name}");
        let chart = Chart::new(title, "multiples of the step frequency", "amplitude (m/s²)")
            .with(Series::line("real", mean_spectrum(real)))
            .with(Series::line("simulated", mean_spectrum(made)));
        let file = format!("spectrum-{}", name.replace(' ', "-"));
        page.picture(&file, &format!("spectrum, {name}"), &chart.to_svg())?;
    }
    Ok(())
}

fn lengths(page: &mut Page) -> Result<(), Box<dyn Error>> {
    let real = real_stretches()?;
    let made: Vec<Stretch> = simulated(CarryMode::HeldLevel)
        .iter()
        .flat_map(|(samples, waypoints)| stretches(samples, waypoints))
        .collect();
    page.say(
        "How amplitude, frequency and step length go together, phone in hand: stretches of at least 6 m between two \
         waypoints, in the mall (indoor-location-competition-20, floors F1 and F2; a few surveyors) and in the simulated \
         office.",
    );
    let values: [Quantity<Stretch>; 9] = [
        ("step frequency (Hz)", |s| s.walking.step_hz),
        ("step length (m)", |s| s.length_m),
        ("amplitude at the step (m/s²)", |s| s.walking.amplitudes[1]),
        ("amplitude at half the step (m/s²)", |s| s.walking.amplitudes[0]),
        ("amplitude at twice the step (m/s²)", |s| s.walking.amplitudes[3]),
        ("amplitude at four times the step (m/s²)", |s| s.walking.amplitudes[HARMONICS.len() - 1]),
        ("half the rise of the phone in a step (mm)", half_rise_mm),
        ("horizontal acceleration, rms (m/s²)", |s| s.walking.horizontal_rms),
        ("stride regularity", |s| s.walking.stride_regularity),
    ];
    let mut rows = vec![["", "mall", "simulated office"].map(String::from).to_vec()];
    for (quantity, value) in values {
        let text = |stretches: &[Stretch], is_real| {
            Spread::new("", is_real, stretches.iter().map(value).collect()).text()
        };
        rows.push(vec![quantity.into(), text(&real, true), text(&made, false)]);
    }
    page.table(&rows);
    let dots = |name: &str, stretches: &[Stretch]| {
        Series::dots(name, stretches.iter().map(|s| (s.length_m, half_rise_mm(s))).collect())
    };
    let law = (0..=12).map(|k| {
        let length_m = 0.35 + 0.05 * f64::from(k);
        (length_m, 1e3 * 0.5 * (0.4 * length_m) * (0.4 * length_m) / (2.0 * 0.53 * 1.72))
    });
    let chart = Chart::new("Rise of the phone by step length", "step length (m)", "half the rise (mm)")
        .with(dots("mall", &real))
        .with(dots("simulated", &made))
        .with(Series::line("pendulum of the trunk (Zijlstra and Hof 2003)", law.collect()))
        .y_up_to(80.0);
    page.picture("rise-by-length", "rise of the phone by step length", &chart.to_svg())?;
    Ok(())
}

/// From the amplitude of the acceleration at the step.
fn half_rise_mm(stretch: &Stretch) -> f64 {
    let rad_s = std::f64::consts::TAU * stretch.walking.step_hz;
    1e3 * stretch.walking.amplitudes[1] / (rad_s * rad_s)
}
