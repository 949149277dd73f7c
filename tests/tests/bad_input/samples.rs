//! Samples that lie, repeat, come late, or do not come at all.

use fieldwalk::Rejections;
use fieldwalk::front_end::FrontEndRule;
use fieldwalk::positioner::{Mode, PositionError};
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_tests::synthetic::WALK_START;

use crate::{
    N_SAMPLES, WORLD, fixes, followers, fresh, hint, is_field, most_error_m, n_fixes, no_rejections, placed,
    recipes, samples,
};

#[test]
fn broken_readings_are_counted_and_change_nothing_else() {
    let broken = |k: usize| {
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30][k % 4];
        let transmitter = TransmitterId::WifiBssid([1; 6]);
        match k % 6 {
            0 => Reading::SpecificForce([0.0, bad, 9.8]),
            1 => Reading::AngularRate([bad, 0.0, 0.0]),
            2 => Reading::MagneticField([20.0, 0.0, bad]),
            3 => Reading::UncalibratedMagneticField { field_ut: [20.0; 3], bias_ut: [bad, 0.0, 0.0] },
            4 => Reading::Pressure { pressure_hpa: bad },
            _ => Reading::Radio(RadioSighting { transmitter, rssi_dbm: bad }),
        }
    };
    for recipe in recipes() {
        let clean = fixes(&mut placed(&recipe), samples().iter().copied());
        let mut positioner = placed(&recipe);
        let with_broken = samples().iter().enumerate().flat_map(|(k, sample)| {
            let broken = (k % 10 == 0).then(|| Sample { time: sample.time, reading: broken(k / 10) });
            broken.into_iter().chain([*sample])
        });
        assert_eq!(fixes(&mut positioner, with_broken), clean, "{}", recipe.name);
        let expected = Rejections { implausible: N_SAMPLES as u64 / 10, ..no_rejections() };
        assert_eq!(positioner.rejections(), expected);
    }
}

#[test]
fn duplicated_lines_are_counted_and_change_nothing_else() {
    for recipe in recipes() {
        let clean = fixes(&mut placed(&recipe), samples().iter().copied());
        let mut positioner = placed(&recipe);
        let twice = samples().iter().flat_map(|sample| [*sample, *sample]);
        assert_eq!(fixes(&mut positioner, twice), clean, "{}", recipe.name);
        assert_eq!(
            positioner.rejections(),
            Rejections { duplicate: N_SAMPLES as u64, ..no_rejections() },
            "{}",
            recipe.name
        );
    }
}

#[test]
fn time_that_runs_backwards_is_counted_and_changes_nothing_else() {
    for recipe in recipes() {
        let clean = fixes(&mut placed(&recipe), samples().iter().copied());
        let mut positioner = placed(&recipe);
        // Every hundredth sample comes once more, later by a second: after its place has been passed.
        let replayed = samples().iter().enumerate().flat_map(|(k, sample)| {
            let late = k.checked_sub(200).filter(|k| k % 100 == 0).map(|k| samples()[k]);
            late.into_iter().chain([*sample])
        });
        assert_eq!(fixes(&mut positioner, replayed), clean, "{}", recipe.name);
        assert_eq!(positioner.rejections(), Rejections { late: 38, ..no_rejections() });
    }
}

#[test]
fn one_stamp_far_ahead_is_counted_and_changes_nothing_else() {
    for recipe in recipes() {
        let clean = fixes(&mut placed(&recipe), samples().iter().copied());
        let mut positioner = placed(&recipe);
        let day = Duration::from_millis(86_400_000);
        let with_jumps = samples().iter().enumerate().flat_map(|(k, sample)| {
            let ahead = (k > 0 && k % 500 == 0)
                .then_some(Sample { time: sample.time + day, reading: sample.reading });
            ahead.into_iter().chain([*sample])
        });
        assert_eq!(fixes(&mut positioner, with_jumps), clean, "{}", recipe.name);
        assert_eq!(positioner.rejections(), Rejections { jumped: 7, ..no_rejections() });
    }
}

#[test]
fn a_clock_that_jumps_ahead_is_followed_after_a_few_witnesses_and_none_is_lost() {
    for recipe in recipes() {
        let mut positioner = placed(&recipe);
        let day = Duration::from_millis(86_400_000);
        let jumping = samples().iter().enumerate().map(|(k, sample)| {
            let time = if k < N_SAMPLES / 2 { sample.time } else { sample.time + day };
            Sample { time, reading: sample.reading }
        });
        let fixes = fixes(&mut positioner, jumping);
        assert_eq!(positioner.rejections(), no_rejections());
        let n_after = fixes.iter().filter(|fix| fix.time > WALK_START + day).count();
        assert!(n_after > n_fixes(&recipe, 15), "{}: {n_after} fixes after the jump", recipe.name);
        let last = fixes.last().unwrap();
        let truth = WORLD.walk.truth(last.time - day).unwrap();
        let error_m = last.position.distance_m(truth);
        // Whether the clock was set or the phone was silent for a day cannot be told: the walker may be anywhere.
        let most_m = most_error_m(&recipe).max(last.radius_95_m);
        assert!(error_m < most_m, "{}: {error_m:.1} m of {most_m:.1} m", recipe.name);
    }
}

#[test]
fn a_clock_that_was_set_back_is_followed_after_a_few_witnesses_and_none_is_lost() {
    for recipe in recipes() {
        let mut positioner = placed(&recipe);
        let hour = Duration::from_millis(3_600_000);
        let (before, after) = samples().split_at(N_SAMPLES / 2);
        assert!(fixes(&mut positioner, before.iter().copied()).len() > 10);
        let set_back = after.iter().map(|s| Sample { time: s.time - hour, reading: s.reading });
        let fixes = fixes(&mut positioner, set_back);
        assert_eq!(positioner.rejections(), no_rejections());
        assert!(fixes.len() > n_fixes(&recipe, 15), "{}: {} fixes", recipe.name, fixes.len());
        let last = fixes.last().unwrap();
        assert_eq!(last.mode, Mode::ParticleFilter);
        let error_m = last.position.distance_m(WORLD.walk.truth(last.time + hour).unwrap());
        assert!(error_m < most_error_m(&recipe), "{}: {error_m:.1} m", recipe.name);
    }
}

fn without(sensor: fn(&Reading) -> bool) -> impl Iterator<Item = Sample> {
    samples().iter().copied().filter(move |sample| !sensor(&sample.reading))
}

#[test]
fn without_a_gyroscope_the_compass_leads() {
    for recipe in recipes() {
        let mut positioner = placed(&recipe);
        let fixes = fixes(&mut positioner, without(|reading| matches!(reading, Reading::AngularRate(_))));
        assert!(fixes.len() > n_fixes(&recipe, 35), "{}: {}", recipe.name, fixes.len());
        let last = fixes.last().unwrap();
        let error_m = last.position.distance_m(WORLD.walk.truth(last.time).unwrap());
        assert!(error_m < most_error_m(&recipe), "{}: {error_m:.1} m", recipe.name);
    }
}

#[test]
fn without_a_magnetometer_the_direction_is_unknown_and_the_radius_says_so() {
    for recipe in [Recipe::dead_reckoning(), Recipe::fused()] {
        let fixes = fixes(&mut placed(&recipe), without(is_field));
        assert!(fixes.len() > n_fixes(&recipe, 35), "{}: {}", recipe.name, fixes.len());
        let tenth = fixes[9];
        assert!(tenth.radius_95_m > 3.0, "{}: {:.1}", recipe.name, tenth.radius_95_m);
        let error_m = tenth.position.distance_m(WORLD.walk.truth(tenth.time).unwrap());
        assert!(error_m < tenth.radius_95_m + 2.0, "{}: {error_m:.1} m", recipe.name);
    }
    // This one has no other direction: it must go on all the same.
    assert!(fixes(&mut placed(&Recipe::mass_centered()), without(is_field)).len() > 35);
}

#[test]
fn without_an_accelerometer_nobody_steps() {
    for recipe in followers() {
        let mut positioner = placed(&recipe);
        let start = positioner.fix().unwrap();
        let fixes = fixes(&mut positioner, without(|reading| matches!(reading, Reading::SpecificForce(_))));
        assert_eq!(fixes, [], "{}", recipe.name);
        let fix = positioner.fix().unwrap();
        assert_eq!((fix.position, fix.mode), (start.position, Mode::Started), "{}", recipe.name);
    }
}

#[test]
fn without_any_sensor_only_the_hint_is_known() {
    for recipe in recipes() {
        assert_eq!(fresh(&recipe).fix(), None);
        assert_eq!(fresh(&recipe).fix_at(WALK_START), Err(PositionError::NoFix));
        let mut positioner = placed(&recipe);
        positioner.flush();
        let fix = positioner.fix().unwrap();
        assert_eq!((fix.time, fix.mode), (hint().time, Mode::Started));
        assert!(fix.position.distance_m(hint().point) < hint().radius_m, "{fix:?}");
        let later = positioner.fix_at(hint().time + Duration::from_millis(65_000)).unwrap();
        assert_eq!(later.mode, Mode::Stale);
        assert!(later.radius_68_m > 50.0);
        assert_eq!(positioner.rejections(), no_rejections());
    }
}

#[test]
fn readings_without_a_start_give_no_fix_until_a_step() {
    // A card's first round is a start, whether it holds a step or not, and so is a second of standing where that counts.
    let tells_of_standing = [FrontEndRule::Card, FrontEndRule::StandingPhone];
    for recipe in followers().filter(|recipe| !tells_of_standing.contains(&recipe.front_end)) {
        let mut positioner = fresh(&recipe);
        // The walker stands for a second and a half first.
        let standing = samples().iter().take_while(|s| s.time < WALK_START + Duration::from_millis(1_300));
        assert_eq!(fixes(&mut positioner, standing.copied()), []);
        assert_eq!(positioner.fix(), None);
        assert_eq!(positioner.fix_at(Timestamp::MAX), Err(PositionError::NoFix));
    }
}
