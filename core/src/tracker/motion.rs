//! How particles move at a step.

use crate::pedestrian::StepEvent;
use crate::random::{Purpose, draw, uniform};
use crate::step::turned_length_m;
use crate::system::{HeadingRule, LengthRule};
use crate::tracker::Tracker;

impl Tracker {
    /// Moves every particle by its steps, each of its own length, in its own direction.
    pub(super) fn move_particles(&mut self, event: &StepEvent) {
        let modelled_m = self.recipe.length.advance_m(&event.cycle);
        let motion = self.recipe.motion;
        let azimuth_rad = event.azimuth_rad().unwrap_or(event.level_heading_rad);
        let (azimuth_sin, azimuth_cos) = libm::sincosf(azimuth_rad);
        let turned = turned_length_m(1.0, self.state.turn_rad);
        let (raw_sin, raw_cos) = libm::sincosf(azimuth_rad + self.floor.mean_deviation_rad());
        let n_steps = f32::from(event.n_steps);
        let particles = &mut self.state.particles;
        let n = particles.x_m.len();
        let mut lengths_m = 0.0f64;
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
            }
            .clamp(0.0, 1.5)
                * n_steps;
            let (sin, cos) = match motion.heading {
                HeadingRule::CompensatedCompass => {
                    let [turn_sin, turn_cos] = self
                        .floor
                        .deviation_sin_cos(particles.x_m[i], particles.y_m[i])
                        .unwrap_or([0.0, 1.0]);
                    (
                        azimuth_sin * turn_cos + azimuth_cos * turn_sin,
                        azimuth_cos * turn_cos - azimuth_sin * turn_sin,
                    )
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
