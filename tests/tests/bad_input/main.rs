//! Bad input: refused with its cause, or counted; never a panic, never a fix that lies.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod anything;
mod hints;
mod maps;
mod samples;
mod snapshots;
mod surveys;

use std::sync::{Arc, LazyLock};

use fieldwalk::Rejections;
use fieldwalk::front_end::FrontEndRule;
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::{Fix, PositionHint, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::system::{MagneticRule, Recipe};
use fieldwalk_tests::synthetic::{Floor, Recorded};

struct World {
    floor: Floor,
    index: Arc<FloorIndex>,
    walk: Recorded,
}

static WORLD: LazyLock<World> = LazyLock::new(|| {
    let floor = Floor::new(1);
    let map = floor.surveyed_map().expect("the synthetic survey gives a map");
    World { index: Arc::new(FloorIndex::new(map)), walk: floor.round_trip(1), floor }
});

/// The first samples of the walk: some 25 s, of which 23 s are walked.
const N_SAMPLES: usize = 4_000;

fn samples() -> &'static [Sample] {
    &WORLD.walk.samples[..N_SAMPLES]
}

fn recipes() -> Vec<Recipe> {
    Recipe::NAMES.iter().map(|name| Recipe::named(name).unwrap()).collect()
}

/// Those that follow steps: RADAR rests on radio alone.
fn followers() -> impl Iterator<Item = Recipe> {
    recipes().into_iter().filter(|recipe| recipe.radar.is_none())
}

/// A card has a fix a second where a phone has one a step.
fn n_fixes(recipe: &Recipe, n_steps: usize) -> usize {
    if recipe.front_end == FrontEndRule::Card { n_steps / 2 } else { n_steps }
}

/// How far off a fix may be, in metres: whoever takes the strength as it is, from a phone that carries iron of its own, or
/// sets every fix by one round of radio, is farther off than the rest.
fn most_error_m(recipe: &Recipe) -> f64 {
    let takes_strength = matches!(recipe.magnetic, MagneticRule::Strength(_) | MagneticRule::Candidates(_));
    if takes_strength || recipe.radar.is_some() { 16.0 } else { 8.0 }
}

fn hint() -> PositionHint {
    WORLD.walk.hint(Point2::new(0.3, 0.2)).unwrap()
}

fn fresh(recipe: &Recipe) -> Positioner {
    Positioner::new(Arc::clone(&WORLD.index), recipe.clone(), 1)
}

fn placed(recipe: &Recipe) -> Positioner {
    let mut positioner = fresh(recipe);
    positioner.hint(hint()).unwrap();
    positioner
}

fn fixes(positioner: &mut Positioner, samples: impl IntoIterator<Item = Sample>) -> Vec<Fix> {
    let fixes: Vec<Fix> = samples.into_iter().filter_map(|sample| positioner.push(sample)).collect();
    fixes.iter().for_each(assert_sound);
    fixes
}

fn is_sound(fix: &Fix) -> bool {
    let Fix { position, heading_rad, speed_m_s, covariance_m2, radius_68_m, radius_95_m, .. } = fix;
    let numbers = [*heading_rad, *speed_m_s, *radius_68_m, *radius_95_m];
    position.is_finite()
        && numbers.iter().chain(covariance_m2.iter().flatten()).all(|number| number.is_finite())
        && *radius_68_m > 0.0
        && radius_95_m >= radius_68_m
}

fn assert_sound(fix: &Fix) {
    assert!(is_sound(fix), "{fix:?}");
}

fn no_rejections() -> Rejections {
    Rejections::default()
}

fn is_field(reading: &Reading) -> bool {
    matches!(reading, Reading::MagneticField(_) | Reading::UncalibratedMagneticField { .. })
}
