//! The application on a card whose parts are watched and broken.

mod bench;

use bench::{SharedWorld, frames, switched_on, world};
use fieldwalk_card::replay::{SensorReading, finish};
use fieldwalk_card::{MAX_DELAY_US, ROUND_US, RoundOutcome};
use fieldwalk_codec::battery_mv;

/// The wearer walks: two steps a second.
fn walking(at_s: f64) -> SensorReading {
    let force = 9.81 + 4.0 * (at_s * std::f64::consts::TAU * 2.0).sin();
    SensorReading { force_m_s2: [0.0, force as f32, 0.0], field_ut: [0.0, -42.0, -20.0] }
}

fn walk(world: &SharedWorld) {
    world.borrow_mut().reading = Box::new(walking);
}

#[test]
fn a_round_is_a_second_and_a_frame() {
    let world = world();
    walk(&world);
    let mut card = switched_on(&world);
    let reprs = frames(&world, &mut card, 200);
    let world = world.borrow();
    let times: Vec<u64> = world.sent.iter().map(|(time_us, _)| *time_us).collect();
    assert!(times.windows(2).all(|pair| (ROUND_US..=ROUND_US + MAX_DELAY_US).contains(&(pair[1] - pair[0]))));
    for (k, repr) in reprs.iter().enumerate() {
        assert_eq!((repr.header.sequence, repr.header.card_id), (k as u8, 0x0102));
        assert_eq!((repr.b_h, repr.b_v, repr.orientation), ([500; 3], [-1_050; 3], 0), "round {k}");
        assert_eq!(repr.header.flags.just_woke, k == 0);
        assert_eq!(repr.previous_b, [if k == 0 { 0 } else { 47 }; 3], "round {k}");
        assert!(!repr.header.flags.calibrated && !repr.header.flags.motion_missing);
        assert_eq!(battery_mv(repr.header.battery), Some(2_960));
    }
    // Two steps a second at 25 readings a second: extremes near 9.81 ± 4 in every round.
    assert!(reprs.iter().all(|repr| repr.acceleration_max.iter().max() >= Some(&13)));
    assert!(reprs.iter().all(|repr| repr.acceleration_min.iter().min() <= Some(&7)));
}

#[test]
fn a_card_that_lies_still_sleeps_until_it_is_moved() {
    let world = world();
    world.borrow_mut().motions_s.extend([500.0]);
    let mut card = switched_on(&world);
    assert_eq!(frames(&world, &mut card, 59).len(), 59);
    assert_eq!(finish(card.round()), RoundOutcome::Slept);
    assert_eq!(world.borrow().sent.len(), 60);
    assert!((500_000_000..500_100_000).contains(&world.borrow().now_us));
    // Asleep the watchdog is fed, at least every half minute.
    assert!(world.borrow().longest_unfed_us <= 30_000_000, "{}", world.borrow().longest_unfed_us);
    walk(&world);
    let reprs = frames(&world, &mut card, 3);
    let numbers: Vec<_> = reprs.iter().map(|repr| repr.header.sequence).collect();
    // Half of all numbers away from 60, so that no receiver takes it to continue.
    assert_eq!(numbers, [188, 189, 190]);
    assert_eq!(
        reprs.iter().map(|repr| repr.header.flags.just_woke).collect::<Vec<_>>(),
        [true, false, false]
    );
    assert_eq!(reprs[0].previous_b, [0; 3], "the field before the sleep is forgotten");
}

#[test]
fn a_walk_keeps_the_card_awake() {
    let world = world();
    walk(&world);
    let mut card = switched_on(&world);
    assert_eq!(frames(&world, &mut card, 400).len(), 400);
}

#[test]
fn a_broken_sensor_is_restarted_told_of_and_at_last_left_to_the_watchdog() {
    let world = world();
    walk(&world);
    let mut card = switched_on(&world);
    frames(&world, &mut card, 5);
    world.borrow_mut().is_sensor_broken = true;
    let reprs = frames(&world, &mut card, 10);
    assert!(reprs.iter().all(|repr| repr.header.flags.motion_missing && repr.b_h == [u16::MAX; 3]));
    assert_eq!(world.borrow().n_starts, 11, "once at the start, once a round");
    world.borrow_mut().is_sensor_broken = false;
    let reprs = frames(&world, &mut card, 3);
    assert!(reprs[1..].iter().all(|repr| !repr.header.flags.motion_missing));
    world.borrow_mut().is_sensor_broken = true;
    frames(&world, &mut card, 60);
    let unfed_us = world.borrow().now_us - world.borrow().fed_us;
    assert!(unfed_us > 30_000_000, "the watchdog is left hungry: {unfed_us} µs");
}

#[test]
fn an_empty_battery_is_told_and_then_silences_the_card() {
    let world = world();
    walk(&world);
    let mut card = switched_on(&world);
    frames(&world, &mut card, 60);
    world.borrow_mut().voltage_mv = 2_300;
    let low = frames(&world, &mut card, 1)[0].header;
    assert!(low.flags.low_battery && battery_mv(low.battery) == Some(2_300));
    frames(&world, &mut card, 59);
    world.borrow_mut().voltage_mv = 1_950;
    let before_us = world.borrow().now_us;
    assert_eq!(finish(card.round()), RoundOutcome::Silent);
    assert!(world.borrow().now_us - before_us > 599_000_000);
    assert!(world.borrow().longest_unfed_us <= 31_000_000);
    assert_eq!(finish(card.round()), RoundOutcome::Silent);
    world.borrow_mut().voltage_mv = 2_700;
    let recovered = frames(&world, &mut card, 1)[0].header;
    assert!(recovered.flags.just_woke && !recovered.flags.low_battery);
}

#[test]
fn numbers_go_on_over_a_reset() {
    let world = world();
    walk(&world);
    frames(&world, &mut switched_on(&world), 40);
    let after = frames(&world, &mut switched_on(&world), 2);
    assert_eq!((after[0].header.sequence, after[1].header.sequence), (168, 169));
    assert!(after[0].header.flags.just_woke);
    // A change of battery forgets.
    world.borrow_mut().retained = 0;
    assert_eq!(frames(&world, &mut switched_on(&world), 1)[0].header.sequence, 0);
}

/// The card is turned about every axis for some time after the tenth second, and is worn before and after; 25, −60 and
/// 8 µT of hard iron move with it.
fn swung(at_s: f64) -> SensorReading {
    let since_s = at_s - 5.0;
    let upright = !(10.0..42.0).contains(&since_s);
    let (roll, pitch) = if upright { (0.0, 0.0) } else { (1.3 * (since_s - 10.0), 0.55 * (since_s - 10.0)) };
    let rotate = |[x, y, z]: [f64; 3]| {
        let (x, y) = (x * f64::cos(roll) - y * f64::sin(roll), x * f64::sin(roll) + y * f64::cos(roll));
        let (y, z) = (y * f64::cos(pitch) - z * f64::sin(pitch), y * f64::sin(pitch) + z * f64::cos(pitch));
        [x, y, z]
    };
    let field = rotate([0.0, -42.0, -20.0]);
    let iron = [25.0, -60.0, 8.0];
    SensorReading {
        force_m_s2: rotate([0.0, 9.81, 0.0]).map(|c| c as f32),
        field_ut: [0, 1, 2].map(|c| (field[c] + iron[c]) as f32),
    }
}

#[test]
fn a_swing_calibrates_the_card_for_ever() {
    let world = world();
    world.borrow_mut().reading = Box::new(swung);
    let mut card = switched_on(&world);
    let reprs = frames(&world, &mut card, 58);
    assert!(!reprs[9].header.flags.calibrated && reprs[55].header.flags.calibrated);
    assert!((f32::from(reprs[5].b_h[0]) / 25.0 - 20.0).abs() > 5.0, "iron shows before");
    let is_right = |b_h: u16, b_v: i16| {
        (f32::from(b_h) / 25.0 - 20.0).abs() < 0.5 && (f32::from(b_v) / 25.0 + 42.0).abs() < 0.5
    };
    assert!(is_right(reprs[57].b_h[1], reprs[57].b_v[1]), "{:?}", reprs[57]);
    let found = *card.calibration().unwrap();
    drop(card);
    let mut card = switched_on(&world);
    assert_eq!(card.calibration(), Some(&found));
    assert!(frames(&world, &mut card, 1)[0].header.flags.calibrated);
}

#[test]
fn power_that_fails_while_a_calibration_is_written_leaves_the_one_before() {
    let world = world();
    world.borrow_mut().reading = Box::new(swung);
    let mut card = switched_on(&world);
    frames(&world, &mut card, 50);
    let first = *card.calibration().unwrap();
    drop(card);
    for n_written in [0, 1, 4, 31, 63] {
        // Another swing, with other iron, whose record is cut short.
        let start_s = world.borrow().now_us as f64 * 1e-6;
        world.borrow_mut().reading = Box::new(move |at_s| {
            let reading = swung(at_s - start_s + 5.0);
            SensorReading { field_ut: reading.field_ut.map(|c| c + 10.0), ..reading }
        });
        world.borrow_mut().writable = n_written;
        let mut card = switched_on(&world);
        frames(&world, &mut card, 55);
        assert_ne!(card.calibration(), Some(&first), "until the reset the new one holds");
        drop(card);
        assert_eq!(world.borrow().writable, 0);
        assert_eq!(switched_on(&world).calibration(), Some(&first), "{n_written} bytes");
    }
    world.borrow_mut().flash.fill(0);
    assert_eq!(switched_on(&world).calibration(), None);
}
