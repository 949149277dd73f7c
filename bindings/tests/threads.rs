//! The threading contract: any thread may call, one call at a time is done, nothing is lost or done twice.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod walk;

use std::thread;

use fieldwalk_ffi::{Positioner, Recorder, RecordingDetails, RecordingReader, Surveyor};

use walk::{Folder, OFFICE, SURVEYED, batch_of};

#[test]
fn two_threads_that_push_at_once_take_turns_batch_by_batch() {
    let folder = Folder::new("threads");
    let path = folder.path("both.mcap");
    let recorder = Recorder::new(path.to_str().unwrap(), RecordingDetails::default()).unwrap();
    let surveyor = Surveyor::new(&OFFICE.plan, "F1".into(), 0).unwrap();
    surveyor.begin_walk("w".into()).unwrap();
    let positioner = Positioner::new(&SURVEYED, 0, Default::default()).unwrap();
    positioner.hint(OFFICE.walk.hint()).unwrap();
    // Less than a minute: a thread that comes so long after the other would pass for a clock that was set back.
    let samples = &OFFICE.walk.samples;
    assert!(samples[samples.len() - 1].time.secs_since(samples[0].time) < 60.0);
    let batches: Vec<Vec<u8>> = samples.chunks(40).map(batch_of).collect();
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                for batch in &batches {
                    recorder.push_samples(batch).unwrap();
                    surveyor.push_samples(batch).unwrap();
                    positioner.push_samples(batch).unwrap();
                    positioner.status();
                }
            });
        }
    });
    let n_samples = samples.len() as u64;
    // The engine takes one of the two copies of each sample, whatever the order.
    let rejections = positioner.status().rejections;
    assert_eq!(rejections.implausible + rejections.jumped, 0);
    assert_eq!(rejections.duplicate + rejections.late, n_samples, "{rejections:?}");
    assert!(positioner.fix().unwrap().is_some());
    assert!(surveyor.status().unwrap().n_steps > 20, "{:?}", surveyor.status());
    // The recording has all of both.
    assert_eq!(recorder.finish().unwrap().n_samples, 2 * n_samples);
    let reader = RecordingReader::open(path.to_str().unwrap()).unwrap();
    let mut n_read = 0;
    while let Some(part) = reader.next_part(10_000).unwrap() {
        n_read += u64::from(part.n_samples);
    }
    assert_eq!(n_read, 2 * n_samples);
}

#[test]
fn a_survey_goes_on_while_its_map_is_built() {
    let surveyor = Surveyor::new(&OFFICE.plan, "F1".into(), 0).unwrap();
    for walk in &OFFICE.surveys {
        walk::survey(&surveyor, walk, 500);
    }
    thread::scope(|scope| {
        let building = scope.spawn(|| surveyor.build().unwrap());
        surveyor.begin_walk("meanwhile".into()).unwrap();
        for samples in OFFICE.walk.samples.chunks(40) {
            surveyor.push_samples(&batch_of(samples)).unwrap();
        }
        assert!(surveyor.status().unwrap().is_walking);
        assert!(building.join().unwrap().coverage().route_m > 50.0);
    });
}
