//! The field's strength against the map's, by a normal density.

use serde::{Deserialize, Serialize};

use crate::map::FloorIndex;
use crate::particle::Particles;

/// Parameters of the normal density of the strength.
///
/// # Source
/// Song 2014, Eq. 1, which leaves `σ_r` open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrengthParams {
    /// `σ_r`, standard deviation of a reading about the map, in µT; default 2: a phone's noise after calibration, and how
    /// much the field differs within the half metre between two points of a map among steel.
    pub sd_ut: f32,
}

impl Default for StrengthParams {
    fn default() -> Self {
        Self { sd_ut: 2.0 }
    }
}

/// A point farther from every surveyed line than this has no measured field, in metres.
pub(crate) const SURVEYED_M: f32 = 1.0;

/// Adds `−(z − ‖f(x)‖)²/2σ_r²` to every particle's log weight; the factor before the exponential is the same for all.
///
/// A particle where nobody measured the field dies; where no particle has a measured field the map ends, and nothing is
/// known of any.
///
/// # Source
/// Song 2014, Eq. 1. What becomes of particles beyond the map is ours: `f(x)` is a row of the map, and there is none.
pub fn update(params: &StrengthParams, floor: &FloorIndex, observed_ut: f32, particles: &mut Particles) {
    let strengths_ut = &floor.map().layers.strength_ut;
    let scale = 1.0 / params.sd_ut.max(1e-3);
    let measured_ut = |x_m: f32, y_m: f32| {
        floor.layer(strengths_ut, x_m, y_m).filter(|_| floor.is_surveyed(x_m, y_m, SURVEYED_M))
    };
    let Particles { x_m, y_m, log_weight, .. } = particles;
    if !x_m.iter().zip(&*y_m).any(|(&x_m, &y_m)| measured_ut(x_m, y_m).is_some()) {
        return;
    }
    for ((&x_m, &y_m), log_weight) in x_m.iter().zip(&*y_m).zip(log_weight) {
        *log_weight += measured_ut(x_m, y_m).map_or(f32::NEG_INFINITY, |strength_ut| {
            let off = (observed_ut - strength_ut) * scale;
            -0.5 * off * off
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorMap, GridFrame, Layers};

    #[test]
    fn equation_1_by_hand() {
        let plan = FloorPlan { width_m: 10.0, height_m: 2.0, ..FloorPlan::default() };
        let frame = GridFrame::covering(10.0, 2.0, 1.0);
        let strength_ut = (0..frame.len()).map(|node| 40.0 + (node % frame.nx) as f32).collect();
        let layers = Layers { strength_ut, ..Layers::default() };
        let floor = FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() });
        let mut particles = Particles {
            x_m: vec![3.0, 7.0, 50.0],
            y_m: vec![1.0; 3],
            log_weight: vec![0.0, -1.0, 0.0],
            ..Particles::default()
        };
        update(&StrengthParams { sd_ut: 2.0 }, &floor, 44.0, &mut particles);
        // 43 against 44: 1/8; 47 against 44: 9/8; the third is beyond the map.
        assert_eq!(particles.log_weight, [-0.125, -2.125, f32::NEG_INFINITY]);
        // Where none is on the map, nothing is known of any.
        particles.x_m.fill(50.0);
        particles.log_weight = vec![0.0, -1.0, -2.0];
        update(&StrengthParams { sd_ut: 2.0 }, &floor, 44.0, &mut particles);
        assert_eq!(particles.log_weight, [0.0, -1.0, -2.0]);
    }
}
