//! The magnetic one of iBILL's three factors: strengths along the last steps, compared as vectors.
//!
//! The other two weigh a particle's step length and turn when it moves: [`LengthRule::Interval`] and
//! [`HeadingRule::GyroscopeTurns`](crate::system::HeadingRule::GyroscopeTurns).
//!
//! [`LengthRule::Interval`]: crate::system::LengthRule::Interval

use serde::{Deserialize, Serialize};

use crate::map::FloorIndex;
use crate::particle::Particles;
use crate::pedestrian::StepEvent;

/// The longest window, in steps.
pub const MAX_WINDOW: usize = 16;

/// Parameters of the magnetic factor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreeFactorsParams {
    /// Steps whose strengths make a vector, `k`; 1 to 16, the paper's is 5.
    pub window: usize,
    /// δ, the fluctuation of the field's strength, in µT; the paper gives none.
    pub delta_ut: f32,
    /// A place farther than this from every surveyed line has no fingerprint, in metres.
    pub reach_m: f32,
}

impl Default for ThreeFactorsParams {
    /// δ is ours: at each step five strengths are compared, four of them not for the first time.
    fn default() -> Self {
        Self { window: 5, delta_ut: 12.0, reach_m: 2.0 }
    }
}

impl ThreeFactorsParams {
    /// The window, within its limits.
    pub(crate) fn n_steps(&self) -> usize {
        self.window.clamp(1, MAX_WINDOW)
    }
}

/// The observing vector: mean strengths of the latest steps, newest first; nothing of a step without a magnetometer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObservedStrengths {
    newest_first_ut: [Option<f32>; MAX_WINDOW],
}

impl ObservedStrengths {
    /// Takes in the mean strength of the latest step, in µT.
    pub fn push(&mut self, strength_ut: Option<f32>) {
        self.newest_first_ut.copy_within(..MAX_WINDOW - 1, 1);
        self.newest_first_ut[0] = strength_ut;
    }
}

/// Mean strength of the field over a step, in µT; nothing without a magnetometer.
///
/// # Source
/// iBILL 2017, §IV-A: the mean strength during each step is one observing value.
pub fn mean_strength_ut(event: &StepEvent) -> Option<f32> {
    let reads = || event.reads.iter().flatten();
    let n = reads().count();
    (n > 0).then(|| reads().map(|read| read.strength_ut).sum::<f32>() / n as f32)
}

/// Reads the map at every particle's place and adds the magnetic factor's logarithm, `−s²/2δ²`, to its log weight.
///
/// `s` is the distance of the observing vector from the particle's; what is unknown in either is left out of both. A
/// particle at a place without a fingerprint dies; where no particle has one the map ends, and nothing is known of any.
/// The normalisation over particles is a factor that all share, so it is left to the weights' own.
///
/// # Source
/// iBILL 2017, Eqs 17 and 18.
pub fn update(
    params: &ThreeFactorsParams,
    floor: &FloorIndex,
    observed: &ObservedStrengths,
    particles: &mut Particles,
) {
    let layers = &floor.map().layers;
    let is_surveyed = |x_m, y_m| floor.is_surveyed(x_m, y_m, params.reach_m);
    let window = params.n_steps();
    let mut has_fingerprint = false;
    let places = particles.x_m.iter().zip(&particles.y_m);
    for ((&x_m, &y_m), strengths_ut) in places.zip(particles.recent_strengths_ut.chunks_exact_mut(window)) {
        let fingerprint_ut = floor.layer(&layers.strength_ut, x_m, y_m).filter(|_| is_surveyed(x_m, y_m));
        strengths_ut.copy_within(..window - 1, 1);
        strengths_ut[0] = fingerprint_ut.unwrap_or(f32::NAN);
        has_fingerprint |= fingerprint_ut.is_some();
    }
    let per_square = -0.5 / (params.delta_ut * params.delta_ut);
    let vectors = particles.recent_strengths_ut.chunks_exact(window);
    for (log_weight, strengths_ut) in particles.log_weight.iter_mut().zip(vectors) {
        if has_fingerprint && strengths_ut[0].is_nan() {
            *log_weight = f32::NEG_INFINITY;
            continue;
        }
        let pairs = observed.newest_first_ut.iter().zip(strengths_ut);
        let errors_ut =
            pairs.filter_map(|(seen_ut, &ut)| Some(*seen_ut.as_ref()? - ut)).filter(|e| !e.is_nan());
        *log_weight += per_square * errors_ut.map(|e| e * e).sum::<f32>();
    }
}

/// Whether weighing by step length and turn does better than by the magnetic field alone: `E(X²) ≤ p`.
///
/// `mean_square_error` is `E(X²)` of the weights by step length and turn, without dimension, growing with the way walked
/// and the turns made; `p_large_deviation` is the probability that the field deviates much, which a crowd raises. The
/// more the field fluctuates, the longer the two factors help; a cluster of beacons sets `X` back to nearly zero.
///
/// # Source
/// iBILL 2017, Eq. 23 (from Eqs 19 to 22 by the Cauchy–Schwarz inequality).
pub fn motion_factors_help(mean_square_error: f64, p_large_deviation: f64) -> bool {
    mean_square_error <= p_large_deviation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorMap, GridFrame, Layers};

    /// 10 m × 2 m where the strength is 40 µT and 2 µT more each metre along x; nobody surveyed beyond x = 8 m.
    fn slope() -> FloorIndex {
        let plan = FloorPlan { width_m: 10.0, height_m: 2.0, ..FloorPlan::default() };
        let frame = GridFrame::covering(plan.width_m, plan.height_m, 1.0);
        let x = |n: usize| (n % frame.nx) as f32;
        let layers = Layers {
            strength_ut: (0..frame.len()).map(|n| 40.0 + 2.0 * x(n)).collect(),
            route_distance_m: (0..frame.len()).map(|n| (x(n) - 6.0).max(0.0)).collect(),
            ..Layers::default()
        };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    fn at(x_m: [f32; 3]) -> Particles {
        Particles {
            x_m: x_m.to_vec(),
            y_m: vec![1.0; 3],
            recent_strengths_ut: vec![f32::NAN; 15],
            log_weight: vec![0.0; 3],
            ..Particles::default()
        }
    }

    #[test]
    fn equations_17_and_18_by_hand() {
        let params = ThreeFactorsParams { delta_ut: 2.0, ..ThreeFactorsParams::default() };
        let (floor, mut observed) = (slope(), ObservedStrengths::default());
        let mut particles = at([1.0, 2.0, 9.5]);
        observed.push(Some(43.0));
        update(&params, &floor, &observed, &mut particles);
        // 42 and 44 against 43: s² = 1, −1/8 each; the third has left the survey.
        assert_eq!(particles.log_weight, [-0.125, -0.125, f32::NEG_INFINITY]);
        particles.x_m = vec![3.0, 4.0, 9.5];
        observed.push(Some(46.0));
        update(&params, &floor, &observed, &mut particles);
        // 46 and 48 against 46: s² = 1 + 0 and 1 + 4, on top of what was inherited.
        assert_eq!(particles.log_weight[..2], [-0.25, -0.75]);
        // Eq. 17 normalises over the particles, which leaves their ratio: exp(0.5).
        let ratio = libm::expf(particles.log_weight[0] - particles.log_weight[1]);
        assert!((ratio - 1.648_721).abs() < 1e-5);
    }

    #[test]
    fn where_nothing_is_known_nothing_dies() {
        let params = ThreeFactorsParams::default();
        let mut observed = ObservedStrengths::default();
        observed.push(Some(43.0));
        let mut particles = at([9.5, -3.0, 20.0]);
        update(&params, &slope(), &observed, &mut particles);
        assert_eq!(particles.log_weight, [0.0; 3]);
        update(&params, &FloorIndex::new(FloorMap::default()), &observed, &mut particles);
        assert_eq!(particles.log_weight, [0.0; 3]);
        // Without a magnetometer only the survey's edge counts.
        observed.push(None);
        let mut particles = at([1.0, 2.0, 9.5]);
        update(&params, &slope(), &observed, &mut particles);
        assert_eq!(particles.log_weight, [0.0, 0.0, f32::NEG_INFINITY]);
    }

    #[test]
    fn equation_23_by_hand() {
        // A fifth of the places deviates in a crowd: motion helps while its squared error is below that.
        assert!(motion_factors_help(0.1, 0.2) && motion_factors_help(0.2, 0.2));
        assert!(!motion_factors_help(0.25, 0.2));
        // Without fluctuations only perfect motion would.
        assert!(!motion_factors_help(1e-6, 0.0) && motion_factors_help(0.0, 0.0));
    }
}
