//! The heading of the device against motion capture.
//!
//! Every system hears the same samples, from the first of the log on, and is asked at every captured frame. Its error
//! is the heading part of `estimate · truth⁻¹`, so no axis of the device is chosen and an upright phone is as well
//! defined as a level one. Frames count from when every system has a heading.
//!
//! The capture's y is geographic north, a heading's zero is magnetic north: between them lies the declination of the
//! place and day by the world magnetic model, one number for all trials. Nothing is fitted to the truth.

use fieldwalk::gravity::LevelParams;
use fieldwalk::heading::{
    Compass, CompassParams, FusedHeading, FusedHeadingParams, GyroscopeHeading, HeadingEstimator,
    LevelCompass, ScalarKalmanParams, WilaHeading, heading_error_rad,
};
use fieldwalk::rotation::Quaternion;
use fieldwalk_formats::tyrex::Motion;
use rayon::prelude::*;

use super::{CapturedTrial, DATASET};
use crate::plot::{Chart, Series};
use crate::walker_evaluation::{ALL, Metric, MetricRow, MetricScores, Plot};

/// The systems, by their names in rows.
const SYSTEMS: [&str; 5] = ["compass", "level-compass", "gyroscope", "wila-kalman", "fused"];

/// Index of the system by whose error the worst trials are chosen.
const JUDGED: usize = 4;

/// Trials that are drawn.
const N_PLOTS: usize = 6;

/// Every so many frames a point is drawn: five a second.
const FRAMES_A_POINT: usize = 12;

/// Declination at Grenoble (45.188° N, 5.727° E, 200 m) on 31 May 2016 by WMM2015v2, in degrees: 1.50° east.
const DECLINATION_DEG: f64 = 1.50;

/// The errors of a trial.
struct TrialErrors {
    name: String,
    motion: Motion,
    is_disturbed: bool,
    /// Time in seconds and the systems' signed errors in degrees, clockwise positive, a captured frame each.
    frames: Vec<(f64, [f64; SYSTEMS.len()])>,
}

/// Appends the rows, and a picture of each of the worst trials.
pub fn score(trials: &[CapturedTrial], scores: &mut MetricScores) {
    let errors: Vec<TrialErrors> = trials.par_iter().map(TrialErrors::of).collect();
    for trial in errors.iter().filter(|trial| trial.frames.is_empty()) {
        scores.warnings.push(format!("{}: no frame at which every system has a heading", trial.name));
    }
    let is_known = |disturbed: bool| move |trial: &&TrialErrors| trial.is_disturbed == disturbed;
    for motion in Motion::ALL {
        for disturbed in [false, true] {
            let of_motion: Vec<_> =
                errors.iter().filter(is_known(disturbed)).filter(|trial| trial.motion == motion).collect();
            append_rows(&mut scores.rows, &subset(motion, disturbed), &of_motion);
        }
    }
    append_rows(&mut scores.rows, "undisturbed", &errors.iter().filter(is_known(false)).collect::<Vec<_>>());
    append_rows(&mut scores.rows, "disturbed", &errors.iter().filter(is_known(true)).collect::<Vec<_>>());
    append_rows(&mut scores.rows, ALL, &errors.iter().collect::<Vec<_>>());
    let mut worst: Vec<_> = errors.iter().filter(|trial| !trial.frames.is_empty()).collect();
    worst.sort_by(|a, b| b.median_deg(JUDGED).total_cmp(&a.median_deg(JUDGED)));
    scores.plots.extend(worst.into_iter().take(N_PLOTS).map(TrialErrors::plot));
}

/// The systems, none of which has heard anything.
fn systems() -> [Box<dyn HeadingEstimator>; SYSTEMS.len()] {
    let level = LevelParams::default();
    [
        Box::new(Compass::new(CompassParams::default())),
        Box::new(LevelCompass::new(level)),
        Box::new(GyroscopeHeading::new(level)),
        Box::new(WilaHeading::new(ScalarKalmanParams::default(), level)),
        Box::new(FusedHeading::new(FusedHeadingParams::default())),
    ]
}

fn subset(motion: Motion, disturbed: bool) -> String {
    let motion = match motion {
        Motion::AugmentedReality => "ar",
        Motion::Texting => "texting",
        Motion::Phoning => "phoning",
        Motion::Swinging => "swinging",
        Motion::FrontPocket => "front-pocket",
        Motion::BackPocket => "back-pocket",
        Motion::RunningInHand => "running-hand",
        Motion::RunningInPocket => "running-pocket",
    };
    if disturbed { format!("{motion}-disturbed") } else { motion.to_owned() }
}

/// A row a system; none for a subset without frames.
fn append_rows(rows: &mut Vec<MetricRow>, subset: &str, trials: &[&TrialErrors]) {
    for (k, system) in SYSTEMS.into_iter().enumerate() {
        let errors: Vec<f64> =
            trials.iter().flat_map(|trial| trial.frames.iter().map(move |frame| frame.1[k].abs())).collect();
        if errors.is_empty() {
            continue;
        }
        rows.push(MetricRow {
            dataset: DATASET,
            subset: subset.to_owned(),
            system: system.to_owned(),
            metric: Metric::HeadingErrorMedianDeg,
            n: errors.len(),
            value: median(errors),
        });
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 0 => 0.5 * (values[middle - 1] + values[middle]),
        _ => values[middle],
    }
}

impl TrialErrors {
    fn of(captured: &CapturedTrial) -> Self {
        let geographic_from_magnetic = Quaternion::from_heading(DECLINATION_DEG.to_radians());
        let mut systems = systems();
        let mut frames = Vec::with_capacity(captured.truth.poses.len());
        let mut samples = captured.samples.iter().peekable();
        for pose in &captured.truth.poses {
            while let Some(sample) = samples.next_if(|sample| sample.time <= pose.time) {
                for system in &mut systems {
                    system.push(sample);
                }
            }
            if samples.peek().is_none() {
                // The log ended: nothing is known of what follows.
                break;
            }
            let truth = Quaternion(pose.earth_from_device);
            let mut errors_deg = [f64::NAN; SYSTEMS.len()];
            for (error_deg, system) in errors_deg.iter_mut().zip(&systems) {
                if let Some(estimate) = system.earth_from_device() {
                    let estimate = geographic_from_magnetic.after(estimate);
                    *error_deg = heading_error_rad(estimate, truth).to_degrees();
                }
            }
            if errors_deg.iter().all(|error| error.is_finite()) {
                frames.push((pose.time.as_nanos() as f64 * 1e-9, errors_deg));
            }
        }
        let trial = &captured.trial;
        Self { name: trial.name.clone(), motion: trial.motion, is_disturbed: trial.is_disturbed, frames }
    }

    fn median_deg(&self, system: usize) -> f64 {
        median(self.frames.iter().map(|frame| frame.1[system].abs()).collect())
    }

    /// The signed errors over time.
    fn plot(&self) -> Plot {
        let title = format!("{}: heading error", self.name);
        let mut chart = Chart::new(title, "time (s)", "error (°, clockwise)");
        for (k, system) in SYSTEMS.into_iter().enumerate() {
            let points = self.frames.iter().step_by(FRAMES_A_POINT);
            let points = points.map(|(time_s, errors)| (*time_s, errors[k])).collect();
            let name = format!("{system}, median {:.1}°", self.median_deg(k));
            // A compass jumps: its points are not joined.
            let is_jumpy = system.ends_with("compass");
            let series = if is_jumpy { Series::dots(name, points) } else { Series::line(name, points) };
            chart = chart.with(series);
        }
        Plot { file_name: format!("heading-{}.svg", self.name), svg: chart.to_svg() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::sensor::{Reading, Sample};
    use fieldwalk::time::Timestamp;
    use fieldwalk_formats::tyrex::{Platform, Pose, Trial, Truth};

    /// Ten seconds at rest, pointing 30° east of magnetic north, under a capture that is turned by `turned_deg` more.
    fn at_rest(turned_deg: f64, disturbed: bool) -> CapturedTrial {
        let magnetic_from_device = Quaternion::from_heading(30f64.to_radians());
        let truth = Quaternion::from_heading((30.0 + DECLINATION_DEG - turned_deg).to_radians());
        let single = |v: [f64; 3]| v.map(|c| c as f32);
        let readings = [
            Reading::AngularRate([0.0; 3]),
            Reading::SpecificForce([0.0, 0.0, 9.806_65]),
            Reading::MagneticField(single(magnetic_from_device.rotate_back([0.0, 22.0, -41.0]))),
        ];
        let samples = (0..1_000).flat_map(|k| {
            let time = Timestamp::from_millis(10 * k);
            readings.map(|reading| Sample { time, reading })
        });
        let pose = |k: i64| Pose {
            time: Timestamp::from_millis(17 * k),
            earth_from_device: truth.0,
            position_m: [0.0; 3],
        };
        CapturedTrial {
            trial: Trial {
                name: "A_B_Dist_Texting".into(),
                person: "A".into(),
                phone: "B".into(),
                platform: Platform::Android,
                motion: Motion::Texting,
                is_disturbed: disturbed,
                folder: "a".into(),
                capture: "b".into(),
            },
            samples: samples.collect(),
            truth: Truth { poses: (0..1_000).map(pose).collect(), n_lost: 0 },
        }
    }

    #[test]
    fn every_system_errs_by_what_the_truth_is_turned() {
        let mut scores = MetricScores::default();
        score(&[at_rest(0.0, false), at_rest(25.0, true)], &mut scores);
        let value = |subset: &str, system: &str| {
            let row = scores.rows.iter().find(|row| row.subset == subset && row.system == system);
            row.map(|row| row.value).unwrap()
        };
        for system in SYSTEMS {
            for subset in ["texting", "undisturbed"] {
                assert!(value(subset, system) < 0.3, "{system}: {}", value(subset, system));
            }
            for subset in ["texting-disturbed", "disturbed"] {
                assert!((value(subset, system) - 25.0).abs() < 0.3, "{system}: {}", value(subset, system));
            }
            // Half of the frames at 0 and half at 25.
            assert!((0.0..25.4).contains(&value(ALL, system)));
        }
        assert_eq!(scores.rows.len(), 5 * SYSTEMS.len());
        // The log ends before the capture does: no frame counts after its end.
        assert!(scores.rows.iter().all(|row| row.n > 500 && row.n < 1_200), "{:?}", scores.rows);
        assert_eq!(scores.plots.len(), 2);
        assert!(scores.plots[0].svg.contains("fused, median 25.0°"));
    }

    #[test]
    fn a_trial_without_fields_gives_a_warning_and_no_row() {
        let mut trial = at_rest(0.0, false);
        trial.samples.retain(|sample| !matches!(sample.reading, Reading::MagneticField(_)));
        let mut scores = MetricScores::default();
        score(&[trial], &mut scores);
        assert!(scores.rows.is_empty() && scores.warnings.len() == 1);
        assert_eq!(median(Vec::new()).to_bits(), f64::NAN.to_bits());
    }
}
