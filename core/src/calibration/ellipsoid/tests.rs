//! The fit on ellipsoids whose axes are known.

use super::*;
use proptest::prelude::*;

/// Directions spread evenly over the sphere (golden spiral), with z from `lowest` to 1.
fn directions(n: usize, lowest: f64) -> impl Iterator<Item = [f64; 3]> {
    (0..n).map(move |k| {
        let z = 1.0 - (1.0 - lowest) * (k as f64 + 0.5) / n as f64;
        let (sin, cos) = libm::sincos(2.399_963_229_728_653 * k as f64);
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    })
}

/// Raw fields of strength 48 µT, bent by the inverse of `matrix` and shifted.
fn raw(matrix: &Matrix3<f64>, offset: [f64; 3], n: usize, lowest: f64) -> Vec<[f64; 3]> {
    let bend = matrix.try_inverse().unwrap();
    directions(n, lowest).map(|d| (bend * Vector3::from(d) * 48.0 + Vector3::from(offset)).into()).collect()
}

/// Noise within ±1, the same on every run.
fn noise(k: usize) -> f64 {
    let bits = (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((bits ^ bits >> 29) % 2_001) as f64 / 1_000.0 - 1.0
}

fn bent() -> Matrix3<f64> {
    let matrix = Matrix3::new(1.05, 0.02, -0.01, 0.02, 0.97, 0.03, -0.01, 0.03, 0.99);
    matrix / libm::cbrt(matrix.determinant())
}

#[test]
fn a_sphere_by_hand() {
    // Six points at 40 µT about (10, 20, 30).
    let six = [[50.0, 20.0, 30.0], [-30.0, 20.0, 30.0], [10.0, 60.0, 30.0]];
    let other = [[10.0, -20.0, 30.0], [10.0, 20.0, 70.0], [10.0, 20.0, -10.0]];
    let (centre, radius_ut) = sphere(&[six, other].concat()).unwrap();
    assert!((0..3).all(|c| (centre[c] - [10.0, 20.0, 30.0][c]).abs() < 1e-9), "{centre:?}");
    assert!((radius_ut - 40.0).abs() < 1e-9);
}

#[test]
fn an_ellipsoid_without_noise_is_found_exactly() {
    let readings = raw(&bent(), [-300.0, 120.0, 412.0], 300, -1.0);
    let params = EllipsoidParams { soft_iron_sd: 10.0, ..EllipsoidParams::default() };
    let fit = fit_ellipsoid(&readings, &params).unwrap();
    for (found, truth) in fit.offset_ut.into_iter().zip([-300.0, 120.0, 412.0]) {
        assert!((found - truth).abs() < 1e-4, "{:?}", fit.offset_ut);
    }
    for r in 0..3 {
        for c in 0..3 {
            assert!((fit.matrix[r][c] - bent()[(r, c)]).abs() < 1e-5, "{:?}", fit.matrix);
        }
    }
    assert!((fit.quality.strength_ut - 48.0).abs() < 1e-3, "{:?}", fit.quality);
    assert!(fit.quality.residual_ut < 1e-3 && fit.quality.coverage == 1.0);
    let calibrated = fit.apply(readings[7].map(|c| c as f32)).map(f64::from);
    assert!((calibrated.iter().map(|c| c * c).sum::<f64>().sqrt() - 48.0).abs() < 1e-3);
}

#[test]
fn a_known_strength_sets_the_scale() {
    // Raw units 20 % too large.
    let readings = raw(&(bent() / 1.2), [5.0, 6.0, 7.0], 200, -1.0);
    let params =
        EllipsoidParams { strength_ut: Some(48.0), soft_iron_sd: 10.0, ..EllipsoidParams::default() };
    let fit = fit_ellipsoid(&readings, &params).unwrap();
    assert!((fit.matrix[0][0] - bent()[(0, 0)] / 1.2).abs() < 1e-5, "{:?}", fit.matrix);
    assert_eq!(fit.quality.strength_ut, 48.0);
}

#[test]
fn noise_and_a_few_disturbed_readings_move_it_little() {
    let mut readings = raw(&bent(), [-30.0, 12.0, 41.0], 200, -1.0);
    for (k, reading) in readings.iter_mut().enumerate() {
        *reading = [0, 1, 2].map(|c| reading[c] + noise(3 * k + c));
        if k % 40 == 0 {
            reading[0] += 12.0;
        }
    }
    let fit = fit_ellipsoid(&readings, &EllipsoidParams::default()).unwrap();
    for (found, truth) in fit.offset_ut.into_iter().zip([-30.0, 12.0, 41.0]) {
        assert!((found - truth).abs() < 0.5, "{:?}", fit.offset_ut);
    }
    assert!(fit.quality.offset_sd_ut < 0.5 && fit.quality.axis_ratio < 1.2, "{:?}", fit.quality);
}

#[test]
fn a_cap_of_the_sphere_is_too_little() {
    let mut readings = raw(&bent(), [-30.0, 12.0, 41.0], 200, 0.8);
    for (k, reading) in readings.iter_mut().enumerate() {
        *reading = [0, 1, 2].map(|c| reading[c] + noise(3 * k + c));
    }
    let verdict = fit_ellipsoid(&readings, &EllipsoidParams::default()).unwrap_err();
    assert!(
        matches!(verdict, SwingAgain::TooLittleCovered { coverage, .. } if coverage < 0.4),
        "{verdict:?}"
    );
    // Turning about one axis alone leaves the others unknown, even if many directions are seen.
    let ring: Vec<_> = (0..200)
        .map(|k| {
            let (sin, cos) = libm::sincos(0.1 * f64::from(k));
            [48.0 * cos, 48.0 * sin, 0.001 * noise(k as usize)]
        })
        .collect();
    let verdict = fit_ellipsoid(&ring, &EllipsoidParams::default()).unwrap_err();
    assert!(matches!(verdict, SwingAgain::TooLittleCovered { .. }), "{verdict:?}");
    let still = fit_ellipsoid(&[[1.0, 2.0, 3.0]; 50], &EllipsoidParams::default()).unwrap_err();
    assert!(matches!(still, SwingAgain::TooLittleCovered { .. }), "{still:?}");
}

#[test]
fn a_swing_among_steel_is_too_disturbed() {
    let mut readings = raw(&bent(), [0.0; 3], 300, -1.0);
    for (k, reading) in readings.iter_mut().enumerate() {
        *reading = [0, 1, 2].map(|c| reading[c] + 15.0 * noise(3 * k + c));
    }
    let verdict = fit_ellipsoid(&readings, &EllipsoidParams::default()).unwrap_err();
    assert!(
        matches!(verdict, SwingAgain::TooDisturbed { residual_ut } if residual_ut > 5.0),
        "{verdict:?} {verdict}"
    );
}

#[test]
fn short_and_saturated_swings_are_told_apart() {
    let readings = raw(&bent(), [0.0; 3], 20, -1.0);
    let verdict = fit_ellipsoid(&readings, &EllipsoidParams::default()).unwrap_err();
    assert_eq!(verdict, SwingAgain::TooShort { n_readings: 20, n_needed: 30 });
    let mut readings = raw(&bent(), [1_180.0, 0.0, 0.0], 200, -1.0);
    for reading in &mut readings {
        reading[0] = reading[0].min(1_200.0);
    }
    let verdict = fit_ellipsoid(&readings, &EllipsoidParams::default()).unwrap_err();
    assert!(matches!(verdict, SwingAgain::Saturated { .. }) && verdict.to_string().contains("magnets"));
    assert!(fit_ellipsoid(&[[f64::NAN; 3]; 99], &EllipsoidParams::default()).is_err());
}

proptest! {
    #[test]
    fn any_ellipsoid_near_a_sphere_is_found(
        offset in prop::array::uniform3(-900.0f64..900.0),
        diagonal in prop::array::uniform3(0.85f64..1.15),
        skew in prop::array::uniform3(-0.08f64..0.08),
    ) {
        let matrix = Matrix3::new(
            diagonal[0], skew[0], skew[1], skew[0], diagonal[1], skew[2], skew[1], skew[2], diagonal[2],
        );
        let readings = raw(&matrix, offset, 150, -0.6);
        let params = EllipsoidParams { soft_iron_sd: 10.0, ..EllipsoidParams::default() };
        let fit = fit_ellipsoid(&readings, &params).unwrap();
        prop_assert!((0..3).all(|c| (fit.offset_ut[c] - offset[c]).abs() < 1e-2), "{:?}", fit);
        prop_assert!(fit.quality.residual_ut < 1e-2);
    }

    #[test]
    fn hostile_readings_get_a_verdict(readings in prop::collection::vec(prop::array::uniform3(
        prop_oneof![Just(0.0), Just(f64::NAN), Just(1e300), -2e3f64..2e3]), 0..80)) {
        let params = EllipsoidParams { range_ut: f64::MAX, ..EllipsoidParams::default() };
        if let Ok(fit) = fit_ellipsoid(&readings, &params) {
            prop_assert!(fit.offset_ut.iter().all(|c| c.is_finite()));
        }
    }
}
