//! How particles move at a step.

use crate::geometry::{Point2, wrap_rad};
use crate::pedestrian::StepEvent;
use crate::random::{Purpose, draw, uniform};
use crate::step::turned_length_m;
use crate::system::{HeadingRule, LengthRule};
use crate::tracker::Tracker;

impl Tracker {
    /// Remembers how far the body turned since the step before, and where the steps alone have led, whatever is made of it.
    pub(super) fn reckon(&mut self, event: &StepEvent) {
        let heading_rad = f64::from(event.level_heading_rad);
        let last_rad = self.state.last_level_heading_rad.replace(event.level_heading_rad);
        // Before the first step of a walk the body turns as it likes.
        let last_rad = last_rad.filter(|_| !event.cycle.is_first);
        self.state.turn_rad = last_rad.map_or(0.0, |last| wrap_rad(heading_rad - f64::from(last)) as f32);
        let step_m = f64::from(event.n_steps) * f64::from(self.recipe.length.advance_m(&event.cycle));
        self.state.walked = self.state.walked + Point2::from_polar(step_m, heading_rad);
    }

    /// Moves every particle by its steps, each of its own length, in its own direction.
    pub(super) fn move_particles(&mut self, event: &StepEvent) {
        let modelled_m = self.recipe.length.advance_m(&event.cycle);
        let motion = self.recipe.motion;
        let azimuth_rad = event.azimuth_rad().unwrap_or(event.level_heading_rad);
        let (azimuth_sin, azimuth_cos) = libm::sincosf(azimuth_rad);
        let turned = turned_length_m(1.0, self.state.turn_rad);
        let (raw_sin, raw_cos) = libm::sincosf(azimuth_rad + self.floor.mean_deviation_rad());
        let n_steps = f32::from(event.n_steps);
        let share = compass_share(motion.heading, event);
        let (body_sin, body_cos) = libm::sincosf(self.state.turn_rad);
        let particles = &mut self.state.particles;
        let n = particles.x_m.len();
        let mut lengths_m = 0.0f64;
        let turn_rad = self.state.turn_rad.abs();
        let is_weighed = !self.state.is_start_unknown;
        for i in 0..n {
            let bits = draw(self.seed, self.state.n_steps, i as u32, Purpose::Motion);
            let noise = bits.map(|b| self.normal.sample(b));
            let length_m = match motion.length {
                LengthRule::Scaled { scale_walk_sd, step_sd, .. } => {
                    particles.length_scale[i] += scale_walk_sd * noise[3];
                    modelled_m * particles.length_scale[i] * (1.0 + step_sd * noise[1])
                }
                LengthRule::Genetic { a_walk_sd_m, b_walk_sd_m, step_sd_m, .. } => {
                    particles.gene_a_m[i] += a_walk_sd_m * noise[2];
                    particles.gene_b_m[i] += b_walk_sd_m * noise[3];
                    let length_m = particles.gene_a_m[i] * event.cycle.frequency_hz
                        + particles.gene_b_m[i]
                        + step_sd_m * noise[1];
                    turned * length_m
                }
                LengthRule::Alike { mean_m, round_sd_m } => mean_m + round_sd_m * noise[1],
                LengthRule::Interval { spread, half_width_sd } => {
                    let z = half_width_sd * (2.0 * uniform(bits[1]) - 1.0);
                    particles.log_weight[i] += if is_weighed { log_normal(z) } else { 0.0 };
                    modelled_m + spread.sd_m(modelled_m) * z
                }
            }
            .clamp(0.0, 1.5)
                * n_steps;
            let (sin, cos) = match motion.heading {
                HeadingRule::CompensatedCompass { .. } => {
                    let deviation = self.floor.deviation_sin_cos(particles.x_m[i], particles.y_m[i]);
                    let compensated = rotated([azimuth_sin, azimuth_cos], deviation.unwrap_or([0.0, 1.0]));
                    let last = [particles.heading_sin[i], particles.heading_cos[i]];
                    drawn_towards(compensated, rotated(last, [body_sin, body_cos]), share).into()
                }
                HeadingRule::Gyroscope { walk_sd_rad, .. } => {
                    particles.heading_offset_rad[i] += walk_sd_rad * noise[2];
                    libm::sincosf(event.level_heading_rad + particles.heading_offset_rad[i])
                }
                HeadingRule::Compass => (raw_sin, raw_cos),
                HeadingRule::Pathway(_) => {
                    let (x_m, y_m) = (particles.x_m[i], particles.y_m[i]);
                    let last = [particles.heading_sin[i], particles.heading_cos[i]];
                    let raw = [raw_sin, raw_cos];
                    let taken =
                        self.ways.as_ref().map(|ways| ways.heading(x_m, y_m, raw, last, uniform(bits[2])));
                    taken.unwrap_or(raw).into()
                }
                HeadingRule::GyroscopeTurns { sd_rad, half_width_sd, from_rad, .. } => {
                    if turn_rad >= from_rad {
                        let z = half_width_sd * (2.0 * uniform(bits[2]) - 1.0);
                        particles.log_weight[i] += if is_weighed { log_normal(z) } else { 0.0 };
                        particles.heading_offset_rad[i] += sd_rad * z;
                    }
                    libm::sincosf(event.level_heading_rad + particles.heading_offset_rad[i])
                }
            };
            particles.heading_sin[i] = sin;
            particles.heading_cos[i] = cos;
            let (noise_sin, noise_cos) = small_sin_cos(motion.direction_sd_rad * noise[0]);
            particles.x_m[i] += length_m * (sin * noise_cos + cos * noise_sin);
            particles.y_m[i] += length_m * (cos * noise_cos - sin * noise_sin);
            lengths_m += f64::from(length_m);
        }
        self.state.step_length_m = lengths_m / n.max(1) as f64;
    }
}

/// How far particles' directions follow the compass in `event`: 1 at once, 0 not at all.
///
/// At the first step of a walk the compass alone is known, since the body turned as it liked before.
fn compass_share(heading: HeadingRule, event: &StepEvent) -> f32 {
    match heading {
        HeadingRule::CompensatedCompass { smoothing_s } if smoothing_s > 0.0 && !event.cycle.is_first => {
            let duration_s = event.cycle.end.secs_since(event.cycle.start) as f32;
            if event.forward_field.is_some() { 1.0 - libm::expf(-duration_s / smoothing_s) } else { 0.0 }
        }
        _ => 1.0,
    }
}

/// The direction `[sin, cos]` turned by another such angle.
#[inline]
pub(super) fn rotated([sin, cos]: [f32; 2], [by_sin, by_cos]: [f32; 2]) -> [f32; 2] {
    [sin * by_cos + cos * by_sin, cos * by_cos - sin * by_sin]
}

/// The direction of `from` drawn by `share` towards `to`; `to` where the two are opposite and nothing is left.
#[inline]
fn drawn_towards(to: [f32; 2], from: [f32; 2], share: f32) -> [f32; 2] {
    if share >= 1.0 {
        return to;
    }
    let [sin, cos] = [0, 1].map(|c| from[c] + share * (to[c] - from[c]));
    let length = (sin * sin + cos * cos).sqrt();
    if length > 1e-3 { [sin / length, cos / length] } else { to }
}

/// Logarithm of the normal density at `z` standard deviations, over that at the mean.
///
/// # Source
/// iBILL 2017, Eqs 15 and 16; their normalisation over particles is left to the weights' own.
#[inline]
fn log_normal(z: f32) -> f32 {
    -0.5 * z * z
}

/// Sine and cosine of a small angle by their series: within 1e-3 below one radian, where noise lives.
#[inline]
fn small_sin_cos(angle_rad: f32) -> (f32, f32) {
    let square = angle_rad * angle_rad;
    let sin = angle_rad * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
    let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)));
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::small_sin_cos;

    #[test]
    fn the_series_follow_the_functions() {
        for k in -10..=10 {
            let angle_rad = 0.1 * k as f32;
            let (sin, cos) = small_sin_cos(angle_rad);
            assert!((sin - libm::sinf(angle_rad)).abs() < 1e-3 && (cos - libm::cosf(angle_rad)).abs() < 1e-3);
        }
    }
}
