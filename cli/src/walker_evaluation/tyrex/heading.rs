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
