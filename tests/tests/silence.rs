//! What a silence of sensors in the middle of a walk leaves: radii that say what is not known, and a way back.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::{Arc, LazyLock};

use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::{Fix, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_tests::synthetic::{Floor, Recorded, WALK_START};

static FLOORS: LazyLock<Vec<(Floor, Arc<FloorIndex>)>> = LazyLock::new(|| {
    let floor = |seed| {
        let floor = Floor::new(seed);
        let map = floor.surveyed_map().expect("the synthetic survey gives a map");
        (floor, Arc::new(FloorIndex::new(map)))
    };
    (1..=5).map(floor).collect()
});

/// The first second that is not heard of.
const SILENT_FROM_S: f64 = 20.0;

fn after_start(time: Timestamp) -> f64 {
    time.secs_since(WALK_START)
}

/// The fixes of `name` on the walk, without the samples that `is_lost` names.
fn fixes(
    name: &str,
    index: &Arc<FloorIndex>,
    walk: &Recorded,
    is_lost: impl Fn(&Sample) -> bool,
) -> Vec<Fix> {
    let mut positioner = Positioner::new(Arc::clone(index), Recipe::named(name).unwrap(), 1);
    positioner.hint(walk.hint(Point2::new(0.8, -0.7)).unwrap()).unwrap();
    walk.samples
        .iter()
        .filter(|sample| !is_lost(sample))
        .filter_map(|sample| positioner.push(*sample))
        .collect()
}

fn error_m(walk: &Recorded, fix: &Fix) -> f64 {
    fix.position.distance_m(walk.truth(fix.time).unwrap())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn after_a_silence_of_all_sensors_the_radius_holds_where_the_walker_may_be() {
    const SILENT_S: f64 = 12.0;
    for name in ["fused", "dead-reckoning", "mass-centered", "dtw", "ibill"] {
        let (mut n_within, mut n) = (0, 0);
        for ((floor, index), seed) in FLOORS.iter().zip(1..) {
            let walk = floor.round_trip(seed);
            let is_lost = |sample: &Sample| {
                (SILENT_FROM_S..SILENT_FROM_S + SILENT_S).contains(&after_start(sample.time))
            };
            let fixes = fixes(name, index, &walk, is_lost);
            let first = fixes.iter().find(|fix| after_start(fix.time) >= SILENT_FROM_S + SILENT_S).unwrap();
            assert!(first.radius_95_m > 0.6 * SILENT_S, "{name}, {seed}: {}", first.radius_95_m);
            n += 1;
            n_within += u32::from(error_m(&walk, first) < first.radius_95_m);
        }
        assert!(n_within + 1 >= n, "{name}: {n_within} of {n} within their radius of 95 %");
    }
}

#[test]
fn fused_finds_the_walker_again_after_a_silence() {
    let mut last_m = Vec::new();
    for ((floor, index), seed) in FLOORS.iter().zip(1..) {
        let walk = floor.round_trip(seed);
        let is_lost =
            |sample: &Sample| (SILENT_FROM_S..SILENT_FROM_S + 8.0).contains(&after_start(sample.time));
        let fixes = fixes("fused", index, &walk, is_lost);
        last_m.push(median(fixes[fixes.len() - 10..].iter().map(|fix| error_m(&walk, fix)).collect()));
    }
    assert!(median(last_m.clone()) < 2.0, "{last_m:.2?}");
}

#[test]
fn a_gyroscope_silent_for_a_second_turns_nobody() {
    let (mut whole_m, mut silent_m) = (Vec::new(), Vec::new());
    // East at first, so that the level frame's y is not north by chance.
    let corners = [(2.0, 18.0), (14.5, 18.0), (15.5, 2.2), (28.0, 2.0), (27.6, 17.8)];
    let corners = corners.map(|(x_m, y_m)| Point2::new(x_m, y_m));
    for ((floor, index), seed) in FLOORS.iter().zip(1..) {
        let walk = floor.walk(seed, &corners);
        let is_lost = |sample: &Sample| {
            matches!(sample.reading, Reading::AngularRate(_))
                && (15.0..16.0).contains(&after_start(sample.time))
        };
        let mean_m =
            |fixes: Vec<Fix>| fixes.iter().map(|fix| error_m(&walk, fix)).sum::<f64>() / fixes.len() as f64;
        // Nothing but steps and turns, so that nothing mends what the silence turned.
        whole_m.push(mean_m(fixes("dead-reckoning", index, &walk, |_| false)));
        silent_m.push(mean_m(fixes("dead-reckoning", index, &walk, is_lost)));
    }
    let says = format!("whole {whole_m:.2?}, silent {silent_m:.2?}");
    assert!(silent_m.iter().zip(&whole_m).all(|(silent, whole)| *silent < whole + 1.5), "{says}");
}

#[test]
fn who_is_seen_in_mid_walk_has_walked_what_went_before() {
    let (floor, index) = &FLOORS[0];
    let walk = floor.round_trip(1);
    let mut worst_m: f64 = 0.0;
    for seen_s in [12.1, 15.3, 18.6, 21.2] {
        let seen = WALK_START + Duration::from_secs_f64(seen_s);
        let mut positioner = Positioner::new(Arc::clone(index), Recipe::named("dead-reckoning").unwrap(), 1);
        let (before, after): (Vec<Sample>, Vec<Sample>) =
            walk.samples.iter().partition(|sample| sample.time <= seen);
        for sample in before {
            positioner.push(sample);
        }
        let mut hint = walk.hint(Point2::default()).unwrap();
        hint.time = seen;
        hint.radius_m = 0.1;
        hint.point = walk.truth(seen).unwrap();
        positioner.hint(hint).unwrap();
        // The samples that still waited for late ones are of before.
        for sample in after.iter().take_while(|sample| sample.time.secs_since(seen) < 0.25) {
            positioner.push(*sample);
        }
        let fix = positioner.fix().unwrap();
        worst_m = worst_m.max(error_m(&walk, &fix));
    }
    assert!(worst_m < 0.5, "{worst_m:.2}");
}

#[test]
fn a_hint_of_another_clock_places_and_is_not_waited_for() {
    let (floor, index) = &FLOORS[0];
    let walk = floor.round_trip(1);
    let mut positioner = Positioner::new(Arc::clone(index), Recipe::fused(), 1);
    let mut hint = walk.hint(Point2::default()).unwrap();
    // Nanoseconds since 1970, where samples count since the phone was switched on.
    hint.time = Timestamp::from_nanos(1_800_000_000_000_000_000);
    positioner.hint(hint).unwrap();
    let fixes: Vec<Fix> = walk.samples.iter().filter_map(|sample| positioner.push(*sample)).collect();
    assert!(fixes.len() > 30, "{}", fixes.len());
    let last = walk.samples.last().unwrap().time;
    assert!(positioner.fix_at(last).is_ok());
    let median_m = median(fixes.iter().map(|fix| error_m(&walk, fix)).collect());
    assert!(median_m < 1.5, "{median_m:.2}");
}
