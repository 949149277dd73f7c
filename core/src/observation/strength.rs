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

/// A place that the map does not know is taken for one that is off by one standard deviation, as right ones are on
/// average: neither evidence for it nor against it.
const UNKNOWN_LOG_WEIGHT: f32 = -0.5;

/// Adds `−(z − ‖f(x)‖)²/2σ_r²` to every particle's log weight; the factor before the exponential is the same for all.
///
/// # Source
/// Song 2014, Eq. 1.
pub fn update(params: &StrengthParams, floor: &FloorIndex, observed_ut: f32, particles: &mut Particles) {
    let strengths_ut = &floor.map().layers.strength_ut;
    let scale = 1.0 / params.sd_ut.max(1e-3);
    let places = particles.x_m.iter().zip(&particles.y_m);
    for ((&x_m, &y_m), log_weight) in places.zip(&mut particles.log_weight) {
        *log_weight += floor.layer(strengths_ut, x_m, y_m).map_or(UNKNOWN_LOG_WEIGHT, |strength_ut| {
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
        // 43 against 44: 1/8; 47 against 44: 9/8; unknown.
        assert_eq!(particles.log_weight, [-0.125, -2.125, -0.5]);
    }
}
