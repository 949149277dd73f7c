//! The loop as a whole.

use super::*;
use crate::floor_plan::FloorPlan;
use crate::magnetic::feature::LevelField;
use crate::map::{FloorMap, GridFrame, Layers};
use crate::step::StepCycle;

/// 60 m × 20 m where the field grows by 2 µT a metre along x.
fn slope() -> FloorIndex {
    let plan = FloorPlan { width_m: 60.0, height_m: 20.0, ..FloorPlan::default() };
    let frame = GridFrame::covering(plan.width_m, plan.height_m, 1.0);
    let strength_ut = (0..frame.len()).map(|node| 20.0 + 2.0 * (node % frame.nx) as f32).collect();
    let layers = Layers { strength_ut, ..Layers::default() };
    FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
}

fn step(k: u32) -> StepEvent {
    let at = |k: u32| Timestamp::from_nanos(500_000_000 * i64::from(k));
    StepEvent {
        cycle: StepCycle {
            start: at(k),
            end: at(k + 1),
            frequency_hz: 2.0,
            amplitude_m_s2: 3.0,
            is_first: false,
        },
        n_steps: 1,
        reads: [None; 3],
        level_heading_rad: core::f32::consts::FRAC_PI_2,
        forward_field: None,
        end_strength_ut: Some(40.0 + 1.5 * k as f32),
        field_bias_reset: false,
        attitude: crate::attitude::AttitudeEstimate::default(),
    }
}

#[test]
fn a_turn_shortens_the_step_that_it_falls_in() {
    let lengths_m = |turn_rad: f32, is_first: bool| {
        let mut tracker = Tracker::new(Recipe::mass_centered(), Arc::new(slope()), 1);
        tracker.place(Point2::new(20.0, 10.0), 2.0);
        tracker.step(&step(0), &[]);
        let mut turned = step(1);
        turned.level_heading_rad += turn_rad;
        turned.cycle.is_first = is_first;
        tracker.step(&turned, &[]);
        tracker.step_length_m()
    };
    // Equation 14: sin((π − π/2)/2) = sin 45°.
    assert!(
        (lengths_m(core::f32::consts::FRAC_PI_2, false) / lengths_m(0.0, false) - 0.5f64.sqrt()).abs() < 1e-4
    );
    assert_eq!(lengths_m(core::f32::consts::FRAC_PI_2, true), lengths_m(0.0, true));
}

#[test]
fn the_first_step_goes_where_somebody_told() {
    for recipe in [Recipe::dead_reckoning(), Recipe::ibill(), Recipe::dtw()] {
        let name = recipe.name.clone();
        let mut tracker = Tracker::new(recipe, Arc::new(slope()), 1);
        // The device's level heading is π/2 at the step.
        let mut heading_rad = |told_rad: f64, level_rad: Option<f32>| {
            let start = Point2::new(20.0, 10.0);
            tracker.place(start, 0.1);
            tracker.face(told_rad, 0.02, level_rad);
            tracker.step(&step(0), &[]);
            let estimate = tracker.estimate().unwrap();
            (Point2::new(estimate.x_m, estimate.y_m) - start).heading_rad()
        };
        // Told before anything was heard, then when the device had half a radian yet to turn.
        for (told_rad, level_rad, expected_rad) in
            [(0.3, None, 0.3), (-2.0, None, -2.0), (1.0, Some(core::f32::consts::FRAC_PI_2 - 0.5), 1.5)]
        {
            let off_rad = wrap_rad(heading_rad(told_rad, level_rad) - expected_rad);
            assert!(off_rad.abs() < 0.15, "{name}: {told_rad} {off_rad}");
        }
    }
}

#[test]
fn mass_centred_weights_last_until_particles_are_resampled() {
    let recipe = Recipe { n_particles: 60, resample_below: 0.0, ..Recipe::mass_centered() };
    let MagneticRule::MassCentered(params) = recipe.magnetic else { panic!("another weight") };
    let mut tracker = Tracker::new(recipe, Arc::new(slope()), 1);
    tracker.place(Point2::new(20.0, 10.0), 2.0);
    (0..4).for_each(|k| tracker.step(&step(k), &[]));
    let before = tracker.particles().log_weight.clone();
    let best = before.iter().fold(f32::NEG_INFINITY, |best, &w| best.max(w));
    assert!(before.iter().any(|&w| w < best - 0.1), "{before:?}");
    tracker.step(&step(4), &[]);
    let Particles { log_weight, delta_errors_ut, .. } = tracker.particles();
    for ((after, before), errors_ut) in log_weight.iter().zip(before).zip(delta_errors_ut.chunks(3)) {
        let mean_ut = errors_ut.iter().sum::<f32>() / 3.0;
        let expected = before - best - libm::logf(mean_ut.max(params.threshold_ut));
        assert!((after - expected).abs() < 1e-4, "{after} {expected}");
    }
}

/// The particles' direction after steps in which the device turned to `level_rad` while its compass said `azimuth_rad`;
/// nothing without a magnetometer.
fn direction_rad(smoothing_s: f32, steps: &[(f32, Option<f32>, bool)]) -> f64 {
    let mut recipe = Recipe { n_particles: 20, ..Recipe::mass_centered() };
    recipe.motion.heading = HeadingRule::CompensatedCompass { smoothing_s };
    let mut tracker = Tracker::new(recipe, Arc::new(slope()), 1);
    tracker.place(Point2::new(20.0, 10.0), 2.0);
    for (k, &(level_rad, azimuth_rad, is_first)) in steps.iter().enumerate() {
        let mut event = step(k as u32);
        event.level_heading_rad = level_rad;
        event.cycle.is_first = is_first;
        event.forward_field = azimuth_rad.map(|rad| {
            let (sin, cos) = libm::sincosf(-rad);
            LevelField { field_ut: [20.0 * sin, 20.0 * cos, -40.0] }
        });
        tracker.step(&event, &[]);
    }
    tracker.estimate().unwrap().heading_rad
}

#[test]
fn a_swinging_compass_is_followed_within_its_time_constant() {
    let is_near = |rad: f64, expected_rad: f64| {
        assert!((rad - expected_rad).abs() < 1e-5, "{rad} instead of {expected_rad}");
    };
    // Half a second a step: of a quarter turn that the gyroscope does not know, 1 − exp(−0.5/1.5) on the chord.
    let share = 1.0 - libm::exp(-0.5 / 1.5);
    let swing = [(0.2, Some(0.0), false), (0.2, Some(core::f32::consts::FRAC_PI_2), false)];
    is_near(direction_rad(1.5, &swing), libm::atan2(share, 1.0 - share));
    is_near(direction_rad(0.0, &swing), core::f64::consts::FRAC_PI_2);
    // A turn that both know is made at once, and one without a magnetometer by the gyroscope.
    is_near(direction_rad(1.5, &[(0.2, Some(0.0), false), (1.2, Some(1.0), false)]), 1.0);
    is_near(direction_rad(1.5, &[(0.2, Some(0.5), false), (0.5, None, false)]), 0.8);
    // At the first step of a walk nobody knows how the body turned before.
    is_near(direction_rad(1.5, &[(0.2, Some(0.0), false), (2.2, Some(1.0), true)]), 1.0);
}
