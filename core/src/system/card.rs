//! The ID card's system of Kwak 2018.

use crate::front_end::FrontEndRule;
use crate::heading::PathwayParams;
use crate::observation::ble_filter::BleFilterParams;
use crate::observation::history::{HistoryFeature, HistoryMetric, HistoryParams};
use crate::particle::ReplenishParams;
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MagneticRule, MotionParams, PlanRule, Recipe,
    StartRule,
};

/// Mean stride `l`, in metres.
const STRIDE_M: f32 = 0.65;
/// Standard deviation of `G_θ`: ten degrees.
const DIRECTION_SD_RAD: f32 = 0.174_532_92;

impl Recipe {
    /// Histories of a card's reads, three a second for half a minute, compared read by read; particles that mostly follow
    /// the ways; newcomers near the best for those that die.
    ///
    /// # Source
    /// Kwak 2018, §5.3.5 and §6.3 (`EUC3000`): Alg. 1, Eqs 3–5, 3000 particles, 30 s, 10 %, 1.5 m, a start anywhere. σ, `τ_w` and
    /// the stated accuracy are ours.
    pub fn card() -> Self {
        Self {
            name: "card".into(),
            front_end: FrontEndRule::Card,
            start: StartRule::WholeFloor,
            n_particles: 3000,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::Pathway(PathwayParams::default()),
                direction_sd_rad: DIRECTION_SD_RAD,
                length: LengthRule::Alike { mean_m: STRIDE_M, round_sd_m: 0.5 * STRIDE_M },
            },
            plan: PlanRule::Purge,
            magnetic: MagneticRule::History(HistoryParams {
                metric: HistoryMetric::Euclidean,
                feature: HistoryFeature::HorizontalVertical,
                window: 90,
                reads_a_move: 3,
                sigma_ut: 20.0,
                counts_once: true,
            }),
            ble_filter: Some(BleFilterParams::default()),
            replenish: Some(ReplenishParams::default()),
            resample_below: 0.0,
            accuracy: AccuracyParams { scale: 2.0, floor_m: 1.5, tail: 1.5 },
            ..Self::bare()
        }
    }
}
