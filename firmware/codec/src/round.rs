//! What one round of a card says, in physical units.

use crate::card::{CardFlags, CardHeader, CardRepr};
use crate::quantisation::{
    acceleration_from_m_s2, b_h_from_ut, b_h_ut, b_v_from_ut, b_v_ut, orientation_from_rad, orientation_rad,
    previous_b_from_ut, previous_b_ut,
};

/// One round (one second) of a card's measurements, in physical units.
///
/// NaN is "not measured", on the way in and on the way out. Arrays run over the thirds of the round, first to last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardRound {
    /// Vertical component of the field, up positive, in µT; ±1200.
    pub b_v_ut: [f32; 3],
    /// Magnitude of the horizontal component of the field, in µT; 0 to 1200.
    pub b_h_ut: [f32; 3],
    /// Magnitude of the field in the round before, in µT; 1 to 255, where 255 means "255 or more".
    pub previous_b_ut: [f32; 3],
    /// Largest magnitude of the specific force in each third, in m/s²; 0 to 15, where 15 means "15 or more".
    pub acceleration_max_m_s2: [f32; 3],
    /// Smallest magnitude of the specific force in each third, in m/s²; 0 to 15, where 15 means "15 or more".
    pub acceleration_min_m_s2: [f32; 3],
    /// Mean orientation of the round, clockwise from magnetic north, in rad.
    pub orientation_rad: f32,
}

impl CardRepr {
    /// The repr nearest to `round`.
    ///
    /// Values are rounded to the nearest step of their field, halves away from zero, and saturate: `B_v` at
    /// ±1200 µT, `B_h` at 0 and 1200 µT, the last round's `|B|` at 1 and 255 µT, acceleration at 0 and 15 m/s².
    /// Orientation wraps. The error is at most half a step within those ranges.
    ///
    /// NaN in a magnetic sample becomes that field's "missing" value and leaves the others alone. The acceleration
    /// nibbles and the orientation have no spare value: NaN in any of them, or an infinite orientation, zeroes
    /// all seven and sets [`CardFlags::motion_missing`], which this function owns: what `header` says of it is
    /// overwritten.
    pub fn from_physical(header: CardHeader, round: &CardRound) -> Self {
        let motion = quantise_motion(round);
        let (acceleration_max, acceleration_min, orientation) = motion.unwrap_or_default();
        Self {
            header: CardHeader {
                flags: CardFlags { motion_missing: motion.is_none(), ..header.flags },
                ..header
            },
            b_v: round.b_v_ut.map(b_v_from_ut),
            b_h: round.b_h_ut.map(b_h_from_ut),
            previous_b: round.previous_b_ut.map(previous_b_from_ut),
            acceleration_max,
            acceleration_min,
            orientation,
        }
    }

    /// The round that this repr stands for; NaN where the card measured nothing.
    ///
    /// Total over every repr. A sender may break the ranges of [`CardRepr::from_physical`]: raw values beyond
    /// ±1200 µT come back as what they say, up to 2621.4 µT.
    pub fn to_physical(&self) -> CardRound {
        let motion = |value: f32| if self.header.flags.motion_missing { f32::NAN } else { value };
        CardRound {
            b_v_ut: self.b_v.map(b_v_ut),
            b_h_ut: self.b_h.map(b_h_ut),
            previous_b_ut: self.previous_b.map(previous_b_ut),
            acceleration_max_m_s2: self.acceleration_max.map(|nibble| motion(f32::from(nibble))),
            acceleration_min_m_s2: self.acceleration_min.map(|nibble| motion(f32::from(nibble))),
            orientation_rad: motion(orientation_rad(self.orientation)),
        }
    }
}

/// Maxima, minima and orientation in steps; `None` where one of them was not measured.
fn quantise_motion(round: &CardRound) -> Option<([u8; 3], [u8; 3], u8)> {
    let nibbles = |[first, second, last]: [f32; 3]| {
        Some([acceleration_from_m_s2(first)?, acceleration_from_m_s2(second)?, acceleration_from_m_s2(last)?])
    };
    Some((
        nibbles(round.acceleration_max_m_s2)?,
        nibbles(round.acceleration_min_m_s2)?,
        orientation_from_rad(round.orientation_rad)?,
    ))
}

/// The gap that [`sequence_gap`] gives for a frame heard twice.
pub const SEQUENCE_REPEATED: u8 = u8::MAX;

/// How many frames were lost between two that were heard, by their sequence numbers.
///
/// 0: `current` follows `previous`. 1: one frame was lost, and the `|B|` in `current` is that of the lost round.
/// Larger: that many were lost. [`SEQUENCE_REPEATED`] (255): the same frame again, as when several receivers
/// hear one advertisement. The number wraps after 256 rounds, so a silence of about four minutes or longer is
/// told by the receiver's clock, and a frame that arrives late looks like a gap of nearly 255.
pub const fn sequence_gap(previous: u8, current: u8) -> u8 {
    current.wrapping_sub(previous).wrapping_sub(1)
}
