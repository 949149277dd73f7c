//! Particles that do not move: each round they are put on the map's points of the most similar field.

use crate::geometry::Point2;
use crate::observation::candidates::{CandidateParams, Candidates, SearchArea};
use crate::pedestrian::StepEvent;
use crate::tracker::Tracker;

/// Where a step from a candidate of the last round leads.
#[derive(Clone, Copy, Debug)]
struct Moved {
    from_m: [f32; 2],
    to_m: [f32; 2],
    heading_sin_cos: [f32; 2],
    weight: f32,
}

/// Memory that one round needs and the next does not remember.
#[derive(Clone, Debug, Default)]
pub(super) struct CandidateScratch {
    candidates: Candidates,
    moved: Vec<Moved>,
}

impl CandidateScratch {
    /// Room for `k` candidates.
    pub fn with_capacity(k: usize) -> Self {
        Self { candidates: Candidates::with_capacity(k), moved: Vec::with_capacity(k) }
    }
}

impl Tracker {
    /// Says that nothing is known but that the walker is within `radius_m` of `point` along each axis.
    pub(super) fn search_about(&mut self, point: Point2, radius_m: f64) {
        let centre_m = [point.x_m as f32, point.y_m as f32];
        // The circle about the square.
        let radius_m = (radius_m * core::f64::consts::SQRT_2) as f32;
        self.state.search = Some(SearchArea { centre_m, radius_m });
    }

    /// Puts the particles on the points whose strength is nearest to the measured one, and weighs them by how well a step
    /// from those of the last round reaches them.
    ///
    /// Where no point is near, or nothing was measured, the last ones are carried on by the step alone.
    ///
    /// # Source
    /// Song 2014, §3, Fig. 1.
    pub(super) fn propose_candidates(&mut self, params: &CandidateParams, event: &StepEvent) {
        self.carry_on(event);
        let CandidateScratch { candidates, moved } = &mut self.scratch.candidates;
        let Some(observed_ut) = event.end_strength_ut else { return };
        candidates.clear();
        match &mut self.state.search {
            Some(area) => candidates.search(&self.floor, *area, observed_ut),
            None => {
                let mut last_m = [f32::NAN; 2];
                for &Moved { to_m, .. } in moved.iter().filter(|moved| moved.weight > 0.0) {
                    if to_m != last_m {
                        let area = SearchArea { centre_m: to_m, radius_m: params.radius_m };
                        candidates.search(&self.floor, area, observed_ut);
                    }
                    last_m = to_m;
                }
            }
        }
        let found = candidates.found();
        let Some(best) = found.first() else { return };
        let is_first = self.state.search.take();
        let particles = &mut self.state.particles;
        for i in 0..particles.x_m.len() {
            let (candidate, is_one) = found.get(i).map_or((best, false), |candidate| (candidate, true));
            let reach_sd_m = params.reach_sd_m.filter(|_| is_first.is_none());
            let (prior, parent) = reach(moved, candidate.place_m, reach_sd_m);
            [particles.x_m[i], particles.y_m[i]] = candidate.place_m;
            particles.log_weight[i] = if is_one { libm::logf(prior) } else { f32::NEG_INFINITY };
            if let Some(parent) = moved.get(parent) {
                [particles.heading_sin[i], particles.heading_cos[i]] = parent.heading_sin_cos;
                [self.scratch.from_x_m[i], self.scratch.from_y_m[i]] = parent.from_m;
            }
        }
        if params.reach_sd_m.is_none() {
            let centre_m = match is_first {
                Some(SearchArea { centre_m, radius_m }) if radius_m < SearchArea::EVERYWHERE.radius_m => {
                    centre_m
                }
                _ => best.place_m,
            };
            self.state.search = Some(SearchArea { centre_m, radius_m: params.radius_m });
        }
    }

    /// Moves all particles, and the area of the search, by the step.
    fn carry_on(&mut self, event: &StepEvent) {
        let length_m = f32::from(event.n_steps) * self.recipe.length.advance_m(&event.cycle);
        self.state.step_length_m = f64::from(length_m);
        let azimuth_rad = event.azimuth_rad().unwrap_or(event.level_heading_rad);
        let (azimuth_sin, azimuth_cos) = libm::sincosf(azimuth_rad);
        let heading = |x_m: f32, y_m: f32| {
            let [sin, cos] = self.floor.deviation_sin_cos(x_m, y_m).unwrap_or([0.0, 1.0]);
            [azimuth_sin * cos + azimuth_cos * sin, azimuth_cos * cos - azimuth_sin * sin]
        };
        let moved = &mut self.scratch.candidates.moved;
        moved.clear();
        let particles = &mut self.state.particles;
        for i in 0..particles.x_m.len() {
            let from_m = [particles.x_m[i], particles.y_m[i]];
            let heading_sin_cos = heading(from_m[0], from_m[1]);
            let to_m = [0, 1].map(|c| from_m[c] + length_m * heading_sin_cos[c]);
            let weight = libm::expf(particles.log_weight[i]);
            moved.push(Moved { from_m, to_m, heading_sin_cos, weight });
            [particles.x_m[i], particles.y_m[i]] = to_m;
            [particles.heading_sin[i], particles.heading_cos[i]] = heading_sin_cos;
        }
        if let Some(SearchArea { centre_m, .. }) = &mut self.state.search {
            let [sin, cos] = heading(centre_m[0], centre_m[1]);
            *centre_m = [centre_m[0] + length_m * sin, centre_m[1] + length_m * cos];
        }
    }
}

/// How likely `place_m` is reached from the last candidates, and which of them it is most likely reached from.
fn reach(moved: &[Moved], place_m: [f32; 2], sd_m: Option<f32>) -> (f32, usize) {
    let (mut sum, mut most, mut parent) = (0.0, f32::NEG_INFINITY, 0);
    let scale = 0.5 / sd_m.map_or(1.0, |sd_m| (sd_m * sd_m).max(1e-6));
    for (k, last) in moved.iter().enumerate() {
        let (dx_m, dy_m) = (place_m[0] - last.to_m[0], place_m[1] - last.to_m[1]);
        let share = last.weight * libm::expf(-scale * (dx_m * dx_m + dy_m * dy_m));
        sum += share;
        if share > most {
            (most, parent) = (share, k);
        }
    }
    (if sd_m.is_some() { sum } else { 1.0 }, parent)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(to_m: [f32; 2], weight: f32) -> Moved {
        Moved { from_m: [0.0; 2], to_m, heading_sin_cos: [0.0, 1.0], weight }
    }

    #[test]
    fn reachability_by_hand() {
        let last = [moved([0.0, 0.0], 1.0), moved([3.0, 4.0], 0.5)];
        // exp(−1²/2) + 0.5·exp(−(2² + 4²)/2)
        let (prior, parent) = reach(&last, [1.0, 0.0], Some(1.0));
        assert!((prior - (0.606_530_66 + 0.5 * 4.54e-5)).abs() < 1e-6, "{prior}");
        assert_eq!(parent, 0);
        assert_eq!(reach(&last, [3.0, 3.0], Some(2.0)).1, 1);
        assert_eq!(reach(&last, [9.0, 9.0], None).0, 1.0);
    }
}
