//! A round from its readings.

use fieldwalk_codec::CardRound;

use crate::level::{LevelReading, norm};

/// Readings of the accelerometer and the magnetometer in, a round out.
///
/// Readings are in the device frame of phones: a card hangs like a phone held up with its back to where the wearer
/// walks. A round has three thirds; each holds the largest and the smallest `|acc|`, and the mean of the fields read in
/// it, in the frame of a low-pass gravity. Fields are averaged as vectors: noise of a reading makes the length of its
/// horizontal part greater, and that of their mean hardly. What was not read is NaN, as the codec has it. No clock, no memory
/// beyond itself.
///
/// # Source
/// Kwak 2018, §4.1, §4.2 and §4.3: three max–min pairs of `|acc|` a round, `B_h` and `B_v` by a low-pass gravity (Eq. 1), the
/// mean orientation, and the last round's `|B|`. That several fields of a third are averaged is ours.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoundBuilder {
    /// `a` of Eq. 1.
    smoothing: f32,
    gravity_m_s2: Option<[f32; 3]>,
    /// Largest and smallest `|acc|` of each third, in m/s².
    extremes_m_s2: [Option<[f32; 2]>; 3],
    /// Sums of the fields of each third, in µT, and of the gravities of their times, and how many there are.
    fields_ut: [[f32; 3]; 3],
    gravities_m_s2: [[f32; 3]; 3],
    n_fields: [u16; 3],
    /// `|B|` of each third of the last round, in µT.
    previous_b_ut: [Option<f32>; 3],
}

impl RoundBuilder {
    /// A builder that has read nothing, whose gravity follows by `smoothing`: see [`low_pass_factor`](crate::low_pass_factor).
    pub fn new(smoothing: f32) -> Self {
        Self {
            smoothing,
            gravity_m_s2: None,
            extremes_m_s2: [None; 3],
            fields_ut: [[0.0; 3]; 3],
            gravities_m_s2: [[0.0; 3]; 3],
            n_fields: [0; 3],
            previous_b_ut: [None; 3],
        }
    }

    /// Reads the accelerometer, in m/s², in a third of the round, 0 to 2; later ones count as the last. What is not
    /// finite is left out.
    pub fn push_force(&mut self, third: usize, force_m_s2: [f32; 3]) {
        let magnitude = norm(force_m_s2);
        if !magnitude.is_finite() {
            return;
        }
        let a = self.smoothing;
        self.gravity_m_s2 = Some(match self.gravity_m_s2 {
            None => force_m_s2,
            Some(y) => [0, 1, 2].map(|c| a * force_m_s2[c] + (1.0 - a) * y[c]),
        });
        let third = third.min(2);
        let [max, min] = self.extremes_m_s2[third].unwrap_or([magnitude; 2]);
        self.extremes_m_s2[third] = Some([max.max(magnitude), min.min(magnitude)]);
    }

    /// Reads the magnetometer, in µT, in a third of the round. Nothing counts before the first acceleration, nor what is
    /// not finite.
    pub fn push_field(&mut self, third: usize, field_ut: [f32; 3]) {
        let third = third.min(2);
        let Some(gravity_m_s2) = self.gravity_m_s2.filter(|gravity| LevelReading::has_up(*gravity)) else {
            return;
        };
        if self.n_fields[third] == u16::MAX || !field_ut.iter().all(|c| c.is_finite()) {
            return;
        }
        for c in 0..3 {
            self.fields_ut[third][c] += field_ut[c];
            self.gravities_m_s2[third][c] += gravity_m_s2[c];
        }
        self.n_fields[third] += 1;
    }

    /// The low-pass gravity's reaction, in m/s², device frame, once there was an acceleration.
    pub fn gravity_m_s2(&self) -> Option<[f32; 3]> {
        self.gravity_m_s2
    }

    /// Largest less smallest `|acc|` of the open round, in m/s²; nothing before the first.
    pub fn swing_m_s2(&self) -> Option<f32> {
        let pairs = || self.extremes_m_s2.iter().flatten();
        let max = pairs().map(|pair| pair[0]).reduce(f32::max)?;
        let min = pairs().map(|pair| pair[1]).reduce(f32::min)?;
        Some(max - min)
    }

    /// Closes the round, and opens the next.
    pub fn close(&mut self) -> CardRound {
        let thirds = [0, 1, 2].map(|third| self.level_reading(third));
        let [sin, cos] = thirds
            .iter()
            .flatten()
            .filter_map(|level| level.heading)
            .fold([0.0f32; 2], |[sum_sin, sum_cos], [sin, cos]| [sum_sin + sin, sum_cos + cos]);
        let has_orientation = sin != 0.0 || cos != 0.0;
        let or_nan = |value: Option<f32>| value.unwrap_or(f32::NAN);
        let level_ut =
            thirds.map(|level| level.map_or([f32::NAN; 2], |level| [level.horizontal_ut, level.vertical_ut]));
        let round = CardRound {
            b_v_ut: level_ut.map(|level| level[1]),
            b_h_ut: level_ut.map(|level| level[0]),
            previous_b_ut: self.previous_b_ut.map(or_nan),
            acceleration_max_m_s2: self.extremes_m_s2.map(|pair| or_nan(pair.map(|pair| pair[0]))),
            acceleration_min_m_s2: self.extremes_m_s2.map(|pair| or_nan(pair.map(|pair| pair[1]))),
            orientation_rad: if has_orientation { libm::atan2f(sin, cos) } else { f32::NAN },
        };
        let strengths_ut = level_ut.map(|[h, v]| libm::sqrtf(h * h + v * v));
        *self = Self {
            gravity_m_s2: self.gravity_m_s2,
            previous_b_ut: strengths_ut.map(|strength_ut| (!strength_ut.is_nan()).then_some(strength_ut)),
            ..Self::new(self.smoothing)
        };
        round
    }

    /// The mean field of a third, by the mean gravity of its readings' times.
    fn level_reading(&self, third: usize) -> Option<LevelReading> {
        let n = f32::from(self.n_fields[third]);
        let mean = |sums: [f32; 3]| sums.map(|sum| sum / n);
        (n > 0.0)
            .then(|| LevelReading::of(mean(self.fields_ut[third]), mean(self.gravities_m_s2[third])))?
            .filter(|level| level.horizontal_ut.is_finite() && level.vertical_ut.is_finite())
    }

    /// Forgets the open round, the last one and gravity: the next reading comes after a gap.
    pub fn restart(&mut self) {
        *self = Self::new(self.smoothing);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_and_means_of_thirds_by_hand() {
        let mut builder = RoundBuilder::new(0.1);
        for (third, forces) in [[9.0, 13.0, 8.0], [9.8, 9.8, 9.8], [7.0, 17.5, 9.8]].iter().enumerate() {
            for force in forces {
                builder.push_force(third, [0.0, *force, 0.0]);
            }
            builder.push_field(third, [-20.0, -45.0 + third as f32, 0.0]);
            builder.push_field(third, [-22.0, -45.0 + third as f32, 0.0]);
        }
        assert_eq!(builder.swing_m_s2(), Some(10.5));
        let round = builder.close();
        assert_eq!(round.acceleration_max_m_s2, [13.0, 9.8, 17.5]);
        assert_eq!(round.acceleration_min_m_s2, [8.0, 9.8, 7.0]);
        assert_eq!((round.b_h_ut, round.b_v_ut), ([21.0; 3], [-45.0, -44.0, -43.0]));
        assert!((round.orientation_rad - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!(round.previous_b_ut.iter().all(|b| b.is_nan()));
        let next = builder.close();
        // √(21² + 45²) = 49.66
        assert!((next.previous_b_ut[0] - 49.66).abs() < 0.01 && next.b_h_ut[0].is_nan());
    }

    #[test]
    fn fields_of_a_third_are_averaged_as_vectors() {
        let mut builder = RoundBuilder::new(0.1);
        builder.push_force(0, [0.0, 9.8, 0.0]);
        // Noise of 15 µT to the left and to the right of 20 µT: each is 25 µT long, their mean is not.
        for (third, across) in [[15.0, -15.0], [0.0, 0.0]].iter().enumerate() {
            for x in across {
                builder.push_field(third, [*x, -45.0, -20.0]);
            }
        }
        let round = builder.close();
        assert_eq!((round.b_h_ut[0], round.b_h_ut[1], round.b_v_ut[0]), (20.0, 20.0, -45.0));
        assert_eq!(round.orientation_rad, 0.0);
        assert!(round.b_h_ut[2].is_nan());
    }

    #[test]
    fn gravity_follows_equation_1() {
        let mut builder = RoundBuilder::new(0.25);
        builder.push_force(0, [0.0, 0.0, 8.0]);
        builder.push_force(0, [4.0, 0.0, 8.0]);
        builder.push_force(0, [4.0, 0.0, 12.0]);
        assert_eq!(builder.gravity_m_s2(), Some([1.75, 0.0, 9.0]));
    }

    #[test]
    fn nonsense_is_left_out_and_later_thirds_count_as_the_last() {
        let mut builder = RoundBuilder::new(0.25);
        builder.push_field(0, [1.0, 2.0, 3.0]);
        builder.push_force(0, [f32::NAN, 0.0, 0.0]);
        builder.push_force(0, [f32::INFINITY, 0.0, 0.0]);
        builder.push_force(9, [0.0, 9.8, 0.0]);
        builder.push_field(9, [f32::NAN; 3]);
        builder.push_field(9, [20.0, -40.0, 0.0]);
        let round = builder.close();
        assert!(round.b_h_ut[0].is_nan() && round.acceleration_max_m_s2[0].is_nan());
        assert_eq!((round.b_h_ut[2], round.b_v_ut[2], round.acceleration_max_m_s2[2]), (20.0, -40.0, 9.8));
    }
}
