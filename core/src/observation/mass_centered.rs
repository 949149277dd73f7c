//! The mass-centred weight: step-to-step changes of the field's strength, compared over a short window.

mod direction;

use serde::{Deserialize, Serialize};

pub use direction::{DirectionParams, ObservedDirection};

use crate::map::FloorIndex;
use crate::particle::Particles;
use crate::pedestrian::StepEvent;
use direction::DirectionChange;

/// Parameters of the mass-centred weight.
///
/// `K` is left out: it cancels when weights are normalised.
///
/// # Source
/// Mass-centred 2019, Eqs. 3–12.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MassCenteredParams {
    /// Window `W`, in steps; the paper's best is 3.
    pub window: usize,
    /// Threshold `T`, in µT: smaller mean errors count as this; the paper's best is 0.05.
    pub threshold_ut: f32,
    /// What azimuth and polar angle add while the device is held as in the survey; nothing leaves them out.
    #[serde(default)]
    pub direction: Option<DirectionParams>,
}

impl Default for MassCenteredParams {
    fn default() -> Self {
        Self { window: 3, threshold_ut: 0.05, direction: Some(DirectionParams::default()) }
    }
}

/// What was observed at the last step, to which the next is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LastObserved {
    strength_ut: Option<f32>,
    direction: Option<ObservedDirection>,
    /// Changes of direction in a row up to the last step.
    n_changes: usize,
}

/// Where all particles moved from at a step, and how the wearer turned in it.
#[derive(Clone, Copy, Debug)]
pub struct Departure<'a> {
    /// The particles' x before the step, in metres.
    pub from_x_m: &'a [f32],
    /// Their y, in metres.
    pub from_y_m: &'a [f32],
    /// How far the body turned since the step before, by the gyroscope, clockwise, in radians.
    pub turn_rad: f32,
}

/// Weighs every particle by the changes that `event` brought: `w ← w·c_s·(c_a·c_p)^I`.
///
/// # Source
/// Mass-centred 2019, Eq. 12.
pub fn weigh(
    params: &MassCenteredParams,
    floor: &FloorIndex,
    event: &StepEvent,
    departure: Departure<'_>,
    last: &mut LastObserved,
    particles: &mut Particles,
    weights: &mut [f32],
) {
    let last_strength_ut = core::mem::replace(&mut last.strength_ut, event.end_strength_ut);
    match (event.end_strength_ut, last_strength_ut) {
        (Some(now_ut), Some(last_ut)) => update(params, floor, now_ut - last_ut, particles, weights),
        // The next change read is from here, so the next change felt is too.
        _ => remember(floor, particles),
    }
    let Some(direction) = &params.direction else { return };
    let observed = ObservedDirection::of(event);
    let last_observed = core::mem::replace(&mut last.direction, observed);
    let change = observed
        .zip(last_observed)
        .map(|(now, before)| DirectionChange::between(before, now, last.n_changes.saturating_add(1)));
    last.n_changes = change.map_or(0, |change| change.n_in_a_row);
    if observed.is_some() {
        direction::update(direction, params.window, floor, departure, change.as_ref(), particles, weights);
    }
}

/// Lets every particle remember the map's strength where it is.
fn remember(floor: &FloorIndex, particles: &mut Particles) {
    let strengths_ut = &floor.map().layers.strength_ut;
    let places = particles.x_m.iter().zip(&particles.y_m);
    for ((&x_m, &y_m), last_ut) in places.zip(&mut particles.strength_ut) {
        *last_ut = floor.layer(strengths_ut, x_m, y_m).unwrap_or(f32::NAN);
    }
}

/// Multiplies every particle's weight by `c_s = 1/max(MMSE, T)`, after a step with strength change `|Δs_obs|`.
///
/// `MMSE` is the mean over the window of `| |Δs_i| − |Δs_obs| |`; terms from before the start are left out.
/// Particles where the map knows no strength count as having felt no change.
///
/// # Source
/// Mass-centred 2019, Eqs. 4 and 8.
fn update(
    params: &MassCenteredParams,
    floor: &FloorIndex,
    observed_change_ut: f32,
    particles: &mut Particles,
    weights: &mut [f32],
) {
    let strengths_ut = &floor.map().layers.strength_ut;
    let window = params.window.max(1);
    let places = particles.x_m.iter().zip(&particles.y_m);
    let memories = particles.strength_ut.iter_mut().zip(particles.delta_errors_ut.chunks_exact_mut(window));
    for (((&x_m, &y_m), (last_ut, errors_ut)), weight) in places.zip(memories).zip(weights) {
        let strength_ut = floor.layer(strengths_ut, x_m, y_m).unwrap_or(f32::NAN);
        let change_ut = (strength_ut - *last_ut).abs();
        *last_ut = strength_ut;
        let felt_ut = if change_ut.is_nan() { 0.0 } else { change_ut };
        let (mut sum_ut, mut n) = (0.0, 0.0);
        let mut newer_ut = (felt_ut - observed_change_ut.abs()).abs();
        for slot_ut in errors_ut {
            let is_known = !newer_ut.is_nan();
            sum_ut += if is_known { newer_ut } else { 0.0 };
            n += if is_known { 1.0 } else { 0.0 };
            newer_ut = core::mem::replace(slot_ut, newer_ut);
        }
        // c_s in one division; where no change is known, none counts as an error.
        *weight *= if n > 0.0 { n / sum_ut.max(n * params.threshold_ut) } else { 1.0 / params.threshold_ut };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::AttitudeEstimate;
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorMap, GridFrame, Layers};
    use crate::step::StepCycle;
    use crate::time::Timestamp;

    /// 40 µT at x = 0, two more each metre.
    fn floor() -> FloorIndex {
        let frame = GridFrame::covering(10.0, 2.0, 1.0);
        let layers = Layers {
            strength_ut: (0..frame.len()).map(|n| 40.0 + 2.0 * (n % frame.nx) as f32).collect(),
            ..Layers::default()
        };
        let plan = FloorPlan { width_m: 10.0, height_m: 2.0, ..FloorPlan::default() };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    #[test]
    fn equations_4_and_11_by_hand() {
        let floor = floor();
        let mut particles = Particles {
            x_m: vec![2.0, 3.0],
            y_m: vec![1.0; 2],
            strength_ut: vec![42.0; 2],
            delta_errors_ut: vec![f32::NAN; 6],
            log_weight: vec![0.0; 2],
            ..Particles::default()
        };
        // Particle 0 felt |44 − 42| = 2 against 3: error 1. Particle 1 felt 4: error 1 too.
        let mut weights = [1.0, 0.5];
        update(&MassCenteredParams::default(), &floor, 3.0, &mut particles, &mut weights);
        assert_eq!(weights, [1.0, 0.5]);
        particles.x_m = vec![4.0, 3.0];
        // Now 4 against 0 (error 4, mean 2.5) and 0 against 0 (error 0, mean 0.5).
        update(&MassCenteredParams::default(), &floor, 0.0, &mut particles, &mut weights);
        assert!(
            (weights[0] - 1.0 / 2.5).abs() < 1e-6 && (weights[1] - 0.5 / 0.5).abs() < 1e-6,
            "{weights:?}"
        );
        assert_eq!(particles.delta_errors_ut[..2], [4.0, 1.0]);
    }

    #[test]
    fn a_change_felt_spans_the_step_of_the_change_read() {
        let floor = floor();
        let mut particles = Particles {
            x_m: vec![3.0],
            y_m: vec![1.0],
            // Of the start, a step before.
            strength_ut: vec![42.0],
            delta_errors_ut: vec![f32::NAN; 3],
            log_weight: vec![0.0],
            ..Particles::default()
        };
        let params = MassCenteredParams { direction: None, ..MassCenteredParams::default() };
        let (mut last, mut weights) = (LastObserved::default(), [1.0]);
        let departure = Departure { from_x_m: &[], from_y_m: &[], turn_rad: 0.0 };
        let mut step = |read_ut, particles: &mut Particles| {
            let cycle = StepCycle {
                start: Timestamp::from_millis(0),
                end: Timestamp::from_millis(500),
                frequency_hz: 2.0,
                amplitude_m_s2: 3.0,
                is_first: false,
            };
            let event = StepEvent {
                cycle,
                n_steps: 1,
                level_heading_rad: 0.0,
                forward_field: None,
                end_strength_ut: read_ut,
                reads: [None; 3],
                attitude: AttitudeEstimate::default(),
                field_bias_reset: false,
            };
            weigh(&params, &floor, &event, departure, &mut last, particles, &mut weights);
            particles.delta_errors_ut[0]
        };
        // Nothing to compare the first with; then 44 µT to 46 µT is felt and read.
        assert!(step(Some(44.0), &mut particles).is_nan());
        particles.x_m = vec![4.0];
        assert_eq!(step(Some(46.0), &mut particles), 0.0);
    }
}
