//! Recordings written and read across the boundary: nothing is lost but what a crash takes.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod walk;

use std::fs;

use fieldwalk_batch::SampleBatch;
use fieldwalk_ffi::{ApiError, Recorder, RecordingDetails, RecordingLosses, RecordingReader, Waypoint};

use walk::{Folder, OFFICE, batch_of, record};

/// All samples as they print, and all waypoints.
fn read(reader: &RecordingReader, max_samples: u32) -> Result<(Vec<String>, Vec<Waypoint>), ApiError> {
    let (mut samples, mut waypoints) = (Vec::new(), Vec::new());
    while let Some(part) = reader.next_part(max_samples)? {
        let batch = SampleBatch::new(&part.samples).unwrap();
        assert!(part.n_samples <= max_samples.max(1) && batch.n_records() == part.n_samples);
        samples.extend(batch.samples().map(|sample| format!("{:?}", sample.unwrap())));
        waypoints.extend(part.waypoint);
    }
    Ok((samples, waypoints))
}

fn open(path: &std::path::Path) -> std::sync::Arc<RecordingReader> {
    RecordingReader::open(path.to_str().unwrap()).unwrap()
}

#[test]
fn what_is_recorded_comes_back_in_parts_of_any_size() {
    let folder = Folder::new("record");
    let path = folder.path("walk.mcap");
    let recorder = record(&path, &OFFICE.walk, 33);
    let status = recorder.finish().unwrap();
    assert_eq!(status.n_samples, OFFICE.walk.samples.len() as u64);
    assert_eq!(status.n_waypoints, OFFICE.walk.waypoints.len() as u64);
    assert!(status.is_finished && recorder.status().unwrap() == status);
    let written: Vec<String> = OFFICE.walk.samples.iter().map(|sample| format!("{sample:?}")).collect();
    for max_samples in [1, 100, u32::MAX] {
        let reader = open(&path);
        let (samples, waypoints) = read(&reader, max_samples).unwrap();
        assert!(samples == written, "other samples in parts of {max_samples}");
        assert_eq!(waypoints, OFFICE.walk.waypoints);
        assert_eq!(reader.losses().unwrap(), RecordingLosses::default());
        assert_eq!(
            (reader.details().unwrap().device.as_str(), reader.floor().unwrap()),
            ("a phone", Some(0))
        );
    }
}

#[test]
fn a_file_torn_anywhere_gives_its_beginning() {
    let folder = Folder::new("torn");
    let path = folder.path("walk.mcap");
    let recorder = record(&path, &OFFICE.walk, 33);
    recorder.flush().unwrap();
    assert_eq!(recorder.status().unwrap().n_waiting_bytes, 0);
    // As a crash leaves it: the recorder is still open.
    let whole = fs::read(&path).unwrap();
    let (all, _) = read(&open(&path), 1_000).unwrap();
    assert_eq!(all.len(), OFFICE.walk.samples.len());
    let torn = folder.path("torn.mcap");
    let mut n_before = 0;
    for length in (64..whole.len()).step_by(whole.len() / 40) {
        fs::write(&torn, &whole[..length]).unwrap();
        let reader = open(&torn);
        let (samples, _) = read(&reader, 1_000).unwrap();
        assert!(samples.len() >= n_before && samples[..] == all[..samples.len()], "{length} bytes");
        assert!(reader.losses().unwrap().was_cut);
        n_before = samples.len();
    }
    assert!(n_before > all.len() / 2, "{n_before} of {}", all.len());
}

#[test]
fn a_file_is_never_replaced_and_a_finished_one_takes_nothing() {
    let folder = Folder::new("finished");
    let path = folder.path("walk.mcap");
    let recorder = Recorder::new(path.to_str().unwrap(), RecordingDetails::default()).unwrap();
    let again = Recorder::new(path.to_str().unwrap(), RecordingDetails::default());
    assert!(matches!(again, Err(ApiError::FileExists { .. })), "{again:?}");
    let nowhere = folder.path("no/such/folder.mcap");
    let nowhere = Recorder::new(nowhere.to_str().unwrap(), RecordingDetails::default());
    assert!(matches!(nowhere, Err(ApiError::FileUnwritable { .. })), "{nowhere:?}");
    recorder.finish().unwrap();
    let batch = batch_of(&OFFICE.walk.samples[..10]);
    let refusals = [
        recorder.push_samples(&batch),
        recorder.push_waypoint(OFFICE.walk.waypoints[0]),
        recorder.flush(),
        recorder.finish().map(drop),
    ];
    assert!(refusals.iter().all(|result| matches!(result, Err(ApiError::Finished { .. }))), "{refusals:?}");
}

#[test]
fn a_recording_that_is_missing_or_none_is_told_apart() {
    let folder = Folder::new("no-recording");
    let missing = RecordingReader::open(folder.path("none.mcap").to_str().unwrap());
    assert!(matches!(missing, Err(ApiError::RecordingNotFound { .. })));
    let path = folder.path("empty.mcap");
    fs::write(&path, b"").unwrap();
    let empty = RecordingReader::open(path.to_str().unwrap());
    assert!(matches!(empty, Err(ApiError::RecordingMalformed { .. })));
}
