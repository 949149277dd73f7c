//! Maps with holes in them, and recipes of any size.

use std::sync::Arc;

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::positioner::{Fix, Positioner};
use fieldwalk::system::Recipe;

use crate::{WORLD, fixes, hint, most_error_m, n_fixes, placed, recipes, samples};

fn run_on(map: FloorMap, recipe: &Recipe) -> Vec<Fix> {
    let mut positioner = Positioner::new(Arc::new(FloorIndex::new(map)), recipe.clone(), 1);
    let _ = positioner.hint(hint());
    fixes(&mut positioner, samples().iter().copied())
}

#[test]
fn a_layer_of_a_wrong_size_reads_as_unknown() {
    let map = WORLD.index.map();
    let names = map.layers.named().map(|(name, _)| name);
    for recipe in recipes() {
        for name in names {
            let with_length = |length: usize| {
                let mut map = map.clone();
                map.layers.named_mut(name).unwrap().resize(length, 0.0);
                run_on(map, &recipe)
            };
            let empty = with_length(0);
            assert!(empty.len() > n_fixes(&recipe, 35), "{}, {name}: {} fixes", recipe.name, empty.len());
            for length in [1, map.frame.len() - 1, map.frame.len() + 1] {
                assert!(with_length(length) == empty, "{}, {name} of length {length}", recipe.name);
            }
        }
    }
}

#[test]
fn layers_of_nan_read_as_unknown() {
    let map = WORLD.index.map();
    for recipe in recipes() {
        let (mut nan, mut none) = (map.clone(), map.clone());
        for (name, _) in map.layers.named() {
            nan.layers.named_mut(name).unwrap().fill(f32::NAN);
            none.layers.named_mut(name).unwrap().clear();
        }
        let fixes = run_on(nan, &recipe);
        assert!(fixes.len() > n_fixes(&recipe, 35));
        assert!(fixes == run_on(none, &recipe), "{}", recipe.name);
    }
}

#[test]
fn a_map_without_a_plan_lets_everyone_pass() {
    let map = WORLD.index.map();
    for recipe in recipes() {
        let bounds = FloorPlan { width_m: 30.0, height_m: 20.0, ..FloorPlan::default() };
        let open = run_on(FloorMap { plan: bounds, ..map.clone() }, &recipe);
        assert!(open.len() > n_fixes(&recipe, 35), "{}", recipe.name);
        let truth = WORLD.walk.truth(open.last().unwrap().time).unwrap();
        let error_m = open.last().unwrap().position.distance_m(truth);
        assert!(error_m < most_error_m(&recipe), "{}: {error_m:.1} m", recipe.name);
        // Not even an extent: hints have nowhere to be, steps are followed all the same.
        let nothing = run_on(FloorMap { plan: FloorPlan::default(), ..map.clone() }, &recipe);
        assert!(nothing.len() > n_fixes(&recipe, 35), "{}", recipe.name);
    }
}

#[test]
fn an_empty_map_is_no_reason_to_fall() {
    for recipe in recipes() {
        let mut positioner =
            Positioner::new(Arc::new(FloorIndex::new(FloorMap::default())), recipe.clone(), 1);
        let n = fixes(&mut positioner, samples().iter().copied()).len();
        let is_follower = recipe.radar.is_none();
        let expected = n_fixes(&recipe, 35);
        assert!(if is_follower { n > expected } else { n == 0 }, "{}: {n}", recipe.name);
    }
}

#[test]
fn a_grid_of_impossible_cells_is_no_reason_to_fall() {
    for cell_m in [0.0, -0.5, f64::NAN, f64::INFINITY, 1e-30, 1e30] {
        for recipe in recipes() {
            let mut map = WORLD.index.map().clone();
            map.frame.cell_m = cell_m;
            assert!(run_on(map, &recipe).len() > n_fixes(&recipe, 35), "{}, {cell_m}", recipe.name);
        }
    }
}

#[test]
fn walls_at_no_place_are_passed() {
    for recipe in recipes() {
        let mut map = WORLD.index.map().clone();
        for unit in &mut map.plan.units {
            for (k, vertex) in unit.polygon.rings.iter_mut().flatten().enumerate() {
                *vertex = [Point2::new(f64::NAN, 1.0), Point2::new(f64::INFINITY, 5.0), *vertex][k % 3];
            }
        }
        assert!(run_on(map, &recipe).len() > n_fixes(&recipe, 35), "{}", recipe.name);
    }
}

#[test]
fn any_number_of_particles_runs() {
    for recipe in recipes() {
        for n_particles in [0, 1, 2, 10 * recipe.n_particles] {
            let recipe = Recipe { n_particles, ..recipe.clone() };
            let fixes = fixes(&mut placed(&recipe), samples()[..2_000].iter().copied());
            assert!(fixes.len() > n_fixes(&recipe, 10), "{}, {n_particles}: {}", recipe.name, fixes.len());
        }
    }
}
