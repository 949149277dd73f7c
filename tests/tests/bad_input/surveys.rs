//! Surveys that give no map, and waypoints that nobody stood at.

use fieldwalk::Rejections;
use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorMap;
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::survey::{SurveyError, SurveyParams, SurveyWalk, Waypoint, build_floor};
use fieldwalk::time::Duration;
use fieldwalk_tests::synthetic::{FLOOR_NAME, FLOOR_ORDINAL};

use crate::{N_SAMPLES, WORLD, is_field, no_rejections, samples};

fn survey(plan: &FloorPlan, walks: &[SurveyWalk]) -> Result<FloorMap, SurveyError> {
    build_floor(FLOOR_NAME, FLOOR_ORDINAL, plan, walks, &SurveyParams::default())
}

fn walk_of(samples: impl IntoIterator<Item = Sample>, waypoints: &[Waypoint]) -> SurveyWalk {
    let mut walk = SurveyWalk::new("walk");
    samples.into_iter().for_each(|sample| walk.push(&sample));
    waypoints.iter().for_each(|waypoint| walk.push_waypoint(*waypoint));
    walk.finish();
    walk
}

#[test]
fn a_survey_without_lines_says_what_to_do() {
    let plan = WORLD.floor.plan();
    let waypoints = &WORLD.walk.waypoints;
    assert_eq!(survey(plan, &[]), Err(SurveyError::NoTrack { n_walks: 0 }));
    let no_waypoint = walk_of(samples().iter().copied(), &[]);
    let one_waypoint = walk_of(samples().iter().copied(), &waypoints[..1]);
    let no_step = walk_of([], waypoints);
    let walks = [no_waypoint, one_waypoint, no_step];
    let error = survey(plan, &walks).unwrap_err();
    assert_eq!(error, SurveyError::NoTrack { n_walks: 3 });
    assert!(error.to_string().contains("tap a waypoint at the start and end of every line"), "{error}");
}

#[test]
fn a_survey_without_a_magnetometer_says_so() {
    let samples = WORLD.walk.samples.iter().copied().filter(|sample| !is_field(&sample.reading));
    let walk = walk_of(samples, &WORLD.walk.waypoints);
    assert!(walk.steps().len() > 100);
    assert_eq!(survey(WORLD.floor.plan(), &[walk]), Err(SurveyError::NoField));
}

#[test]
fn a_plan_without_an_extent_is_refused() {
    let walk = WORLD.walk.survey_walk("walk");
    for (width_m, height_m) in
        [(0.0, 20.0), (30.0, 0.0), (-30.0, 20.0), (f64::NAN, 20.0), (30.0, f64::INFINITY), (10_001.0, 20.0)]
    {
        let plan = FloorPlan { width_m, height_m, ..WORLD.floor.plan().clone() };
        assert_eq!(
            survey(&plan, std::slice::from_ref(&walk)),
            Err(SurveyError::BadPlan),
            "{width_m} {height_m}"
        );
    }
}

#[test]
fn a_map_that_would_fill_the_memory_is_refused() {
    let walks = WORLD.floor.survey();
    let of_size = |width_m: f64, height_m: f64, cell_m: f64| {
        let plan = FloorPlan { width_m, height_m, ..WORLD.floor.plan().clone() };
        build_floor("F1", 0, &plan, &walks, &SurveyParams { cell_m, ..SurveyParams::default() })
    };
    // At half a metre, 10 km by 10 km are 400 million nodes; at 50 m they are 40 thousand.
    let error = of_size(10_000.0, 10_000.0, 0.5).unwrap_err();
    assert_eq!(error, SurveyError::TooManyNodes { width_m: 10_000, height_m: 10_000 });
    let said = error.to_string();
    assert!(said.contains("10000 m by 10000 m") && said.contains("4200000 nodes"), "{said}");
    assert!(of_size(10_000.0, 10_000.0, 50.0).is_ok());
    for cell_m in [0.0, -0.5, 1e-300, f64::NAN] {
        assert!(matches!(of_size(20.0, 20.0, cell_m), Err(SurveyError::TooManyNodes { .. })), "{cell_m}");
    }
}

#[test]
fn waypoints_that_make_no_sense_are_counted_and_change_nothing() {
    let clean = WORLD.walk.survey_walk("walk");
    let mut waypoints = Vec::new();
    for waypoint in &WORLD.walk.waypoints {
        let nan = Waypoint { point: Point2::new(f64::NAN, 2.0), ..*waypoint };
        let infinite = Waypoint { point: Point2::new(2.0, f64::INFINITY), ..*waypoint };
        let backwards = Waypoint { time: waypoint.time - Duration::from_millis(1), ..*waypoint };
        waypoints.extend([nan, infinite, *waypoint, *waypoint, backwards]);
    }
    let walk = walk_of(WORLD.walk.samples.iter().copied(), &waypoints);
    assert_eq!(walk.n_refused_waypoints(), 4 * WORLD.walk.waypoints.len() as u64);
    assert_eq!(walk.waypoints(), clean.waypoints());
    assert_eq!(survey(WORLD.floor.plan(), &[walk]), survey(WORLD.floor.plan(), &[clean]));
}

#[test]
fn a_waypoint_at_the_end_of_the_world_gives_a_map_all_the_same() {
    let mut walks = WORLD.floor.survey();
    walks.truncate(3);
    for far_m in [1e4, 1e12, 1e300, -1e300] {
        let mut recorded = WORLD.walk.clone();
        recorded.waypoints[3].point = Point2::new(far_m, 5.0);
        walks.push(recorded.survey_walk("to the end of the world"));
        let map = survey(WORLD.floor.plan(), &walks).unwrap();
        walks.pop();
        for (name, layer) in map.layers.named() {
            assert!(layer.iter().all(|value| value.is_finite()), "{name} with a waypoint at {far_m}");
        }
    }
}

#[test]
fn broken_samples_in_a_survey_are_counted() {
    let mut walk = SurveyWalk::new("walk");
    for sample in samples() {
        walk.push(&Sample { time: sample.time, reading: Reading::SpecificForce([f32::NAN; 3]) });
        walk.push(sample);
        walk.push(sample);
    }
    walk.finish();
    let n = N_SAMPLES as u64;
    assert_eq!(walk.rejections(), Rejections { implausible: n, duplicate: n, ..no_rejections() });
    assert_eq!(walk.steps(), walk_of(samples().iter().copied(), &[]).steps());
}
