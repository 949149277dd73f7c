//! What is left of a place and a direction after a time in which nothing was seen of the wearer.

use crate::observation::{history, mass_centered};
use crate::particle::Centre;
use crate::random::{Purpose, draw, uniform};
use crate::system::MagneticRule;
use crate::tracker::Tracker;
use crate::tracker::beacons::Pause;

/// The fastest that somebody walks unseen, in m/s.
pub(crate) const UNSEEN_WALK_M_S: f64 = 1.3;
/// A direction carried through a silence loses so much of its certainty: standard deviation in radians, by the square root of
/// seconds. A walker in a building turns off about every ten seconds.
const TURN_SD_RAD_PER_SQRT_S: f64 = 0.5;
/// After so long a silence a direction is worth no more than the compass, in seconds.
const TURNED_S: f64 = 5.0;
/// Draws for a place that is not inside a wall.
const N_TRIES: u32 = 8;

impl Tracker {
    /// Spreads the particles over where their wearer may be after `unseen_s` seconds without a sample of motion.
    ///
    /// Each goes straight in any direction at any pace up to a walker's. What they have learnt of walker and device is kept;
    /// what they remember of their way is not.
    pub fn lose_sight(&mut self, unseen_s: f64) {
        if !self.state.is_placed {
            return;
        }
        let plan = &self.floor.map().plan;
        let across_m = (plan.width_m * plan.width_m + plan.height_m * plan.height_m).sqrt();
        let reach_m = (UNSEEN_WALK_M_S * unseen_s).min(across_m) as f32;
        let (seed, step, n) = (self.seed, self.state.n_steps, self.state.particles.len() as u32);
        let particles = &mut self.state.particles;
        for i in 0..n {
            let from_m = [particles.x_m[i as usize], particles.y_m[i as usize]];
            let place_m = |k: u32| {
                let bits = draw(seed, step, i + k * n, Purpose::Unseen);
                let (sin, cos) = libm::sincosf(core::f32::consts::TAU * uniform(bits[0]));
                let away_m = reach_m * uniform(bits[1]);
                [from_m[0] + away_m * sin, from_m[1] + away_m * cos]
            };
            let open_m = (0..N_TRIES).map(place_m).find(|&[x_m, y_m]| self.floor.is_open(x_m, y_m));
            let [x_m, y_m] = open_m.unwrap_or(from_m);
            particles.x_m[i as usize] = x_m;
            particles.y_m[i as usize] = y_m;
        }
        let log_weight = core::mem::take(&mut particles.log_weight);
        particles.forget_places();
        particles.log_weight = log_weight;
        if let MagneticRule::History(params) = &self.recipe.magnetic {
            history::forget(params, &mut self.state.history, &mut self.state.particles);
        }
        self.state.last_observed = mass_centered::LastObserved::default();
        self.state.visit.leave();
        self.state.pause = Pause::Running;
        self.lose_direction(unseen_s);
        self.weigh_alike();
        if !self.weigh() {
            return;
        }
        self.estimate_cloud(Centre::Mean);
        if let (MagneticRule::Candidates(_), Some(estimate)) = (&self.recipe.magnetic, self.state.estimate) {
            let centre = crate::geometry::Point2::new(estimate.x_m, estimate.y_m);
            self.search_about(centre, f64::from(reach_m) + estimate.radius_95_m);
        }
    }

    /// Takes from the particles' directions what `unseen_s` seconds without a gyroscope take.
    pub fn lose_direction(&mut self, unseen_s: f64) {
        let (seed, step) = (self.seed, self.state.n_steps);
        // The next silence draws other numbers.
        self.state.n_steps = step.wrapping_add(1);
        self.state.last_level_heading_rad = None;
        self.state.turn_rad = 0.0;
        if unseen_s >= TURNED_S {
            self.state.is_oriented = false;
            self.state.told = None;
            return;
        }
        let sd_rad = (TURN_SD_RAD_PER_SQRT_S * unseen_s.max(0.0).sqrt()) as f32;
        for (offset_rad, i) in self.state.particles.heading_offset_rad.iter_mut().zip(0..) {
            *offset_rad += sd_rad * self.normal.sample(draw(seed, step, i, Purpose::Unseen)[2]);
        }
    }
}
