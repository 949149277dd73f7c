//! What a card does with its readings: no clock, no memory beyond itself, so that firmware can run it too.

use fieldwalk_codec::{CardFlags, CardFrame, CardHeader, CardRepr, CardRound};
use serde::{Deserialize, Serialize};

use crate::gravity::VectorLowPass;
use crate::rotation::{cross, norm};

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
/// walks. The orientation is that of the top edge, or of the back where the top edge points up or down.
///
/// # Source
/// Kwak 2018, §4.1, §4.2 and §4.3: three max–min pairs of `|acc|` a round, `B_h` and `B_v` by a low-pass gravity (Eq. 1), the
/// mean orientation, and the last round's `|B|`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardRoundBuilder {
    gravity: VectorLowPass,
    /// `a` of Eq. 1 at 15 Hz.
    smoothing: f32,
    /// Accelerometer readings of the open round.
    n_readings: u8,
    /// Largest and smallest `|acc|` of each third, in m/s².
    extremes_m_s2: [Option<[f32; 2]>; 3],
    /// `B_h` and `B_v` of each third, in µT.
    level_ut: [Option<[f32; 2]>; 3],
    /// `|B|` of each third of the last round, in µT.
    previous_b_ut: [Option<f32>; 3],
    /// Sums of sines and cosines of the orientation.
    orientation: [f32; 2],
    card_id: u16,
    sequence: u8,
    just_woke: bool,
}

impl CardRoundBuilder {
    /// A card that has just been switched on.
    pub fn new(params: CardSensingParams, card_id: u16) -> Self {
        let period_s = 1.0 / (3.0 * f32::from(READINGS_A_THIRD));
        Self {
            gravity: VectorLowPass::default(),
            smoothing: VectorLowPass::factor(params.gravity_cutoff_hz, period_s),
            n_readings: 0,
            extremes_m_s2: [None; 3],
            level_ut: [None; 3],
            previous_b_ut: [None; 3],
            orientation: [0.0; 2],
            card_id,
            sequence: 0,
            just_woke: true,
        }
    }

    /// Whether the magnetometer is to be read now: once a third, after the third's third acceleration.
    pub fn wants_field(&self) -> bool {
        self.n_readings % READINGS_A_THIRD == FIELD_READING + 1
    }

    /// Reads the magnetometer, in µT; a round in which that is not done lacks the third.
    pub fn push_field(&mut self, field_ut: [f32; 3]) {
        let third = usize::from(self.n_readings.saturating_sub(1) / READINGS_A_THIRD).min(2);
        let Some(up) = self.up() else { return };
        let field = field_ut.map(f64::from);
        let vertical = dot(field, up);
        let north = [0, 1, 2].map(|c| field[c] - vertical * up[c]);
        let horizontal = norm(north);
        self.level_ut[third] = Some([horizontal as f32, vertical as f32]);
        let forward = if up[1].abs() < 0.85 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] };
        let east = cross(north, up);
        let (sin, cos) = (dot(forward, east), dot(forward, north));
        let length = (sin * sin + cos * cos).sqrt();
        if length > 1e-9 {
            self.orientation[0] += (sin / length) as f32;
            self.orientation[1] += (cos / length) as f32;
        }
    }

    /// Reads the accelerometer, in m/s²; gives the frame when that ends a round.
    pub fn push_force(&mut self, force_m_s2: [f32; 3]) -> Option<[u8; CardRepr::BUFFER_LEN]> {
        self.gravity.update(force_m_s2, self.smoothing);
        let [x, y, z] = force_m_s2;
        let magnitude = (x * x + y * y + z * z).sqrt();
        let third = usize::from(self.n_readings / READINGS_A_THIRD).min(2);
        let [max, min] = self.extremes_m_s2[third].unwrap_or([magnitude; 2]);
        self.extremes_m_s2[third] = Some([max.max(magnitude), min.min(magnitude)]);
        self.n_readings += 1;
        (self.n_readings == 3 * READINGS_A_THIRD).then(|| self.close_round())
    }

    /// Drops the open round; the next has a number that is `n_rounds` later. For readings that stay away that long.
    pub fn skip(&mut self, n_rounds: u8) {
        *self = Self {
            gravity: VectorLowPass::default(),
            sequence: self.sequence.wrapping_add(n_rounds),
            ..self.opened([None; 3])
        };
    }

    fn up(&self) -> Option<[f64; 3]> {
        let gravity = self.gravity.output()?.map(f64::from);
        let strength = norm(gravity);
        (strength > 1.0).then(|| gravity.map(|c| c / strength))
    }

    fn close_round(&mut self) -> [u8; CardRepr::BUFFER_LEN] {
        let [sin, cos] = self.orientation;
        let has_orientation = sin != 0.0 || cos != 0.0;
        let or_nan = |value: Option<f32>| value.unwrap_or(f32::NAN);
        let part =
            |pairs: [Option<[f32; 2]>; 3], c: usize| pairs.map(|pair| or_nan(pair.map(|pair| pair[c])));
        let round = CardRound {
            b_v_ut: part(self.level_ut, 1),
            b_h_ut: part(self.level_ut, 0),
            previous_b_ut: self.previous_b_ut.map(or_nan),
            acceleration_max_m_s2: part(self.extremes_m_s2, 0),
            acceleration_min_m_s2: part(self.extremes_m_s2, 1),
            orientation_rad: if has_orientation { libm::atan2f(sin, cos) } else { f32::NAN },
        };
        let flags = CardFlags { just_woke: self.just_woke, ..CardFlags::default() };
        let header = CardHeader { flags, battery: 0, sequence: self.sequence, card_id: self.card_id };
        let mut frame = [0; CardRepr::BUFFER_LEN];
        CardRepr::from_physical(header, &round).emit(&mut CardFrame::new_unchecked(&mut frame));
        let strengths_ut = self.level_ut.map(|level| level.map(|[h, v]| (h * h + v * v).sqrt()));
        *self =
            Self { sequence: self.sequence.wrapping_add(1), just_woke: false, ..self.opened(strengths_ut) };
        frame
    }

    /// The same card at the beginning of a round.
    fn opened(&self, previous_b_ut: [Option<f32>; 3]) -> Self {
        Self {
            n_readings: 0,
            extremes_m_s2: [None; 3],
            level_ut: [None; 3],
            previous_b_ut,
            orientation: [0.0; 2],
            ..*self
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
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
