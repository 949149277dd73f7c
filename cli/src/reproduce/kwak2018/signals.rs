//! The field along a walk by itself: at several rates, and on several devices.

use fieldwalk::geometry::Point2;
use fieldwalk::gravity::{LevelEstimator, LevelParams};
use fieldwalk::sensor::Reading;
use fieldwalk_sim::phone::PhoneModel;
use fieldwalk_sim::scenario::{Scenario, Walk};

use crate::plot::{Chart, Series};
use crate::reproduce::estimate::mean_of;
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run, test_bed};

const N_SEEDS: u64 = 12;
/// Trajectories of the office that are walked.
const TRAJECTORIES: [usize; 3] = [0, 2, 4];
/// The rate that others are set against, and those, in Hz.
///
/// # Source
/// Kwak 2018, Fig. 4.
const FULL_HZ: f64 = 50.0;
const RATES_HZ: [f64; 3] = [3.0, 1.0, 0.5];
/// Devices whose readings are compared.
///
/// # Source
/// Kwak 2018, Fig. 1: three.
const N_DEVICES: u64 = 3;
/// The first seconds and the last are standing.
const STANDING_S: f64 = 2.0;

/// `B_h` and `B_v` of a walk along `path` in µT, read at [`FULL_HZ`] by `device`, as its sensor gives the field or with
/// the operating system's first bias taken off.
fn features(scenario: &Scenario, path: Vec<Point2>, device: u64, seed: u64, is_raw: bool) -> [Vec<f64>; 2] {
    let mut walk = Walk::along("signal", path, seed);
    walk.walker.speed_m_s = test_bed::KWAK_USUAL_M_S;
    let phone =
        PhoneModel { rate_error: 0.0, jitter_s: 0.0, loss: 0.0, gap_every_s: 0.0, ..PhoneModel::default() };
    walk = Walk { phone: phone.at_rates(100.0, FULL_HZ), device, ..walk };
    let recorded = scenario.simulate(&walk);
    let mut level = LevelEstimator::new(LevelParams::default());
    let mut features = [Vec::new(), Vec::new()];
    let mut bias_ut = None;
    for sample in &recorded.samples {
        match sample.reading {
            Reading::AngularRate(rate) => level.push_angular_rate(sample.time, rate),
            Reading::SpecificForce(force) => {
                level.push_specific_force(sample.time, force);
            }
            Reading::UncalibratedMagneticField { field_ut, bias_ut: estimated } => {
                let bias = *bias_ut.get_or_insert(if is_raw { [0.0; 3] } else { estimated });
                if let Some([x, y, z]) = level.to_level([0, 1, 2].map(|c| field_ut[c] - bias[c])) {
                    features[0].push(f64::from(x * x + y * y).sqrt());
                    features[1].push(f64::from(z));
                }
            }
            _ => {}
        }
    }
    let standing = (STANDING_S * FULL_HZ) as usize;
    features.map(|row| {
        let end = row.len().saturating_sub(standing);
        row.get(standing..end).map_or(Vec::new(), <[f64]>::to_vec)
    })
}

/// `row` read at `rate_hz` only, with straight lines between the readings.
fn thinned(row: &[f64], rate_hz: f64) -> Vec<f64> {
    let every = FULL_HZ / rate_hz;
    let read = |k: usize| row[((k as f64 * every) as usize).min(row.len() - 1)];
    (0..row.len())
        .map(|i| {
            let (k, share) = ((i as f64 / every) as usize, (i as f64 / every).fract());
            read(k) + share * (read(k + 1) - read(k))
        })
        .collect()
}

fn centred(row: &[f64]) -> Vec<f64> {
    let mean = mean_of(row);
    row.iter().map(|value| value - mean).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (centred(a), centred(b));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt()
}

fn rms_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).collect();
    mean_of(&squares).sqrt()
}

/// The corridor that several devices are carried along: the long side of the loop in the other office, 40 m.
///
/// # Source
/// Kwak 2018, Fig. 1: a corridor of 60 m.
fn corridor() -> Vec<Point2> {
    let [_, from, to, _] = test_bed::MASS_CENTERED_LOOP;
    vec![from, to]
}

/// Correlations by rate.
fn correlations(seed: u64) -> [f64; 3] {
    let scenario = test_bed::kwak_office(seed);
    let mut correlations = [Vec::new(), Vec::new(), Vec::new()];
    for trajectory in TRAJECTORIES {
        let path = test_bed::kwak_trajectory(&scenario, trajectory);
        for row in features(&scenario, path, seed, 100 * seed + trajectory as u64, false) {
            for (of_rate, rate_hz) in correlations.iter_mut().zip(RATES_HZ).filter(|_| !row.is_empty()) {
                of_rate.push(correlation(&row, &thinned(&row, rate_hz)));
            }
        }
    }
    correlations.map(|row| mean_of(&row))
}

/// RMS difference of `B_v` between devices, before and after their means are removed.
fn differences_ut(seed: u64) -> [f64; 2] {
    let scenario = test_bed::mass_centered_office(seed);
    // One walk, as if three devices were carried on it; no system has calibrated them.
    let rows: Vec<Vec<f64>> = (0..N_DEVICES)
        .map(|device| {
            let [_, vertical] = features(&scenario, corridor(), 10 * seed + device, seed, true);
            vertical
        })
        .collect();
    let mut differences = [Vec::new(), Vec::new()];
    for (k, one) in rows.iter().enumerate() {
        for other in &rows[..k] {
            let n = one.len().min(other.len());
            differences[0].push(rms_difference(&one[..n], &other[..n]));
            differences[1].push(rms_difference(&centred(&one[..n]), &centred(&other[..n])));
        }
    }
    differences.map(|row| mean_of(&row))
}

/// Reads walks at several rates and with several devices.
pub fn run(run: &Run) -> Findings {
    let measured = run.per_seed(N_SEEDS, |seed| (correlations(seed), differences_ut(seed)));
    let n = measured.len();
    let rate = |k: usize| measured.iter().map(|(correlations, _)| correlations[k]).collect::<Vec<f64>>();
    let ratios: Vec<f64> = measured.iter().map(|(_, [before, after])| after / before).collect();
    let office = test_bed::kwak_office(1);
    let row = &features(&office, test_bed::kwak_trajectory(&office, 0), 1, 1, false)[1];
    let points = |row: &[f64]| {
        row.iter().step_by(5).enumerate().map(|(i, value)| (5.0 * i as f64 / FULL_HZ, *value)).collect()
    };
    let mut chart = Chart::new("One walk at several rates", "time (s)", "B_v (µT)")
        .with(Series::line("50 Hz", points(row)));
    if !row.is_empty() {
        for rate_hz in RATES_HZ {
            chart = chart.with(Series::line(format!("{rate_hz} Hz"), points(&thinned(row, rate_hz))));
        }
    }
    Findings::default()
        .with(Finding::new(
            "kwak-3hz",
            n,
            [
                Estimate::mean(&rate(0)),
                Estimate::paired(&rate(1), &rate(0)),
                Estimate::paired(&rate(2), &rate(1)),
            ],
        ))
        .with(
            Finding::new("kwak-mean-removal", n, [Estimate::mean(&ratios)])
                .because("soft iron and the hand's sway make what is constant in a device's frame vary"),
        )
        .with_picture(Picture::of("The vertical field of a walk through the office.", chart.to_svg()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_survives_any_rate_and_a_wave_does_not() {
        let line: Vec<f64> = (0..301).map(f64::from).collect();
        assert!((correlation(&line, &thinned(&line, 0.5)) - 1.0).abs() < 1e-3);
        let wave: Vec<f64> = (0..500).map(|i| (std::f64::consts::TAU * f64::from(i) / 50.0).sin()).collect();
        assert!(correlation(&wave, &thinned(&wave, 10.0)) > 0.9);
        assert!(correlation(&wave, &thinned(&wave, 1.0)).abs() < 0.2 || thinned(&wave, 1.0)[25].abs() < 0.1);
    }

    #[test]
    fn removed_means_make_shifted_rows_alike() {
        assert!((rms_difference(&[1.0, 2.0], &[4.0, 5.0]) - 3.0).abs() < 1e-12);
        assert!(rms_difference(&centred(&[1.0, 2.0]), &centred(&[4.0, 5.0])) < 1e-12);
    }
}
