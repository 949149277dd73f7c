//! Where particles begin, which way they face, and how they begin anew when all have died.

use serde::{Deserialize, Serialize};

use crate::geometry::Point2;
use crate::observation::candidates::SearchArea;
use crate::observation::radio::{RadioObservation, log_likelihood};
use crate::particle::{Centre, Particles};
use crate::pedestrian::StepEvent;
use crate::random::{Purpose, draw, uniform};
use crate::system::{HeadingRule, LengthRule, MagneticRule, StartRule};
use crate::tracker::Tracker;
use crate::tracker::motion::rotated;

/// Without a hint, particles start within this distance of a surveyed line, in metres.
const START_REACH_M: f32 = 2.0;
/// Half the side of the square in which particles are spread after all have died, in metres.
const RECOVERY_RADIUS_M: f64 = 3.0;

/// Without a hint, this many transmitters heard at once are worth a start.
const START_TRANSMITTERS: usize = 3;
/// So many steps are waited for them.
const START_WAIT_STEPS: u32 = 8;

/// The direction in which somebody said that the walker goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ToldDirection {
    /// Clockwise from the floor's y axis, and its standard deviation, in radians.
    pub heading_rad: f32,
    pub sd_rad: f32,
    /// The device's level heading at that time; the first step's where that was not known yet.
    pub level_rad: Option<f32>,
}

impl ToldDirection {
    /// Walking direction minus level heading, in radians.
    fn offset_rad(&self, event: &StepEvent) -> f32 {
        self.heading_rad - self.level_rad.unwrap_or(event.level_heading_rad)
    }
}

impl Tracker {
    /// Whether a start without a hint is better put off: too little radio was heard yet, and more may come.
    pub(super) fn waits_for_radio(&mut self, radio: &[RadioObservation]) -> bool {
        let has_transmitters = !self.floor.map().transmitters.is_empty();
        let waits =
            has_transmitters && radio.len() < START_TRANSMITTERS && self.state.n_waited < START_WAIT_STEPS;
        self.state.n_waited += u32::from(waits);
        waits
    }

    /// Gives every particle its place, and its length genes; directions come with the first step.
    pub(super) fn occupy(&mut self, x_m: Vec<f32>, y_m: Vec<f32>) {
        let n = x_m.len();
        let mut particles = Particles { x_m, y_m, log_weight: vec![0.0; n], ..Particles::default() };
        particles.heading_sin = vec![0.0; n];
        particles.heading_cos = vec![1.0; n];
        let genes: Vec<[f32; 2]> = (0..n as u32)
            .map(|i| {
                let bits = draw(self.seed, self.state.n_steps, i, Purpose::Genes);
                [self.normal.sample(bits[0]), self.normal.sample(bits[1])]
            })
            .collect();
        match self.recipe.motion.length {
            LengthRule::Scaled { scale_sd, .. } => {
                particles.length_scale = genes.iter().map(|g| 1.0 + scale_sd * g[0]).collect();
            }
            LengthRule::Genetic { a_m, a_sd_m, b_m, b_sd_m, .. } => {
                particles.gene_a_m = genes.iter().map(|g| a_m + a_sd_m * g[0]).collect();
                particles.gene_b_m = genes.iter().map(|g| b_m + b_sd_m * g[1]).collect();
            }
            LengthRule::Alike { .. } => {}
            LengthRule::Interval { .. } => {}
        }
        match &self.recipe.magnetic {
            MagneticRule::Ignore | MagneticRule::Strength(_) | MagneticRule::Candidates(_) => {}
            MagneticRule::MassCentered(params) => {
                let strengths = &self.floor.map().layers.strength_ut;
                particles.strength_ut = (0..n)
                    .map(|i| {
                        self.floor.layer(strengths, particles.x_m[i], particles.y_m[i]).unwrap_or(f32::NAN)
                    })
                    .collect();
                let window = params.window.max(1);
                particles.delta_errors_ut = vec![f32::NAN; n * window];
                if params.direction.is_some() {
                    particles.field_heading_rad = vec![f32::NAN; n];
                    particles.polar_rad = vec![f32::NAN; n];
                    particles.azimuth_errors_rad = vec![0.0; n * window];
                    particles.polar_errors_rad = vec![0.0; n * window];
                }
            }
            MagneticRule::FieldVector(params) => {
                particles.bias_x_ut = vec![0.0; n];
                particles.bias_y_ut = vec![0.0; n];
                particles.bias_z_ut = vec![0.0; n];
                particles.bias_variance_ut2 = vec![params.bias_sd_ut * params.bias_sd_ut; n];
            }
            MagneticRule::History(params) => {
                particles.history_ut = vec![0.0; n * params.n_values()];
                particles.history_sums = vec![0.0; n * params.n_sums()];
                particles.history_log_weight = vec![0.0; n];
                self.state.history.start_anew(params);
            }
            MagneticRule::ThreeFactors(params) => {
                particles.recent_strengths_ut = vec![f32::NAN; n * params.n_steps()];
            }
        }
        if self.recipe.ble_filter.is_some() {
            particles.n_rounds_outside = vec![0.0; n];
            self.state.first_round = None;
        }
        if let Some(routes) = self.recipe.routes {
            let densities = &self.floor.map().layers.route_density;
            for i in 0..n {
                let density = self.floor.layer(densities, particles.x_m[i], particles.y_m[i]).unwrap_or(0.0);
                particles.log_weight[i] = routes.start_power * libm::logf(routes.start_floor + density);
            }
        }
        self.state.particles = particles;
        self.state.is_placed = true;
        self.state.is_oriented = false;
        self.reserve();
        self.weigh_alike();
        self.weigh();
        self.estimate_cloud(Centre::Mean);
    }

    /// Places particles without a hint: where the recipe says, and of that where radio makes it likely if it was heard.
    pub(super) fn place_unknown(&mut self, radio: &[RadioObservation]) {
        let map = self.floor.map();
        let (frame, distances) = (map.frame, &map.layers.route_distance_m);
        let is_route = |node: usize| distances.get(node).is_some_and(|&d| d <= START_REACH_M);
        let is_open = |node: usize| {
            let Point2 { x_m, y_m } = frame.node(node % frame.nx.max(1), node / frame.nx.max(1));
            self.floor.is_open(x_m as f32, y_m as f32)
        };
        let is_start = |node: &usize| match self.recipe.start {
            StartRule::Routes | StartRule::Circle { .. } => is_route(*node),
            StartRule::WholeFloor => is_open(*node),
        };
        let mut nodes: Vec<usize> = (0..frame.len()).filter(is_start).collect();
        if nodes.is_empty() {
            nodes = (0..frame.len()).collect();
        }
        let place = |node: usize| frame.node(node % frame.nx.max(1), node / frame.nx.max(1));
        let log_weights: Vec<f32> = nodes
            .iter()
            .map(|&node| {
                let Point2 { x_m, y_m } = place(node);
                radio
                    .iter()
                    .filter_map(|o| Some((map.transmitters.get(o.transmitter as usize)?, o.rssi_dbm)))
                    .map(|(transmitter, rssi_dbm)| {
                        0.5 * log_likelihood(4.0, transmitter, rssi_dbm, x_m as f32, y_m as f32)
                    })
                    .sum()
            })
            .collect();
        let best = log_weights.iter().fold(f32::NEG_INFINITY, |best, &w| best.max(w));
        let weights: Vec<f64> = log_weights.iter().map(|&w| f64::from(libm::expf(w - best))).collect();
        let total: f64 = weights.iter().sum();
        let n = self.recipe.n_particles.max(1);
        let (mut x_m, mut y_m) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let (mut k, mut reached) = (0, weights.first().copied().unwrap_or(0.0));
        for i in 0..n {
            let bits = draw(self.seed, self.state.n_steps, i as u32, Purpose::Start);
            let target = total * (i as f64 + f64::from(uniform(bits[2]))) / n as f64;
            while reached < target && k + 1 < weights.len() {
                k += 1;
                reached += weights[k];
            }
            let centre = nodes.get(k).map_or(Point2::default(), |&node| place(node));
            let jitter_m = |b: u32| frame.cell_m * (f64::from(uniform(b)) - 0.5);
            x_m.push((centre.x_m + jitter_m(bits[0])) as f32);
            y_m.push((centre.y_m + jitter_m(bits[1])) as f32);
        }
        self.occupy(x_m, y_m);
        self.state.told = None;
        self.state.search = Some(SearchArea::EVERYWHERE);
        self.state.is_start_unknown = matches!(self.recipe.start, StartRule::Circle { .. });
    }

    /// Faces the particles as somebody told, else by the compass of their first step, corrected by the map; anywhere
    /// without a compass.
    pub(super) fn orient(&mut self, event: &StepEvent) {
        self.state.is_oriented = true;
        if let HeadingRule::Pathway(_) = self.recipe.motion.heading {
            // The heading before the first: the compass's.
            let azimuth_rad = event.azimuth_rad().unwrap_or(event.level_heading_rad);
            let (sin, cos) = libm::sincosf(azimuth_rad + self.floor.mean_deviation_rad());
            self.state.particles.heading_sin.fill(sin);
            self.state.particles.heading_cos.fill(cos);
        }
        if matches!(self.recipe.motion.heading, HeadingRule::CompensatedCompass { smoothing_s } if smoothing_s > 0.0)
        {
            self.face_by_compass(event);
        }
        let Some(start_sd_rad) = self.recipe.motion.heading.start_sd_rad() else { return };
        let deviations = &self.floor.map().layers.compass_deviation_rad;
        let (seed, step) = (self.seed, self.state.n_steps);
        let n_directions = self.directions_and_number().0;
        let azimuth_rad = event.azimuth_rad().filter(|_| !self.state.is_start_unknown);
        let told = self.state.told;
        let particles = &mut self.state.particles;
        particles.heading_offset_rad.clear();
        for i in 0..particles.x_m.len() {
            let bits = draw(seed, step, i as u32, Purpose::Genes);
            let offset = match (told, azimuth_rad) {
                (Some(told), _) => told.offset_rad(event) + told.sd_rad * self.normal.sample(bits[2]),
                (None, Some(azimuth)) => {
                    let deviation =
                        self.floor.nearest(deviations, particles.x_m[i], particles.y_m[i]).unwrap_or(0.0);
                    azimuth + deviation - event.level_heading_rad + start_sd_rad * self.normal.sample(bits[2])
                }
                (None, None) if self.state.is_start_unknown => {
                    core::f32::consts::TAU * (i % n_directions) as f32 / n_directions as f32
                }
                (None, None) => core::f32::consts::TAU * uniform(bits[2]),
            };
            particles.heading_offset_rad.push(offset);
        }
    }

    /// Turns every particle to the compensated azimuth of `event`, less the turn that the event will bring.
    fn face_by_compass(&mut self, event: &StepEvent) {
        let azimuth_rad = event.azimuth_rad().unwrap_or(event.level_heading_rad);
        let (sin, cos) = libm::sincosf(azimuth_rad - self.state.turn_rad);
        let particles = &mut self.state.particles;
        for i in 0..particles.x_m.len() {
            let deviation = self.floor.deviation_sin_cos(particles.x_m[i], particles.y_m[i]);
            [particles.heading_sin[i], particles.heading_cos[i]] =
                rotated([sin, cos], deviation.unwrap_or([0.0, 1.0]));
        }
    }

    /// After every particle has died: a fresh spread round the last estimate, directions kept.
    pub(super) fn recover(&mut self) {
        self.state.n_recoveries += 1;
        let Some(estimate) = self.state.estimate else { return };
        let dead = core::mem::take(&mut self.state.particles);
        let is_start_unknown = self.state.is_start_unknown;
        self.place(Point2::new(estimate.x_m, estimate.y_m), RECOVERY_RADIUS_M);
        self.state.is_start_unknown = is_start_unknown;
        let particles = &mut self.state.particles;
        // Where particles spawn, more or fewer may have died than begin.
        let n = particles.len();
        let kept = |array: &[f32]| array.iter().copied().cycle().take(n).collect();
        particles.heading_offset_rad = kept(&dead.heading_offset_rad);
        particles.heading_sin = kept(&dead.heading_sin);
        particles.heading_cos = kept(&dead.heading_cos);
        self.state.is_oriented = true;
        self.reserve();
    }
}
