//! Every named scenario: its walks are free of walls, its recordings plausible, its stairs as high as its storeys.

#![expect(clippy::unwrap_used, reason = "test code outside test functions")]

use fieldwalk::geometry::Segment;
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk_sim::scenario::{Recorded, Scenario, Walk};

fn scenario(name: &str) -> Scenario {
    Scenario::named(name, 1).unwrap()
}

fn is_clear(scenario: &Scenario, walk: &Walk) -> bool {
    walk.path.windows(2).all(|p| {
        let step = Segment { a: p[0], b: p[1] };
        !scenario.building.plan.barriers().any(|barrier| barrier.crosses(&step))
    })
}

#[test]
fn names_are_known_and_others_are_not() {
    for name in Scenario::NAMES {
        assert_eq!(scenario(name).name, name);
    }
    assert!(Scenario::named("castle", 1).is_none());
}

#[test]
fn every_scenario_is_surveyed_and_walked_clear_of_walls() {
    for name in Scenario::NAMES {
        let scenario = scenario(name);
        let (surveys, tests) = (scenario.survey_walks(), scenario.test_walks(6, 60.0));
        let length_m = |walk: &Walk| walk.path.windows(2).map(|p| p[0].distance_m(p[1])).sum::<f64>();
        let surveyed_m: f64 = surveys.iter().map(length_m).sum();
        println!("{name}: {} survey walks, {surveyed_m:.0} m", surveys.len());
        assert!(surveys.len() >= 4 && tests.len() == 6, "{name}");
        for walk in surveys.iter().chain(&tests) {
            assert!(length_m(walk) > 1.0, "{name}: nothing is walked in {}", walk.name);
            assert!(is_clear(&scenario, walk), "{name}, {}: {:?}", walk.name, walk.path);
        }
        assert!(tests.iter().all(|walk| length_m(walk) >= 50.0), "{name}");
    }
}

fn recorded(scenario: &Scenario, k: usize) -> Recorded {
    scenario.simulate(&scenario.test_walks(k as u64 + 1, 40.0)[k])
}

#[test]
fn every_scenario_gives_plausible_recordings() {
    for name in Scenario::NAMES {
        let scenario = scenario(name);
        let walk = recorded(&scenario, 0);
        assert!(walk.samples.iter().all(Sample::is_plausible), "{name}");
        let share = walk.survey_walk().steps().len() as f64 / walk.steps.len() as f64;
        println!("{name}: {} steps, {share:.2} of them counted", walk.steps.len());
        assert!((0.85..1.1).contains(&share), "{name}: {share}");
    }
}

fn pressure_hpa(sample: &Sample) -> Option<f64> {
    match sample.reading {
        Reading::Pressure { pressure_hpa } => Some(f64::from(pressure_hpa)),
        _ => None,
    }
}

#[test]
fn stairs_lead_from_floor_to_floor_tread_by_tread() {
    let scenario = scenario("two-floors");
    let storey_m = scenario.upstairs[0].height_m;
    let mut starts = Vec::new();
    for k in 0..4 {
        let walk = recorded(&scenario, k);
        let (first, last) = (walk.truth[0], walk.truth[walk.truth.len() - 1]);
        assert_eq!((first.floor - last.floor).abs(), 1);
        assert!(((first.height_m - last.height_m).abs() - storey_m).abs() < 1e-9);
        assert!((first.height_m - f64::from(first.floor) * storey_m).abs() < 1e-9);
        starts.push(first.floor);
        // The barometer tells it: 12 Pa a metre, within what weather, draughts and its drift do in a minute or two.
        let pressures: Vec<f64> = walk.samples.iter().filter_map(pressure_hpa).collect();
        let duration_s = last.time.secs_since(first.time);
        assert!((pressures.len() as f64 / duration_s - 10.0).abs() < 0.3);
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let n = pressures.len();
        let climbed_hpa = mean(&pressures[..50]) - mean(&pressures[n - 50..]);
        let climbed_m = last.height_m - first.height_m;
        assert!((climbed_hpa - 0.1194 * climbed_m).abs() < 0.15, "{climbed_hpa} hPa for {climbed_m} m");
        // Twenty treads of 0.17 m, at 1.3 to 1.8 steps a second.
        let is_between = |h: f64| h > 0.02 && h < storey_m - 0.02;
        let climbing: Vec<_> = walk
            .steps
            .iter()
            .filter(|step| {
                let height_m = |s: f64| {
                    walk.truth_at(
                        fieldwalk_sim::scenario::ORIGIN + fieldwalk::time::Duration::from_secs_f64(s),
                    )
                    .unwrap()
                    .height_m
                };
                (height_m(step.end_s) - height_m(step.start_s)).abs() > 0.1
                    && (is_between(height_m(step.start_s)) || is_between(height_m(step.end_s)))
            })
            .collect();
        assert_eq!(climbing.len(), 20);
        let mean_s = climbing.iter().map(|step| step.end_s - step.start_s).sum::<f64>() / 20.0;
        assert!((0.5..0.8).contains(&mean_s), "{mean_s} s a tread");
        assert!(climbing.iter().all(|step| (step.length_m - 0.29).abs() < 0.01));
    }
    assert!(starts.contains(&0) && starts.contains(&1), "{starts:?}");
}
