//! Counter-based randomness: every draw is a pure function of (seed, step, particle, purpose).
//!
//! Nothing here has a position in a stream, so particles can be moved, batched or vectorised without changing a bit.

use core::convert::Infallible;

use rand::rand_core::TryRng;

/// What a draw is for; keeps the draws of one particle at one step independent of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Purpose {
    Start = 0,
    Motion = 1,
    Genes = 2,
    Resampling = 3,
    Replenishing = 4,
    Unseen = 5,
}

/// Ten rounds of Philox4x32: 128 random bits from a 64-bit key and a 128-bit counter.
///
/// # Source
/// Salmon, Moraes, Dror and Shaw 2011, *Parallel random numbers: as easy as 1, 2, 3*, §3.3.
pub(crate) fn philox4x32(mut key: [u32; 2], mut counter: [u32; 4]) -> [u32; 4] {
    const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..10 {
        let p0 = MULTIPLIER[0] * u64::from(counter[0]);
        let p1 = MULTIPLIER[1] * u64::from(counter[2]);
        counter = [
            (p1 >> 32) as u32 ^ counter[1] ^ key[0],
            p1 as u32,
            (p0 >> 32) as u32 ^ counter[3] ^ key[1],
            p0 as u32,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// 128 random bits for one particle at one step.
pub(crate) fn draw(seed: u64, step: u32, particle: u32, purpose: Purpose) -> [u32; 4] {
    philox4x32([seed as u32, (seed >> 32) as u32], [particle, step, purpose as u32, 0])
}

/// A uniform number in [0, 1) from 32 random bits (24 of them used).
pub(crate) fn uniform(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// An explicit generator over the same counters, for code that wants a [`rand::Rng`].
#[derive(Clone, Debug)]
pub struct CounterRng {
    seed: u64,
    stream: u64,
    block: u32,
    left: [u32; 4],
    n_left: usize,
}

impl CounterRng {
    /// The generator of stream `stream` under `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { seed, stream, block: 0, left: [0; 4], n_left: 0 }
    }
}

impl TryRng for CounterRng {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        if self.n_left == 0 {
            let key = [self.seed as u32, (self.seed >> 32) as u32];
            let counter = [self.block, u32::MAX, self.stream as u32, (self.stream >> 32) as u32];
            self.left = philox4x32(key, counter);
            self.block = self.block.wrapping_add(1);
            self.n_left = 4;
        }
        self.n_left -= 1;
        Ok(self.left[3 - self.n_left])
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let low = u64::from(self.try_next_u32()?);
        Ok(low | u64::from(self.try_next_u32()?) << 32)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(4) {
            let word = self.try_next_u32()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

/// The standard normal distribution by its quantile function, tabulated and interpolated.
///
/// Piecewise linear in 2048 intervals of equal probability on each side, exact in the outermost one, so that a draw
/// costs two loads; the table's largest error, just inside the tail, is below 0.01 standard deviations.
#[derive(Clone, Debug)]
pub(crate) struct NormalTable {
    quantile: Box<[f32]>,
}

impl NormalTable {
    const N_INTERVALS: usize = 2048;

    pub(crate) fn new() -> Self {
        let quantile = (0..=Self::N_INTERVALS)
            .map(|i| normal_quantile(0.5 + 0.5 * i as f64 / Self::N_INTERVALS as f64) as f32)
            .collect();
        Self { quantile }
    }

    /// A standard normal number from 32 random bits.
    #[inline(always)]
    pub(crate) fn sample(&self, bits: u32) -> f32 {
        let magnitude = bits & 0x7FFF_FFFF;
        let interval = (magnitude >> 20) as usize;
        let value = if interval + 1 < Self::N_INTERVALS {
            let fraction = (magnitude & 0xF_FFFF) as f32 * (1.0 / 1_048_576.0);
            let low = self.quantile[interval];
            low + (self.quantile[interval + 1] - low) * fraction
        } else {
            tail(magnitude)
        };
        // The top bit is the sign: no branch, since it would be mispredicted half of the time.
        f32::from_bits(value.to_bits() | (bits & 0x8000_0000))
    }
}

/// The normal quantile in the outermost interval, where a straight line would not do.
#[cold]
fn tail(magnitude: u32) -> f32 {
    normal_quantile(0.5 + (f64::from(magnitude) + 0.5) * (0.5 / 2_147_483_648.0)) as f32
}

/// The standard normal quantile function, to a relative error of 1.2e-9; `p` in (0, 1).
///
/// # Source
/// Acklam 2003, *An algorithm for computing the inverse normal cumulative distribution function*.
fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969683028665376e1,
        2.209460984245205e2,
        -2.759285104469687e2,
        1.383_577_518_672_69e2,
        -3.066479806614716e1,
        2.506628277459239,
    ];
    const B: [f64; 5] = [
        -5.447609879822406e1,
        1.615858368580409e2,
        -1.556989798598866e2,
        6.680131188771972e1,
        -1.328068155288572e1,
    ];
    const C: [f64; 6] = [
        -7.784894002430293e-3,
        -3.223964580411365e-1,
        -2.400758277161838,
        -2.549732539343734,
        4.374664141464968,
        2.938163982698783,
    ];
    const D: [f64; 4] = [7.784695709041462e-3, 3.224671290700398e-1, 2.445134137142996, 3.754408661907416];
    let polynomial = |coefficients: &[f64], x: f64| coefficients.iter().fold(0.0, |sum, c| sum * x + c);
    if p > 0.97575 {
        let q = (-2.0 * libm::log(1.0 - p)).sqrt();
        -polynomial(&C, q) / (polynomial(&D, q) * q + 1.0)
    } else if p < 0.02425 {
        -normal_quantile(1.0 - p)
    } else {
        let q = p - 0.5;
        let r = q * q;
        polynomial(&A, r) * q / (polynomial(&B, r) * r + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    /// The known answers that the generator's authors publish (Random123, kat_vectors).
    #[test]
    fn philox_gives_the_published_known_answers() {
        assert_eq!(philox4x32([0; 2], [0; 4]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox4x32([u32::MAX; 2], [u32::MAX; 4]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox4x32([0xa409_3822, 0x299f_31d0], [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344]),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn the_table_has_the_normal_moments_and_tails() {
        let table = NormalTable::new();
        let mut rng = CounterRng::new(7, 0);
        let n = 400_000;
        let (mut sum, mut square, mut fourth, mut beyond2) = (0.0, 0.0, 0.0, 0);
        for _ in 0..n {
            let z = f64::from(table.sample(rng.next_u32()));
            sum += z;
            square += z * z;
            fourth += z * z * z * z;
            beyond2 += i32::from(z.abs() > 1.959_964);
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 0.006, "mean {}", sum / n);
        assert!((square / n - 1.0).abs() < 0.01, "variance {}", square / n);
        assert!((fourth / n - 3.0).abs() < 0.08, "fourth moment {}", fourth / n);
        assert!((f64::from(beyond2) / n - 0.05).abs() < 0.002);
        assert!((normal_quantile(0.975) - 1.959_963_985).abs() < 1e-6);
        assert!((normal_quantile(0.01) + 2.326_347_874).abs() < 1e-6);
    }

    #[test]
    fn draws_differ_by_every_part_of_the_key() {
        let base = draw(1, 2, 3, Purpose::Motion);
        assert_ne!(base, draw(2, 2, 3, Purpose::Motion));
        assert_ne!(base, draw(1, 3, 3, Purpose::Motion));
        assert_ne!(base, draw(1, 2, 4, Purpose::Motion));
        assert_ne!(base, draw(1, 2, 3, Purpose::Genes));
        assert_eq!(uniform(0), 0.0);
        assert!(uniform(u32::MAX) < 1.0);
    }
}
