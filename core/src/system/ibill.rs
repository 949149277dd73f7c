//! iBILL 2017: spawning particles weighed by three factors, corrected where clusters of iBeacons hang.

use crate::beacon_mode::BeaconModeParams;
use crate::observation::three_factors::ThreeFactorsParams;
use crate::particle::SpawningParams;
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, LengthSpread, MagneticRule, MotionParams, Recipe,
    StartRule,
};

/// φ⁻¹(0.9): half of the middle 80 % of a normal distribution, in standard deviations.
const HALF_OF_80_PERCENT: f32 = 1.281_551_6;
/// φ⁻¹(0.85): half of the middle 70 %.
const HALF_OF_70_PERCENT: f32 = 1.036_433_4;
/// 10°, the standard deviation of a turn in the source that iBILL cites.
const TURN_SD_RAD: f32 = core::f32::consts::PI / 18.0;

impl Recipe {
    /// Particles that spawn several each, weighed by step length, turn and the last five strengths of the field.
    ///
    /// Ours: the step length's mean (the paper's `l`), δ, the number of children and the cap on particles.
    ///
    /// # Source
    /// iBILL 2017, §IV, Eqs 6 to 18. The printed variances, 0.2 l and π/18, have no consistent dimension; the work that
    /// they are cited from has standard deviations of 0.2 l and 10°, which are used here. [`Recipe::ibill_as_printed`]
    /// has the others.
    pub fn ibill() -> Self {
        Self {
            name: "ibill".into(),
            start: StartRule::Circle { n_directions: 12, n_places: 80 },
            n_particles: 1000,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::GyroscopeTurns {
                    start_sd_rad: 0.22,
                    sd_rad: TURN_SD_RAD,
                    half_width_sd: HALF_OF_70_PERCENT,
                    from_rad: 0.17,
                },
                direction_sd_rad: 0.0,
                length: LengthRule::Interval {
                    spread: LengthSpread::ShareOfLength(0.2),
                    half_width_sd: HALF_OF_80_PERCENT,
                },
            },
            spawning: Some(SpawningParams { n_children: 3, kill_below: 1e-6 }),
            magnetic: MagneticRule::ThreeFactors(ThreeFactorsParams::default()),
            beacons: Some(BeaconModeParams::default()),
            resample_below: 0.0,
            accuracy: AccuracyParams { scale: 2.1, floor_m: 2.0, tail: 1.5 },
            ..Self::bare()
        }
    }

    /// [`Recipe::ibill`] with the variances that the paper prints: 0.2 l (in m²) and π/18 (in rad²), and with fixes that
    /// replace the particles.
    ///
    /// # Source
    /// iBILL 2017, Eqs 8 and 10, Fig. 4.
    pub fn ibill_as_printed() -> Self {
        let ibill = Self::ibill();
        let heading = match ibill.motion.heading {
            HeadingRule::GyroscopeTurns { start_sd_rad, half_width_sd, from_rad, .. } => {
                HeadingRule::GyroscopeTurns {
                    start_sd_rad,
                    sd_rad: TURN_SD_RAD.sqrt(),
                    half_width_sd,
                    from_rad,
                }
            }
            other => other,
        };
        let length = LengthRule::Interval {
            spread: LengthSpread::VarianceOfLength(0.2),
            half_width_sd: HALF_OF_80_PERCENT,
        };
        Self {
            name: "ibill-as-printed".into(),
            motion: MotionParams { heading, length, ..ibill.motion },
            beacons: ibill.beacons.map(|beacons| BeaconModeParams { fix_share: None, ..beacons }),
            ..ibill
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_readings_of_the_spread_by_hand() {
        let spread = |recipe: Recipe| match recipe.motion {
            MotionParams {
                length: LengthRule::Interval { spread, half_width_sd },
                heading: HeadingRule::GyroscopeTurns { sd_rad, .. },
                ..
            } => [half_width_sd * spread.sd_m(0.7), sd_rad.to_degrees()],
            _ => [f32::NAN; 2],
        };
        let is_near =
            |seen: [f32; 2], [m, deg]: [f32; 2]| (seen[0] - m).abs() < 1e-4 && (seen[1] - deg).abs() < 0.01;
        // 1.2816·0.2·0.7 m and 10°; 1.2816·sqrt(0.2·0.7) m and sqrt(π/18) rad.
        assert!(is_near(spread(Recipe::ibill()), [0.1794, 10.0]), "{:?}", spread(Recipe::ibill()));
        let printed = spread(Recipe::ibill_as_printed());
        assert!(is_near(printed, [0.4795, 23.936]), "{printed:?}");
    }
}
