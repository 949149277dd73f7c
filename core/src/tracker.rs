//! The filter loop: start, move, weigh, resample, estimate — whatever the recipe.

mod beacons;
mod candidates;
mod motion;
mod radar;
mod start;
#[cfg(test)]
mod tests;
mod unseen;
mod weigh;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use beacons::Pause;
use start::ToldDirection;
pub(crate) use unseen::UNSEEN_WALK_M_S;

use crate::beacon_mode::{BeaconCluster, BeaconVisit, find_clusters};
use crate::front_end::FrontEndRule;
use crate::geometry::{Point2, wrap_rad};
use crate::heading::{Pathways, WayGrid};
use crate::map::FloorIndex;
use crate::observation::candidates::SearchArea;
use crate::observation::history::{DeviceHistory, HistoryScratch};
use crate::observation::radio::RadioObservation;
use crate::observation::three_factors::ObservedStrengths;
use crate::observation::{mass_centered, radio};
use crate::particle::{
    Centre, CloudEstimate, EstimateScratch, Part, Particles, ReplenishScratch, ResampleScratch,
};
use crate::pedestrian::StepEvent;
use crate::radio::fingerprint::FingerprintMatcher;
use crate::radio::range::Range;
use crate::random::{NormalTable, Purpose, draw, uniform};
use crate::system::{HeadingRule, LengthRule, MagneticRule, PlanRule, Recipe};
use crate::time::Timestamp;
use candidates::CandidateScratch;

/// Everything that the tracker remembers from step to step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrackerState {
    particles: Particles,
    /// Whether the particles have a place.
    is_placed: bool,
    /// Steps that went by without a place, waiting for radio.
    n_waited: u32,
    /// Whether they have a direction too, which takes a first step.
    is_oriented: bool,
    /// The direction that somebody told.
    #[serde(default)]
    told: Option<ToldDirection>,
    /// Number of steps consumed: the counter of the random draws.
    n_steps: u32,
    /// Mean length of the latest step over particles, in metres.
    step_length_m: f64,
    /// What the mass-centred weight compares the next step to.
    last_observed: mass_centered::LastObserved,
    /// Heading of the latest step's device, and how far it turned since the step before: what Eq. 14 asks for.
    last_level_heading_rad: Option<f32>,
    turn_rad: f32,
    /// What the device has read lately, where histories are compared.
    history: DeviceHistory,
    /// Where the next candidates are looked for, when not about the last ones.
    search: Option<SearchArea>,
    /// Mean strengths of the latest steps, for recipes that compare them.
    #[serde(default)]
    observed_strengths: ObservedStrengths,
    /// Whether neither place nor direction was known at the start: what the steps say of a particle is then no evidence.
    #[serde(default)]
    is_start_unknown: bool,
    /// The sum of the steps by the length model, in the level frame, in metres.
    #[serde(default)]
    walked: Point2,
    /// The visit to a cluster of beacons, if there is one.
    #[serde(default)]
    visit: BeaconVisit,
    /// Whether positioning pauses.
    #[serde(default)]
    pause: Pause,
    /// Times that every particle died and the cloud was spread anew.
    n_recoveries: u32,
    /// The first round after the start.
    first_round: Option<Timestamp>,
    /// When a radio fingerprint was last matched.
    matched_at: Option<Timestamp>,
    /// The latest estimate: resampling loses what it was made from.
    estimate: Option<CloudEstimate>,
}

/// What the particles' place rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackerMode {
    /// Steps, and what weighs them.
    Particles,
    /// Ranges to a cluster of beacons.
    Beacons,
    /// Nothing new: positioning pauses, after so many steps of which nothing was made.
    Paused {
        /// The steps.
        n_steps: u32,
    },
}

/// Runs one recipe on one floor.
#[derive(Clone, Debug)]
pub struct Tracker {
    recipe: Recipe,
    floor: Arc<FloorIndex>,
    /// The ways of the floor, for a recipe whose particles follow them.
    ways: Option<WayGrid>,
    seed: u64,
    normal: NormalTable,
    /// Those of the floor, where the recipe follows them.
    clusters: Vec<BeaconCluster>,
    state: TrackerState,
    scratch: Scratch,
}

/// Ranges that a place is made from, at most.
const MAX_RANGES: usize = 64;

/// Memory that one step needs and the next does not remember.
#[derive(Clone, Debug, Default)]
struct Scratch {
    from_x_m: Vec<f32>,
    from_y_m: Vec<f32>,
    weights: Vec<f32>,
    resample: ResampleScratch,
    estimate: EstimateScratch,
    candidates: CandidateScratch,
    history: HistoryScratch,
    replenish: ReplenishScratch,
    matcher: FingerprintMatcher,
    ranges: Vec<Range>,
}

impl Tracker {
    /// A tracker that knows no place yet.
    pub fn new(recipe: Recipe, floor: Arc<FloorIndex>, seed: u64) -> Self {
        let n = most_particles(&recipe);
        let window = match recipe.magnetic {
            MagneticRule::MassCentered(params) => params.window.max(1),
            MagneticRule::History(params) => params.n_values(),
            _ => 1,
        };
        let n_slots = if let MagneticRule::History(params) = recipe.magnetic { params.n_slots() } else { 0 };
        let ways = match recipe.motion.heading {
            HeadingRule::Pathway(params) => {
                let plan = &floor.map().plan;
                Some(WayGrid::new(&Pathways::of_map(floor.map()), params, plan.width_m, plan.height_m))
            }
            _ => None,
        };
        let scratch = Scratch {
            from_x_m: Vec::with_capacity(n),
            from_y_m: Vec::with_capacity(n),
            weights: Vec::with_capacity(n),
            resample: ResampleScratch::with_capacity(n, window),
            estimate: EstimateScratch::default(),
            candidates: match recipe.magnetic {
                MagneticRule::Candidates(_) => CandidateScratch::with_capacity(n),
                _ => CandidateScratch::default(),
            },
            history: HistoryScratch::with_capacity(n_slots),
            replenish: ReplenishScratch::with_capacity(if recipe.replenish.is_some() { n } else { 0 }),
            matcher: if recipe.radar.is_some() || recipe.ble_filter.is_some() {
                FingerprintMatcher::new(&floor.map().fingerprints)
            } else {
                FingerprintMatcher::default()
            },
            ranges: Vec::with_capacity(MAX_RANGES),
        };
        let clusters = recipe
            .beacons
            .map_or(Vec::new(), |beacons| find_clusters(&floor.map().transmitters, beacons.range_m));
        let normal = NormalTable::new();
        Self { recipe, floor, ways, seed, normal, clusters, state: TrackerState::default(), scratch }
    }

    /// The recipe that runs.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The floor that it runs on.
    pub fn floor(&self) -> &Arc<FloorIndex> {
        &self.floor
    }

    /// What the tracker remembers.
    pub fn state(&self) -> &TrackerState {
        &self.state
    }

    /// Continues from `state`, which a tracker with the same recipe, floor and seed has given.
    pub fn set_state(&mut self, state: TrackerState) {
        self.state = state;
        self.reserve();
    }

    /// Whether `state`'s arrays are as long as this recipe's: a torn snapshot's are not.
    pub fn fits(&self, state: &TrackerState) -> bool {
        let most = self.recipe.n_particles.max(1);
        let n = match (state.is_placed, self.recipe.spawning) {
            (false, _) => 0,
            (true, None) => most,
            (true, Some(_)) => state.particles.len().clamp(1, most),
        };
        let length = self.recipe.motion.length;
        let is_genetic = matches!(length, LengthRule::Genetic { .. });
        let is_scaled = matches!(length, LengthRule::Scaled { .. });
        let has_gyroscope = self.recipe.motion.heading.start_sd_rad().is_some();
        let (window, has_direction) = match self.recipe.magnetic {
            MagneticRule::MassCentered(params) => (params.window.max(1), params.direction.is_some()),
            _ => (0, false),
        };
        let (n_values, n_sums, n_slots) = match self.recipe.magnetic {
            MagneticRule::History(params) => (params.n_values(), params.n_sums(), params.n_slots()),
            _ => (0, 0, 0),
        };
        let factors_window = match self.recipe.magnetic {
            MagneticRule::ThreeFactors(params) => params.n_steps(),
            _ => 0,
        };
        let a_particle = |part| match part {
            Part::Always => 1,
            Part::Gyroscope => usize::from(has_gyroscope && state.is_oriented),
            Part::ScaledLength => usize::from(is_scaled),
            Part::GeneticLength => usize::from(is_genetic),
            Part::FieldVector => usize::from(matches!(self.recipe.magnetic, MagneticRule::FieldVector(_))),
            Part::MassCentered => usize::from(window > 0),
            Part::MassCenteredWindow => window,
            Part::FieldDirection => usize::from(has_direction),
            Part::FieldDirectionWindow => {
                if has_direction {
                    window
                } else {
                    0
                }
            }
            Part::History => usize::from(n_values > 0),
            Part::HistoryWindow => n_values,
            Part::HistorySums => n_sums,
            Part::BleFilter => usize::from(self.recipe.ble_filter.is_some()),
            Part::ThreeFactorsWindow => factors_window,
        };
        state.history.fits(n_slots)
            && state.particles.arrays().all(|(part, array)| array.len() == n * a_particle(part))
    }

    /// Places all particles uniformly in the square `point ± radius_m`, forgetting what was known.
    ///
    /// # Source
    /// Mass-centred 2019, Alg. 1, line 4.
    pub fn place(&mut self, point: Point2, radius_m: f64) {
        let n = self.recipe.n_particles.max(1);
        let (seed, step) = (self.seed, self.state.n_steps);
        let coordinate =
            |centre_m: f64, bits: u32| (centre_m + radius_m * (2.0 * f64::from(uniform(bits)) - 1.0)) as f32;
        let bits = (0..n as u32).map(|i| draw(seed, step, i, Purpose::Start));
        let (x_m, y_m) = bits.map(|b| (coordinate(point.x_m, b[0]), coordinate(point.y_m, b[1]))).unzip();
        self.occupy(x_m, y_m);
        self.search_about(point, radius_m);
        self.state.is_start_unknown = false;
        self.state.pause = Pause::Running;
        self.state.visit.leave();
        self.state.told = None;
    }

    /// Says which way the walker goes from the place just given: `heading_rad` give or take `sd_rad` when the device's level
    /// heading is `level_rad`, or at the first step where that is not known yet.
    pub fn face(&mut self, heading_rad: f64, sd_rad: f64, level_rad: Option<f32>) {
        self.state.told = Some(ToldDirection {
            heading_rad: wrap_rad(heading_rad) as f32,
            sd_rad: sd_rad as f32,
            level_rad,
        });
    }

    /// The latest estimate; nothing before the particles have a place.
    pub fn estimate(&self) -> Option<&CloudEstimate> {
        self.state.estimate.as_ref()
    }

    /// The particles as the last step left them; none before they have a place.
    pub fn particles(&self) -> &Particles {
        &self.state.particles
    }

    /// Mean length of the latest step, in metres; 0 before the first.
    pub fn step_length_m(&self) -> f64 {
        self.state.step_length_m
    }

    /// Times that every particle died and the cloud was spread anew round the last estimate.
    pub fn n_recoveries(&self) -> u32 {
        self.state.n_recoveries
    }

    /// Consumes a step and what radio was heard during it.
    pub fn step(&mut self, event: &StepEvent, radio: &[RadioObservation]) {
        if self.recipe.radar.is_some() {
            return;
        }
        self.reckon(event);
        if self.is_paused_by(event) {
            return;
        }
        if !self.state.is_placed {
            if (self.recipe.radio.is_some() || !self.clusters.is_empty()) && self.waits_for_radio(radio) {
                return;
            }
            self.place_unknown(radio);
        }
        if !self.state.is_oriented {
            self.orient(event);
        }
        self.state.n_steps = self.state.n_steps.wrapping_add(1);
        if let Some(spawning) = &self.recipe.spawning {
            self.state.particles.spawn(spawning.n_children);
        }
        self.weigh_alike();
        self.scratch.from_x_m.clone_from(&self.state.particles.x_m);
        self.scratch.from_y_m.clone_from(&self.state.particles.y_m);
        match self.recipe.magnetic {
            MagneticRule::Candidates(params) => self.propose_candidates(&params, event),
            _ => self.move_particles(event),
        }
        self.apply_plan();
        self.apply_routes();
        self.apply_magnetic(event);
        if let Some(params) = &self.recipe.radio {
            let is_wide = self.state.estimate.is_some_and(|e| e.radius_68_m > f64::from(params.wide_m));
            let transmitters = &self.floor.map().transmitters;
            radio::update(params, transmitters, radio, is_wide, &mut self.state.particles);
        }
        self.filter_start(event, radio);
        if !self.weigh() {
            self.recover();
        }
        self.replenish();
        let centre = match self.recipe.magnetic {
            MagneticRule::Candidates(_) => Centre::Heaviest,
            _ => Centre::Mean,
        };
        self.estimate_cloud(centre);
        self.resample();
    }

    /// Reserves the room that a step takes, so that none has to be found in it.
    fn reserve(&mut self) {
        if self.recipe.spawning.is_some() {
            self.state.particles.reserve(most_particles(&self.recipe));
        }
    }

    fn is_card(&self) -> bool {
        self.recipe.front_end == FrontEndRule::Card
    }

    /// Lets every particle weigh the same, whatever its log weight.
    fn weigh_alike(&mut self) {
        self.scratch.weights.clear();
        self.scratch.weights.resize(self.state.particles.len(), 1.0);
    }

    /// Multiplies the weights by what the log weights stand for, the largest as 1; false when no particle is left alive.
    fn weigh(&mut self) -> bool {
        let particles = &mut self.state.particles;
        let best =
            particles.log_weight.iter().fold(f32::NEG_INFINITY, |best, &w| if w > best { w } else { best });
        if !best.is_finite() {
            return false;
        }
        let mut is_alive = false;
        for (weight, log_weight) in self.scratch.weights.iter_mut().zip(&mut particles.log_weight) {
            *log_weight -= best;
            // After resampling most are 0: no exponential for those.
            let product = *weight * if *log_weight == 0.0 { 1.0 } else { libm::expf(*log_weight) };
            *weight = if product.is_nan() { 0.0 } else { product };
            is_alive |= *weight > 0.0;
        }
        is_alive
    }

    /// Lets who weighs too little die, and newcomers take the places of the dead.
    fn replenish(&mut self) {
        let Some(params) = &self.recipe.replenish else { return };
        let (seed, step) = (self.seed, self.state.n_steps);
        let minds_walls = self.recipe.plan != PlanRule::Ignore;
        let may_stand = |from_m: [f32; 2], to_m: [f32; 2]| {
            !minds_walls || (self.floor.is_open(to_m[0], to_m[1]) && !self.floor.is_blocked(from_m, to_m))
        };
        let draw = |i| draw(seed, step, i, Purpose::Replenishing);
        let Scratch { weights, replenish, .. } = &mut self.scratch;
        self.state.particles.replenish(params, weights, replenish, draw, may_stand);
    }

    fn estimate_cloud(&mut self, centre: Centre) {
        if self.state.particles.is_empty() || self.scratch.weights.len() != self.state.particles.len() {
            return;
        }
        let Scratch { weights, estimate, .. } = &mut self.scratch;
        let estimate = CloudEstimate::centred(centre, &self.state.particles, weights, estimate);
        self.state.estimate = estimate.or(self.state.estimate);
    }

    fn resample(&mut self) {
        if let Some(spawning) = &self.recipe.spawning {
            let u = uniform(draw(self.seed, self.state.n_steps, 0, Purpose::Resampling)[0]);
            let (n_max, Scratch { weights, resample, .. }) = (self.recipe.n_particles, &mut self.scratch);
            self.state.particles.thin(spawning, n_max, weights, u, resample);
            return;
        }
        let n = self.state.particles.len() as f64;
        let is_degenerate = self
            .state
            .estimate
            .is_some_and(|e| e.effective_sample_size < f64::from(self.recipe.resample_below) * n);
        if is_degenerate || self.recipe.resample_below >= 1.0 {
            let (seed, step) = (self.seed, self.state.n_steps);
            let bits = |k| draw(seed, step, k, Purpose::Resampling)[0];
            let Scratch { weights, resample, .. } = &mut self.scratch;
            self.state.particles.resample(self.recipe.resampling, weights, bits, resample);
            if let MagneticRule::History(params) = &self.recipe.magnetic
                && !params.counts_once
            {
                self.state.particles.history_log_weight.fill(0.0);
            }
        } else if matches!(self.recipe.magnetic, MagneticRule::MassCentered(_)) {
            // Its weights are not in the log weights yet, which alone are kept.
            for (log_weight, weight) in self.state.particles.log_weight.iter_mut().zip(&self.scratch.weights)
            {
                *log_weight = libm::logf(*weight);
            }
        }
    }
}

/// The most particles that there are at any moment of a step.
fn most_particles(recipe: &Recipe) -> usize {
    let n_children = recipe.spawning.map_or(1, |spawning| spawning.n_children.max(1));
    recipe.n_particles.max(1).saturating_mul(n_children)
}
