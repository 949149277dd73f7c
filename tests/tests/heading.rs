//! Headings on recordings by others: phones carried in known ways under motion capture.
//!
//! Needs the recordings that [`fieldwalk_tests::recordings`] finds; skipped, and said so, without them.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use fieldwalk::heading::{
    Compass, CompassParams, FusedHeading, FusedHeadingParams, HeadingEstimator, heading_error_rad,
};
use fieldwalk::rotation::Quaternion;
use fieldwalk_formats::tyrex::{Trial, find_trials};
use fieldwalk_tests::recordings::tyrex_attitude;

/// Declination at the place and day by the world magnetic model of 2015, in degrees.
const DECLINATION_DEG: f64 = 1.5;

fn errors_deg(trial: &Trial, estimator: &mut impl HeadingEstimator) -> Vec<f64> {
    let (samples, truth) = (trial.samples().unwrap().samples, trial.truth().unwrap());
    let geographic_from_magnetic = Quaternion::from_heading(DECLINATION_DEG.to_radians());
    let mut samples = samples.iter().peekable();
    let mut errors = Vec::new();
    for pose in &truth.poses {
        while let Some(sample) = samples.next_if(|sample| sample.time <= pose.time) {
            estimator.push(sample);
        }
        if let Some(estimate) = estimator.earth_from_device() {
            let truth = Quaternion(pose.earth_from_device);
            errors
                .push(heading_error_rad(geographic_from_magnetic.after(estimate), truth).to_degrees().abs());
        }
    }
    errors
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn magnets_mislead_the_fused_heading_far_less_than_the_compass() {
    let Some(folder) = tyrex_attitude() else { return };
    let (mut compass, mut fused) = (Vec::new(), Vec::new());
    for trial in find_trials(&folder).unwrap().trials.iter().filter(|trial| trial.is_disturbed) {
        compass.extend(errors_deg(trial, &mut Compass::new(CompassParams::default())));
        fused.extend(errors_deg(trial, &mut FusedHeading::new(FusedHeadingParams::default())));
    }
    let (compass_deg, fused_deg) = (median(&mut compass), median(&mut fused));
    assert!(fused_deg < 0.7 * compass_deg, "fused {fused_deg:.1}°, compass {compass_deg:.1}°");
}

#[test]
fn without_magnets_the_fused_heading_is_good_in_every_motion() {
    let Some(folder) = tyrex_attitude() else { return };
    for trial in find_trials(&folder).unwrap().trials.iter().filter(|trial| !trial.is_disturbed) {
        let mut fused = FusedHeading::new(FusedHeadingParams::default());
        let median_deg = median(&mut errors_deg(trial, &mut fused));
        assert!(median_deg < 10.0, "{}: {median_deg:.1}°", trial.name);
        let bias = fused.bias_rad_s();
        assert!(bias.iter().all(|b| b.abs() < 0.2), "{}: {bias:?}", trial.name);
    }
}
