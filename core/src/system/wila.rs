//! WILA 2016: steps and heading at the waist, no map.

use crate::front_end::FrontEndRule;
use crate::step::StepLengthModel;
use crate::system::{AccuracyParams, HeadingRule, LengthRule, MotionParams, Recipe};

impl Recipe {
    /// Steps from a filter of 51 taps, lengths by the fourth root of the amplitude, a heading by a scalar Kalman filter:
    /// no survey is needed, a hint is.
    ///
    /// Particles are there for the radii alone: each has a length and noise of its own, and nothing weighs them. On a
    /// floor without a survey +y of the plan is taken for magnetic north; with one, its mean deviation is added.
    ///
    /// # Source
    /// WILA 2016, §3. `K` is for a walker of average size; [`StepLengthModel::trained`] makes it the wearer's own.
    pub fn wila() -> Self {
        Self {
            name: "wila".into(),
            front_end: FrontEndRule::Waist,
            n_particles: 100,
            length: StepLengthModel::Weinberg { k_m: 0.45 },
            motion: MotionParams {
                heading: HeadingRule::Compass,
                direction_sd_rad: 0.15,
                length: LengthRule::Scaled { scale_sd: 0.08, scale_walk_sd: 0.0, step_sd: 0.08 },
            },
            resample_below: 0.0,
            accuracy: AccuracyParams { scale: 3.0, floor_m: 2.0, tail: 1.3 },
            ..Self::dead_reckoning()
        }
    }
}
