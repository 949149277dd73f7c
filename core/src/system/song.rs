//! Song 2014: few particles at similar intensities, and what it was compared with.

use crate::front_end::FrontEndRule;
use crate::observation::candidates::CandidateParams;
use crate::observation::strength::StrengthParams;
use crate::particle::Resampling;
use crate::step::StepLengthModel;
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MagneticRule, MotionParams, PlanRule, Recipe,
    StartRule,
};

/// The paper's steps are not described: the frequency model is not enough for all walkers, so the fitted one.
const LENGTH: StepLengthModel = FITTED_LENGTH;

impl Recipe {
    /// Ten candidates a round: the map's points of the most similar strength, weighed by reachability and strength; the
    /// heaviest is the position.
    ///
    /// # Source
    /// Song 2014, §3: `k` = 10. Ours are the radius after the first round, the density of the reach (what steps and
    /// compass miss in a step, and half a cell of the map) and `σ_r`.
    pub fn candidates() -> Self {
        Self {
            name: "candidates".into(),
            n_particles: 10,
            magnetic: MagneticRule::Candidates(CandidateParams {
                strength: StrengthParams::default(),
                radius_m: 2.0,
                reach_sd_m: Some(0.6),
            }),
            accuracy: AccuracyParams { scale: 2.0, floor_m: 3.0, tail: 1.5 },
            ..Self::particle_100()
        }
    }

    /// The surveyed point of the most similar strength within five metres of where the steps from the start lead;
    /// standing or walking.
    ///
    /// # Source
    /// Song 2014, §4: the nearest-neighbour baseline.
    pub fn nearest() -> Self {
        Self {
            name: "nearest".into(),
            front_end: FrontEndRule::StandingPhone,
            magnetic: MagneticRule::Candidates(CandidateParams {
                strength: StrengthParams::default(),
                radius_m: 5.0,
                reach_sd_m: None,
            }),
            accuracy: AccuracyParams { scale: 1.0, floor_m: 3.0, tail: 1.5 },
            ..Self::candidates()
        }
    }

    /// An ordinary particle filter of a hundred particles: steps, compass, strength; no floor plan.
    ///
    /// # Source
    /// Song 2014, §4: the particle-filter baseline; how its particles move is ours.
    pub fn particle_100() -> Self {
        Self {
            name: "particle-100".into(),
            front_end: FrontEndRule::Phone,
            start: StartRule::Routes,
            n_particles: 100,
            length: LENGTH,
            motion: MotionParams {
                heading: HeadingRule::CompensatedCompass,
                direction_sd_rad: 0.2,
                length: LengthRule::Scaled { scale_sd: 0.05, scale_walk_sd: 0.0, step_sd: 0.15 },
            },
            plan: PlanRule::Ignore,
            routes: None,
            magnetic: MagneticRule::Strength(StrengthParams::default()),
            radio: None,
            beacons: None,
            spawning: None,
            radar: None,
            ble_filter: None,
            replenish: None,
            resample_below: 1.0,
            resampling: Resampling::Systematic,
            accuracy: AccuracyParams { scale: 2.0, floor_m: 3.0, tail: 1.5 },
        }
    }
}
