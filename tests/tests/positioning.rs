//! What positioning does on a small synthetic floor: it follows, it stays where one can stand, it says what it does
//! not know.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::{Arc, LazyLock};

use fieldwalk::geometry::{Point2, Segment};
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::metrics::{ErrorSummary, ScoredFix};
use fieldwalk::positioner::{Mode, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::survey::{LeaveOneOut, SurveyParams, SurveyWalk, Waypoint, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk::time::Duration;
use fieldwalk_tests::synthetic::{FLOOR_NAME, FLOOR_ORDINAL, Floor, Recorded, WALK_START};

struct World {
    floor: Floor,
    index: Arc<FloorIndex>,
}

/// Five floors with other steel and other beacons.
static WORLDS: LazyLock<Vec<World>> = LazyLock::new(|| {
    let world = |seed| {
        let floor = Floor::new(seed);
        let map = floor.surveyed_map().expect("the synthetic survey gives a map");
        World { floor, index: Arc::new(FloorIndex::new(map)) }
    };
    (1..=5).map(world).collect()
});

/// Off the truth, for hints.
const HINT_OFF: Point2 = Point2::new(0.8, -0.7);

impl World {
    fn positioner(&self, name: &str, walk: &Recorded) -> Positioner {
        let mut positioner = Positioner::new(Arc::clone(&self.index), Recipe::named(name).unwrap(), 1);
        positioner.hint(walk.hint(HINT_OFF).unwrap()).unwrap();
        positioner
    }

    /// The fixes at every step of a walk, against the truth.
    fn scores(&self, name: &str, walk: &Recorded) -> Vec<ScoredFix> {
        let mut positioner = self.positioner(name, walk);
        let fixes = walk.samples.iter().filter_map(|sample| positioner.push(*sample));
        fixes
            .map(|fix| ScoredFix {
                error_m: fix.position.distance_m(walk.truth(fix.time).unwrap()),
                radius_68_m: fix.radius_68_m,
                radius_95_m: fix.radius_95_m,
            })
            .collect()
    }

    fn summary(&self, name: &str, walk_seed: u64) -> ErrorSummary {
        ErrorSummary::of(&self.scores(name, &self.floor.round_trip(walk_seed))).unwrap()
    }
}

#[test]
fn fused_is_closer_than_dead_reckoning() {
    let (mut fused_m, mut reckoned_m) = (Vec::new(), Vec::new());
    for (world, seed) in WORLDS.iter().zip(1..) {
        fused_m.push(world.summary("fused", seed).mean_m);
        reckoned_m.push(world.summary("dead-reckoning", seed).mean_m);
    }
    let mean = |errors_m: &[f64]| errors_m.iter().sum::<f64>() / errors_m.len() as f64;
    let says = format!("fused {fused_m:.2?}, dead reckoning {reckoned_m:.2?}");
    assert!(mean(&fused_m) < 0.7 * mean(&reckoned_m), "{says}");
    assert!(fused_m.iter().all(|&m| m < 1.5), "{says}");
}

#[test]
fn mass_centered_follows_the_walk_on_open_ground() {
    for (world, seed) in WORLDS.iter().zip(1..) {
        let walk = world.floor.round_trip(seed);
        let mut positioner = world.positioner("mass-centered", &walk);
        let (mut n_steps, mut n_closed) = (0, 0);
        for sample in &walk.samples {
            let Some(fix) = positioner.push(*sample) else { continue };
            n_steps += 1;
            // Particles stay out of closed units; their mean may graze a corner that they turn round.
            let is_in_unit = world.floor.plan().units.iter().any(|unit| {
                let is_deep = unit.polygon.edges().all(|edge| edge.distance_m(fix.position) > 1.0);
                !unit.walkable && is_deep && unit.polygon.contains(fix.position)
            });
            n_closed += u32::from(is_in_unit);
            assert!(world.floor.plan().contains(fix.position), "seed {seed}: {:?}", fix.position);
        }
        assert!(n_steps > 130, "seed {seed}: {n_steps} steps");
        assert_eq!(n_closed, 0, "seed {seed}");
        let mean_m = world.summary("mass-centered", seed).mean_m;
        assert!(mean_m < 4.0, "seed {seed}: {mean_m:.2}");
    }
}

#[test]
fn stated_radii_hold_the_truth() {
    let pooled: Vec<ScoredFix> = WORLDS
        .iter()
        .zip(1..)
        .flat_map(|(world, seed)| world.scores("fused", &world.floor.round_trip(seed)))
        .collect();
    let ErrorSummary { inside_68, inside_95, .. } = ErrorSummary::of(&pooled).unwrap();
    assert!(inside_68 > 0.5 && inside_95 > 0.85, "{inside_68:.2} {inside_95:.2}");
}

/// The last 20 ms of a walk's samples but radio, over and over for `seconds`: a walker who stands.
fn standing(walk: &Recorded, seconds: i64) -> Vec<Sample> {
    let last = walk.samples.last().unwrap().time;
    let tick: Vec<Sample> = walk
        .samples
        .iter()
        .rev()
        .filter(|sample| !matches!(sample.reading, Reading::Radio(_)))
        .take(3)
        .copied()
        .collect();
    let ticks = 1..=50 * seconds;
    ticks
        .flat_map(|k| {
            tick.iter().rev().map(move |sample| Sample {
                time: sample.time + Duration::from_millis(20 * k),
                reading: sample.reading,
            })
        })
        .filter(|sample| sample.time > last)
        .collect()
}

#[test]
fn who_stands_stays() {
    for (world, seed) in WORLDS.iter().zip(1..) {
        // RADAR knows nothing of standing, and the beacons have fallen silent; the nearest neighbour is measured anew
        // every second.
        for name in Recipe::NAMES.into_iter().filter(|name| !["radar", "nearest"].contains(name)) {
            let walk = world.floor.round_trip(seed);
            let mut positioner = world.positioner(name, &walk);
            for sample in &walk.samples {
                positioner.push(*sample);
            }
            let stopped = positioner.fix().unwrap();
            let settled = walk.samples.last().unwrap().time + Duration::from_millis(1_000);
            for sample in standing(&walk, 30) {
                let fix = positioner.push(sample);
                // A card has a round a second, with or without steps.
                let is_step = fix.is_some_and(|fix| name != "card" || fix.speed_m_s > 0.0);
                // WILA's filter of 51 taps at 50 Hz tells the last steps of the walk half a second late.
                let is_late = name == "wila" && sample.time < settled;
                assert!(!is_step || is_late, "{name}: a step in standing");
            }
            let stood = positioner.fix().unwrap();
            let moved_m = stood.position.distance_m(stopped.position);
            // A card's last round of the walk ends in standing, and so does what WILA's filter tells late.
            let most_m = match name {
                "card" => 2.0,
                "wila" => 1.0,
                _ => 0.5,
            };
            assert!(moved_m < most_m, "{name}, seed {seed}: moved {moved_m:.2} m");
            assert_eq!((stood.speed_m_s, stood.mode), (0.0, Mode::ParticleFilter), "{name}");
        }
    }
}

#[test]
fn a_silent_phone_goes_stale_and_says_so() {
    let world = &WORLDS[0];
    let walk = world.floor.round_trip(1);
    for name in Recipe::NAMES {
        let mut positioner = world.positioner(name, &walk);
        for sample in &walk.samples[..walk.samples.len() / 2] {
            positioner.push(*sample);
        }
        positioner.flush();
        let last = positioner.fix().unwrap();
        let after = |s: f64| positioner.fix_at(last.time + Duration::from_secs_f64(s)).unwrap();
        // RADAR's last round ended up to a second before the last sample.
        let fresh = after(if name == "radar" { 3.9 } else { 4.9 });
        assert_eq!(fresh.mode, Mode::ParticleFilter);
        assert_eq!(fresh.radius_68_m, last.radius_68_m);
        let (early, late) = (after(6.0), after(60.0));
        assert_eq!((early.mode, late.mode), (Mode::Stale, Mode::Stale));
        assert_eq!((early.speed_m_s, late.speed_m_s), (0.0, 0.0));
        assert_eq!(early.position, late.position);
        assert!(early.position.distance_m(last.position) < 1.0);
        assert!(last.radius_68_m < early.radius_68_m && early.radius_68_m < late.radius_68_m);
        assert!(last.radius_95_m < early.radius_95_m && early.radius_95_m < late.radius_95_m);
        assert!(late.radius_68_m > 54.0, "a minute's walk away: {}", late.radius_68_m);
    }
}

#[test]
fn radar_finds_the_walk_by_its_beacons_alone() {
    for (world, seed) in WORLDS.iter().zip(1..) {
        let walk = world.floor.round_trip(seed);
        let mut positioner = Positioner::new(Arc::clone(&world.index), Recipe::radar(), 1);
        let beacons = walk.samples.iter().filter(|sample| matches!(sample.reading, Reading::Radio(_)));
        let errors_m: Vec<f64> = beacons
            .filter_map(|sample| positioner.push(*sample))
            .map(|fix| fix.position.distance_m(walk.truth(fix.time).unwrap()))
            .collect();
        let seconds = walk.samples.last().unwrap().time.secs_since(WALK_START);
        assert!(errors_m.len() as f64 > 0.9 * seconds, "a fix a second: {}", errors_m.len());
        let mean_m = errors_m.iter().sum::<f64>() / errors_m.len() as f64;
        assert!(mean_m < 5.0, "seed {seed}: {mean_m:.2}");
    }
}

#[test]
fn radar_without_beacons_has_no_fix_and_grows_stale_when_they_fall_silent() {
    let world = &WORLDS[0];
    let walk = world.floor.round_trip(1);
    let is_radio = |sample: &&Sample| matches!(sample.reading, Reading::Radio(_));
    let mut deaf = Positioner::new(Arc::clone(&world.index), Recipe::radar(), 1);
    for sample in walk.samples.iter().filter(|sample| !is_radio(sample)) {
        assert_eq!(deaf.push(*sample), None);
    }
    assert_eq!(deaf.fix(), None);
    let mut positioner = Positioner::new(Arc::clone(&world.index), Recipe::radar(), 1);
    let half = WALK_START + Duration::from_millis(20_000);
    for sample in walk.samples.iter().filter(|sample| sample.time < half || !is_radio(sample)) {
        positioner.push(*sample);
        let silent_s = sample.time.secs_since(half);
        if silent_s > 6.0 {
            let fix = positioner.fix().unwrap();
            assert_eq!(fix.mode, Mode::Stale, "{silent_s}");
            assert!(fix.radius_68_m > 1.3 * (silent_s - 5.2), "{silent_s}: {}", fix.radius_68_m);
        }
    }
}

#[test]
fn a_hint_after_a_long_silence_is_fresh() {
    let world = &WORLDS[0];
    let walk = world.floor.round_trip(1);
    let mut positioner = world.positioner("fused", &walk);
    for sample in &walk.samples[..1_000] {
        positioner.push(*sample);
    }
    let mut hint = walk.hint(Point2::default()).unwrap();
    hint.time = walk.samples[999].time + Duration::from_millis(600_000);
    positioner.hint(hint).unwrap();
    let fix = positioner.fix_at(hint.time + Duration::from_millis(100)).unwrap();
    assert_eq!(fix.mode, Mode::Started);
    assert!(fix.position.distance_m(hint.point) < 0.3);
    assert!(fix.radius_68_m < 3.0, "{}", fix.radius_68_m);
}

#[test]
fn without_a_hint_the_walk_is_found_in_the_end() {
    let world = &WORLDS[0];
    let walk = world.floor.round_trip(1);
    let mut positioner = Positioner::new(Arc::clone(&world.index), Recipe::fused(), 1);
    let fixes: Vec<_> = walk.samples.iter().filter_map(|sample| positioner.push(*sample)).collect();
    let (first, last) = (fixes[0], fixes[fixes.len() - 1]);
    assert!(first.radius_95_m > 5.0, "nothing is known at first: {}", first.radius_95_m);
    let error_m = last.position.distance_m(walk.truth(last.time).unwrap());
    assert!(error_m < last.radius_95_m && error_m < 5.0, "{error_m:.2} of {:.2}", last.radius_95_m);
}

// What a survey's waypoints may and may not do.

fn map_of(floor: &Floor, walks: &[SurveyWalk]) -> FloorMap {
    build_floor(FLOOR_NAME, FLOOR_ORDINAL, floor.plan(), walks, &SurveyParams::default()).unwrap()
}

#[test]
fn a_waypoint_that_ends_no_line_leaves_no_trace() {
    let floor = &WORLDS[0].floor;
    let survey = floor.survey();
    let map = map_of(floor, &survey[..3]);
    let there = Point2::new(8.0, 10.0);
    let mut lone = SurveyWalk::new("one tap and no step");
    lone.push_waypoint(Waypoint { time: WALK_START, point: there });
    lone.finish();
    let mut walked = SurveyWalk::new("one tap and a walk");
    for sample in &floor.round_trip(1).samples {
        walked.push(sample);
    }
    walked.push_waypoint(Waypoint { time: WALK_START + Duration::from_millis(20_000), point: there });
    walked.finish();
    assert!(walked.steps().len() > 100);
    let mut two_taps = SurveyWalk::new("two taps and no step");
    for (ms, off_m) in [(0, 0.0), (9_000, 4.0)] {
        let time = WALK_START + Duration::from_millis(ms);
        two_taps.push_waypoint(Waypoint { time, point: there + Point2::new(off_m, 0.0) });
    }
    two_taps.finish();
    let mut walks = survey[..3].to_vec();
    walks.insert(0, lone);
    walks.insert(2, walked);
    walks.push(two_taps);
    assert_eq!(map, map_of(floor, &walks));
}

#[test]
fn a_waypoint_on_its_own_line_changes_the_map_no_more_than_the_line() {
    // One straight line with a tap in the middle: the tap's place is where the steps lead anyway, so with and without
    // it the map is nearly the same. A candidate place at the waypoint would stand out.
    let floor = &WORLDS[0].floor;
    let line = [Point2::new(2.0, 2.0), Point2::new(28.0, 2.0)];
    let recorded = floor.walk(1, &[line[0], line[0].lerp(line[1], 0.5), line[1]]);
    let whole = Recorded {
        samples: recorded.samples.clone(),
        waypoints: vec![recorded.waypoints[0], recorded.waypoints[2]],
    };
    let (with, without) =
        (map_of(floor, &[recorded.survey_walk("tap")]), map_of(floor, &[whole.survey_walk("no tap")]));
    let largest = |a: &[f32], b: &[f32]| a.iter().zip(b).fold(0.0f32, |m, (a, b)| m.max((a - b).abs()));
    let strength = largest(&with.layers.strength_ut, &without.layers.strength_ut);
    let distance = largest(&with.layers.route_distance_m, &without.layers.route_distance_m);
    assert!(strength < 2.0, "{strength} µT");
    assert!(distance < 1e-3, "{distance} m");
}

#[test]
fn a_waypoint_moved_along_its_line_stretches_that_line_alone() {
    // Two lines far from each other in one walk's survey, and a second walk: the far walk's surroundings must not
    // change by a bit when the first walk's end is moved along its own line.
    let floor = &WORLDS[0].floor;
    let (from, to) = (Point2::new(1.5, 1.5), Point2::new(8.0, 1.5));
    let far = floor.walk(2, &[Point2::new(28.5, 18.5), Point2::new(28.5, 10.0)]).survey_walk("far");
    let near = floor.walk(3, &[from, to]);
    let mut stretched = near.clone();
    stretched.waypoints[1].point = to + Point2::new(0.6, 0.0);
    let params = SurveyParams { field_reach_m: 3.0, ..SurveyParams::default() };
    let map = |near: &Recorded| {
        let walks = [far.clone(), near.survey_walk("near")];
        build_floor(FLOOR_NAME, FLOOR_ORDINAL, floor.plan(), &walks, &params).unwrap()
    };
    let (before, after) = (map(&near), map(&stretched));
    let line = Segment { a: from, b: to + Point2::new(0.6, 0.0) };
    let (mut n_near, mut n_far) = (0, 0);
    for node in 0..before.frame.len() {
        let place = before.frame.node(node % before.frame.nx, node / before.frame.nx);
        let is_changed =
            before.layers.route_distance_m[node].to_bits() != after.layers.route_distance_m[node].to_bits();
        if line.distance_m(place) > params.route_reach_m + 0.1 {
            assert!(!is_changed, "{place:?}");
            n_far += 1;
        }
        n_near += u32::from(is_changed);
    }
    assert!(n_near > 0 && n_far > 100, "{n_near} {n_far}");
}

#[test]
fn without_a_hint_no_particle_prefers_a_waypoint() {
    let world = &WORLDS[0];
    let waypoints: Vec<Point2> =
        world.floor.survey().iter().flat_map(|w| w.waypoints().to_vec()).map(|w| w.point).collect();
    // Radio tells places apart, and so would hide what this test looks for.
    let walk = world.floor.round_trip(1);
    let mut positioner = Positioner::new(Arc::clone(&world.index), Recipe::dead_reckoning(), 1);
    let mut samples = walk.samples.iter().filter(|sample| !matches!(sample.reading, Reading::Radio(_)));
    while positioner.fix().is_none() {
        positioner.push(*samples.next().unwrap());
    }
    let fix = positioner.fix().unwrap();
    assert!(fix.radius_68_m > 5.0, "{}", fix.radius_68_m);
    let snapshot = serde_json::to_value(positioner.snapshot()).unwrap();
    let axis = |name: &str| -> Vec<f64> {
        let values = snapshot["tracker"]["particles"][name].as_array().unwrap();
        values.iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let particles: Vec<Point2> =
        axis("x_m").into_iter().zip(axis("y_m")).map(|(x, y)| Point2::new(x, y)).collect();
    let is_at_waypoint = |p: Point2| waypoints.iter().any(|w| w.distance_m(p) < 1.0);
    let share = particles.iter().filter(|p| is_at_waypoint(**p)).count() as f64 / particles.len() as f64;
    // By area: the surveyed band against the discs round its corners.
    let map = world.index.map();
    let band: Vec<Point2> = (0..map.frame.len())
        .filter(|&node| map.layers.route_distance_m[node] <= 2.0)
        .map(|node| map.frame.node(node % map.frame.nx, node / map.frame.nx))
        .collect();
    let expected = band.iter().filter(|p| is_at_waypoint(**p)).count() as f64 / band.len() as f64;
    assert!(share < 1.5 * expected + 0.02, "{share:.3} of the particles, {expected:.3} of the area");
}

#[test]
fn leaving_one_walk_out_scores_every_walk_at_each_waypoint_but_the_first() {
    let world = &WORLDS[0];
    let mut walks = world.floor.survey();
    walks.truncate(6);
    let mut lone = SurveyWalk::new("one tap");
    lone.push_waypoint(Waypoint { time: WALK_START, point: Point2::new(2.0, 2.0) });
    walks.push(lone);
    let map = map_of(&world.floor, &walks);
    let survey = LeaveOneOut::new(&map, &walks, &SurveyParams::default());
    let score = |left_out: usize| survey.score(left_out, &Recipe::fused(), 1);
    for (left_out, walk) in walks[..6].iter().enumerate() {
        let scores = score(left_out);
        let places: Vec<Point2> = scores.iter().map(|(place, _)| *place).collect();
        let expected: Vec<Point2> = walk.waypoints()[1..].iter().map(|w| w.point).collect();
        assert_eq!(places, expected, "{}", walk.name());
        for (place, fix) in &scores {
            let ScoredFix { error_m, radius_68_m, radius_95_m } = *fix;
            assert!(error_m.is_finite() && error_m < 10.0, "{} at {place:?}: {fix:?}", walk.name());
            assert!(radius_68_m > 0.0 && radius_95_m >= radius_68_m && radius_95_m.is_finite());
        }
    }
    assert_eq!(score(6), [], "one tap cannot be scored");
    assert_eq!(score(7), [], "there is no such walk");
}
