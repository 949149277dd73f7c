//! Song 2014: few particles at similar intensities, and what it was compared with.

use crate::front_end::FrontEndRule;
use crate::observation::candidates::CandidateParams;
use crate::observation::strength::StrengthParams;
use crate::system::{
    AccuracyParams, FITTED_LENGTH, HeadingRule, LengthRule, MagneticRule, MotionParams, Recipe,
};

impl Recipe {
    /// Ten candidates a round: the map's points of the most similar strength, weighed by reachability and strength; the
    /// heaviest is the position.
    ///
    /// # Source
    /// Song 2014, §3: `k` = 10. Ours are the radius after the first round, the density of the reach (what steps and
    /// compass miss in a step, and half a cell of the map) and `σ_r`. Ten points by strength alone out of a wider circle
    /// run away with a phone that carries iron of its own: in the simulated ring the median error is 1.5 m with these,
    /// 15 m with 2 m and 0.6 m.
    pub fn candidates() -> Self {
        Self {
            name: "candidates".into(),
            n_particles: 10,
            magnetic: MagneticRule::Candidates(CandidateParams {
                strength: StrengthParams::default(),
                radius_m: 0.8,
                reach_sd_m: Some(0.3),
            }),
            accuracy: AccuracyParams { scale: 2.0, floor_m: 3.0, tail: 1.5 },
            ..Self::particle_100()
        }
    }

    /// The surveyed point of the most similar strength in a circle five metres across, where the steps from the start lead;
    /// standing or walking.
    ///
    /// # Source
    /// Song 2014, §4: the nearest-neighbour baseline, and its range of five metres.
    pub fn nearest() -> Self {
        Self {
            name: "nearest".into(),
            front_end: FrontEndRule::StandingPhone,
            magnetic: MagneticRule::Candidates(CandidateParams {
                strength: StrengthParams::default(),
                radius_m: 2.5,
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
            n_particles: 100,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::CompensatedCompass { smoothing_s: 0.0 },
                direction_sd_rad: 0.2,
                length: LengthRule::Scaled { scale_sd: 0.05, scale_walk_sd: 0.0, step_sd: 0.15 },
            },
            magnetic: MagneticRule::Strength(StrengthParams::default()),
            resample_below: 1.0,
            accuracy: AccuracyParams { scale: 2.0, floor_m: 3.0, tail: 1.5 },
            ..Self::bare()
        }
    }
}
