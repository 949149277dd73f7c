//! Attitudes on recordings by others: phones carried in known ways under motion capture.
//!
//! Needs the recordings that [`fieldwalk_tests::recordings`] finds; skipped, and said so, without them.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use fieldwalk::attitude::{AttitudeEstimate, AttitudeParams, EventCounts, EventTable, Pointing};
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Duration;
use fieldwalk_formats::tyrex::{Motion, Truth, find_trials};
use fieldwalk_tests::recordings::tyrex_attitude;

/// Means, over the samples that the capture covers, of what the readings are in the earth frame.
fn mean_in_earth(
    truth: &Truth,
    vectors: impl Iterator<Item = (fieldwalk::time::Timestamp, [f32; 3])>,
) -> [f64; 3] {
    let mut n = 0.0;
    let mut sum = [0.0; 3];
    for (time, vector) in vectors {
        let Some(pose) = truth.pose_at(time) else { continue };
        let earth = pose.to_earth(vector.map(f64::from));
        sum = [0, 1, 2].map(|c| sum[c] + earth[c]);
        n += 1.0;
    }
    sum.map(|c| c / n)
}

#[test]
fn the_captured_attitude_turns_the_force_up_and_the_field_north() {
    let Some(folder) = tyrex_attitude() else { return };
    let found = find_trials(&folder).unwrap();
    assert_eq!(found.foreign.len(), 0, "{:?}", found.foreign);
    let walks = found.trials.iter().filter(|trial| trial.motion != Motion::RunningInHand);
    for trial in walks {
        let (truth, samples) = (trial.truth().unwrap(), trial.samples().unwrap().samples);
        // Over two minutes of walking in loops, accelerations cancel and gravity remains.
        let forces = samples.iter().filter_map(|sample| match sample.reading {
            Reading::SpecificForce(force) => Some((sample.time, force)),
            _ => None,
        });
        let force = mean_in_earth(&truth, forces);
        assert!(force[0].abs() < 0.15 && force[1].abs() < 0.2, "{}: {force:?}", trial.name);
        assert!((force[2] - 9.81).abs() < 0.25, "{}: {force:?}", trial.name);
        if trial.is_disturbed {
            continue;
        }
        let fields = samples.iter().filter_map(|sample| match sample.reading {
            Reading::MagneticField(field) => Some((sample.time, field)),
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                Some((sample.time, [0, 1, 2].map(|c| field_ut[c] - bias_ut[c])))
            }
            _ => None,
        });
        let field = mean_in_earth(&truth, fields);
        // 47° N: about 22 µT to the north and 40 µT down; a quarter of that is iron and the phone's own calibration.
        assert!(field[1] > 14.0 && field[2] < -28.0, "{}: {field:?}", trial.name);
        assert!(field[0].abs() < 0.45 * field[1], "{}: {field:?}", trial.name);
    }
}

/// The chance that a positive scores higher than a negative, ties counting half.
fn area_under_curve(positives: &[f32], negatives: &[f32]) -> f64 {
    let wins = positives.iter().map(|p| {
        let beaten = negatives.iter().filter(|&n| n < p).count() as f64;
        beaten + 0.5 * negatives.iter().filter(|&n| n == p).count() as f64
    });
    wins.sum::<f64>() / (positives.len() as f64 * negatives.len() as f64)
}

/// What a detector with `table` says at every whole second of the capture.
fn said(samples: &[Sample], truth: &Truth, table: EventTable) -> Vec<AttitudeEstimate> {
    let attitude = AttitudeParams { table, ..AttitudeParams::default() };
    let mut pedestrian = Pedestrian::new(PedestrianParams { attitude, ..PedestrianParams::default() });
    let second = Duration::from_millis(1_000);
    let mut next = truth.poses[0].time + second;
    let last = truth.poses[truth.poses.len() - 1].time;
    let mut said = Vec::new();
    for sample in samples {
        if sample.time > next && next <= last {
            said.push(pedestrian.attitude());
            next = next + second;
        }
        pedestrian.push(sample);
    }
    said
}

/// A table of the strides of these trials of texting.
fn table_of<'a>(texting: impl Iterator<Item = &'a Vec<Sample>>) -> EventTable {
    let mut counts = EventCounts::default();
    for samples in texting {
        let mut pedestrian = Pedestrian::new(PedestrianParams::default());
        let mut last_end = None;
        for sample in samples {
            pedestrian.push(sample);
            let stride = pedestrian.last_stride().filter(|stride| Some(stride.end) != last_end);
            let Some(mut stride) = stride.copied() else { continue };
            last_end = Some(stride.end);
            for pointing in [Pointing::Forward, Pointing::Leftward, Pointing::Backward, Pointing::Rightward] {
                counts.add(stride.events(), pointing);
                stride = stride.turned_left();
            }
        }
    }
    assert!(counts.n_strides(Pointing::Forward) > 100);
    counts.table([0.25; 4])
}

#[test]
fn texting_is_told_from_the_rest_with_a_table_of_other_trials() {
    let Some(folder) = tyrex_attitude() else { return };
    let trials = find_trials(&folder).unwrap().trials;
    let read: Vec<_> = trials
        .iter()
        .map(|trial| (trial, trial.samples().unwrap().samples, trial.truth().unwrap()))
        .collect();
    let is_texting = |motion: Motion| motion == Motion::Texting;
    // By phone, so that neither the table nor its strides come from the phone that is scored.
    let (mut ufh, mut upward) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for phone in ["Nexus5", "iPhone5"] {
        let others = read.iter().filter(|(trial, ..)| trial.phone != phone && is_texting(trial.motion));
        let table = table_of(others.map(|(_, samples, _)| samples));
        for (trial, samples, truth) in read.iter().filter(|(trial, ..)| trial.phone == phone) {
            let label = usize::from(is_texting(trial.motion));
            let said = said(samples, truth, table);
            ufh[label].extend(said.iter().map(|said| said.ufh_score));
            upward[label].extend(said.iter().map(|said| said.upward_g));
        }
    }
    let (auc_ufh, auc_upward) =
        (area_under_curve(&ufh[1], &ufh[0]), area_under_curve(&upward[1], &upward[0]));
    println!("auc_ufh {auc_ufh:.4}, auc_non_upward {auc_upward:.4}, {} moments", ufh[0].len() + ufh[1].len());
    assert!(auc_ufh > 0.97, "{auc_ufh}");
    assert!(auc_upward > 0.99, "{auc_upward}");
}
