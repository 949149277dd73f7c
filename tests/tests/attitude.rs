//! Attitudes on recordings by others: phones carried in known ways under motion capture.
//!
//! Needs the recordings that [`fieldwalk_tests::recordings`] finds; skipped, and said so, without them.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use fieldwalk::sensor::Reading;
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
