//! BLE filtering: in the beginning, particles far from the nearest radio fingerprint die.

use serde::{Deserialize, Serialize};

use crate::geometry::Point2;
use crate::particle::Particles;
use crate::radio::fingerprint::FingerprintParams;

/// Parameters of [`update`].
///
/// # Source
/// Kwak 2018, §5.3.4: `R_BLE` = 6 m, `τ_c` = 2 rounds, for 10 s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BleFilterParams {
    /// How the round's fingerprint is matched.
    pub fingerprint: FingerprintParams,
    /// `R_BLE`: farther than this from the matched cell a particle is outside, in metres; default 6.
    pub radius_m: f32,
    /// `τ_c`: outside so many rounds in a row, it dies; default 2.
    pub n_rounds: u8,
    /// How long after the start, in seconds; default 10.
    pub duration_s: f64,
}

impl Default for BleFilterParams {
    fn default() -> Self {
        Self { fingerprint: FingerprintParams::default(), radius_m: 6.0, n_rounds: 2, duration_s: 10.0 }
    }
}

/// Counts for every particle the rounds in a row that it has been outside, and lets it die when they are too many.
///
/// When that would leave none, the match is not believed and nobody dies.
///
/// # Source
/// Kwak 2018, §5.3.4.
pub fn update(params: &BleFilterParams, matched: Point2, particles: &mut Particles) {
    let [x_m, y_m] = [matched.x_m as f32, matched.y_m as f32];
    let most_m2 = params.radius_m * params.radius_m;
    let n_rounds = f32::from(params.n_rounds.max(1));
    let mut is_one_left = false;
    for (i, n_outside) in particles.n_rounds_outside.iter_mut().enumerate() {
        let (dx, dy) = (particles.x_m[i] - x_m, particles.y_m[i] - y_m);
        let is_outside = dx * dx + dy * dy > most_m2;
        *n_outside = if is_outside { *n_outside + 1.0 } else { 0.0 };
        is_one_left |= *n_outside < n_rounds && particles.log_weight[i] > f32::NEG_INFINITY;
    }
    if !is_one_left {
        return;
    }
    for (n_outside, log_weight) in particles.n_rounds_outside.iter().zip(&mut particles.log_weight) {
        if *n_outside >= n_rounds {
            *log_weight = f32::NEG_INFINITY;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_outside_is_once_too_often() {
        let params = BleFilterParams::default();
        let mut particles = Particles {
            x_m: vec![0.0, 5.9, 6.1, 20.0],
            y_m: vec![0.0; 4],
            log_weight: vec![0.0, -1.0, -1.0, 0.0],
            n_rounds_outside: vec![0.0; 4],
            ..Particles::default()
        };
        let dead = |particles: &Particles| {
            particles.log_weight.iter().map(|&w| w == f32::NEG_INFINITY).collect::<Vec<_>>()
        };
        update(&params, Point2::new(0.0, 0.0), &mut particles);
        assert_eq!(dead(&particles), [false; 4]);
        // The third is inside for once, and counts anew.
        update(&params, Point2::new(1.0, 0.0), &mut particles);
        assert_eq!(dead(&particles), [false, false, false, true]);
        update(&params, Point2::new(0.0, 0.0), &mut particles);
        assert_eq!(dead(&particles), [false, false, false, true]);
        update(&params, Point2::new(0.0, 0.0), &mut particles);
        assert_eq!(dead(&particles), [false, false, true, true]);
        // A match far from everybody is not believed.
        update(&params, Point2::new(500.0, 0.0), &mut particles);
        update(&params, Point2::new(500.0, 0.0), &mut particles);
        assert_eq!(dead(&particles), [false, false, true, true]);
    }
}
