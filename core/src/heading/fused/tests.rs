//! What the fused heading withstands.

use super::super::simulated::Simulated;
use super::*;
use crate::sensor::{RadioSighting, TransmitterId};
use crate::time::Duration;

/// Walking about: turns this way and that, and sways.
fn wandering(t: f64) -> [f64; 3] {
    [0.4 * libm::sin(5.0 * t), 0.3 * libm::sin(3.1 * t), 0.9 * libm::sin(0.4 * t)]
}

fn settled(mut device: Simulated, seconds: f64) -> (Simulated, FusedHeading) {
    let mut fused = FusedHeading::new(FusedHeadingParams::default());
    device.turn(&mut fused, seconds, wandering);
    (device, fused)
}

#[test]
fn a_calm_field_gives_the_heading_at_once() {
    let (device, fused) = settled(Simulated::new(Quaternion::from_heading(2.0)), 1.5);
    assert!(device.error_deg(&fused).abs() < 1.5, "{}", device.error_deg(&fused));
}

#[test]
fn the_bias_of_the_gyroscope_is_learnt_while_walking() {
    let device =
        Simulated { gyroscope_bias_rad_s: [0.05, -0.02, 0.03], ..Simulated::new(Quaternion::IDENTITY) };
    let (device, fused) = settled(device, 60.0);
    assert!(device.error_deg(&fused).abs() < 3.0, "{}", device.error_deg(&fused));
    for (learnt, truth) in fused.bias_rad_s().into_iter().zip([0.05, -0.02, 0.03]) {
        assert!((learnt - truth).abs() < 0.005, "{:?}", fused.bias_rad_s());
    }
}

#[test]
fn rest_shows_the_bias_within_seconds() {
    let mut device =
        Simulated { gyroscope_bias_rad_s: [0.01, 0.02, -0.03], ..Simulated::new(Quaternion::IDENTITY) };
    let mut fused = FusedHeading::new(FusedHeadingParams::default());
    device.turn(&mut fused, 4.0, |_| [0.0; 3]);
    for (learnt, truth) in fused.bias_rad_s().into_iter().zip([0.01, 0.02, -0.03]) {
        assert!((learnt - truth).abs() < 0.001, "{:?}", fused.bias_rad_s());
    }
}

#[test]
fn a_magnet_passes_without_harm() {
    let (mut device, mut fused) = settled(Simulated::new(Quaternion::IDENTITY), 20.0);
    device.field_ut = [80.0, 10.0, -20.0];
    device.turn(&mut fused, 10.0, wandering);
    assert!(device.error_deg(&fused).abs() < 5.0, "{}", device.error_deg(&fused));
    // A compass would be 83° off.
    device.field_ut = [0.0, 22.0, -40.0];
    device.turn(&mut fused, 20.0, wandering);
    assert!(device.error_deg(&fused).abs() < 3.0, "{}", device.error_deg(&fused));
}

#[test]
fn a_start_beside_a_magnet_is_overcome() {
    let device = Simulated { field_ut: [120.0, 60.0, 10.0], ..Simulated::new(Quaternion::IDENTITY) };
    let (mut device, mut fused) = settled(device, 3.0);
    assert!(device.error_deg(&fused).abs() > 45.0);
    device.field_ut = [0.0, 22.0, -40.0];
    device.turn(&mut fused, 60.0, wandering);
    assert!(device.error_deg(&fused).abs() < 5.0, "{}", device.error_deg(&fused));
}

#[test]
fn hard_iron_that_the_system_missed_is_learnt_by_turning() {
    let device = Simulated {
        hard_iron_ut: [112.0, -41.0, 30.0],
        system_iron_ut: [100.0, -35.0, 30.0],
        ..Simulated::new(Quaternion::IDENTITY)
    };
    let (device, fused) = settled(device, 120.0);
    assert!(device.error_deg(&fused).abs() < 6.0, "{}", device.error_deg(&fused));
    let iron = fused.hard_iron_ut();
    assert!((iron[0] - 112.0).abs() < 4.0 && (iron[1] + 41.0).abs() < 4.0, "{iron:?}");
}

#[test]
fn a_recalibration_by_the_system_moves_nothing_suddenly() {
    let (mut device, mut fused) = settled(Simulated::new(Quaternion::IDENTITY), 30.0);
    let before_deg = device.error_deg(&fused);
    // The raw stream stays; the system changes its mind by more than the horizontal field.
    device.system_iron_ut = [25.0, -20.0, 10.0];
    device.turn(&mut fused, 2.0, wandering);
    assert!((device.error_deg(&fused) - before_deg).abs() < 3.0, "{}", device.error_deg(&fused));
}

#[test]
fn a_silent_gyroscope_leaves_a_compass() {
    let (mut device, mut fused) = settled(Simulated::new(Quaternion::IDENTITY), 10.0);
    // The device turns by a quarter while no sensor is heard, then lies still with no gyroscope.
    device.earth_from_device = Quaternion::from_heading(1.57).after(device.earth_from_device);
    let q = device.earth_from_device;
    let single = |v: [f64; 3]| v.map(|c| c as f32);
    for _ in 0..2_000 {
        device.now = device.now + Duration::from_nanos(10_000_000);
        let force = Reading::SpecificForce(single(q.rotate_back([0.0, 0.0, 9.806_65])));
        let field = Reading::UncalibratedMagneticField {
            field_ut: single(q.rotate_back(device.field_ut)),
            bias_ut: [0.0; 3],
        };
        for reading in [force, field] {
            fused.push(&Sample { time: device.now, reading });
        }
    }
    assert!(device.error_deg(&fused).abs() < 5.0, "{}", device.error_deg(&fused));
}

#[test]
fn nonsense_and_time_that_goes_backwards_do_no_harm() {
    let (mut device, mut fused) = settled(Simulated::new(Quaternion::IDENTITY), 20.0);
    let mut push = |time: Timestamp, reading: Reading| fused.push(&Sample { time, reading });
    push(device.now, Reading::AngularRate([f32::NAN; 3]));
    push(device.now, Reading::SpecificForce([f32::INFINITY; 3]));
    push(device.now, Reading::MagneticField([1e9; 3]));
    push(Timestamp::MIN, Reading::AngularRate([9.0; 3]));
    push(Timestamp::MIN, Reading::SpecificForce([0.0; 3]));
    push(Timestamp::from_millis(1), Reading::SpecificForce([0.0; 3]));
    let sighting = RadioSighting { transmitter: TransmitterId::WifiBssid([0; 6]), rssi_dbm: -60.0 };
    push(device.now, Reading::Radio(sighting));
    device.turn(&mut fused, 5.0, wandering);
    assert!(device.error_deg(&fused).abs() < 5.0, "{}", device.error_deg(&fused));
    assert!(fused.heading_sd_rad().unwrap().is_finite());
}

#[test]
fn the_stated_deviation_shrinks_and_grows_again_without_a_gyroscope() {
    let (device, mut fused) = settled(Simulated::new(Quaternion::IDENTITY), 30.0);
    let settled_rad = fused.heading_sd_rad().unwrap();
    assert!(settled_rad < 0.2, "{settled_rad}");
    let force =
        Reading::SpecificForce(device.earth_from_device.rotate_back([0.0, 0.0, 9.8]).map(|c| c as f32));
    for k in 1..300 {
        let time = device.now + Duration::from_nanos(k * 10_000_000);
        fused.push(&Sample { time, reading: force });
    }
    assert!(fused.heading_sd_rad().unwrap() > 1.0, "{:?}", fused.heading_sd_rad());
}
