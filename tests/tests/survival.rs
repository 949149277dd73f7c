//! Every system survives what happens to phones: sensors and beacons that are missing, floors without a map, pockets, and
//! clouds of any size.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::{Arc, LazyLock};

use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::positioner::{Fix, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::system::{MagneticRule, Recipe};
use fieldwalk::time::Timestamp;
use fieldwalk_tests::synthetic::{Floor, Recorded};

struct World {
    floor: Arc<FloorIndex>,
    unmapped: Arc<FloorIndex>,
    walk: Recorded,
}

static WORLD: LazyLock<World> = LazyLock::new(|| {
    let floor = Floor::new(1);
    let map = floor.surveyed_map().unwrap();
    let unmapped = FloorMap {
        name: map.name.clone(),
        ordinal: map.ordinal,
        plan: map.plan.clone(),
        ..FloorMap::default()
    };
    let walk = floor.round_trip(1);
    World { floor: Arc::new(FloorIndex::new(map)), unmapped: Arc::new(FloorIndex::new(unmapped)), walk }
});

/// Walks with `recipe` over `samples`; says how many of a hundred fixes once a second hold the truth within their 95 %
/// radius.
fn survive(what: &str, floor: &Arc<FloorIndex>, recipe: Recipe, samples: &[Sample]) -> f64 {
    let name = format!("{what}, {}", recipe.name);
    let mut positioner = Positioner::new(Arc::clone(floor), recipe, 1);
    positioner.hint(WORLD.walk.hint(Point2::new(0.5, -0.3)).unwrap()).unwrap();
    let mut next = Timestamp::MIN;
    let (mut n, mut n_inside) = (0.0, 0.0);
    for sample in samples {
        positioner.push(*sample);
        if sample.time < next {
            continue;
        }
        next = Timestamp::from_nanos(sample.time.as_nanos() + 1_000_000_000);
        let fix = positioner.fix().unwrap();
        assert_is_sound(&name, &fix);
        if let Some(truth) = WORLD.walk.truth(fix.time) {
            n += 1.0;
            n_inside += f64::from(u8::from(fix.position.distance_m(truth) <= fix.radius_95_m));
        }
    }
    assert!(n > 10.0, "{name}: {n} fixes");
    positioner.flush();
    assert_is_sound(&name, &positioner.fix().unwrap());
    println!("{name}: {:.0} % within the 95 % radius", 100.0 * n_inside / n);
    n_inside / n
}

fn assert_is_sound(name: &str, fix: &Fix) {
    let numbers = [fix.position.x_m, fix.position.y_m, fix.heading_rad, fix.speed_m_s];
    assert!(numbers.iter().all(|number| number.is_finite() && number.abs() < 1_000.0), "{name}: {fix:?}");
    assert!(fix.covariance_m2.iter().flatten().all(|m2| m2.is_finite()), "{name}: {fix:?}");
    // No system knows a place to the decimetre.
    assert!(fix.radius_68_m > 0.3 && fix.radius_68_m <= fix.radius_95_m, "{name}: {fix:?}");
    assert!(fix.radius_95_m.is_finite(), "{name}: {fix:?}");
}

/// The share of fixes that hold the truth, over all systems in `what`, none of which may fall below `least`.
///
/// Who takes the strength as it is cannot be true with a phone that carries iron of its own, or moves by the compass of a
/// pocketed one: these must survive, and no more.
fn survive_all(what: &str, samples: &[Sample], recipes: impl Iterator<Item = Recipe>, least: f64) {
    let mut untrue = Vec::new();
    for recipe in recipes {
        let is_bound = !matches!(recipe.magnetic, MagneticRule::Strength(_) | MagneticRule::Candidates(_));
        let name = recipe.name.clone();
        let share = survive(what, &WORLD.floor, recipe, samples);
        if is_bound && share < least {
            untrue.push((name, share));
        }
    }
    assert!(untrue.is_empty(), "{what}: {untrue:?}");
}

fn recipes() -> impl Iterator<Item = Recipe> {
    Recipe::NAMES.into_iter().filter_map(Recipe::named)
}

fn without(is_missing: impl Fn(&Reading) -> bool) -> Vec<Sample> {
    WORLD.walk.samples.iter().filter(|sample| !is_missing(&sample.reading)).copied().collect()
}

fn is_radio(reading: &Reading) -> bool {
    matches!(reading, Reading::Radio(_))
}

#[test]
fn no_beacons() {
    let samples = without(is_radio);
    // RADAR has nothing else.
    survive_all("no beacons", &samples, recipes().filter(|recipe| recipe.radar.is_none()), 0.6);
    survive("no beacons", &WORLD.floor, Recipe::radar(), &samples);
}

#[test]
fn no_map_under_the_user() {
    for recipe in recipes() {
        survive("no map", &WORLD.unmapped, recipe.clone(), &WORLD.walk.samples);
        survive("no map, with plan", &WORLD.unmapped, recipe.with_plan(), &WORLD.walk.samples);
    }
}

/// The walk with the phone tipped by a right angle about its short edge, as in a pocket, for its middle third.
fn pocketed() -> Vec<Sample> {
    let samples = &WORLD.walk.samples;
    let (first, last) = (samples[0].time, samples[samples.len() - 1].time);
    let third_s = last.secs_since(first) / 3.0;
    let tip_rad = |t_s: f64| {
        let eased = |from_s: f64| (t_s - from_s).clamp(0.0, 1.0);
        1.57 * (eased(third_s) - eased(2.0 * third_s))
    };
    let tipped = |sample: &Sample| {
        let t_s = sample.time.secs_since(first);
        let (sin, cos) = tip_rad(t_s).sin_cos();
        let (sin, cos) = (sin as f32, cos as f32);
        // The device turns about its x by the angle; what it senses turns back.
        let turn = |[x, y, z]: [f32; 3]| [x, cos * y + sin * z, cos * z - sin * y];
        let rate_rad_s = ((tip_rad(t_s + 1e-3) - tip_rad(t_s - 1e-3)) / 2e-3) as f32;
        let reading = match sample.reading {
            Reading::SpecificForce(v) => Reading::SpecificForce(turn(v)),
            Reading::MagneticField(v) => Reading::MagneticField(turn(v)),
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                Reading::UncalibratedMagneticField { field_ut: turn(field_ut), bias_ut }
            }
            Reading::AngularRate(v) => {
                let [x, y, z] = turn(v);
                Reading::AngularRate([x + rate_rad_s, y, z])
            }
            other => other,
        };
        Sample { time: sample.time, reading }
    };
    samples.iter().map(tipped).collect()
}

#[test]
fn into_the_pocket_and_back() {
    let samples = pocketed();
    survive_all("pocket", &samples, recipes(), 0.5);
}

#[test]
fn each_sensor_missing_in_turn() {
    let is_field = |reading: &Reading| {
        matches!(reading, Reading::MagneticField(_) | Reading::UncalibratedMagneticField { .. })
    };
    let missing: [(&str, Vec<Sample>); 4] = [
        ("no accelerometer", without(|reading| matches!(reading, Reading::SpecificForce(_)))),
        ("no gyroscope", without(|reading| matches!(reading, Reading::AngularRate(_)))),
        ("no magnetometer", without(is_field)),
        ("nothing but radio", without(|reading| !is_radio(reading))),
    ];
    for (what, samples) in &missing {
        for recipe in recipes() {
            survive(what, &WORLD.floor, recipe, samples);
        }
    }
}

#[test]
fn ten_times_the_particles() {
    let first = WORLD.walk.samples[0].time;
    let samples: Vec<Sample> =
        WORLD.walk.samples.iter().filter(|sample| sample.time.secs_since(first) < 25.0).copied().collect();
    let many = recipes().map(|recipe| Recipe { n_particles: 10 * recipe.n_particles, ..recipe });
    survive_all("ten times the particles", &samples, many, 0.7);
}

#[test]
fn one_particle() {
    for recipe in recipes() {
        survive("one particle", &WORLD.floor, Recipe { n_particles: 1, ..recipe }, &WORLD.walk.samples);
    }
}
