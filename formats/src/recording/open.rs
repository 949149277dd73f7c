//! Logs of any kind that this crate reads, told apart by their content.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::{Losses, Record, RecordingReader};
use crate::error::FormatError;
use crate::get_sensor_data::{GetSensorDataReader, is_get_sensor_data};
use crate::ilc::TraceReader;

/// A log of any format: a stream of records, and what there is to know about it.
pub trait RecordSource: Iterator<Item = Result<Record, FormatError>> {
    /// The floor that the log says it was taken on; known once the first record has been read.
    fn floor_name(&self) -> Option<&str>;

    /// What was not handed out so far.
    fn losses(&self) -> Losses;
}

/// Opens the log at `path`, whichever format it is in: an MCAP recording, a text trace of the
/// indoor-location-competition-20 collection, or a GetSensorData log.
///
/// # Errors
/// When the file cannot be opened, or is empty. What is of no such format gives an error as the first record is read.
///
/// # Example
/// ```no_run
/// let mut log = fieldwalk_formats::open_recording("walk.mcap".as_ref())?;
/// for record in log.by_ref() {
///     println!("{:?}", record?);
/// }
/// println!("{}", log.losses());
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
pub fn open_recording(path: &Path) -> Result<Box<dyn RecordSource + Send>, FormatError> {
    let failed = |error| FormatError::io("open the recording", path, error);
    let file = File::open(path).map_err(failed)?;
    let mut reader = BufReader::with_capacity(64 * 1024, file);
    let head = reader.fill_buf().map_err(failed)?;
    if head.is_empty() {
        return Err(FormatError::malformed("an empty file", "give a recording").at_path(path));
    }
    let n_compared = head.len().min(mcap::MAGIC.len());
    Ok(if head[..n_compared] == mcap::MAGIC[..n_compared] {
        Box::new(RecordingReader::new(reader, path))
    } else if is_get_sensor_data(head) {
        Box::new(GetSensorDataReader::new(reader, path))
    } else {
        Box::new(TraceReader::new(reader, path))
    })
}

impl<R: Read> RecordSource for RecordingReader<R> {
    fn floor_name(&self) -> Option<&str> {
        self.info().map(|info| info.floor.as_str()).filter(|floor| !floor.is_empty())
    }

    fn losses(&self) -> Losses {
        *RecordingReader::losses(self)
    }
}

impl<R: BufRead> RecordSource for TraceReader<R> {
    fn floor_name(&self) -> Option<&str> {
        TraceReader::floor_name(self)
    }

    fn losses(&self) -> Losses {
        Losses { n_malformed: self.rejections().total(), ..Losses::default() }
    }
}

impl<R: BufRead> RecordSource for GetSensorDataReader<R> {
    fn floor_name(&self) -> Option<&str> {
        GetSensorDataReader::floor_name(self)
    }

    fn losses(&self) -> Losses {
        Losses { n_malformed: self.rejections().total(), ..Losses::default() }
    }
}
