//! Carry modes and attitudes of simulated walkers, of whom the detector knows nothing.

#![expect(clippy::unwrap_used, reason = "test code outside test functions")]

use fieldwalk::attitude::{Attitude, AttitudeEstimate, CarryMode as Detected};
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk::time::Duration;
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_sim::scenario::{ORIGIN, Scenario};

/// What is said twice a second of three walks with the phone carried in `mode`, from the eighth second on.
fn said(mode: CarryMode) -> Vec<AttitudeEstimate> {
    let scenario = Scenario::named("office", 3).unwrap();
    let mut said = Vec::new();
    for mut walk in scenario.test_walks(3, 50.0) {
        walk.carrying = vec![(0.0, mode)];
        let mut pedestrian = Pedestrian::new(PedestrianParams::default());
        let mut next = ORIGIN + Duration::from_millis(8_000);
        for sample in scenario.simulate(&walk).samples {
            pedestrian.push(&sample);
            if sample.time >= next {
                said.push(pedestrian.attitude());
                next = next + Duration::from_millis(500);
            }
        }
    }
    said
}

fn share_percent(said: &[AttitudeEstimate], is_right: impl Fn(&AttitudeEstimate) -> bool) -> f64 {
    100.0 * said.iter().filter(|said| is_right(said)).count() as f64 / said.len() as f64
}

#[test]
fn simulated_phones_are_found_where_they_are() {
    for (mode, detected, least_percent) in [
        (CarryMode::HeldLevel, Detected::HeldUp, 95.0),
        (CarryMode::AtEar, Detected::Calling, 80.0),
        (CarryMode::SwingingHand, Detected::Swinging, 80.0),
        (CarryMode::FrontPocket, Detected::FrontPocket, 50.0),
        // One of the three walkers swings his seat like others their thigh.
        (CarryMode::BackPocket, Detected::BackPocket, 55.0),
        (CarryMode::OnTable, Detected::OnTable, 95.0),
    ] {
        let said = said(mode);
        let right_percent = share_percent(&said, |said| said.carry_mode == detected);
        let upward_percent = share_percent(&said, |said| said.attitude.is_upward());
        println!("{mode:?}: {right_percent:.0} % {detected:?}, {upward_percent:.0} % upward");
        assert!(right_percent >= least_percent, "{mode:?}: {right_percent} % {detected:?}");
    }
}

#[test]
fn only_a_phone_held_level_and_ahead_may_use_the_direction_of_the_field() {
    let allowed_percent = |mode| {
        let percent = share_percent(&said(mode), |said| said.attitude == Attitude::UpwardForwardHorizontal);
        println!("{mode:?}: {percent:.0} % UFH");
        percent
    };
    // One of the three walkers hardly sways: his strides look like those of a phone with its top edge to the right.
    assert!(allowed_percent(CarryMode::HeldLevel) > 60.0);
    for mode in [CarryMode::AtEar, CarryMode::SwingingHand, CarryMode::FrontPocket] {
        assert!(allowed_percent(mode) < 2.0, "{mode:?}");
    }
    assert!(allowed_percent(CarryMode::HeldLandscape) < 20.0);
}
