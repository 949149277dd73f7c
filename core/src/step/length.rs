//! How long a step is.

use serde::{Deserialize, Serialize};

use crate::step::StepCycle;

/// How long a step is, from what is known of it: pure models, the walker's own scale left to others.
///
/// Lengths that vary by chance (the papers' "normal" model) are a model here with the noise of
/// [`LengthRule::Scaled`](crate::system::LengthRule::Scaled); genetic ones are
/// [`LengthRule::Genetic`](crate::system::LengthRule::Genetic).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepLengthModel {
    /// Every step has the same length, in metres.
    ///
    /// # Source
    /// Mass-centred 2019, step-length experiment: 0.65 m.
    Static {
        /// The length, in metres.
        length_m: f32,
    },
    /// `length = offset + per_hz·f`, in metres: who steps faster steps longer.
    ///
    /// # Source
    /// Mass-centred 2019, step-length experiment, the "frequency" model; its coefficients are not given.
    Frequency {
        /// Constant term, in metres.
        offset_m: f32,
        /// Metres per Hz of step frequency.
        per_hz_m: f32,
    },
    /// `length = offset + per_hz·f + per_root·(a_max − a_min)^¼`, in metres.
    ///
    /// # Source
    /// WILA 2016, Eq. 3 (the Weinberg fourth root), with a frequency term; coefficients are ours, by least squares
    /// over surveyed segments.
    FrequencyAmplitude {
        /// Constant term, in metres.
        offset_m: f32,
        /// Metres per Hz of step frequency.
        per_hz_m: f32,
        /// Metres per fourth root of the amplitude in m/s².
        per_root_m: f32,
    },
    /// `length = K·(a_max − a_min)^¼`, in metres.
    ///
    /// # Source
    /// WILA 2016, Eq. 3. The scan reads `K·4√(…)`, which is taken for the fourth root, the form of Weinberg.
    Weinberg {
        /// `K`, in metres per fourth root of m/s²; about 0.45, and a walker's own by
        /// [`trained`](StepLengthModel::trained).
        k_m: f32,
    },
}

/// Share of a full step by which the body advances at the first step of a walk.
///
/// From standing with both feet together the first swing moves the body half a step (gait initiation).
const FIRST_STEP_SHARE: f32 = 0.5;

impl StepLengthModel {
    /// How far `cycle` carries the walker by this model, in metres.
    pub fn advance_m(&self, cycle: &StepCycle) -> f32 {
        let share = if cycle.is_first { FIRST_STEP_SHARE } else { 1.0 };
        share * self.length_m(cycle.frequency_hz, cycle.amplitude_m_s2)
    }

    /// The length of a step of this frequency and amplitude, in metres; between 0.2 and 1.2.
    pub fn length_m(&self, frequency_hz: f32, amplitude_m_s2: f32) -> f32 {
        let root = || amplitude_m_s2.max(0.0).sqrt().sqrt();
        let length_m = match *self {
            Self::Static { length_m } => length_m,
            Self::Frequency { offset_m, per_hz_m } => offset_m + per_hz_m * frequency_hz,
            Self::FrequencyAmplitude { offset_m, per_hz_m, per_root_m } => {
                offset_m + per_hz_m * frequency_hz + per_root_m * root()
            }
            Self::Weinberg { k_m } => k_m * root(),
        };
        length_m.clamp(0.2, 1.2)
    }

    /// The same model for the walker who went `known_m` while it said `walked_m`: `K ← K·L_r/L_0`, and likewise the
    /// coefficients of the others.
    ///
    /// Distances that are not finite and positive teach nothing, and one walk no more than a factor of two.
    ///
    /// # Source
    /// WILA 2016, Eq. 4. Learning from many uncertain distances is
    /// [`LengthScaleEstimator`](crate::step::LengthScaleEstimator)'s.
    #[must_use]
    pub fn trained(self, known_m: f32, walked_m: f32) -> Self {
        let ratio = known_m / walked_m;
        let is_usable = known_m > 0.0 && walked_m > 0.0 && ratio.is_finite();
        let scale = if is_usable { ratio.clamp(0.5, 2.0) } else { 1.0 };
        match self {
            Self::Static { length_m } => Self::Static { length_m: scale * length_m },
            Self::Frequency { offset_m, per_hz_m } => {
                Self::Frequency { offset_m: scale * offset_m, per_hz_m: scale * per_hz_m }
            }
            Self::FrequencyAmplitude { offset_m, per_hz_m, per_root_m } => Self::FrequencyAmplitude {
                offset_m: scale * offset_m,
                per_hz_m: scale * per_hz_m,
                per_root_m: scale * per_root_m,
            },
            Self::Weinberg { k_m } => Self::Weinberg { k_m: scale * k_m },
        }
    }
}

/// How far a step of `length_m` carries the walker when the body turns by `turn_rad` in it: `l·sin((π − θ)/2)`.
///
/// Half a turn carries nowhere; turns beyond that count as half a turn.
///
/// # Source
/// Mass-centred 2019, Eq. 14.
pub fn turned_length_m(length_m: f32, turn_rad: f32) -> f32 {
    let turn_rad = turn_rad.abs().min(core::f32::consts::PI);
    length_m * libm::sinf(0.5 * (core::f32::consts::PI - turn_rad))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, FRAC_PI_3, PI};

    #[test]
    fn lengths_by_hand() {
        assert_eq!(StepLengthModel::Static { length_m: 0.65 }.length_m(2.0, 9.0), 0.65);
        let model = StepLengthModel::FrequencyAmplitude { offset_m: 0.1, per_hz_m: 0.05, per_root_m: 0.2 };
        // 0.1 + 0.05·2 + 0.2·16^¼ = 0.6
        assert!((model.length_m(2.0, 16.0) - 0.6).abs() < 1e-6);
        assert_eq!(model.length_m(2.0, f32::NAN.max(0.0)), 0.2);
        // 0.28 + 0.2·1.75 = 0.63
        let model = StepLengthModel::Frequency { offset_m: 0.28, per_hz_m: 0.2 };
        assert!((model.length_m(1.75, 3.0) - 0.63).abs() < 1e-6);
    }

    #[test]
    fn wila_equations_3_and_4_by_hand() {
        // 0.4·(4.5 − 2.6 + 3.1625)^¼ = 0.4·5.0625^¼ = 0.4·1.5
        let model = StepLengthModel::Weinberg { k_m: 0.4 };
        assert!((model.length_m(1.8, 5.0625) - 0.6).abs() < 1e-6);
        // 30 m walked, 25 m said: 0.4·30/25
        assert_eq!(model.trained(30.0, 25.0), StepLengthModel::Weinberg { k_m: 0.4 * 1.2 });
        for (known_m, walked_m) in [(0.0, 25.0), (30.0, 0.0), (f32::NAN, 25.0), (-3.0, 2.0)] {
            assert_eq!(model.trained(known_m, walked_m), model);
        }
        assert_eq!(model.trained(1e9, 1.0), StepLengthModel::Weinberg { k_m: 0.8 });
    }

    #[test]
    fn mass_centred_equation_14_by_hand() {
        assert_eq!(turned_length_m(0.7, 0.0), 0.7);
        // sin((π − π/3)/2) = sin 60°; sin((π − π/2)/2) = sin 45°
        assert!((turned_length_m(0.7, FRAC_PI_3) - 0.7 * 0.866_025_4).abs() < 1e-6);
        assert!((turned_length_m(0.7, -FRAC_PI_2) - 0.7 * 0.707_106_77).abs() < 1e-6);
        assert!(turned_length_m(0.7, PI).abs() < 1e-6 && turned_length_m(0.7, 9.0).abs() < 1e-6);
    }

    #[test]
    fn training_scales_every_model() {
        for model in [
            StepLengthModel::Static { length_m: 0.65 },
            StepLengthModel::Frequency { offset_m: 0.28, per_hz_m: 0.2 },
            StepLengthModel::FrequencyAmplitude { offset_m: 0.1, per_hz_m: 0.05, per_root_m: 0.2 },
            StepLengthModel::Weinberg { k_m: 0.4 },
        ] {
            let (before, after) = (model.length_m(1.8, 4.0), model.trained(11.0, 10.0).length_m(1.8, 4.0));
            assert!((after / before - 1.1).abs() < 1e-5, "{model:?}");
        }
    }
}
