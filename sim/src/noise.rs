//! Seeded randomness: independent streams by purpose, the usual distributions, and smooth random functions.

use std::f64::consts::TAU;

use fieldwalk::random::CounterRng;
use rand::Rng as _;

/// A stream of random numbers for one purpose.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    rng: CounterRng,
}

impl Noise {
    /// The stream of `purpose` and `index` under `seed`: streams of other purposes or indices are independent of it.
    pub(crate) fn new(seed: u64, purpose: &str, index: u64) -> Self {
        // FNV-1a: a new purpose never changes the numbers of the others.
        let fnv = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        let hash = purpose.bytes().chain(index.to_le_bytes()).fold(0xcbf2_9ce4_8422_2325, fnv);
        Self { rng: CounterRng::new(seed, hash) }
    }

    /// 64 random bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.rng.next_u64()
    }

    /// Uniform in (0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (f64::from(self.rng.next_u32()) + 0.5) / 4_294_967_296.0
    }

    /// Uniform between `low` and `high`.
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Whether something of probability `p` happens.
    pub(crate) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// Uniform in `0..n`; 0 when `n` is 0.
    pub(crate) fn index(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n.saturating_sub(1))
    }

    /// Normal about 0, by Box and Muller.
    pub(crate) fn normal(&mut self, sd: f64) -> f64 {
        let radius = (-2.0 * libm::log(self.unit())).sqrt();
        sd * radius * libm::cos(TAU * self.unit())
    }

    /// Three independent normals about 0.
    pub(crate) fn normal3(&mut self, sd: f64) -> [f64; 3] {
        [0; 3].map(|_| self.normal(sd))
    }

    /// The times between `start_s` and `end_s` at which something happens that happens `per_minute` times a minute, and
    /// not within `rest_s` of the last time: a Poisson process.
    pub(crate) fn arrivals_s(&mut self, start_s: f64, end_s: f64, per_minute: f64, rest_s: f64) -> Vec<f64> {
        let mut times_s = Vec::new();
        if per_minute <= 0.0 {
            return times_s;
        }
        let mut time_s = start_s;
        loop {
            time_s -= 60.0 / per_minute * libm::log(self.unit());
            if time_s >= end_s {
                return times_s;
            }
            times_s.push(time_s);
            time_s += rest_s;
        }
    }

    /// Normal, kept within two standard deviations of `mean`.
    pub(crate) fn typical(&mut self, mean: f64, sd: f64) -> f64 {
        mean + self.normal(sd).clamp(-2.0 * sd, 2.0 * sd)
    }
}

/// A smooth random function of one variable: a few sinusoids of random frequency and phase.
#[derive(Clone, Debug)]
pub(crate) struct SmoothNoise {
    amplitude: f64,
    /// Radians per unit of the variable, and radians.
    modes: [(f64, f64); 5],
}

impl SmoothNoise {
    /// A function of standard deviation `sd`, its frequencies (in cycles per unit) evenly drawn from a band.
    pub(crate) fn new(noise: &mut Noise, sd: f64, frequencies: [f64; 2]) -> Self {
        let modes =
            [0; 5].map(|_| (TAU * noise.within(frequencies[0], frequencies[1]), noise.within(0.0, TAU)));
        Self { amplitude: sd * (2.0 / modes.len() as f64).sqrt(), modes }
    }

    pub(crate) fn at(&self, x: f64) -> f64 {
        self.amplitude * self.modes.iter().map(|&(k, phase)| libm::sin(k * x + phase)).sum::<f64>()
    }
}

/// A step from 0 at `x ≤ 0` to 1 at `x ≥ 1` with two continuous derivatives.
pub(crate) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 - x * (15.0 - 6.0 * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_independent_and_repeatable() {
        let draw = |seed, purpose, index| Noise::new(seed, purpose, index).bits();
        assert_eq!(draw(1, "a", 0), draw(1, "a", 0));
        let others = [draw(2, "a", 0), draw(1, "b", 0), draw(1, "a", 1)];
        assert!(others.iter().all(|&other| other != draw(1, "a", 0)));
    }

    #[test]
    fn distributions_have_their_moments() {
        let mut noise = Noise::new(3, "moments", 0);
        let n = 40_000;
        let draws: Vec<f64> = (0..n).map(|_| noise.normal(2.0)).collect();
        let mean = draws.iter().sum::<f64>() / f64::from(n);
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
        assert!(mean.abs() < 0.05 && (variance - 4.0).abs() < 0.1, "{mean} {variance}");
        let smooth = SmoothNoise::new(&mut noise, 1.5, [0.1, 0.4]);
        let square = (0..n).map(|k| smooth.at(f64::from(k))).map(|y| y * y).sum::<f64>() / f64::from(n);
        assert!((square.sqrt() - 1.5).abs() < 0.1, "{square}");
        let arrivals_s = noise.arrivals_s(0.0, 60_000.0, 3.0, 0.0);
        assert!(
            (2_800..3_200).contains(&arrivals_s.len()) && noise.arrivals_s(0.0, 9.0, 0.0, 0.0).is_empty()
        );
        assert_eq!((smooth_step(-1.0), smooth_step(0.5), smooth_step(2.0)), (0.0, 0.5, 1.0));
    }
}
