//! How finely the field varies along corridors.

use std::f64::consts::TAU;

use fieldwalk::geometry::Segment;
use fieldwalk_sim::magnetic_field::MagneticField;

use crate::plot::{Chart, Series};
use crate::reproduce::estimate::mean_of;
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run, test_bed};

const N_SEEDS: u64 = 12;
/// Steps sample up to this spatial frequency, in cycles a metre.
///
/// # Source
/// Mass-centred 2019, Fig. 9: half of 1.53 samples a metre.
const STEPS_PER_M: f64 = 0.765;
/// Distance of the samples that the spectrum is made of, in metres.
const SPACING_M: f64 = 0.1;
/// Height of a phone before the chest, in metres.
const PHONE_M: f64 = 1.1;
/// The spectrum is drawn up to this, in cycles a metre.
const DRAWN_PER_M: f64 = 2.0;

/// Energy of the strength along a line, its mean taken off, by spatial frequency in cycles a metre.
fn spectrum(field: &MagneticField, line: &Segment) -> Vec<(f64, f64)> {
    let length_m = line.a.distance_m(line.b);
    let n = (length_m / SPACING_M) as usize;
    let strengths: Vec<f64> = (0..n)
        .map(|k| {
            let p = line.a.lerp(line.b, k as f64 / n as f64);
            let [x, y, z] = field.field_ut([p.x_m, p.y_m, PHONE_M]);
            (x * x + y * y + z * z).sqrt()
        })
        .collect();
    let mean = mean_of(&strengths);
    let energy = |k: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for (i, strength) in strengths.iter().enumerate() {
            // Hann's window: the ends of a corridor do not meet.
            let value = (strength - mean) * (0.5 - 0.5 * (TAU * i as f64 / n as f64).cos());
            let (sin, cos) = (TAU * (k * i % n) as f64 / n as f64).sin_cos();
            re += value * cos;
            im += value * sin;
        }
        re * re + im * im
    };
    (1..=n / 2).map(|k| (k as f64 / length_m, energy(k))).collect()
}

/// The share of `spectrum` up to `per_m` cycles a metre, in percent.
fn share_percent(spectrum: &[(f64, f64)], per_m: f64) -> f64 {
    let sum =
        |limit: f64| spectrum.iter().filter(|(f, _)| *f <= limit).map(|(_, energy)| energy).sum::<f64>();
    100.0 * sum(per_m) / sum(f64::INFINITY)
}

/// The spectra of all corridors of an office, together.
fn measure(seed: u64) -> Vec<(f64, f64)> {
    let office = test_bed::mass_centered_office(seed);
    office.building.corridors.iter().flat_map(|corridor| spectrum(&office.field, &corridor.line)).collect()
}

/// Spectra of many offices.
pub fn run(run: &Run) -> Findings {
    let spectra = run.per_seed(N_SEEDS, measure);
    let shares: Vec<f64> = spectra.iter().map(|spectrum| share_percent(spectrum, STEPS_PER_M)).collect();
    let all = spectra.concat();
    let points = (1..=40).map(|k| {
        let per_m = DRAWN_PER_M * f64::from(k) / 40.0;
        (per_m, share_percent(&all, per_m))
    });
    let chart =
        Chart::new("Energy of the strength along corridors", "spatial frequency (1/m)", "share up to it (%)")
            .with(Series::line("share", points.collect()))
            .y_up_to(100.0);
    Findings::default()
        .with(Finding::new("mc-spectrum", spectra.len(), [Estimate::mean(&shares)]))
        .with_picture(Picture::of("Steps sample the field up to 0.765 cycles a metre.", chart.to_svg()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_of_the_energy_up_to_a_frequency() {
        let spectrum = [(0.2, 3.0), (0.7, 1.0), (0.9, 4.0)];
        assert!((share_percent(&spectrum, 0.765) - 50.0).abs() < 1e-12);
    }
}
