//! Recordings read a part at a time, as batches.

use std::path::Path;
use std::sync::{Arc, Mutex};

use fieldwalk::floor_plan::Georeference;
use fieldwalk_batch::SampleBatchWriter;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::floor_ordinal;
use fieldwalk_formats::recording::{self, InOrder, Record, RecordSource, open_recording_on};

use crate::building_map::BuildingMap;
use crate::error::{ApiError, api_error, locked};
use crate::recorder::{RecordingDetails, Waypoint};

/// A part of a recording: samples, then the waypoint that comes after them, if one does.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct RecordingPart {
    /// The samples in order of time, as a batch.
    pub samples: Vec<u8>,
    /// How many they are; there may be none.
    pub n_samples: u32,
    /// The waypoint after them.
    pub waypoint: Option<Waypoint>,
}

/// What a recording held, or should have held, and did not give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, uniffi::Record)]
pub struct RecordingLosses {
    /// Whether the file ends before its end: its writer died, or the file was cut short.
    pub was_cut: bool,
    /// Parts left out because they have changed since they were written.
    pub n_corrupt_chunks: u64,
    /// Entries left out because they are not of their kind's form.
    pub n_malformed: u64,
    /// Entries of other programs.
    pub n_foreign_messages: u64,
}

/// Reads a recording of any format that Fieldwalk knows, in order of time and never whole.
#[derive(Debug, uniffi::Object)]
pub struct RecordingReader {
    state: Mutex<State>,
}

struct State {
    log: InOrder<Box<dyn RecordSource + Send>>,
    /// Whether no record is to come.
    is_done: bool,
    /// Why not, until it has been told.
    failed: Option<ApiError>,
}

impl std::fmt::Debug for State {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("State").field("is_done", &self.is_done).finish_non_exhaustive()
    }
}

#[uniffi::export]
impl RecordingReader {
    /// Opens the recording at `path`.
    ///
    /// # Errors
    /// When it does not exist, cannot be read, or is of no format that Fieldwalk knows.
    #[uniffi::constructor]
    pub fn open(path: &str) -> Result<Arc<Self>, ApiError> {
        Self::open_at(Path::new(path), None)
    }

    /// As `open`, for a recording whose waypoints are in degrees: they are placed on the floor of `map` with that
    /// ordinal, which must be georeferenced.
    ///
    /// # Errors
    /// As `open`, and when the map has no such floor.
    #[uniffi::constructor]
    pub fn open_on(path: &str, map: &BuildingMap, floor: i32) -> Result<Arc<Self>, ApiError> {
        Self::open_at(Path::new(path), map.floor(floor)?.map().plan.georeference)
    }

    /// The next samples, `max_samples` at most and at least one, up to the next waypoint; nothing at the end.
    ///
    /// # Errors
    /// When the rest cannot be read; what came before it has been given then, and nothing follows.
    pub fn next_part(&self, max_samples: u32) -> Result<Option<RecordingPart>, ApiError> {
        let mut state = locked(&self.state)?;
        let mut batch = SampleBatchWriter::new();
        let mut waypoint = None;
        while !state.is_done && waypoint.is_none() && batch.n_records() < max_samples.clamp(1, MAX_SAMPLES) {
            match state.log.next() {
                Some(Ok(Record::Sample(sample))) => {
                    batch.push(&sample);
                }
                Some(Ok(Record::Waypoint { time, point })) => {
                    if state.log.source().is_in_floor_frame() {
                        waypoint = Some(Waypoint { time_ns: time.as_nanos(), point: point.into() });
                    } else {
                        state.end(Some(in_degrees()));
                    }
                }
                Some(Err(error)) => state.end(Some(ApiError::of_recording(&error))),
                None => state.end(None),
            }
        }
        if batch.n_records() == 0 && waypoint.is_none() {
            return state.failed.take().map_or(Ok(None), Err);
        }
        let n_samples = batch.n_records();
        Ok(Some(RecordingPart { samples: batch.finish(), n_samples, waypoint }))
    }

    /// What the recording says about itself; known once the first part has been read.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn details(&self) -> Result<RecordingDetails, ApiError> {
        Ok(locked(&self.state)?.log.source().info().into())
    }

    /// The ordinal of the floor that the recording says it was made on; known once all has been read, often earlier.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn floor(&self) -> Result<Option<i32>, ApiError> {
        Ok(locked(&self.state)?.log.source().floor_name().map(floor_ordinal))
    }

    /// What was not given so far.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn losses(&self) -> Result<RecordingLosses, ApiError> {
        Ok(locked(&self.state)?.log.source().losses().into())
    }
}

impl State {
    fn end(&mut self, failed: Option<ApiError>) {
        self.is_done = true;
        self.failed = failed;
    }
}

/// The most samples in a part: about 4 MB.
const MAX_SAMPLES: u32 = 1 << 17;

impl RecordingReader {
    fn open_at(path: &Path, georeference: Option<Georeference>) -> Result<Arc<Self>, ApiError> {
        let log = open_recording_on(path, georeference).map_err(|error| ApiError::of_recording(&error))?;
        Ok(Self::over(log))
    }

    fn over(source: Box<dyn RecordSource + Send>) -> Arc<Self> {
        Arc::new(Self {
            state: Mutex::new(State { log: InOrder::new(source), is_done: false, failed: None }),
        })
    }
}

/// All records of the log at `path`, in order of time; waypoints in degrees are placed by `georeference`.
///
/// # Errors
/// When it cannot be read, or when its waypoints cannot be placed.
pub(crate) fn for_each_record(
    path: &Path,
    georeference: Option<Georeference>,
    mut take: impl FnMut(Record),
) -> Result<Option<i32>, ApiError> {
    let of_recording = |error: FormatError| ApiError::of_recording(&error);
    let mut log = InOrder::new(open_recording_on(path, georeference).map_err(of_recording)?);
    while let Some(record) = log.next() {
        let record = record.map_err(of_recording)?;
        if matches!(record, Record::Waypoint { .. }) && !log.source().is_in_floor_frame() {
            return Err(in_degrees());
        }
        take(record);
    }
    Ok(log.source().floor_name().map(floor_ordinal))
}

fn in_degrees() -> ApiError {
    api_error!(
        RecordingMalformed,
        "the waypoints are in degrees, and the floor is not georeferenced",
        "open it on a map, or survey on a plan, that is drawn in longitude and latitude"
    )
}

impl From<recording::Losses> for RecordingLosses {
    fn from(losses: recording::Losses) -> Self {
        let recording::Losses { was_cut, n_corrupt_chunks, n_malformed, n_foreign_messages } = losses;
        Self { was_cut, n_corrupt_chunks, n_malformed, n_foreign_messages }
    }
}
