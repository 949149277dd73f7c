//! The filter loop: start, move, weigh, resample, estimate — whatever the recipe.

mod beacons;
mod motion;
mod start;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use beacons::Pause;

use crate::beacon_mode::{BeaconCluster, BeaconVisit, find_clusters};
use crate::geometry::Point2;
use crate::map::FloorIndex;
use crate::observation::radio::RadioObservation;
use crate::observation::three_factors::ObservedStrengths;
use crate::observation::{field_vector, mass_centered, radio, three_factors};
use crate::particle::{CloudEstimate, EstimateScratch, Part, Particles, ResampleScratch};
use crate::pedestrian::StepEvent;
use crate::radio::range::Range;
use crate::random::{NormalTable, Purpose, draw, uniform};
use crate::system::{LengthRule, MagneticRule, PlanRule, Recipe};

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
    /// Number of steps consumed: the counter of the random draws.
    n_steps: u32,
    /// Mean length of the latest step over particles, in metres.
    step_length_m: f64,
    last_end_strength_ut: Option<f32>,
    /// Heading of the device at the latest step, in the level frame, in radians.
    #[serde(default)]
    last_level_heading_rad: Option<f32>,
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
    ranges: Vec<Range>,
    /// By what angle the device turned from the last step to this one, in radians.
    turned_rad: f64,
}

impl Tracker {
    /// A tracker that knows no place yet.
    pub fn new(recipe: Recipe, floor: Arc<FloorIndex>, seed: u64) -> Self {
        let n = most_particles(&recipe);
        let window = match recipe.magnetic {
            MagneticRule::MassCentered(params) => params.window.max(1),
            _ => 1,
        };
        let scratch = Scratch {
            from_x_m: Vec::with_capacity(n),
            from_y_m: Vec::with_capacity(n),
            weights: Vec::with_capacity(n),
            resample: ResampleScratch::with_capacity(n, window),
            estimate: EstimateScratch::default(),
            ranges: Vec::with_capacity(MAX_RANGES),
            turned_rad: 0.0,
        };
        let clusters = recipe
            .beacons
            .map_or(Vec::new(), |beacons| find_clusters(&floor.map().transmitters, beacons.range_m));
        let normal = NormalTable::new();
        Self { recipe, floor, seed, normal, clusters, state: TrackerState::default(), scratch }
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
        let window = match self.recipe.magnetic {
            MagneticRule::MassCentered(params) => params.window.max(1),
            _ => 0,
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
            Part::ThreeFactorsWindow => factors_window,
        };
        state.particles.arrays().all(|(part, array)| array.len() == n * a_particle(part))
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
        self.state.is_start_unknown = false;
        self.state.pause = Pause::Running;
        self.state.visit.leave();
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
        self.move_particles(event);
        self.apply_plan();
        self.apply_routes();
        self.apply_magnetic(event);
        if let Some(params) = &self.recipe.radio {
            let is_wide = self.state.estimate.is_some_and(|e| e.radius_68_m > f64::from(params.wide_m));
            let transmitters = &self.floor.map().transmitters;
            radio::update(params, transmitters, radio, is_wide, &mut self.state.particles);
        }
        if !self.weigh() {
            self.recover();
        }
        self.estimate_cloud();
        self.resample();
    }

    fn apply_plan(&mut self) {
        let particles = &mut self.state.particles;
        let (crossing, closed) = match self.recipe.plan {
            PlanRule::Ignore => return,
            PlanRule::Purge => (f32::NEG_INFINITY, f32::NEG_INFINITY),
            PlanRule::Soft { crossing_log_weight, closed_log_weight } => {
                (crossing_log_weight, closed_log_weight)
            }
        };
        for i in 0..particles.x_m.len() {
            let to = [particles.x_m[i], particles.y_m[i]];
            if !self.floor.is_open(to[0], to[1]) {
                particles.log_weight[i] += closed;
                if particles.log_weight[i] == f32::NEG_INFINITY {
                    continue;
                }
            }
            if self.floor.is_blocked([self.scratch.from_x_m[i], self.scratch.from_y_m[i]], to) {
                particles.log_weight[i] += crossing;
            }
        }
    }

    fn apply_routes(&mut self) {
        let Some(routes) = self.recipe.routes else { return };
        let distances = &self.floor.map().layers.route_distance_m;
        let particles = &mut self.state.particles;
        for i in 0..particles.x_m.len() {
            let distance_m = self.floor.nearest(distances, particles.x_m[i], particles.y_m[i]);
            let cost = distance_m.map_or(routes.min_log_weight, |d| {
                (routes.log_weight_per_m * (d - routes.free_m).max(0.0)).max(routes.min_log_weight)
            });
            particles.log_weight[i] += cost;
        }
    }

    fn apply_magnetic(&mut self, event: &StepEvent) {
        match &self.recipe.magnetic {
            MagneticRule::Ignore => {}
            MagneticRule::MassCentered(params) => {
                let last = core::mem::replace(&mut self.state.last_end_strength_ut, event.end_strength_ut);
                if let (Some(now), Some(last)) = (event.end_strength_ut, last) {
                    let (particles, weights) = (&mut self.state.particles, &mut self.scratch.weights);
                    mass_centered::update(params, &self.floor, now - last, particles, weights);
                }
            }
            MagneticRule::FieldVector(params) => {
                if event.field_bias_reset {
                    field_vector::forget_bias(params, &mut self.state.particles);
                }
                if let Some(field) = &event.forward_field {
                    field_vector::update(params, &self.floor, field, &mut self.state.particles);
                }
            }
            MagneticRule::ThreeFactors(params) => {
                let observed = &mut self.state.observed_strengths;
                observed.push(three_factors::mean_strength_ut(event));
                three_factors::update(params, &self.floor, observed, &mut self.state.particles);
            }
        }
    }

    /// Reserves the room that a step takes, so that none has to be found in it.
    fn reserve(&mut self) {
        if self.recipe.spawning.is_some() {
            self.state.particles.reserve(most_particles(&self.recipe));
        }
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

    fn estimate_cloud(&mut self) {
        if self.state.particles.is_empty() || self.scratch.weights.len() != self.state.particles.len() {
            return;
        }
        let estimate =
            CloudEstimate::of(&self.state.particles, &self.scratch.weights, &mut self.scratch.estimate);
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
            let u = uniform(draw(self.seed, self.state.n_steps, 0, Purpose::Resampling)[0]);
            self.state.particles.resample_systematic(&self.scratch.weights, u, &mut self.scratch.resample);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorMap, GridFrame, Layers};
    use crate::step::StepCycle;
    use crate::time::Timestamp;

    /// 60 m × 20 m where the field grows by 2 µT a metre along x.
    fn slope() -> FloorIndex {
        let plan = FloorPlan { width_m: 60.0, height_m: 20.0, ..FloorPlan::default() };
        let frame = GridFrame::covering(plan.width_m, plan.height_m, 1.0);
        let strength_ut = (0..frame.len()).map(|node| 20.0 + 2.0 * (node % frame.nx) as f32).collect();
        let layers = Layers { strength_ut, ..Layers::default() };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    fn step(k: u32) -> StepEvent {
        let at = |k: u32| Timestamp::from_nanos(500_000_000 * i64::from(k));
        StepEvent {
            cycle: StepCycle {
                start: at(k),
                end: at(k + 1),
                frequency_hz: 2.0,
                amplitude_m_s2: 3.0,
                is_first: false,
            },
            n_steps: 1,
            reads: [None; 3],
            level_heading_rad: core::f32::consts::FRAC_PI_2,
            forward_field: None,
            end_strength_ut: Some(40.0 + 1.5 * k as f32),
            field_bias_reset: false,
            attitude: crate::attitude::AttitudeEstimate::default(),
        }
    }

    #[test]
    fn mass_centred_weights_last_until_particles_are_resampled() {
        let recipe = Recipe { n_particles: 60, resample_below: 0.0, ..Recipe::mass_centered() };
        let MagneticRule::MassCentered(params) = recipe.magnetic else { panic!("another weight") };
        let mut tracker = Tracker::new(recipe, Arc::new(slope()), 1);
        tracker.place(Point2::new(20.0, 10.0), 2.0);
        (0..4).for_each(|k| tracker.step(&step(k), &[]));
        let before = tracker.particles().log_weight.clone();
        let best = before.iter().fold(f32::NEG_INFINITY, |best, &w| best.max(w));
        assert!(before.iter().any(|&w| w < best - 0.1), "{before:?}");
        tracker.step(&step(4), &[]);
        let Particles { log_weight, delta_errors_ut, .. } = tracker.particles();
        for ((after, before), errors_ut) in log_weight.iter().zip(before).zip(delta_errors_ut.chunks(3)) {
            let mean_ut = errors_ut.iter().sum::<f32>() / 3.0;
            let expected = before - best - libm::logf(mean_ut.max(params.threshold_ut));
            assert!((after - expected).abs() < 1e-4, "{after} {expected}");
        }
    }
}
