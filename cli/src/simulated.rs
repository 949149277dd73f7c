//! Simulated walks as files: the recording, and the truth beside it.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Read as _;
use std::path::Path;

use fieldwalk::geometry::Point2;
use fieldwalk::survey::Waypoint;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::recording::{Record, RecordingInfo, RecordingWriter};
use fieldwalk_sim::scenario::Recorded;

use crate::evaluation::{PointKind, TestWalk, TruthPoint};
use crate::report::Truth;

/// The first line of a truth.
const TRUTH_HEADER: &str = "time_ns,x_m,y_m,heading_rad,floor";
/// A larger truth is refused, in bytes: more than a day's.
const MAX_TRUTH_BYTES: u64 = 100_000_000;

/// What a floor is called.
pub fn floor_name(ordinal: i32) -> String {
    format!("F{}", ordinal + 1)
}

/// Writes what the phone recorded as MCAP, with the waypoints of the floor where the walk begins, whose name it tells.
pub fn write_recording(recorded: &Recorded, path: &Path) -> Result<(), FormatError> {
    let info = RecordingInfo {
        device: "simulated".into(),
        software: concat!("fieldwalk ", env!("CARGO_PKG_VERSION")).into(),
        floor: floor_name(first_floor(recorded)),
        start_unix_ms: None,
    };
    let mut writer = RecordingWriter::create(path, &info)?;
    for record in records(recorded) {
        writer.write(&record)?;
    }
    writer.finish()
}

fn first_floor(recorded: &Recorded) -> i32 {
    recorded.truth.first().map_or(0, |truth| truth.floor)
}

/// In order of time, a waypoint after the samples of its instant.
fn records(recorded: &Recorded) -> Vec<Record> {
    let samples = recorded.samples.iter().map(|&sample| Record::Sample(sample));
    let is_on_floor =
        |time| recorded.truth_at(time).is_some_and(|truth| truth.floor == first_floor(recorded));
    let waypoints = recorded.waypoints.iter().filter(|waypoint| is_on_floor(waypoint.time));
    let waypoints = waypoints.map(|waypoint| Record::Waypoint { time: waypoint.time, point: waypoint.point });
    let mut records: Vec<Record> = samples.chain(waypoints).collect();
    records.sort_by_key(Record::time);
    records
}

/// Writes where the walker truly was: `time_ns,x_m,y_m,heading_rad,floor`, ten lines a second.
pub fn write_truth(recorded: &Recorded, path: &Path) -> Result<(), FormatError> {
    let mut text = format!("{TRUTH_HEADER}\n");
    for truth in &recorded.truth {
        let (time_ns, position) = (truth.time.as_nanos(), truth.position);
        let (heading_rad, floor) = (truth.heading_rad, truth.floor);
        let _ = writeln!(text, "{time_ns},{},{},{heading_rad},{floor}", position.x_m, position.y_m);
    }
    fs::write(path, text).map_err(|error| FormatError::io("write the truth", path, error))
}

/// The truth that was written beside `recording`, as far as it is on `floor`, in order of time; nothing where there is
/// none.
///
/// # Errors
/// When there is one that cannot be read, or that is not as [`write_truth`] writes it.
pub fn read_truth(recording: &Path, floor: i32) -> Result<Option<Vec<(Timestamp, Point2)>>, FormatError> {
    let path = recording.with_extension("truth.csv");
    if !path.exists() {
        return Ok(None);
    }
    let failed = |error| FormatError::io("read the truth", &path, error);
    let mut text = String::new();
    let file = File::open(&path).map_err(failed)?;
    file.take(MAX_TRUTH_BYTES + 1).read_to_string(&mut text).map_err(failed)?;
    parse_truth(&text, floor).map(Some).map_err(|error| error.at_path(&path))
}

/// The recording, its fixes to be scored once a second from `first_scored_s` on against the simulator's truth; nothing
/// when there is no truth.
pub fn test_walk(recorded: Recorded, first_scored_s: i64) -> Option<TestWalk> {
    let (first, last) = (*recorded.truth.first()?, *recorded.truth.last()?);
    let truth = (first_scored_s..)
        .map(|after_s| first.time + Duration::from_millis(1_000 * after_s))
        .take_while(|&time| time <= last.time)
        .filter_map(|time| recorded.truth_at(time))
        .map(|truth| TruthPoint { kind: PointKind::Truth, time: truth.time, point: truth.position })
        .collect();
    let start = Waypoint { time: first.time, point: first.position };
    let line = Truth::continuous(recorded.truth.iter().map(|truth| (truth.time, truth.position)));
    Some(TestWalk { samples: recorded.samples, start, truth, line })
}

fn parse_truth(text: &str, floor: i32) -> Result<Vec<(Timestamp, Point2)>, FormatError> {
    let remedy = "simulate the walk anew, or remove the file: waypoints then are the truth";
    if text.len() as u64 > MAX_TRUTH_BYTES {
        return Err(FormatError::malformed("more than a day of truth", remedy));
    }
    let mut lines = text.lines();
    if lines.next() != Some(TRUTH_HEADER) {
        return Err(FormatError::malformed("its first line is not that of a truth", remedy));
    }
    let mut truth: Vec<(Timestamp, Point2)> = Vec::new();
    let mut last = None;
    for (line, number) in lines.zip(2..) {
        let mut fields = line.split(',');
        let time = fields.next().and_then(|field| field.parse().ok()).map(Timestamp::from_nanos);
        let mut metres = || fields.next()?.parse().ok().filter(|m: &f64| m.is_finite());
        let place = metres().zip(metres()).map(|(x_m, y_m)| Point2::new(x_m, y_m));
        let on_floor = fields.nth(1).and_then(|field| field.parse::<i32>().ok());
        match time.filter(|&time| last.is_none_or(|last| last < time)).zip(place).zip(on_floor) {
            Some((now, on_floor)) => {
                last = time;
                if on_floor == floor {
                    truth.push(now);
                }
            }
            None => {
                let message = "not a later time in nanoseconds with a place in metres and a floor";
                return Err(FormatError::malformed(message, remedy).at_line(number));
            }
        }
    }
    Ok(truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_truth_is_read_and_a_broken_one_is_located() {
        let text = |lines: &str| format!("{TRUTH_HEADER}\n{lines}");
        let truth = parse_truth(&text("5,1.5,2.5,0,1\n6,9,9,0,0\n7,-1,0.25,3.1,1\n"), 1).unwrap();
        let point = |ns, x_m, y_m| (Timestamp::from_nanos(ns), Point2::new(x_m, y_m));
        assert_eq!(truth, [point(5, 1.5, 2.5), point(7, -1.0, 0.25)]);
        assert_eq!(parse_truth(&text(""), 0).unwrap(), []);
        for second in ["5,1,2,0,0", "6,NaN,2,0,0", "6,1", "6,1,2,0", "\n6,1,2,0,0"] {
            let broken = format!("5,1,2,0,0\n{second}");
            let error = parse_truth(&text(&broken), 0).unwrap_err();
            assert!(error.to_string().contains("line 3"), "{error}");
        }
        assert!(parse_truth("time,x,y", 0).is_err());
    }
}
