//! How long nothing was heard of the wearer's motion, and hints of another clock.

use fieldwalk_codec::{CardFrame, CardRepr};
use serde::{Deserialize, Serialize};

use crate::sensor::{Reading, Sample};
use crate::time::Timestamp;

/// A longer silence of the accelerometer hides steps, in seconds.
const SILENT_S: f64 = 1.0;
/// A longer silence of a card hides rounds that its receiver does not fill, in seconds.
const CARD_SILENT_S: f64 = 7.0;
/// A longer silence of the gyroscope alone hides turns, in seconds: as long as the level frame does without.
const UNTURNED_S: f64 = 0.25;
/// So many samples of a gyroscope in a row make one that is missed; fewer were never of use.
const N_RATES: u32 = 10;
/// Samples this long after a hint, and still so far behind it, say that its clock is not theirs, in seconds.
const HINT_SETTLED_S: f64 = 1.0;
const HINT_AHEAD_S: f64 = 5.0;

/// What a silence took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lost {
    /// Place and direction, for so many seconds.
    Sight(f64),
    /// The direction alone.
    Direction(f64),
}

/// When motion was last heard of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Silence {
    last_motion: Option<Timestamp>,
    last_rate: Option<Timestamp>,
    /// Samples of the gyroscope without a silence between them, up to `N_RATES`.
    n_rates: u32,
    /// The latest hint's time, while it may prove to be of another clock, and the first sample after it.
    hint: Option<Timestamp>,
    first_after_hint: Option<Timestamp>,
}

impl Silence {
    /// A hint said where the wearer is: what was not seen before it does not matter.
    pub fn begin_anew(&mut self, hint_time: Timestamp) {
        *self = Self { hint: Some(hint_time), ..Self::default() };
    }

    /// What the silence that `sample` ends took.
    pub fn ended_by(&mut self, sample: &Sample) -> Option<Lost> {
        let time = sample.time;
        let since = |last: Option<Timestamp>| last.map_or(0.0, |last| time.secs_since(last));
        match &sample.reading {
            Reading::SpecificForce(_) => {
                let silent_s = since(self.last_motion.replace(time));
                if silent_s <= SILENT_S {
                    return None;
                }
                // The gyroscope's silence is in it.
                self.last_rate = None;
                Some(Lost::Sight(silent_s))
            }
            Reading::AngularRate(_) => {
                let silent_s = since(self.last_rate.replace(time));
                if silent_s <= UNTURNED_S {
                    self.n_rates = (self.n_rates + 1).min(N_RATES);
                    return None;
                }
                let n_rates = core::mem::take(&mut self.n_rates);
                (n_rates == N_RATES).then_some(Lost::Direction(silent_s))
            }
            Reading::CardFrame(bytes) => {
                let silent_s = since(self.last_motion.replace(time));
                // Who slept lay still.
                let just_woke = || {
                    let repr = CardFrame::new_checked(&bytes[..]).and_then(|frame| CardRepr::parse(&frame));
                    repr.is_ok_and(|repr| repr.header.flags.just_woke)
                };
                (silent_s > CARD_SILENT_S && !just_woke()).then_some(Lost::Sight(silent_s))
            }
            _ => None,
        }
    }

    /// Whether samples go on far behind the hint: its time then says nothing about theirs.
    pub fn is_hint_on_another_clock(&mut self, time: Timestamp) -> bool {
        let Some(hint) = self.hint else { return false };
        let first = *self.first_after_hint.get_or_insert(time);
        if time.secs_since(first) < HINT_SETTLED_S {
            return false;
        }
        self.hint = None;
        hint.secs_since(time) > HINT_AHEAD_S
    }
}
