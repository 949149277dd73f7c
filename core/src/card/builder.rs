//! What a card of the paper's rates does with its readings: no clock, no memory beyond itself.

use fieldwalk_card::{RoundBuilder, low_pass_factor};
use fieldwalk_codec::{CardFlags, CardFrame, CardHeader, CardRepr};
use serde::{Deserialize, Serialize};

/// Accelerometer readings in a third of a round.
pub(super) const READINGS_A_THIRD: u8 = 5;
/// Reading of a third beside which the magnetometer is read: the middle one.
pub(super) const FIELD_READING: u8 = 2;

/// What a card is tuned to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardSensingParams {
    /// Cut-off of gravity's low-pass, in Hz; default 0.3: half of the slowest walk's frequency, so that steps do not tilt
    /// the vertical, and a card that turns on its strap is upright again within seconds.
    pub gravity_cutoff_hz: f32,
}

impl Default for CardSensingParams {
    fn default() -> Self {
        Self { gravity_cutoff_hz: 0.3 }
    }
}

/// Fifteen readings of the accelerometer and three of the magnetometer a second in, a frame a second out.
///
/// Readings are in the device frame of phones: a card hangs like a phone held up with its back to where the wearer
/// walks. The orientation is that of the top edge, or of the back where the top edge points up or down. The arithmetic is
/// [`fieldwalk_card::RoundBuilder`], which runs on cards.
///
/// # Source
/// Kwak 2018, §4.1, §4.2 and §4.3: three max–min pairs of `|acc|` a round, `B_h` and `B_v` by a low-pass gravity (Eq. 1), the
/// mean orientation, and the last round's `|B|`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardRoundBuilder {
    rounds: RoundBuilder,
    /// Accelerometer readings of the open round.
    n_readings: u8,
    card_id: u16,
    sequence: u8,
    just_woke: bool,
}

impl CardRoundBuilder {
    /// A card that has just been switched on.
    pub fn new(params: CardSensingParams, card_id: u16) -> Self {
        let period_s = 1.0 / (3.0 * f32::from(READINGS_A_THIRD));
        let rounds = RoundBuilder::new(low_pass_factor(params.gravity_cutoff_hz, period_s));
        Self { rounds, n_readings: 0, card_id, sequence: 0, just_woke: true }
    }

    /// Whether the magnetometer is to be read now: once a third, after the third's third acceleration.
    pub fn wants_field(&self) -> bool {
        self.n_readings % READINGS_A_THIRD == FIELD_READING + 1
    }

    /// Reads the magnetometer, in µT; a round in which that is not done lacks the third.
    pub fn push_field(&mut self, field_ut: [f32; 3]) {
        self.rounds.push_field(usize::from(self.n_readings.saturating_sub(1) / READINGS_A_THIRD), field_ut);
    }

    /// Reads the accelerometer, in m/s²; gives the frame when that ends a round.
    pub fn push_force(&mut self, force_m_s2: [f32; 3]) -> Option<[u8; CardRepr::BUFFER_LEN]> {
        self.rounds.push_force(usize::from(self.n_readings / READINGS_A_THIRD), force_m_s2);
        self.n_readings += 1;
        (self.n_readings == 3 * READINGS_A_THIRD).then(|| self.close_round())
    }

    /// Drops the open round; the next has a number that is `n_rounds` later. For readings that stay away that long.
    pub fn skip(&mut self, n_rounds: u8) {
        self.rounds.restart();
        self.n_readings = 0;
        self.sequence = self.sequence.wrapping_add(n_rounds);
    }

    fn close_round(&mut self) -> [u8; CardRepr::BUFFER_LEN] {
        let flags = CardFlags { just_woke: self.just_woke, ..CardFlags::default() };
        let header = CardHeader { flags, battery: 0, sequence: self.sequence, card_id: self.card_id };
        let mut frame = [0; CardRepr::BUFFER_LEN];
        CardRepr::from_physical(header, &self.rounds.close()).emit(&mut CardFrame::new_unchecked(&mut frame));
        self.n_readings = 0;
        self.sequence = self.sequence.wrapping_add(1);
        self.just_woke = false;
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A round of a card that hangs upright, its back to the east, where the field is 20 µT north and 45 µT down.
    fn round(builder: &mut CardRoundBuilder, forces_m_s2: [f32; 15]) -> CardRepr {
        let mut frame = None;
        for force in forces_m_s2 {
            frame = builder.push_force([0.0, force, 0.0]);
            if builder.wants_field() {
                // The back looks east, so that x, to the right of who sees the screen, looks south.
                builder.push_field([-20.0, -45.0, 0.0]);
            }
        }
        CardRepr::parse(&CardFrame::new_checked(frame.unwrap()).unwrap()).unwrap()
    }

    const FORCES: [f32; 15] =
        [9.8, 11.6, 13.2, 10.0, 8.4, 7.2, 6.9, 9.0, 9.8, 10.2, 9.8, 9.8, 9.8, 9.8, 17.0];

    #[test]
    fn a_round_by_hand() {
        let mut builder = CardRoundBuilder::new(CardSensingParams::default(), 7);
        let repr = round(&mut builder, FORCES);
        assert_eq!((repr.acceleration_max, repr.acceleration_min), ([13, 10, 15], [8, 7, 10]));
        assert_eq!((repr.b_v, repr.b_h), ([-1125; 3], [500; 3]));
        // East is a quarter turn from north: 64 of 256.
        assert_eq!((repr.orientation, repr.previous_b), (64, [0; 3]));
        assert_eq!((repr.header.sequence, repr.header.card_id, repr.header.flags.just_woke), (0, 7, true));
        let repr = round(&mut builder, FORCES);
        // |B| = √(20² + 45²) = 49.2
        assert_eq!((repr.previous_b, repr.header.sequence, repr.header.flags.just_woke), ([49; 3], 1, false));
    }

    #[test]
    fn what_is_not_measured_is_said_to_be_missing() {
        let mut builder = CardRoundBuilder::new(CardSensingParams::default(), 7);
        let frames: Vec<_> = (0..15).filter_map(|_| builder.push_force([0.0, 9.8, 0.0])).collect();
        let repr = CardRepr::parse(&CardFrame::new_checked(frames[0]).unwrap()).unwrap();
        assert!(repr.header.flags.motion_missing);
        assert!(repr.to_physical().b_v_ut.iter().all(|b_v_ut| b_v_ut.is_nan()));
        builder.push_force([0.0, 9.8, 0.0]);
        builder.skip(3);
        assert_eq!(round(&mut builder, FORCES).header.sequence, 4);
    }
}
