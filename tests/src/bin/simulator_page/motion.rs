//! What a recording's specific force says of the gait: its frequency, its harmonics, its regularity.

use std::f64::consts::TAU;

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;

pub const RATE_HZ: f64 = 100.0;
/// Harmonics of the step frequency whose amplitudes are taken.
pub const HARMONICS: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0];
/// Half the width of the band of a harmonic, in Hz.
const BAND_HZ: f64 = 0.22;
const GRID_HZ: f64 = 0.05;
const HIGHEST_HZ: f64 = 12.0;

/// The force at an even rate from the first sample on.
pub struct Force {
    pub start: Timestamp,
    pub values: Vec<[f64; 3]>,
}

/// The gait in a stretch of walking.
pub struct Walking {
    pub step_hz: f64,
    /// Amplitudes of the vertical acceleration at [`HARMONICS`], in m/s².
    pub amplitudes: [f64; 6],
    /// Root mean square of the vertical and of the horizontal acceleration, in m/s².
    pub vertical_rms: f64,
    pub horizontal_rms: f64,
    /// Autocorrelation of the vertical acceleration at a step and at a stride.
    pub step_regularity: f64,
    pub stride_regularity: f64,
    /// Amplitude in m/s² by multiples of the step frequency, a twentieth apart.
    pub spectrum: Vec<f64>,
}

impl Force {
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let read = samples.iter().filter_map(|sample| match sample.reading {
            Reading::SpecificForce(force) => Some((sample.time, force.map(f64::from))),
            _ => None,
        });
        let mut read: Vec<(Timestamp, [f64; 3])> = read.collect();
        read.sort_by_key(|(time, _)| *time);
        let (start, end) = (read.first()?.0, read.last()?.0);
        let n = (end.secs_since(start) * RATE_HZ) as usize;
        let mut k = 0;
        let values = (0..n).map(|i| {
            let at_s = i as f64 / RATE_HZ;
            while k + 2 < read.len() && read[k + 1].0.secs_since(start) <= at_s {
                k += 1;
            }
            let (from, to) = (&read[k], &read[k + 1]);
            let (from_s, to_s) = (from.0.secs_since(start), to.0.secs_since(start));
            let share = if to_s > from_s { ((at_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0) } else { 0.0 };
            [0, 1, 2].map(|c| from.1[c] + share * (to.1[c] - from.1[c]))
        });
        Some(Self { start, values: values.collect() })
    }

    pub fn between(&self, from: Timestamp, to: Timestamp) -> &[[f64; 3]] {
        let index = |time: Timestamp| {
            ((time.secs_since(self.start) * RATE_HZ).max(0.0) as usize).min(self.values.len())
        };
        &self.values[index(from)..index(to).max(index(from))]
    }

    /// The gait in every whole window of ten seconds in which somebody walks throughout.
    pub fn windows(&self) -> Vec<Walking> {
        self.values.chunks_exact((10.0 * RATE_HZ) as usize).filter_map(Walking::of).collect()
    }
}

impl Walking {
    /// The gait in `force`; nothing where it is too short, or where somebody stands for a second and a half.
    pub fn of(force: &[[f64; 3]]) -> Option<Self> {
        if force.len() < (4.0 * RATE_HZ) as usize {
            return None;
        }
        let n = force.len() as f64;
        let sum = force.iter().fold([0.0; 3], |sum, f| [0, 1, 2].map(|c| sum[c] + f[c]));
        let gravity = sum.iter().map(|c| c * c).sum::<f64>().sqrt() / n;
        let up = sum.map(|c| c / n / gravity);
        let along = |f: &[f64; 3]| f[0] * up[0] + f[1] * up[1] + f[2] * up[2];
        let vertical: Vec<f64> = force.iter().map(|f| along(f) - gravity).collect();
        let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
        let square: f64 =
            force.iter().map(|f| f.iter().map(|c| c * c).sum::<f64>() - along(f) * along(f)).sum();
        if vertical.chunks_exact((1.5 * RATE_HZ) as usize).any(|part| rms(part) < 0.5) {
            return None;
        }
        let grid = spectrum(&vertical);
        let peak = |low_hz: f64, high_hz: f64| {
            let range = (low_hz / GRID_HZ) as usize..(high_hz / GRID_HZ) as usize;
            range.max_by(|&a, &b| grid[a].total_cmp(&grid[b])).unwrap_or(0)
        };
        let step_hz = refined_hz(&grid, peak(1.2, 2.6));
        // Hann's window spreads a tone over 1.5 bins of 1/T: energy in the band over that of a tone of amplitude 1.
        let tone = 1.5 * RATE_HZ / n / GRID_HZ;
        let amplitude = |multiple: f64| {
            let middle_hz = multiple * step_hz;
            let low = (((middle_hz - BAND_HZ) / GRID_HZ).ceil().max(0.0)) as usize;
            let high = ((middle_hz + BAND_HZ) / GRID_HZ) as usize;
            let energy: f64 = grid[low..=high.min(grid.len() - 1)].iter().map(|a| a * a).sum();
            (energy / tone).sqrt()
        };
        let lag = |periods: f64| autocorrelation(&vertical, periods * RATE_HZ / step_hz);
        let at = |multiple: f64| {
            let k = (multiple * step_hz / GRID_HZ) as usize;
            grid.get(k).copied().unwrap_or(f64::NAN)
        };
        Some(Self {
            step_hz,
            amplitudes: HARMONICS.map(amplitude),
            vertical_rms: rms(&vertical),
            horizontal_rms: (square / n).sqrt(),
            step_regularity: lag(1.0),
            stride_regularity: lag(2.0),
            spectrum: (4..=100).map(|k| at(0.05 * f64::from(k))).collect(),
        })
    }
}

/// Amplitudes on a grid of frequencies, by a windowed Fourier sum.
fn spectrum(values: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let windowed: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(i, v)| v * (0.5 - 0.5 * libm::cos(TAU * (i as f64 + 0.5) / n)))
        .collect();
    (0..(HIGHEST_HZ / GRID_HZ) as usize)
        .map(|k| {
            let (sin, cos) = libm::sincos(TAU * k as f64 * GRID_HZ / RATE_HZ);
            // Goertzel's recurrence.
            let (mut s1, mut s2) = (0.0, 0.0);
            for v in &windowed {
                (s1, s2) = (v + 2.0 * cos * s1 - s2, s1);
            }
            let (re, im) = (s1 - cos * s2, sin * s2);
            (re * re + im * im).sqrt() * 4.0 / n
        })
        .collect()
}

/// The peak of a parabola through the greatest amplitude and its neighbours.
fn refined_hz(grid: &[f64], k: usize) -> f64 {
    let (a, b, c) = (grid[k - 1], grid[k], grid[k + 1]);
    let bend = a - 2.0 * b + c;
    let off = if bend.abs() > 1e-12 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    (k as f64 + off) * GRID_HZ
}

/// The greatest autocorrelation within a tenth of `lag` samples: Moe-Nilssen and Helbostad 2004.
fn autocorrelation(values: &[f64], lag: f64) -> f64 {
    let at = |lag: usize| {
        let pairs = values.len().saturating_sub(lag);
        let sum: f64 = values.iter().zip(&values[values.len() - pairs..]).map(|(a, b)| a * b).sum();
        sum / pairs as f64
    };
    let zero = at(0);
    ((0.9 * lag) as usize..=(1.1 * lag) as usize).map(|lag| at(lag) / zero).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pure_bounce_has_its_frequency_amplitude_and_regularity() {
        // 3 m/s² up and down twice a second, 1 m/s² across once a second, a phone on its side.
        let force: Vec<[f64; 3]> = (0..1_000)
            .map(|k| {
                let (step, stride) = (TAU * 0.02 * f64::from(k), TAU * 0.01 * f64::from(k));
                [9.8 + 3.0 * libm::sin(step), libm::sin(stride), 0.0]
            })
            .collect();
        let walking = Walking::of(&force).unwrap();
        assert!((walking.step_hz - 2.0).abs() < 0.02, "{}", walking.step_hz);
        assert!((walking.amplitudes[1] - 3.0).abs() < 0.1, "{:?}", walking.amplitudes);
        assert!(walking.amplitudes[0] < 0.1 && walking.amplitudes[3] < 0.1, "{:?}", walking.amplitudes);
        assert!((walking.vertical_rms - 2.12).abs() < 0.02 && (walking.horizontal_rms - 0.707).abs() < 0.01);
        assert!(walking.step_regularity > 0.98 && walking.stride_regularity > 0.98);
        assert!(Walking::of(&[[9.8, 0.0, 0.0]; 1_000]).is_none());
    }
}
