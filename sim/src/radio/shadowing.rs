//! Shadowing: a smooth random loss over the floor, correlated from place to place.

use std::f64::consts::TAU;

use fieldwalk::geometry::Point2;

use crate::noise::Noise;

/// Number of plane waves: enough that the sum is nearly Gaussian.
const N_MODES: usize = 32;

/// A stationary Gaussian random field, as a sum of random plane waves.
///
/// Its correlation is `exp(−d²/2ℓ²)` at distance `d`: the waves' numbers are drawn from the Fourier transform of that.
#[derive(Clone, Debug, PartialEq)]
pub struct Shadowing {
    amplitude_db: f64,
    /// Wave numbers along x and y in rad/m, and phase in rad.
    modes: Vec<[f64; 3]>,
}

impl Shadowing {
    /// A field of standard deviation `sd_db` and correlation length `length_m`.
    pub fn new(sd_db: f64, length_m: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed, "shadowing", 0);
        let mode = |_| {
            let [kx, ky] = [0; 2].map(|_| noise.normal(1.0 / length_m));
            [kx, ky, noise.within(0.0, TAU)]
        };
        let modes = (0..N_MODES).map(mode).collect();
        Self { amplitude_db: sd_db * (2.0 / N_MODES as f64).sqrt(), modes }
    }

    /// The gain (loss where negative) at `p`, in dB.
    pub fn at_db(&self, p: Point2) -> f64 {
        let wave = |mode: &[f64; 3]| libm::cos(mode[0] * p.x_m + mode[1] * p.y_m + mode[2]);
        self.amplitude_db * self.modes.iter().map(wave).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadowing_has_its_spread_and_correlation() {
        let (mut square, mut near, mut far, mut n) = (0.0, 0.0, 0.0, 0.0);
        for seed in 0..60 {
            let field = Shadowing::new(4.0, 3.0, seed);
            for k in 0..40 {
                let p = Point2::new(f64::from(k % 8) * 7.3, f64::from(k / 8) * 6.1);
                let here = field.at_db(p);
                square += here * here;
                near += here * field.at_db(p + Point2::new(3.0, 0.0));
                far += here * field.at_db(p + Point2::new(0.0, 12.0));
                n += 1.0;
            }
        }
        let sd = (square / n).sqrt();
        // exp(−½) at one length, nothing at four.
        let (near, far) = (near / square, far / square);
        assert!((sd - 4.0).abs() < 0.25, "{sd}");
        assert!((near - 0.61).abs() < 0.08 && far.abs() < 0.1, "{near} {far}");
    }
}
