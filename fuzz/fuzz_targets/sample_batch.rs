//! Sample batches: reading never panics and gives something for every record, what it gives survives being written and
//! read again, and a positioner takes it.
#![no_main]

use std::sync::{Arc, LazyLock};

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::positioner::Positioner;
use fieldwalk::sensor::Sample;
use fieldwalk::system::Recipe;
use fieldwalk_batch::{SampleBatch, SampleBatchWriter};
use libfuzzer_sys::fuzz_target;

static FLOOR: LazyLock<Arc<FloorIndex>> = LazyLock::new(|| {
    let plan = FloorPlan { width_m: 20.0, height_m: 20.0, ..FloorPlan::default() };
    Arc::new(FloorIndex::new(FloorMap { plan, ..FloorMap::default() }))
});

fuzz_target!(|bytes: &[u8]| {
    let Ok(batch) = SampleBatch::new(bytes) else { return };
    let read: Vec<_> = batch.samples().collect();
    assert!(read.len().abs_diff(batch.n_records() as usize) <= 1);
    let samples: Vec<Sample> = read.into_iter().filter_map(Result::ok).collect();

    let mut writer = SampleBatchWriter::new();
    assert!(samples.iter().all(|sample| writer.push(sample)));
    let written = writer.finish();
    let again = SampleBatch::new(&written).expect("what was written can be read");
    let again: Vec<Sample> = again.samples().map(|sample| sample.expect("a whole record")).collect();
    // Every NaN is alike.
    assert_eq!(format!("{again:?}"), format!("{samples:?}"));

    let recipe = Recipe { n_particles: 20, ..Recipe::fused() };
    let mut positioner = Positioner::new(Arc::clone(&FLOOR), recipe, 1);
    for sample in samples {
        positioner.push(sample);
    }
});
