//! The systems as data: a recipe is a choice of parts with their parameters.

mod card;
mod dead_reckoning;
mod dtw;
mod fused;
mod ibill;
mod mass_centered;
mod radar;
mod song;
mod wila;

use serde::{Deserialize, Serialize};

use crate::beacon_mode::BeaconModeParams;
use crate::front_end::FrontEndRule;
use crate::heading::PathwayParams;
use crate::observation::ble_filter::BleFilterParams;
use crate::observation::candidates::CandidateParams;
use crate::observation::field_vector::FieldVectorParams;
use crate::observation::history::HistoryParams;
use crate::observation::mass_centered::MassCenteredParams;
use crate::observation::radio::RadioParams;
use crate::observation::strength::StrengthParams;
use crate::observation::three_factors::ThreeFactorsParams;
use crate::particle::{ReplenishParams, Resampling, SpawningParams};
use crate::radio::fingerprint::FingerprintParams;
use crate::step::StepLengthModel;

/// A positioning system: which parts run and how they are tuned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// The system's name, as on the command line.
    pub name: String,
    /// What is worn, and how its samples become steps.
    #[serde(default)]
    pub front_end: FrontEndRule,
    /// Number of particles.
    pub n_particles: usize,
    /// Where particles begin without a hint; with one, in the square round it.
    #[serde(default)]
    pub start: StartRule,
    /// How long a step is before the walker's own scale.
    pub length: StepLengthModel,
    /// How particles move.
    pub motion: MotionParams,
    /// Whether particles spawn several each at every step; without, their number is constant.
    #[serde(default)]
    pub spawning: Option<SpawningParams>,
    /// What walls and closed units do.
    pub plan: PlanRule,
    /// How the surveyed routes attract, if they do.
    pub routes: Option<RouteParams>,
    /// What the magnetic field says.
    pub magnetic: MagneticRule,
    /// What radio says, if anything.
    pub radio: Option<RadioParams>,
    /// Whether fingerprints say in the beginning where no particle is worth keeping.
    #[serde(default)]
    pub ble_filter: Option<BleFilterParams>,
    /// Set, the place of the nearest radio fingerprint is the position, once a second, and steps say nothing.
    #[serde(default)]
    pub radar: Option<FingerprintParams>,
    /// Who dies of too small a weight and how the dead are replaced, before the estimate; without, nobody is until
    /// resampling.
    #[serde(default)]
    pub replenish: Option<ReplenishParams>,
    /// Whether clusters of beacons take over from the particles, and how.
    #[serde(default)]
    pub beacons: Option<BeaconModeParams>,
    /// Resample when the effective sample size falls below this fraction of the particles; 1 resamples every step.
    pub resample_below: f32,
    /// How copies are drawn then.
    #[serde(default)]
    pub resampling: Resampling,
    /// How the stated radii follow from the cloud.
    pub accuracy: AccuracyParams,
}

/// Where particles begin when nobody says where the wearer is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StartRule {
    /// Along the surveyed routes.
    #[default]
    Routes,
    /// Anywhere on the floor that is open.
    ///
    /// # Source
    /// Kwak 2018, §5.2: uniform over the area.
    WholeFloor,
    /// In a circle round the place that the ranges to the nearest cluster of beacons give, roughly, in every direction
    /// from every place; without beacons along the surveyed routes. What the steps say of a particle is then no evidence
    /// before a cluster is entered.
    ///
    /// # Source
    /// iBILL 2017, Fig. 7; the numbers are ours.
    Circle {
        /// `N_d`: directions, evenly spread.
        n_directions: usize,
        /// `N_l`: places, by chance.
        n_places: usize,
    },
}

/// How particles move at a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionParams {
    /// Where the walking direction comes from.
    pub heading: HeadingRule,
    /// Standard deviation of each move's direction, in radians.
    pub direction_sd_rad: f32,
    /// How the length varies over particles and steps.
    pub length: LengthRule,
}

/// Where a particle's walking direction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeadingRule {
    /// The compass azimuth of every step, with the surveyed deviation at the particle's last place added; the gyroscope
    /// carries the direction on meanwhile, as in a phone's own azimuth.
    ///
    /// # Source
    /// Mass-centred 2019, Eq. 15: `α + ξ(x_{t−1}, y_{t−1}) + Λ'`. How a phone smooths its azimuth is left open. Every
    /// particle smooths `α + ξ` along its own way, since a deviation that was smoothed in the survey would depend on the
    /// way that led to the place.
    CompensatedCompass {
        /// Time constant within which the direction follows the compass, in seconds; 0 takes each step's azimuth as it
        /// is.
        smoothing_s: f32,
    },
    /// The compass once, at the start; the gyroscope from there, with a small random walk.
    Gyroscope {
        /// Standard deviation of the first compass reading about the walking direction, in radians.
        start_sd_rad: f32,
        /// Standard deviation of the random walk a step, in radians.
        walk_sd_rad: f32,
    },
    /// The compass azimuth of every round turned by the floor's mean deviation, or the direction of a way near it or near
    /// the particle's last heading; drawn anew for each particle each round.
    ///
    /// # Source
    /// Kwak 2018, Alg. 1.
    Pathway(PathwayParams),
    /// The azimuth of every step, turned by the floor's mean deviation where there was a survey.
    ///
    /// # Source
    /// WILA 2016, §3.3: the heading as its filter has it.
    Compass,
    /// As [`HeadingRule::Gyroscope`], but the direction is off only by what turns leave: at a step that turns, every
    /// particle turns by the gyroscope's angle and a uniform share of the interval `± half_width·sd`, and is weighed by the
    /// normal density of that share. On a straight way the factor is 1.
    ///
    /// # Source
    /// iBILL 2017, Eqs 10–13 and 16; the area of Eqs 12 and 13 is what the two intervals span.
    GyroscopeTurns {
        /// Standard deviation of the first compass reading about the walking direction, in radians; ours: the paper
        /// knows the direction from beacons.
        start_sd_rad: f32,
        /// Standard deviation of a turn about the gyroscope's, in radians.
        sd_rad: f32,
        /// Half the interval in standard deviations; the middle 70 % is φ⁻¹(0.85) = 1.0364.
        half_width_sd: f32,
        /// A step turns when the device turns by this since the step before, in radians; ours.
        from_rad: f32,
    },
}

impl HeadingRule {
    /// Standard deviation of the first compass reading, in radians, where a direction is kept from there on by gyroscope.
    pub(crate) fn start_sd_rad(&self) -> Option<f32> {
        match *self {
            Self::CompensatedCompass { .. } | Self::Compass | Self::Pathway(_) => None,
            Self::Gyroscope { start_sd_rad, .. } | Self::GyroscopeTurns { start_sd_rad, .. } => {
                Some(start_sd_rad)
            }
        }
    }
}

/// How step lengths vary over particles and steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthRule {
    /// Each particle has a scale of its own on the length model, and each step a noise of its own.
    Scaled {
        /// Standard deviation of the walker's scale.
        scale_sd: f32,
        /// Standard deviation of the scale's random walk a step.
        scale_walk_sd: f32,
        /// Standard deviation of one step's length over its mean.
        step_sd: f32,
    },
    /// Genes: `l = p_a·f + p_b + Λ`, `p ← p + δ`, and steps in a turn shortened by
    /// [`turned_length_m`](crate::step::turned_length_m).
    ///
    /// # Source
    /// Mass-centred 2019, Eqs. 13 and 14; initial genes, δ and Λ are ours (the paper gives none).
    Genetic {
        /// Mean of `p_a` at the start, metres per Hz.
        a_m: f32,
        /// Its standard deviation.
        a_sd_m: f32,
        /// Mean of `p_b` at the start, in metres.
        b_m: f32,
        /// Its standard deviation.
        b_sd_m: f32,
        /// Standard deviation of δ on `p_a`.
        a_walk_sd_m: f32,
        /// Standard deviation of δ on `p_b`.
        b_walk_sd_m: f32,
        /// Standard deviation of Λ, in metres.
        step_sd_m: f32,
    },
    /// The same for everybody, with a noise that each particle draws each round: `N·(l + G_l)` for `N` steps.
    ///
    /// # Source
    /// Kwak 2018, Eq. 3: `l` = 0.65 m, `G_l` with 0.5 `l`. A negative stride, which is drawn one time in forty, is cut to
    /// nothing.
    Alike {
        /// `l`, in metres.
        mean_m: f32,
        /// Standard deviation of `G_l`, in metres.
        round_sd_m: f32,
    },
    /// Uniform in the interval `± half_width·sd` about the length model's, and weighed by the normal density there.
    ///
    /// # Source
    /// iBILL 2017, Eqs 7–9 and 15: draws are uniform, since Eq. 15 weighs them by the density.
    Interval {
        /// Standard deviation of a step's length.
        spread: LengthSpread,
        /// Half the interval in standard deviations; the middle 80 % is φ⁻¹(0.9) = 1.2816.
        half_width_sd: f32,
    },
}

/// How much a step's length `l` varies.
///
/// # Source
/// iBILL 2017, Eq. 8.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthSpread {
    /// The standard deviation is this share of `l`: 0.2 is what the source that iBILL cites means.
    ShareOfLength(f32),
    /// The variance is this times `l`, in m² with `l` in metres: 0.2, as iBILL prints it.
    VarianceOfLength(f32),
}

impl LengthSpread {
    /// The standard deviation of a step of `length_m`, in metres.
    pub fn sd_m(&self, length_m: f32) -> f32 {
        match *self {
            Self::ShareOfLength(share) => share * length_m,
            Self::VarianceOfLength(factor) => (factor * length_m).max(0.0).sqrt(),
        }
    }
}

/// What walls and closed units do to particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanRule {
    /// Nothing.
    Ignore,
    /// A particle that crosses a wall or stands in a closed unit dies.
    ///
    /// # Source
    /// Mass-centred 2019, Alg. 1.
    Purge,
    /// Both cost weight only: plans err, and a filter that believes them too much dies and jumps.
    Soft {
        /// Added to the log weight at a crossing.
        crossing_log_weight: f32,
        /// Added to the log weight at every step that ends in a closed unit.
        closed_log_weight: f32,
    },
}

/// How the surveyed routes attract particles.
///
/// A survey walks where people walk. Its density is a prior of the place where a walk begins; at later steps only
/// leaving the routes costs weight, since a density applied at every step would pull particles along their way
/// towards its maxima.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RouteParams {
    /// At the start, `power·ln(floor + density)` is added to the log weight.
    pub start_power: f32,
    /// The density of a place that no line passes, in lines.
    pub start_floor: f32,
    /// No cost up to this distance from a surveyed line, in metres; less where surveyed lines keep closer together, and
    /// the cost beyond is then steeper by as much.
    pub free_m: f32,
    /// Added to the log weight, at every step, per metre beyond.
    pub log_weight_per_m: f32,
    /// Added to the log weight at every step right across surveyed lines that all run one way, less at a slant or where
    /// they agree less.
    #[serde(default)]
    pub across_log_weight: f32,
    /// The most that is added (a negative number).
    pub min_log_weight: f32,
}

impl RouteParams {
    /// The free distance, in metres, and the log weight per metre beyond it on a floor whose lines keep within `band_m` of
    /// each other.
    pub(crate) fn within(&self, band_m: f32) -> (f32, f32) {
        if band_m < self.free_m {
            (band_m, self.log_weight_per_m * (self.free_m / band_m))
        } else {
            (self.free_m, self.log_weight_per_m)
        }
    }
}

/// What the magnetic field says of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MagneticRule {
    /// Nothing.
    Ignore,
    /// Changes of strength from step to step.
    MassCentered(MassCenteredParams),
    /// The vector in the particle's own heading, with a learnt bias.
    FieldVector(FieldVectorParams),
    /// The strength, by a normal density.
    Strength(StrengthParams),
    /// The strength again, of particles that are put on the map's points of the most similar one; the heaviest is the
    /// position.
    Candidates(CandidateParams),
    /// What was read during the last while against what the map says along each particle's way.
    History(HistoryParams),
    /// Strengths along the last steps, compared as vectors.
    ThreeFactors(ThreeFactorsParams),
}

/// How the stated radii follow from the cloud: `radius_68 = sqrt((scale·r_68)² + floor²)` and
/// `radius_95 = tail·sqrt((scale·r_95)² + (1.62·floor)²)`.
///
/// The cloud knows only what the recipe models; scale and floor make the radii true as often as they say on
/// recordings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AccuracyParams {
    /// Factor on the cloud's radii.
    pub scale: f32,
    /// The smallest 68 % radius, in metres; the 95 % floor is 1.62 times that (a circular normal's ratio).
    pub floor_m: f32,
    /// Factor on the 95 % radius alone: errors have heavier tails than clouds.
    pub tail: f32,
}

/// The step-length model fitted over surveyed segments of many walks.
const FITTED_LENGTH: StepLengthModel =
    StepLengthModel::FrequencyAmplitude { offset_m: 0.4765, per_hz_m: -0.268, per_root_m: 0.444 };

/// The systems by name: the list that tables follow, and the look-up in it.
macro_rules! systems {
    ($($name:literal => $recipe:path,)*) => {
        impl Recipe {
            /// The names of all systems, in the order in which tables list them.
            pub const NAMES: [&'static str; [$($name),*].len()] = [$($name),*];

            /// The system called `name`, if there is one.
            pub fn named(name: &str) -> Option<Self> {
                match name {
                    $($name => Some($recipe()),)*
                    _ => None,
                }
            }
        }
    };
}

systems! {
    "dead-reckoning" => Recipe::dead_reckoning,
    "radar" => Recipe::radar,
    "wila" => Recipe::wila,
    "nearest" => Recipe::nearest,
    "particle-100" => Recipe::particle_100,
    "candidates" => Recipe::candidates,
    "card" => Recipe::card,
    "dtw" => Recipe::dtw,
    "mass-centered" => Recipe::mass_centered,
    "ibill" => Recipe::ibill,
    "fused" => Recipe::fused,
}

impl Recipe {
    /// Steps of a phone and nothing else: what a system leaves out.
    fn bare() -> Self {
        Self {
            name: String::new(),
            front_end: FrontEndRule::Phone,
            n_particles: 1,
            start: StartRule::Routes,
            length: FITTED_LENGTH,
            motion: MotionParams {
                heading: HeadingRule::Gyroscope { start_sd_rad: 0.22, walk_sd_rad: 0.025 },
                direction_sd_rad: 0.06,
                length: LengthRule::Scaled { scale_sd: 0.06, scale_walk_sd: 0.0, step_sd: 0.08 },
            },
            spawning: None,
            plan: PlanRule::Ignore,
            routes: None,
            magnetic: MagneticRule::Ignore,
            radio: None,
            beacons: None,
            radar: None,
            ble_filter: None,
            replenish: None,
            resample_below: 0.0,
            resampling: Resampling::Systematic,
            accuracy: AccuracyParams { scale: 1.0, floor_m: 1.0, tail: 1.0 },
        }
    }

    /// The same system with the floor plan, the surveyed routes and, on a phone, the dead reckoning that
    /// [`Recipe::fused`] uses, so that systems are compared by what they make of the field and of radio.
    ///
    /// A system whose steps come from elsewhere than a phone keeps its motion, and one without steps is as it was.
    #[must_use]
    pub fn with_plan(self) -> Self {
        if self.radar.is_some() {
            return self;
        }
        let Self { plan, routes, length, motion, .. } = Self::fused();
        match self.front_end {
            FrontEndRule::Card => Self { plan, routes, ..self },
            _ => Self { plan, routes, length, motion, ..self },
        }
    }
}
