//! Dead reckoning: the baseline that every other system must beat.

use crate::system::{AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MotionParams, Recipe};

impl Recipe {
    /// Steps and gyroscope from the compass's first direction; nothing corrects them.
    pub fn dead_reckoning() -> Self {
        Self {
            name: "dead-reckoning".into(),
            n_particles: 500,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::Gyroscope { start_sd_rad: 0.22, walk_sd_rad: 0.025 },
                direction_sd_rad: 0.06,
                length: LengthRule::Scaled { scale_sd: 0.06, scale_walk_sd: 0.0, step_sd: 0.08 },
            },
            resample_below: 0.0,
            accuracy: AccuracyParams { scale: 1.0, floor_m: 1.0, tail: 1.05 },
            ..Self::bare()
        }
    }
}
