//! Recordings written while they happen.

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::sync::{Arc, Mutex};

use fieldwalk::time::Timestamp;
use fieldwalk_batch::SampleBatch;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::recording::{self, Record, RecordingWriter};

use crate::error::{ApiError, api_error, locked};
use crate::fix::Point2;
use crate::samples::take_each;
use crate::status::BatchFaults;

/// Where a recording comes from; what is empty is unknown.
#[derive(Clone, Debug, Default, PartialEq, Eq, uniffi::Record)]
pub struct RecordingDetails {
    /// The device that records, such as `Pixel 8`.
    #[uniffi(default = "")]
    pub device: String,
    /// The app that records, and its version.
    #[uniffi(default = "")]
    pub software: String,
    /// The floor walked, as its map names it.
    #[uniffi(default = "")]
    pub floor: String,
    /// When the recording started, in milliseconds since 1970 UTC.
    #[uniffi(default = None)]
    pub start_unix_ms: Option<i64>,
}

/// A place at which the walker said to be.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Waypoint {
    /// When, on the clock of the samples, in nanoseconds.
    pub time_ns: i64,
    /// Where, in the floor's frame.
    pub point: Point2,
}

/// How a recording fares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, uniffi::Record)]
pub struct RecorderStatus {
    /// Samples written.
    pub n_samples: u64,
    /// Waypoints written.
    pub n_waypoints: u64,
    /// Bytes that still wait in memory: what a crash of the app would take.
    pub n_waiting_bytes: u64,
    /// Records of batches that gave no sample, by cause.
    pub batch_faults: BatchFaults,
    /// Whether the recording has been finished.
    pub is_finished: bool,
}

/// Writes a recording, an MCAP file, so that a crash costs a second of it at most.
///
/// What was written stays readable wherever the file ends. An object that is closed without `finish` leaves such a
/// file too.
#[derive(Debug, uniffi::Object)]
pub struct Recorder {
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    open: Option<Open>,
    status: RecorderStatus,
}

#[derive(Debug)]
struct Open {
    writer: RecordingWriter<File>,
    /// The same file, to have its content brought to the disk.
    file: File,
}

#[uniffi::export]
impl Recorder {
    /// Starts a recording in a new file at `path`.
    ///
    /// # Errors
    /// When there is a file already, when the operating system refuses, and when there is no room.
    #[uniffi::constructor(default(details))]
    pub fn new(path: &str, details: RecordingDetails) -> Result<Arc<Self>, ApiError> {
        let path = Path::new(path);
        let file = OpenOptions::new().write(true).create_new(true).open(path);
        Self::over(file.map_err(|error| refused(path, error))?, path, details)
    }

    /// Adds the samples of a batch, as they are: what no sensor gives is kept too, and refused when it is replayed.
    ///
    /// # Errors
    /// When `batch` is no sample batch, is torn or is too new: nothing of it is written then. When there is no room or
    /// writing fails: the samples before that are written, and every later call fails too. After `finish`.
    pub fn push_samples(&self, batch: &[u8]) -> Result<(), ApiError> {
        let batch = SampleBatch::new(batch)?;
        let mut state = locked(&self.state)?;
        let State { open, status } = &mut *state;
        let Open { writer, .. } = open.as_mut().ok_or_else(finished)?;
        let RecorderStatus { n_samples, batch_faults, .. } = status;
        take_each(&batch, batch_faults, |sample| {
            writer.write(&Record::Sample(sample))?;
            *n_samples += 1;
            Ok(())
        })
        .map_err(|error: FormatError| ApiError::of_writing(&error))
    }

    /// Adds a waypoint.
    ///
    /// # Errors
    /// When there is no room or writing fails, and after `finish`.
    pub fn push_waypoint(&self, waypoint: Waypoint) -> Result<(), ApiError> {
        let Waypoint { time_ns, point } = waypoint;
        let mut state = locked(&self.state)?;
        let State { open, status } = &mut *state;
        let Open { writer, .. } = open.as_mut().ok_or_else(finished)?;
        let record = Record::Waypoint { time: Timestamp::from_nanos(time_ns), point: point.into() };
        writer.write(&record).map_err(|error| ApiError::of_writing(&error))?;
        status.n_waypoints += 1;
        Ok(())
    }

    /// Brings all that was added to the disk, where a loss of power does not take it either: for when the app goes to
    /// the background.
    ///
    /// # Errors
    /// When there is no room or writing fails, and after `finish`.
    pub fn flush(&self) -> Result<(), ApiError> {
        let mut state = locked(&self.state)?;
        let Open { writer, file } = state.open.as_mut().ok_or_else(finished)?;
        writer.flush().map_err(|error| ApiError::of_writing(&error))?;
        file.sync_data().map_err(|error| refused(Path::new(""), error))
    }

    /// Ends the recording and brings it to the disk; nothing can be added any more.
    ///
    /// # Errors
    /// When there is no room or writing fails: what was written so far stays readable. After `finish`.
    pub fn finish(&self) -> Result<RecorderStatus, ApiError> {
        let mut state = locked(&self.state)?;
        let Open { writer, file } = state.open.take().ok_or_else(finished)?;
        state.status.is_finished = true;
        writer.finish().map_err(|error| ApiError::of_writing(&error))?;
        file.sync_all().map_err(|error| refused(Path::new(""), error))?;
        Ok(state.status)
    }

    /// What was written so far.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn status(&self) -> Result<RecorderStatus, ApiError> {
        let state = locked(&self.state)?;
        let n_waiting_bytes = state.open.as_ref().map_or(0, |open| open.writer.n_buffered_bytes() as u64);
        Ok(RecorderStatus { n_waiting_bytes, ..state.status })
    }
}

impl Recorder {
    fn over(file: File, path: &Path, details: RecordingDetails) -> Result<Arc<Self>, ApiError> {
        let RecordingDetails { device, software, floor, start_unix_ms } = details;
        let info = recording::RecordingInfo { device, software, floor, start_unix_ms };
        let again = file.try_clone().map_err(|error| refused(path, error))?;
        let writer = RecordingWriter::new(file, path, &info).map_err(|error| ApiError::of_writing(&error))?;
        let open = Some(Open { writer, file: again });
        Ok(Arc::new(Self { state: Mutex::new(State { open, status: RecorderStatus::default() }) }))
    }
}

fn refused(path: &Path, error: std::io::Error) -> ApiError {
    ApiError::of_writing(&FormatError::io("write the recording", path, error))
}

fn finished() -> ApiError {
    api_error!(Finished, "the recording has been finished", "start another one")
}

impl From<recording::RecordingInfo> for RecordingDetails {
    fn from(info: recording::RecordingInfo) -> Self {
        let recording::RecordingInfo { device, software, floor, start_unix_ms } = info;
        Self { device, software, floor, start_unix_ms }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_is_told_apart_at_the_first_chunk_and_from_then_on() {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let refusal = match Recorder::over(full, Path::new("/dev/full"), RecordingDetails::default()) {
            Err(refusal) => refusal,
            Ok(_) => panic!("a full disk took a recording"),
        };
        assert!(matches!(refusal, ApiError::StorageFull { .. }), "{refusal}");
    }
}
