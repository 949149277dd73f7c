//! The mass-centred system of 2019.

use crate::observation::mass_centered::MassCenteredParams;
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MagneticRule, MotionParams, PlanRule, Recipe,
};

impl Recipe {
    /// Mass-centred weighting of field strength on a floor plan, genetic step lengths, compensated azimuth.
    ///
    /// # Source
    /// Mass-centred 2019, Alg. 1; `W`, `T` and the number of particles are the paper's. Ours are the genes' start, their
    /// drift and the noise: weights as sharp as these select genes by chance when they start far apart or drift fast,
    /// which enlarges the errors on recordings. Ours is the azimuth's smoothing too: phones fuse their azimuth with the
    /// gyroscope, over a time that they do not tell. Without it a compass that swings by tens of degrees in a turn leads all
    /// particles into a wall.
    pub fn mass_centered() -> Self {
        Self {
            name: "mass-centered".into(),
            n_particles: 3000,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::CompensatedCompass { smoothing_s: 1.5 },
                direction_sd_rad: 0.3,
                length: LengthRule::Genetic {
                    a_m: 0.18,
                    a_sd_m: 0.02,
                    b_m: 0.36,
                    b_sd_m: 0.03,
                    a_walk_sd_m: 0.0005,
                    b_walk_sd_m: 0.001,
                    step_sd_m: 0.05,
                },
            },
            plan: PlanRule::Purge,
            magnetic: MagneticRule::MassCentered(MassCenteredParams::default()),
            resample_below: 1.0,
            accuracy: AccuracyParams { scale: 3.5, floor_m: 2.0, tail: 1.6 },
            ..Self::bare()
        }
    }
}
