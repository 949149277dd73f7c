//! What a step says of each particle: the plan, the surveyed routes, the field.

use crate::observation::candidates::CandidateParams;
use crate::observation::mass_centered::Departure;
use crate::observation::{field_vector, history, mass_centered, strength, three_factors};
use crate::pedestrian::StepEvent;
use crate::system::{MagneticRule, PlanRule};
use crate::tracker::{Scratch, Tracker, TrackerState};

impl Tracker {
    pub(super) fn apply_plan(&mut self) {
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

    pub(super) fn apply_routes(&mut self) {
        let Some(routes) = self.recipe.routes else { return };
        let distances = &self.floor.map().layers.route_distance_m;
        let (free_m, log_weight_per_m) = routes.within(self.floor.way_band_m());
        let particles = &mut self.state.particles;
        for i in 0..particles.x_m.len() {
            let (x_m, y_m) = (particles.x_m[i], particles.y_m[i]);
            let cost = self.floor.nearest(distances, x_m, y_m).map_or(routes.min_log_weight, |d| {
                (log_weight_per_m * (d - free_m).max(0.0)).max(routes.min_log_weight)
            });
            let (sin, cos) = (particles.heading_sin[i], particles.heading_cos[i]);
            let across = self.floor.across_ways(x_m, y_m, sin, cos);
            particles.log_weight[i] += cost + routes.across_log_weight * across;
        }
    }

    pub(super) fn apply_magnetic(&mut self, event: &StepEvent) {
        match &self.recipe.magnetic {
            MagneticRule::Ignore => {}
            MagneticRule::MassCentered(params) => {
                let Scratch { from_x_m, from_y_m, weights, .. } = &mut self.scratch;
                let departure = Departure { from_x_m, from_y_m, turn_rad: self.state.turn_rad };
                let TrackerState { last_observed, particles, .. } = &mut self.state;
                mass_centered::weigh(
                    params,
                    &self.floor,
                    event,
                    departure,
                    last_observed,
                    particles,
                    weights,
                );
            }
            MagneticRule::Strength(params)
            | MagneticRule::Candidates(CandidateParams { strength: params, .. }) => {
                if let Some(observed_ut) = event.end_strength_ut {
                    strength::update(params, &self.floor, observed_ut, &mut self.state.particles);
                }
            }
            MagneticRule::FieldVector(params) => {
                if event.field_bias_reset {
                    field_vector::forget_bias(params, &mut self.state.particles);
                }
                if let Some(field) = &event.forward_field {
                    let from_m = [&*self.scratch.from_x_m, &*self.scratch.from_y_m];
                    field_vector::update(params, &self.floor, field, from_m, &mut self.state.particles);
                }
            }
            MagneticRule::History(params) if event.cycle.is_first && self.is_card() => {
                // The way between was not heard of.
                history::forget(params, &mut self.state.history, &mut self.state.particles);
            }
            // Who stands reads the same again: half a minute of that would wipe the history out.
            MagneticRule::History(_) if event.n_steps == 0 => {}
            MagneticRule::History(params) => {
                let Scratch { from_x_m, from_y_m, history: scratch, .. } = &mut self.scratch;
                let (device, particles) = (&mut self.state.history, &mut self.state.particles);
                let from_m = [&**from_x_m, &**from_y_m];
                history::update(params, &self.floor, &event.reads, from_m, device, particles, scratch);
            }
            MagneticRule::ThreeFactors(params) => {
                let observed = &mut self.state.observed_strengths;
                observed.push(three_factors::mean_strength_ut(event));
                three_factors::update(params, &self.floor, observed, &mut self.state.particles);
            }
        }
    }
}
