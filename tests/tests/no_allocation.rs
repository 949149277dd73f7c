//! One step allocates nothing: counted, not believed.
#![allow(unsafe_code, reason = "a global allocator that counts can only be written with unsafe code")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::{Mode, Positioner};
use fieldwalk::system::Recipe;
use fieldwalk_tests::synthetic::Floor;

/// The system's allocator, counting what each thread asks of it.
struct Counting;

thread_local! {
    static N_ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    N_ALLOCATIONS.with(|n| n.set(n.get() + 1));
}

// SAFETY: every call goes to the system's allocator unchanged; counting touches a thread-local integer alone, which is
// initialised at compile time, has no destructor and so allocates nothing itself.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, new_size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(work: impl FnOnce()) -> u64 {
    let before = N_ALLOCATIONS.with(Cell::get);
    work();
    N_ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(std::hint::black_box(vec![1u8; 100]))), 1);
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(7)))), 1);
    assert_eq!(allocations(|| ()), 0);
}

#[test]
fn no_push_allocates_once_the_walk_has_begun() {
    let floor = Floor::new(1);
    let index = Arc::new(FloorIndex::new(floor.surveyed_map().unwrap()));
    let walk = floor.round_trip(1);
    for name in Recipe::NAMES {
        let mut positioner = Positioner::new(Arc::clone(&index), Recipe::named(name).unwrap(), 3);
        positioner.hint(walk.hint(Point2::default()).unwrap()).unwrap();
        let (mut n_steps, mut n_watched) = (0, 0);
        for sample in &walk.samples {
            let is_watched = (10..60).contains(&n_steps);
            let mut has_stepped = false;
            let n_allocations = allocations(|| has_stepped = positioner.push(*sample).is_some());
            n_steps += u32::from(has_stepped);
            n_watched += u32::from(has_stepped && is_watched);
            if is_watched {
                assert_eq!(n_allocations, 0, "{name}, step {n_steps}: {sample:?}");
            }
        }
        assert_eq!(n_watched, 50, "{name}");
    }
}

#[test]
fn no_push_allocates_inside_a_cluster_of_beacons() {
    let floor = Floor::new(1);
    let mut map = floor.surveyed_map().unwrap();
    // Three beacons moved together, and so weak that they seem near from everywhere.
    for (transmitter, (x_m, y_m)) in
        map.transmitters.iter_mut().zip([(10.0, 10.0), (13.0, 10.0), (11.5, 12.5)])
    {
        transmitter.position = Point2::new(x_m, y_m);
        (transmitter.power_at_1m_dbm, transmitter.path_loss_exponent) = (-80.0, 4.0);
    }
    let index = Arc::new(FloorIndex::new(map));
    let walk = floor.round_trip(1);
    let mut positioner = Positioner::new(index, Recipe::ibill(), 3);
    positioner.hint(walk.hint(Point2::default()).unwrap()).unwrap();
    let (mut n_fixes, mut n_inside) = (0, 0);
    for sample in &walk.samples {
        let mut fix = None;
        let n_allocations = allocations(|| fix = positioner.push(*sample));
        n_fixes += u32::from(fix.is_some());
        n_inside += u32::from(fix.is_some_and(|fix| fix.mode == Mode::Beacon));
        if n_fixes > 10 {
            assert_eq!(n_allocations, 0, "fix {n_fixes}: {sample:?}");
        }
    }
    assert!(n_inside > 50, "{n_inside} of {n_fixes}");
}

#[test]
fn asking_for_a_fix_allocates_nothing() {
    let floor = Floor::new(1);
    let index = Arc::new(FloorIndex::new(floor.surveyed_map().unwrap()));
    let walk = floor.round_trip(1);
    for name in Recipe::NAMES {
        let mut positioner = Positioner::new(Arc::clone(&index), Recipe::named(name).unwrap(), 3);
        positioner.hint(walk.hint(Point2::default()).unwrap()).unwrap();
        for sample in walk.samples.iter().take(1_000) {
            positioner.push(*sample);
            let n_allocations = allocations(|| drop(std::hint::black_box(positioner.fix_at(sample.time))));
            assert_eq!(n_allocations, 0, "{name}");
        }
    }
}
