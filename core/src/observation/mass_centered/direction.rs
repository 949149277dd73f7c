//! The same weight on the field's direction: step-to-step changes of its azimuth and its polar angle.

use core::f32::consts::{FRAC_PI_2, PI, TAU};

use serde::{Deserialize, Serialize};

use crate::map::FloorIndex;
use crate::observation::mass_centered::Departure;
use crate::particle::Particles;
use crate::pedestrian::StepEvent;

/// Parameters of the weight on azimuth and polar angle.
///
/// `K_a` and `K_p` are left out: the indicator is the same for all particles, so both cancel when weights are
/// normalised.
///
/// # Source
/// Mass-centred 2019, Eqs. 9–12, which leave both thresholds open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectionParams {
    /// Threshold `T_a` of the azimuth, in radians: smaller mean errors count as this; default 0.02, the best of 0.002
    /// to 1 on a mall's recordings among those that are as good as any in a simulated office.
    pub azimuth_threshold_rad: f32,
    /// Threshold `T_p` of the polar angle, in radians; default 0.01, found likewise: gravity is known better than the
    /// hand's heading.
    pub polar_threshold_rad: f32,
}

impl Default for DirectionParams {
    fn default() -> Self {
        Self { azimuth_threshold_rad: 0.02, polar_threshold_rad: 0.01 }
    }
}

/// The field's angles as the device read them over a step, and how the body turned to it from the step before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObservedDirection {
    /// Azimuth of the device's forward axis, clockwise from the field's horizontal part, in radians.
    pub azimuth_rad: f32,
    /// Polar angle, in radians.
    pub polar_rad: f32,
}

impl ObservedDirection {
    /// The angles over `event`, if it was walked in the survey's attitude: the paper's indicator `I`.
    ///
    /// # Source
    /// Mass-centred 2019, Eq. 11.
    pub fn of(event: &StepEvent) -> Option<Self> {
        let field = event.forward_field.filter(|_| event.attitude.attitude.allows_magnetic_direction())?;
        Some(Self { azimuth_rad: -field.heading_rad(), polar_rad: field.polar_rad() })
    }
}

/// What changed between two steps, both walked in the survey's attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionChange {
    /// `|Δa_obs|`, in [0, π] radians.
    pub azimuth_rad: f32,
    /// `|Δp_obs|`, in radians.
    pub polar_rad: f32,
    /// Such changes in a row, this one included; the window holds no more terms.
    pub n_in_a_row: usize,
}

impl DirectionChange {
    /// From `last` to `now`.
    pub fn between(last: ObservedDirection, now: ObservedDirection, n_in_a_row: usize) -> Self {
        Self {
            azimuth_rad: wrapped_size_rad(now.azimuth_rad - last.azimuth_rad),
            polar_rad: (now.polar_rad - last.polar_rad).abs(),
            n_in_a_row,
        }
    }
}

/// Multiplies every particle's weight by `c_a·c_p` after a step.
///
/// Observed angles are those of the mean field over a step, since a hand sways within one; a particle's are therefore
/// read in the middle of its move. They are compared in the frame of the device, which points where the walker goes: a
/// particle's azimuth is its heading less the direction of the map's field. From one step to the next that heading
/// turns as the gyroscope says. The compensated azimuth that moves the particle would not do, since it is made of the
/// observed one: the observation would be compared with itself.
///
/// Without a `change` the angles are only remembered. Particles where the map knows no field count as having felt no
/// change.
///
/// # Source
/// Mass-centred 2019, Eqs. 6, 7, 9 and 10; which heading turns the map's field is ours, the paper does not say.
pub fn update(
    params: &DirectionParams,
    window: usize,
    floor: &FloorIndex,
    departure: Departure<'_>,
    change: Option<&DirectionChange>,
    particles: &mut Particles,
    weights: &mut [f32],
) {
    let window = window.max(1);
    let n_terms = change.map_or(0, |change| change.n_in_a_row.min(window));
    let Departure { from_x_m, from_y_m, turn_rad } = departure;
    let [azimuth_obs_rad, polar_obs_rad] =
        change.map_or([0.0; 2], |change| [change.azimuth_rad, change.polar_rad]);
    let least = n_terms as f32;
    let (least_azimuth_rad, least_polar_rad) =
        (least * params.azimuth_threshold_rad, least * params.polar_threshold_rad);
    let places = particles.x_m.iter().zip(&particles.y_m).zip(from_x_m.iter().zip(from_y_m));
    let angles = particles.field_heading_rad.iter_mut().zip(&mut particles.polar_rad);
    let errors = particles
        .azimuth_errors_rad
        .chunks_exact_mut(window)
        .zip(particles.polar_errors_rad.chunks_exact_mut(window));
    for ((((to_m, from_m), (heading_rad, polar_rad)), errors), weight) in
        places.zip(angles).zip(errors).zip(weights)
    {
        let (x_m, y_m) = (0.5 * (to_m.0 + from_m.0), 0.5 * (to_m.1 + from_m.1));
        let [heading_now_rad, polar_now_rad] =
            floor.field(x_m, y_m).map_or([f32::NAN; 2], |[x, y, z, _]| field_angles_rad([x, y, z]));
        let last_heading_rad = core::mem::replace(heading_rad, heading_now_rad);
        let last_polar_rad = core::mem::replace(polar_rad, polar_now_rad);
        if n_terms == 0 {
            continue;
        }
        let swung_rad = or_zero(heading_now_rad - last_heading_rad);
        let azimuth_error_rad = (wrapped_size_rad(turn_rad - swung_rad) - azimuth_obs_rad).abs();
        let polar_error_rad = (or_zero(polar_now_rad - last_polar_rad).abs() - polar_obs_rad).abs();
        let azimuth_sum_rad = push_and_sum(errors.0, azimuth_error_rad, n_terms);
        let polar_sum_rad = push_and_sum(errors.1, polar_error_rad, n_terms);
        // c_a·c_p in one division.
        *weight *=
            least * least / (azimuth_sum_rad.max(least_azimuth_rad) * polar_sum_rad.max(least_polar_rad));
    }
}

/// Puts `newest` in front of `errors`; the sum of the first `n`.
#[inline]
fn push_and_sum(errors: &mut [f32], newest: f32, n: usize) -> f32 {
    let (mut sum, mut newer) = (0.0, newest);
    for (k, slot) in errors.iter_mut().enumerate() {
        sum += if k < n { newer } else { 0.0 };
        newer = core::mem::replace(slot, newer);
    }
    sum
}

#[inline]
fn or_zero(change_rad: f32) -> f32 {
    if change_rad.is_nan() { 0.0 } else { change_rad }
}

/// The size of an angle the short way round, for angles within one and a half turns.
#[inline]
fn wrapped_size_rad(angle_rad: f32) -> f32 {
    let size_rad = angle_rad.abs();
    size_rad.min((size_rad - TAU).abs())
}

/// Direction of the horizontal part, clockwise from y, and angle from the upward vertical of a field (x, y, z), in
/// radians.
#[inline]
fn field_angles_rad([x, y, z]: [f32; 3]) -> [f32; 2] {
    [atan2_rad(x, y), atan2_rad((x * x + y * y).sqrt(), z)]
}

/// The arc tangent of `y/x` in its quadrant, within 2e-5 radians, by an odd polynomial fitted to the least greatest
/// error: a tenth of the time of the exact function, which thousands of particles would take twice a step.
#[inline]
fn atan2_rad(y: f32, x: f32) -> f32 {
    let (across, along) = (y.abs(), x.abs());
    let (least, most) = if across < along { (across, along) } else { (along, across) };
    let t = if most > 0.0 { least / most } else { 0.0 };
    let square = t * t;
    let octant_rad = t
        * (0.999_866_3
            + square
                * (-0.330_304_8 + square * (0.180_159_3 + square * (-0.085_156_34 + square * 0.020_845_11))));
    let quadrant_rad = if across <= along { octant_rad } else { FRAC_PI_2 - octant_rad };
    let half_rad = if x < 0.0 { PI - quadrant_rad } else { quadrant_rad };
    if y < 0.0 { -half_rad } else { half_rad }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::{Attitude, AttitudeEstimate};
    use crate::floor_plan::FloorPlan;
    use crate::magnetic::feature::LevelField;
    use crate::map::{FloorMap, GridFrame, Layers};
    use crate::step::StepCycle;
    use crate::time::Timestamp;

    /// A field of 20 µT that turns clockwise by 0.1 rad a metre along x, and is inclined by 0.05 rad a metre along y.
    fn floor() -> FloorIndex {
        let plan = FloorPlan { width_m: 60.0, height_m: 10.0, ..FloorPlan::default() };
        let frame = GridFrame::covering(60.0, 10.0, 0.25);
        let field_at = |node: usize| {
            let place = frame.node(node % frame.nx, node / frame.nx);
            let polar = 1.5 + 0.05 * place.y_m as f32;
            let (sin, cos) = libm::sincosf(0.1 * place.x_m as f32);
            let (horizontal, vertical) = libm::sincosf(polar);
            [20.0 * horizontal * sin, 20.0 * horizontal * cos, 20.0 * vertical]
        };
        let component = |c: usize| (0..frame.len()).map(|node| field_at(node)[c]).collect();
        let layers = Layers {
            field_x_ut: component(0),
            field_y_ut: component(1),
            field_z_ut: component(2),
            field_variance_ut2: vec![0.0; frame.len()],
            ..Layers::default()
        };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    fn particles(x_m: &[f32], y_m: &[f32]) -> Particles {
        let n = x_m.len();
        Particles {
            x_m: x_m.into(),
            y_m: y_m.into(),
            field_heading_rad: vec![f32::NAN; n],
            polar_rad: vec![f32::NAN; n],
            azimuth_errors_rad: vec![0.0; 3 * n],
            polar_errors_rad: vec![0.0; 3 * n],
            ..Particles::default()
        }
    }

    const PARAMS: DirectionParams =
        DirectionParams { azimuth_threshold_rad: 0.01, polar_threshold_rad: 0.02 };

    /// Moves the particles to `to_m` and weighs them.
    fn step(
        particles: &mut Particles,
        weights: &mut [f32],
        to_m: [&[f32]; 2],
        turn_rad: f32,
        change: Option<DirectionChange>,
    ) {
        let (from_x_m, from_y_m) = (particles.x_m.clone(), particles.y_m.clone());
        let departure = Departure { from_x_m: &from_x_m, from_y_m: &from_y_m, turn_rad };
        (particles.x_m, particles.y_m) = (to_m[0].into(), to_m[1].into());
        update(&PARAMS, 3, &floor(), departure, change.as_ref(), particles, weights);
    }

    #[test]
    fn equations_6_7_9_and_10_by_hand() {
        let mut particles = particles(&[2.0, 6.0], &[1.0, 5.0]);
        let mut weights = [1.0; 2];
        step(&mut particles, &mut weights, [&[3.0, 6.0], &[1.0, 6.0]], 0.0, None);
        assert_eq!(weights, [1.0; 2]);
        // Middles of the moves: x = 2.5 and y = 1; x = 6 and y = 5.5.
        assert!((particles.field_heading_rad[0] - 0.25).abs() < 1e-3, "{particles:?}");
        assert!((particles.polar_rad[1] - (1.5 + 0.05 * 5.5)).abs() < 1e-3, "{particles:?}");
        // Straight on; the azimuth fell by 0.1: the first particle felt that, and no polar change as observed.
        let change = DirectionChange { azimuth_rad: 0.1, polar_rad: 0.0, n_in_a_row: 1 };
        step(&mut particles, &mut weights, [&[4.0, 6.0], &[1.0, 7.0]], 0.0, Some(change));
        assert!((weights[0] * 0.01 * 0.02 - 1.0).abs() < 0.02, "{weights:?}");
        // The second felt 0 against 0.1 and 0.05 against 0.
        assert!((weights[1] * 0.1 * 0.05 - 1.0).abs() < 0.02, "{weights:?}");
        // A turn of 0.5 while the field turned 0.1 with the walker: 0.4 is felt, against 0.3. Means (0 + 0.1)/2, 0.
        weights = [1.0; 2];
        let change = DirectionChange { azimuth_rad: 0.3, polar_rad: 0.0, n_in_a_row: 2 };
        step(&mut particles, &mut weights, [&[5.0, 6.0], &[1.0, 7.0]], 0.5, Some(change));
        assert!((weights[0] * 0.05 * 0.02 - 1.0).abs() < 0.02, "{weights:?}");
    }

    #[test]
    fn angles_go_the_short_way_round() {
        assert!((wrapped_size_rad(-3.0 - 3.1) - (TAU - 6.1)).abs() < 1e-6);
        // The field heads 3.1 rad at 31 m and −3.08 at 32 m: a change of 0.1, not of 6.18.
        let mut particles = particles(&[30.5], &[1.0]);
        let mut weights = [1.0];
        step(&mut particles, &mut weights, [&[31.5], &[1.0]], 0.0, None);
        let observed = |azimuth_rad| ObservedDirection { azimuth_rad, polar_rad: 1.55 };
        let change = DirectionChange::between(observed(-3.1), observed(3.083), 1);
        assert!((change.azimuth_rad - 0.1).abs() < 2e-3, "{change:?}");
        step(&mut particles, &mut weights, [&[32.5], &[1.0]], 0.0, Some(change));
        assert!((weights[0] * 0.01 * 0.02 - 1.0).abs() < 0.02, "{weights:?}");
    }

    #[test]
    fn an_unknown_place_has_felt_no_change() {
        let mut particles = particles(&[2.0, -5.0], &[1.0; 2]);
        let mut weights = [1.0; 2];
        step(&mut particles, &mut weights, [&[2.0, -5.0], &[1.0; 2]], 0.0, None);
        let change = DirectionChange { azimuth_rad: 0.1, polar_rad: 0.1, n_in_a_row: 1 };
        step(&mut particles, &mut weights, [&[2.0, -5.0], &[1.0; 2]], 0.0, Some(change));
        assert!((weights[0] - weights[1]).abs() < 1e-3 * weights[0] && weights[0].is_finite(), "{weights:?}");
    }

    #[test]
    fn only_the_survey_s_attitude_allows_angles() {
        let event = |attitude| {
            let attitude = AttitudeEstimate { attitude, ..AttitudeEstimate::default() };
            // The field is to the left and downward: the device points clockwise of it by a right angle.
            let forward_field = Some(LevelField { field_ut: [-20.0, 0.0, -20.0] });
            let cycle = StepCycle {
                start: Timestamp::from_millis(0),
                end: Timestamp::from_millis(500),
                frequency_hz: 2.0,
                amplitude_m_s2: 3.0,
                is_first: false,
            };
            StepEvent {
                cycle,
                n_steps: 1,
                level_heading_rad: 0.0,
                forward_field,
                end_strength_ut: None,
                reads: [None; 3],
                attitude,
                field_bias_reset: false,
            }
        };
        let observed = ObservedDirection::of(&event(Attitude::UpwardForwardHorizontal)).unwrap();
        assert!((observed.azimuth_rad - FRAC_PI_2).abs() < 1e-6);
        assert!((observed.polar_rad - 0.75 * PI).abs() < 1e-6);
        for other in [Attitude::UpwardForwardInclined, Attitude::UpwardNotForward, Attitude::Unknown] {
            assert_eq!(ObservedDirection::of(&event(other)), None);
        }
    }

    #[test]
    fn the_fast_arc_tangent_follows_the_exact_one() {
        for k in 0..10_000 {
            let (sin, cos) = libm::sincosf(0.001 * TAU * k as f32);
            let size = 1.0 + k as f32;
            let (y, x) = (size * sin, size * cos);
            assert!(wrapped_size_rad(atan2_rad(y, x) - libm::atan2f(y, x)) < 2e-5, "{y} {x}");
        }
        assert_eq!([atan2_rad(0.0, 0.0), atan2_rad(0.0, 3.0)], [0.0; 2]);
    }
}
