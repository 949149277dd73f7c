//! A phone's samples read as a card would read its sensors.

use fieldwalk_codec::CardRepr;
use serde::{Deserialize, Serialize};

use crate::card::builder::{CardRoundBuilder, CardSensingParams};
use crate::sensor::{Reading, Sample};
use crate::time::{Duration, Timestamp};

/// The accelerometer is read at 15 Hz.
const READING_PERIOD: Duration = Duration::from_nanos(66_666_667);
/// Nothing is read across a gap that is longer than this.
const MAX_GAP: Duration = Duration::from_millis(400);
/// A round.
const ROUND_S: f64 = 1.0;

/// A card made of a phone: the same readings, low-pass, rounding and frame.
///
/// The specific force is interpolated to 15 Hz. Of the magnetometer the last sample counts, as a sensor holds its last
/// conversion; of two streams the uncalibrated one, with the bias that came with it first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardEmulator {
    builder: CardRoundBuilder,
    last_force: Option<(Timestamp, [f32; 3])>,
    next_reading: Timestamp,
    last_field: Option<(Timestamp, [f32; 3])>,
    bias_ut: Option<[f32; 3]>,
}

impl Default for CardEmulator {
    fn default() -> Self {
        Self {
            builder: CardRoundBuilder::new(CardSensingParams::default(), 0),
            last_force: None,
            next_reading: Timestamp::MIN,
            last_field: None,
            bias_ut: None,
        }
    }
}

impl CardEmulator {
    /// Consumes a sample (in order of time); gives the frame that it completes, if any.
    pub fn push(&mut self, sample: &Sample) -> Option<[u8; CardRepr::BUFFER_LEN]> {
        match sample.reading {
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                let bias = *self.bias_ut.get_or_insert(bias_ut);
                self.last_field = Some((sample.time, [0, 1, 2].map(|c| field_ut[c] - bias[c])));
            }
            Reading::MagneticField(field_ut) if self.bias_ut.is_none() => {
                self.last_field = Some((sample.time, field_ut));
            }
            Reading::SpecificForce(force) => return self.push_force(sample.time, force),
            _ => {}
        }
        None
    }

    fn push_force(&mut self, time: Timestamp, force: [f32; 3]) -> Option<[u8; CardRepr::BUFFER_LEN]> {
        let Some((last_time, last)) = self.last_force.replace((time, force)) else {
            self.next_reading = time;
            return self.read(time, force);
        };
        let gap = time - last_time;
        if gap > MAX_GAP || gap < Duration::ZERO {
            // A clock that was set back says nothing of how long it took.
            let n_missed = gap.as_nanos() as f64 * 1e-9 / ROUND_S;
            self.builder.skip(n_missed.clamp(1.0, 255.0) as u8);
            self.next_reading = time;
            return self.read(time, force);
        }
        let mut frame = None;
        // A gap that is read across spans seven readings at most, hence ends one round at most.
        while self.next_reading <= time && self.next_reading < Timestamp::MAX {
            let at = self.next_reading;
            let gap_s = time.secs_since(last_time);
            let share = if gap_s > 0.0 { (at.secs_since(last_time) / gap_s) as f32 } else { 1.0 };
            let reading = core::array::from_fn(|c| last[c] + share * (force[c] - last[c]));
            frame = self.read(at, reading).or(frame);
        }
        frame
    }

    fn read(&mut self, time: Timestamp, force: [f32; 3]) -> Option<[u8; CardRepr::BUFFER_LEN]> {
        self.next_reading = time + READING_PERIOD;
        let frame = self.builder.push_force(force);
        if self.builder.wants_field()
            && let Some((_, field_ut)) = self.last_field.filter(|(at, _)| time - *at <= MAX_GAP)
        {
            self.builder.push_field(field_ut);
        }
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk_codec::CardFrame;

    /// The frames of a phone that lies on a table, read at 50 Hz from `from_ms` to `to_ms`.
    fn frames(emulator: &mut CardEmulator, from_ms: i64, to_ms: i64) -> Vec<(i64, CardRepr)> {
        let mut frames = Vec::new();
        for at_ms in (from_ms..to_ms).step_by(20) {
            let time = Timestamp::from_millis(at_ms);
            let field_ut = [0.0, 22.0, -40.0];
            emulator.push(&Sample { time, reading: Reading::MagneticField(field_ut) });
            let force = Reading::SpecificForce([0.0, 0.0, 9.81]);
            if let Some(frame) = emulator.push(&Sample { time, reading: force }) {
                frames.push((at_ms, CardRepr::parse(&CardFrame::new_checked(frame).unwrap()).unwrap()));
            }
        }
        frames
    }

    #[test]
    fn a_phone_on_a_table_is_a_card_on_a_table() {
        let frames = frames(&mut CardEmulator::default(), 0, 10_000);
        // The fifteenth reading of each second falls 0.93 s after its first.
        assert_eq!(frames.iter().map(|(at_ms, _)| at_ms / 1_000).collect::<Vec<_>>(), Vec::from_iter(0..10));
        for (k, (_, repr)) in frames.iter().enumerate() {
            assert_eq!((repr.b_h, repr.b_v, repr.orientation), ([550; 3], [-1000; 3], 0));
            assert_eq!((usize::from(repr.header.sequence), repr.acceleration_max), (k, [10; 3]));
        }
    }

    #[test]
    fn a_gap_is_rounds_that_nobody_heard() {
        let mut emulator = CardEmulator::default();
        frames(&mut emulator, 0, 5_000);
        let after = frames(&mut emulator, 9_000, 11_000);
        // The rounds from 5 s to 9 s are missing.
        assert_eq!(after[0].1.header.sequence, 9);
    }
}
