//! A low-pass filter of finite response, designed where it is made.

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::step::fixed_array;

/// A windowed-sinc low-pass filter with a circular buffer, of unit gain at rest and linear phase.
///
/// The gain at the cut-off is one half (-6 dB); the delay is half the number of taps less one.
///
/// # Source
/// WILA 2016, Eq. 1: `y_n = Σ h_k·x_{n−k}` with 51 taps and a cut-off of 5 Hz at 50 Hz, in a circular buffer. The paper
/// does not give the coefficients; these are the sinc function under a Hamming window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LowPassFir<const TAPS: usize> {
    #[serde(with = "fixed_array")]
    taps: [f32; TAPS],
    /// Inputs, the latest before `next`.
    #[serde(with = "fixed_array")]
    inputs: [f32; TAPS],
    next: usize,
    is_filled: bool,
}

impl<const TAPS: usize> LowPassFir<TAPS> {
    /// A filter with cut-off `cutoff_hz` for inputs at `rate_hz`; the cut-off must lie between 0 and half the rate.
    pub fn new(cutoff_hz: f64, rate_hz: f64) -> Self {
        let middle = (TAPS as f64 - 1.0) / 2.0;
        let cycles = (cutoff_hz / rate_hz).clamp(0.0, 0.5);
        let weights: [f64; TAPS] = core::array::from_fn(|k| {
            let from_middle = k as f64 - middle;
            let x = TAU * cycles * from_middle;
            let sinc = if x == 0.0 { 1.0 } else { libm::sin(x) / x };
            let span = if middle > 0.0 { from_middle / middle } else { 0.0 };
            sinc * (0.54 + 0.46 * libm::cos(PI * span))
        });
        let sum: f64 = weights.iter().sum();
        let taps = weights.map(|weight| (weight / sum) as f32);
        Self { taps, inputs: [0.0; TAPS], next: 0, is_filled: false }
    }

    /// Forgets the inputs; the next one counts as if it had always been there.
    pub fn reset(&mut self) {
        self.is_filled = false;
    }

    /// The coefficients, which are symmetric.
    pub fn taps(&self) -> &[f32; TAPS] {
        &self.taps
    }

    /// Feeds `input` and returns the output, that of `(TAPS - 1) / 2` inputs ago.
    pub fn push(&mut self, input: f32) -> f32 {
        if TAPS == 0 {
            return input;
        }
        if !self.is_filled {
            self.inputs = [input; TAPS];
            self.is_filled = true;
        }
        // Within the buffer even where a torn snapshot says otherwise.
        let at = self.next % TAPS;
        self.inputs[at] = input;
        self.next = (at + 1) % TAPS;
        // From the oldest input, which `next` is at, round to the latest; the taps are symmetric.
        let (newer, older) = self.inputs.split_at(self.next);
        let mut sum = 0.0;
        for (x, h) in older.iter().chain(newer).zip(&self.taps) {
            sum += x * h;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wila() -> LowPassFir<51> {
        LowPassFir::new(5.0, 50.0)
    }

    /// The gain at `hz`, by the sum over the taps.
    fn gain(hz: f64) -> f64 {
        let at = |k: usize| TAU * hz / 50.0 * (k as f64 - 25.0);
        wila().taps().iter().enumerate().map(|(k, h)| f64::from(*h) * libm::cos(at(k))).sum()
    }

    #[test]
    fn the_gain_is_one_at_rest_half_at_the_cut_off_and_next_to_nothing_beyond() {
        assert!((gain(0.0) - 1.0).abs() < 1e-6);
        assert!((gain(5.0) - 0.5).abs() < 0.005, "{}", gain(5.0));
        assert!((0.99..1.01).contains(&gain(3.0)), "{}", gain(3.0));
        for hz in [7.5, 10.0, 15.0, 25.0] {
            assert!(gain(hz).abs() < 0.005, "{hz} Hz: {}", gain(hz));
        }
    }

    #[test]
    fn the_taps_are_as_computed_by_hand_and_symmetric() {
        let filter = wila();
        let h = filter.taps();
        assert!((0..51).all(|k| (h[k] - h[50 - k]).abs() < 1e-9));
        // The sinc of a tenth of the rate: 2·0.1 in the middle, and nothing five samples away.
        assert!((h[25] - 0.2).abs() < 2e-3, "{}", h[25]);
        assert!(h[30].abs() < 1e-7 && h[35].abs() < 1e-7);
        // sin(0.2π·2.5)… at one sample: sin(0.2π)/π · (0.54 + 0.46·cos(π/25)) = 0.18710 · 0.99637.
        assert!((h[26] / h[25] - 0.935_489 * 0.996_373).abs() < 1e-4, "{}", h[26] / h[25]);
    }

    #[test]
    fn an_impulse_comes_back_as_the_taps_a_constant_as_itself() {
        let mut filter = wila();
        assert!((0..100).all(|_| (filter.push(3.0) - 3.0).abs() < 1e-5));
        let mut filter = wila();
        filter.push(0.0);
        let response: Vec<f32> = (0..51).map(|k| filter.push(if k == 0 { 1.0 } else { 0.0 })).collect();
        assert!(response.iter().zip(wila().taps()).all(|(y, h)| (y - h).abs() < 1e-7));
    }

    #[test]
    fn the_delay_is_half_a_second_at_every_frequency() {
        for hz in [0.5, 1.0, 2.0, 3.0] {
            let mut filter = wila();
            for k in 0..300 {
                let t = f64::from(k) / 50.0;
                let out = f64::from(filter.push(libm::sin(TAU * hz * t) as f32));
                if k > 60 {
                    assert!((out - libm::sin(TAU * hz * (t - 0.5))).abs() < 0.02, "{hz} Hz at {t} s: {out}");
                }
            }
        }
    }
}
