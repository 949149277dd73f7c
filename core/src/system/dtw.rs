//! The baseline of phones: histories under dynamic time warping.

use crate::observation::history::{HistoryFeature, HistoryMetric, HistoryParams};
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MagneticRule, MotionParams, PlanRule, Recipe,
};

impl Recipe {
    /// Steps, compass and gyroscope of a phone; histories of the field compared under dynamic time warping; a floor plan
    /// whose walls kill.
    ///
    /// # Source
    /// The particle filter of Magicol as its competitors describe it (Kwak 2018, §5.3.3; Mass-centred 2019, Fig. 20);
    /// window, σ and the stated accuracy are ours.
    pub fn dtw() -> Self {
        Self {
            name: "dtw".into(),
            n_particles: 1000,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::Gyroscope { start_sd_rad: 0.22, walk_sd_rad: 0.025 },
                direction_sd_rad: 0.06,
                length: LengthRule::Scaled { scale_sd: 0.06, scale_walk_sd: 0.004, step_sd: 0.08 },
            },
            plan: PlanRule::Purge,
            magnetic: MagneticRule::History(HistoryParams {
                metric: HistoryMetric::DynamicTimeWarping { band: None },
                feature: HistoryFeature::HorizontalVertical,
                window: 30,
                reads_a_move: 1,
                sigma_ut: 17.0,
                counts_once: false,
            }),
            resample_below: 0.7,
            accuracy: AccuracyParams { scale: 1.15, floor_m: 1.3, tail: 1.15 },
            ..Self::bare()
        }
    }
}
