//! Snapshots of another positioner, and torn ones.

use std::sync::Arc;

use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::{PositionError, Positioner, Snapshot};
use fieldwalk::system::Recipe;

use crate::{WORLD, fixes, fresh, placed, samples};

#[test]
fn foreign_snapshots_are_refused_and_change_nothing() {
    let mut other_map = WORLD.index.map().clone();
    other_map.name = "another floor".into();
    let other_floor = Arc::new(FloorIndex::new(other_map));
    let mut positioner = placed(&Recipe::fused());
    fixes(&mut positioner, samples()[..2_000].iter().copied());
    let before = positioner.fix();
    let tuned = Recipe { n_particles: 999, ..Recipe::fused() };
    let foreign = [
        ("recipe", placed(&Recipe::dead_reckoning()).snapshot()),
        ("parameters", placed(&tuned).snapshot()),
        ("seed", Positioner::new(Arc::clone(&WORLD.index), Recipe::fused(), 2).snapshot()),
        ("floor", Positioner::new(other_floor, Recipe::fused(), 1).snapshot()),
    ];
    for (what, snapshot) in foreign {
        assert_eq!(positioner.restore(snapshot), Err(PositionError::ForeignSnapshot), "{what}");
        assert_eq!(positioner.fix(), before, "{what}");
    }
}

#[test]
fn a_torn_snapshot_is_refused_or_harmless() {
    let mut walked = placed(&Recipe::fused());
    fixes(&mut walked, samples()[..2_000].iter().copied());
    let whole = serde_json::to_value(walked.snapshot()).unwrap();
    let particles = whole["tracker"]["particles"].as_object().unwrap();
    let names: Vec<&String> = particles
        .iter()
        .filter(|(_, v)| v.as_array().is_some_and(|a| !a.is_empty()))
        .map(|(n, _)| n)
        .collect();
    assert!(names.len() >= 5, "{names:?}");
    for name in names {
        for length in [0, 3, 1_003] {
            let mut torn = whole.clone();
            let array = torn["tracker"]["particles"][name].as_array_mut().unwrap();
            array.resize(length, 0.5.into());
            let snapshot: Snapshot = serde_json::from_value(torn).unwrap();
            let mut positioner = fresh(&Recipe::fused());
            assert_eq!(
                positioner.restore(snapshot),
                Err(PositionError::ForeignSnapshot),
                "{name} of length {length}"
            );
        }
    }
}
