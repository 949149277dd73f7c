//! The whole field vector, turned by each particle's own heading, with a bias that each particle learns.

use serde::{Deserialize, Serialize};

use crate::magnetic::feature::LevelField;
use crate::map::FloorIndex;
use crate::particle::Particles;

/// Parameters of the field-vector likelihood.
///
/// # Source
/// Ours. The bias is marginalised per particle by a Kalman filter (Schön, Gustafsson and Nordlund 2005, marginalised
/// particle filters); the Student-t density and the tempering answer to what prototypes showed on recordings:
/// successive readings are far from independent and sometimes far off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldVectorParams {
    /// Standard deviation of one field component about the map, beside the map's own variance, in µT.
    pub noise_sd_ut: f32,
    /// Standard deviation of the unknown magnetometer bias at the start, in µT.
    pub bias_sd_ut: f32,
    /// Standard deviation of the bias's random walk a step, in µT.
    pub bias_walk_sd_ut: f32,
    /// Degrees of freedom ν of the Student-t density.
    pub degrees_of_freedom: f32,
    /// The likelihood is raised to this power, in (0, 1].
    pub tempering: f32,
}

impl Default for FieldVectorParams {
    fn default() -> Self {
        Self {
            noise_sd_ut: 4.0,
            bias_sd_ut: 5.0,
            bias_walk_sd_ut: 0.2,
            degrees_of_freedom: 4.0,
            tempering: 0.1,
        }
    }
}

/// Adds the tempered log-likelihood of `observed` (forward frame) to every particle and updates its bias.
///
/// Particles off the map keep their weight: an unknown place is no evidence.
pub fn update(
    params: &FieldVectorParams,
    floor: &FloorIndex,
    observed: &LevelField,
    from_m: [&[f32]; 2],
    particles: &mut Particles,
) {
    let noise_ut2 = params.noise_sd_ut * params.noise_sd_ut;
    let walk_ut2 = params.bias_walk_sd_ut * params.bias_walk_sd_ut;
    let nu = params.degrees_of_freedom;
    let [right, ahead, up] = observed.field_ut;
    for i in 0..particles.x_m.len() {
        // What a step has read, it has read about its middle: there the survey has put it too.
        let middle_m = |from_m: &[f32], to_m: f32| from_m.get(i).map_or(to_m, |from_m| 0.5 * (from_m + to_m));
        let x_m = middle_m(from_m[0], particles.x_m[i]);
        let y_m = middle_m(from_m[1], particles.y_m[i]);
        let Some([fx, fy, fz, map_ut2]) = floor.field(x_m, y_m) else { continue };
        let (sin, cos) = (particles.heading_sin[i], particles.heading_cos[i]);
        let bias = [particles.bias_x_ut[i], particles.bias_y_ut[i], particles.bias_z_ut[i]];
        let innovation = [
            right - (fx * cos - fy * sin) - bias[0],
            ahead - (fx * sin + fy * cos) - bias[1],
            up - fz - bias[2],
        ];
        let bias_ut2 = particles.bias_variance_ut2[i] + walk_ut2;
        let reading_ut2 = noise_ut2 + map_ut2.max(0.0);
        let total_ut2 = bias_ut2 + reading_ut2;
        let square: f32 = innovation.iter().map(|c| c * c).sum();
        let q = square / total_ut2;
        let log_likelihood = -1.5 * libm::logf(total_ut2) - 0.5 * (nu + 3.0) * libm::logf(1.0 + q / nu);
        particles.log_weight[i] += params.tempering * log_likelihood;
        // Outliers teach the bias less, by the Student-t weight; tempering thins every reading alike.
        let trust = params.tempering * (nu + 3.0) / (nu + q);
        let gain = bias_ut2 / (bias_ut2 + reading_ut2 / trust);
        particles.bias_x_ut[i] = bias[0] + gain * innovation[0];
        particles.bias_y_ut[i] = bias[1] + gain * innovation[1];
        particles.bias_z_ut[i] = bias[2] + gain * innovation[2];
        particles.bias_variance_ut2[i] = bias_ut2 * (1.0 - gain);
    }
}

/// Makes every particle's bias as unknown again as at the start, about what it was: the magnetometer was recalibrated.
pub fn forget_bias(params: &FieldVectorParams, particles: &mut Particles) {
    for variance_ut2 in &mut particles.bias_variance_ut2 {
        *variance_ut2 += params.bias_sd_ut * params.bias_sd_ut;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorMap, GridFrame, Layers};
    use core::f32::consts::FRAC_PI_2;

    fn floor() -> FloorIndex {
        let frame = GridFrame::covering(10.0, 10.0, 1.0);
        let n = frame.len();
        let layers = Layers {
            field_x_ut: vec![0.0; n],
            field_y_ut: vec![20.0; n],
            field_z_ut: vec![-40.0; n],
            field_variance_ut2: vec![0.0; n],
            ..Layers::default()
        };
        let plan = FloorPlan { width_m: 10.0, height_m: 10.0, ..FloorPlan::default() };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    fn particles(headings: &[f32]) -> Particles {
        let n = headings.len();
        Particles {
            x_m: vec![5.0; n],
            y_m: vec![5.0; n],
            heading_sin: headings.iter().map(|h| libm::sinf(*h)).collect(),
            heading_cos: headings.iter().map(|h| libm::cosf(*h)).collect(),
            bias_x_ut: vec![0.0; n],
            bias_y_ut: vec![0.0; n],
            bias_z_ut: vec![0.0; n],
            bias_variance_ut2: vec![25.0; n],
            log_weight: vec![0.0; n],
            ..Particles::default()
        }
    }

    #[test]
    fn the_particle_that_faces_the_right_way_wins() {
        // Facing east, north is to the left: x = −20.
        let observed = LevelField { field_ut: [-20.0, 0.0, -40.0] };
        let mut particles = particles(&[FRAC_PI_2, 0.0, -FRAC_PI_2]);
        update(&FieldVectorParams::default(), &floor(), &observed, [&[], &[]], &mut particles);
        assert!(particles.log_weight[0] > particles.log_weight[1]);
        assert!(particles.log_weight[1] > particles.log_weight[2]);
    }

    #[test]
    fn the_bias_follows_the_kalman_equations() {
        let params = FieldVectorParams {
            noise_sd_ut: 3.0,
            bias_walk_sd_ut: 0.0,
            degrees_of_freedom: 1e6,
            tempering: 1.0,
            ..FieldVectorParams::default()
        };
        let mut particles = particles(&[0.0]);
        update(&params, &floor(), &LevelField { field_ut: [3.4, 20.0, -40.0] }, [&[], &[]], &mut particles);
        // gain = 25/(25 + 9), variance = 25·9/34
        assert!((particles.bias_x_ut[0] - 3.4 * 25.0 / 34.0).abs() < 1e-3);
        assert!((particles.bias_variance_ut2[0] - 25.0 * 9.0 / 34.0).abs() < 1e-3);
    }

    #[test]
    fn an_unknown_place_is_no_evidence() {
        let mut particles = particles(&[0.0]);
        particles.x_m[0] = 50.0;
        update(&FieldVectorParams::default(), &floor(), &LevelField::default(), [&[], &[]], &mut particles);
        assert_eq!(particles.log_weight, [0.0]);
    }

    #[test]
    fn a_reset_makes_the_bias_unknown_again() {
        let (floor, params) = (floor(), FieldVectorParams::default());
        let mut particles = particles(&[0.0]);
        let readings = |n: usize, ahead_ut: f32, particles: &mut Particles| {
            for _ in 0..n {
                update(
                    &params,
                    &floor,
                    &LevelField { field_ut: [0.0, ahead_ut, -40.0] },
                    [&[], &[]],
                    particles,
                );
            }
            particles.bias_y_ut[0]
        };
        readings(200, 20.0, &mut particles);
        let learnt_ut2 = particles.bias_variance_ut2[0];
        // The same jump of 10 µT, told and untold: what is told is believed sooner.
        let mut told = particles.clone();
        forget_bias(&params, &mut told);
        assert_eq!(told.bias_variance_ut2[0], learnt_ut2 + 25.0);
        assert!(readings(5, 30.0, &mut told) > 1.5 * readings(5, 30.0, &mut particles));
    }
}
