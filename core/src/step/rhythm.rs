//! Walking has a rhythm: whether a row of peaks is steps, or a hand that fidgets.

use serde::{Deserialize, Serialize};

/// What a row of peaks must be like to be walking.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RhythmParams {
    /// Steps in a row that must fit each other before any counts, 1 to 5; default 3.
    ///
    /// With 4, hands that take a phone out, turn it or put it away make a third of the false steps, but in the mall's
    /// surveys the short bursts of steps between two waypoints are lost.
    pub n_to_confirm: u8,
    /// Most by which a period may differ from the last, as a ratio; default 1.6 (a foot in two may be weak in a
    /// pocket, and its peak early or late).
    pub max_period_ratio: f32,
    /// Most by which a period may differ from the last but one, that of the same foot, where it fits the last period
    /// not; default 1.3.
    pub max_stride_ratio: f32,
    /// Most by which an amplitude may differ from the nearer of the last two, as a ratio; default 2.5.
    pub max_amplitude_ratio: f32,
}

impl Default for RhythmParams {
    fn default() -> Self {
        Self { n_to_confirm: 3, max_period_ratio: 1.6, max_stride_ratio: 1.3, max_amplitude_ratio: 2.5 }
    }
}

/// Steps more than this are never held back.
const MAX_TO_CONFIRM: u8 = 5;
/// A step out of rhythm counts so much against the walk, and one in rhythm 1 for it.
const MISS: u8 = 2;
/// The walk is no longer one when this much stands against it: two misses in a row.
const MAX_MISSES: u8 = 4;

/// Judges peaks one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Rhythm {
    /// Peaks in a row that fit.
    n_fitting: u8,
    is_walking: bool,
    /// Whether some step of this walk has been confirmed.
    has_begun: bool,
    misses: u8,
    /// The last two, latest first.
    periods_s: [f32; 2],
    amplitudes: [f32; 2],
    /// Steps held back, and how many of them came with the last peak.
    n_held: u8,
    n_of_last: u8,
}

/// What [`Rhythm`] thinks of a peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Verdict {
    pub(super) n_held: u8,
    pub(super) is_confirmed: bool,
    pub(super) starts_walk: bool,
}

impl Rhythm {
    /// Forgets everything: what comes next is not a continuation.
    pub(super) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Judges a peak `period_s` after the last (nothing: after standing) that stands for `n_steps` steps.
    pub(super) fn judge(
        &mut self,
        params: &RhythmParams,
        period_s: Option<f32>,
        amplitude: f32,
        n_steps: u8,
    ) -> Verdict {
        match period_s {
            None => {
                self.reset();
                self.n_fitting = 1;
            }
            Some(period_s) => {
                let fits = self.fits(params, period_s, amplitude);
                let before_s = if n_steps > 1 { period_s } else { self.periods_s[0] };
                self.periods_s = [period_s, before_s];
                self.count(fits);
            }
        }
        self.n_fitting = self.n_fitting.saturating_add(n_steps - 1);
        self.amplitudes = [amplitude, self.amplitudes[0]];
        let n_to_confirm = params.n_to_confirm.clamp(1, MAX_TO_CONFIRM);
        let confirms = !self.is_walking && self.n_fitting >= n_to_confirm;
        let verdict = Verdict {
            n_held: self.n_held,
            is_confirmed: self.is_walking || confirms,
            starts_walk: confirms && !self.has_begun,
        };
        if verdict.is_confirmed {
            (self.is_walking, self.has_begun, self.n_held) = (true, true, 0);
        } else {
            self.n_held += n_steps;
        }
        self.n_of_last = n_steps;
        verdict
    }

    fn count(&mut self, fits: bool) {
        if fits {
            self.n_fitting = self.n_fitting.saturating_add(1);
            self.misses = self.misses.saturating_sub(1);
        } else if self.is_walking {
            self.misses += MISS;
            if self.misses >= MAX_MISSES {
                (self.is_walking, self.misses, self.n_fitting) = (false, 0, 2);
            }
        } else {
            // The last peak and this one may be the first two of a walk.
            self.n_held = self.n_held.min(self.n_of_last);
            self.n_fitting = 2;
        }
    }

    fn fits(&self, params: &RhythmParams, period_s: f32, amplitude: f32) -> bool {
        let fits_last = ratio(period_s, self.periods_s[0]) <= params.max_period_ratio;
        let fits_stride =
            self.n_fitting >= 3 && ratio(period_s, self.periods_s[1]) <= params.max_stride_ratio;
        let is_even = self.n_fitting < 2 || fits_last || fits_stride;
        let to_last = ratio(amplitude, self.amplitudes[0]);
        let to_stride = if self.n_fitting >= 2 { ratio(amplitude, self.amplitudes[1]) } else { to_last };
        is_even && to_last.min(to_stride) <= params.max_amplitude_ratio
    }
}

fn ratio(a: f32, b: f32) -> f32 {
    if a > b { a / b } else { b / a }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdicts(peaks: &[(Option<f32>, f32)]) -> Vec<(u8, bool)> {
        let mut rhythm = Rhythm::default();
        let judged = peaks.iter().map(|&(period_s, amplitude)| {
            let params = RhythmParams { n_to_confirm: 4, ..RhythmParams::default() };
            let verdict = rhythm.judge(&params, period_s, amplitude, 1);
            (verdict.n_held, verdict.is_confirmed)
        });
        judged.collect()
    }

    #[test]
    fn the_fourth_even_step_confirms_the_three_before_it() {
        let even = [(None, 2.0), (Some(0.5), 4.0), (Some(0.55), 4.5), (Some(0.5), 4.0), (Some(0.5), 4.0)];
        assert_eq!(verdicts(&even), [(0, false), (1, false), (2, false), (3, true), (0, true)]);
    }

    #[test]
    fn an_uneven_peak_starts_the_row_anew_with_the_one_before_it() {
        let uneven = [(None, 4.0), (Some(0.5), 4.0), (Some(1.2), 4.0), (Some(1.1), 4.0), (Some(1.2), 4.0)];
        // The third fits neither; the row is then the second and the third, and the fifth makes it four.
        assert_eq!(verdicts(&uneven), [(0, false), (1, false), (1, false), (2, false), (3, true)]);
        let strong = [(None, 1.0), (Some(0.5), 4.0), (Some(0.5), 20.0), (Some(0.5), 3.0)];
        assert!(verdicts(&strong).iter().all(|(_, is_confirmed)| !is_confirmed));
    }

    #[test]
    fn a_limp_is_a_rhythm() {
        let limp: Vec<_> =
            (0..8).map(|k| ((k > 0).then_some([0.4, 0.64][k % 2]), [6.0, 3.0][k % 2])).collect();
        assert!(verdicts(&limp)[3..].iter().all(|(_, is_confirmed)| *is_confirmed));
    }

    #[test]
    fn one_stumble_is_forgiven_two_are_not() {
        let mut peaks = vec![(None, 4.0)];
        peaks.extend([(Some(0.5), 4.0); 5]);
        peaks.push((Some(1.2), 4.0));
        peaks.push((Some(0.5), 4.0));
        assert!(verdicts(&peaks)[3..].iter().all(|(_, is_confirmed)| *is_confirmed));
        assert_eq!(verdicts(&peaks)[7], (0, true));
        peaks[7] = (Some(0.3), 4.0);
        assert!(!verdicts(&peaks)[7].1);
    }
}
