//! Fieldwalk's own system.

use crate::observation::field_vector::FieldVectorParams;
use crate::observation::radio::RadioParams;
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MagneticRule, MotionParams, PlanRule, Recipe,
    RouteParams,
};

impl Recipe {
    /// Fieldwalk's own: soft plan and routes, the field vector with a learnt bias, weak radio.
    pub fn fused() -> Self {
        Self {
            name: "fused".into(),
            n_particles: 1000,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::Gyroscope { start_sd_rad: 0.22, walk_sd_rad: 0.025 },
                direction_sd_rad: 0.06,
                length: LengthRule::Scaled { scale_sd: 0.05, scale_walk_sd: 0.004, step_sd: 0.08 },
            },
            plan: PlanRule::Soft { crossing_log_weight: -1.9, closed_log_weight: -1.0 },
            routes: Some(RouteParams {
                start_power: 2.0,
                start_floor: 0.5,
                free_m: 2.5,
                log_weight_per_m: -0.03,
                min_log_weight: -0.3,
                across_log_weight: -2.0,
            }),
            magnetic: MagneticRule::FieldVector(FieldVectorParams::default()),
            radio: Some(RadioParams::default()),
            resample_below: 0.7,
            accuracy: AccuracyParams { scale: 1.3, floor_m: 1.25, tail: 1.15 },
            ..Self::bare()
        }
    }
}
