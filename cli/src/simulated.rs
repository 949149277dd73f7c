//! Simulated walks as files: the recording, and the truth beside it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use fieldwalk_formats::FormatError;
use fieldwalk_formats::recording::{Record, RecordingInfo, RecordingWriter};
use fieldwalk_sim::scenario::Recorded;

/// Writes what the phone recorded, with its waypoints, as MCAP; the floor is called `floor`.
pub fn write_recording(recorded: &Recorded, floor: &str, path: &Path) -> Result<(), FormatError> {
    let info = RecordingInfo {
        device: "simulated".into(),
        software: concat!("fieldwalk ", env!("CARGO_PKG_VERSION")).into(),
        floor: floor.into(),
        start_unix_ms: None,
    };
    let mut writer = RecordingWriter::create(path, &info)?;
    for record in records(recorded) {
        writer.write(&record)?;
    }
    writer.finish()
}

/// In order of time, a waypoint after the samples of its instant.
fn records(recorded: &Recorded) -> Vec<Record> {
    let samples = recorded.samples.iter().map(|&sample| Record::Sample(sample));
    let waypoints = recorded.waypoints.iter();
    let waypoints = waypoints.map(|waypoint| Record::Waypoint { time: waypoint.time, point: waypoint.point });
    let mut records: Vec<Record> = samples.chain(waypoints).collect();
    records.sort_by_key(Record::time);
    records
}

/// Writes where the walker truly was: `time_ns,x_m,y_m,heading_rad`, ten lines a second.
pub fn write_truth(recorded: &Recorded, path: &Path) -> Result<(), FormatError> {
    let mut text = String::from("time_ns,x_m,y_m,heading_rad\n");
    for truth in &recorded.truth {
        let (time_ns, position) = (truth.time.as_nanos(), truth.position);
        let _ = writeln!(text, "{time_ns},{},{},{}", position.x_m, position.y_m, truth.heading_rad);
    }
    fs::write(path, text).map_err(|error| FormatError::io("write the truth", path, error))
}
