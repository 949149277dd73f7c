//! Swings that others recorded.
//!
//! Needs the recordings that [`fieldwalk_tests::recordings`] finds; skipped, and said so, without them.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use fieldwalk::calibration::{CalibratorParams, MagnetometerCalibrator};
use fieldwalk::sensor::Reading;
use fieldwalk_formats::tyrex::{LogKind, Platform, SensorLogReader};
use fieldwalk_tests::recordings::tyrex_attitude;

#[test]
fn swings_of_one_phone_on_four_days_agree_with_its_system() {
    let Some(folder) = tyrex_attitude() else { return };
    let mut n_swings = 0;
    for day in 1..=4 {
        let swing = folder.join(format!("android/calib_mag_Nexus5_d{day}"));
        let mut calibrator = MagnetometerCalibrator::new(CalibratorParams::default());
        let mut system_bias_ut = [0.0; 3];
        let kind = LogKind::RawMagneticField;
        let path = swing.join(kind.file_name(Platform::Android));
        for sample in SensorLogReader::open(&path, Platform::Android, kind, 0.0).unwrap() {
            let sample = sample.unwrap();
            calibrator.push(&sample);
            if let Reading::UncalibratedMagneticField { bias_ut, .. } = sample.reading {
                system_bias_ut = bias_ut.map(f64::from);
            }
        }
        let fit = calibrator.calibration().unwrap_or_else(|verdict| panic!("day {day}: {verdict}"));
        let quality = fit.quality;
        // The Earth's field there is 47 µT; indoors it is bent.
        assert!((38.0..56.0).contains(&quality.strength_ut), "day {day}: {quality:?}");
        assert!(quality.residual_ut < 2.5 && quality.axis_ratio < 1.3, "day {day}: {quality:?}");
        assert!(quality.coverage > 0.6 && quality.offset_sd_ut < 1.0, "day {day}: {quality:?}");
        // The phone's own estimate at the end of the swing, with which it agrees to a few µT.
        for (found, system) in fit.offset_ut.into_iter().zip(system_bias_ut) {
            assert!((found - system).abs() < 10.0, "day {day}: {:?} {system_bias_ut:?}", fit.offset_ut);
        }
        n_swings += 1;
    }
    assert_eq!(n_swings, 4);
}
