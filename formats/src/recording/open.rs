//! Logs of any kind that this crate reads, told apart by their content.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use fieldwalk::floor_plan::Georeference;

use super::{Losses, Record, RecordingInfo, RecordingReader};
use crate::error::FormatError;
use crate::get_sensor_data::{GetSensorDataReader, is_get_sensor_data};
use crate::ilc::{LineRejections, TraceReader};
use crate::sensor_logger::{SensorLoggerReader, is_export, is_json};
use crate::uji_mag::{UjiMagReader, is_uji_mag};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// A column that all the CSV files of an export of Sensor Logger have.
const LOGGER_COLUMN: &[u8] = b"seconds_elapsed";

/// A log of any format: a stream of records, and what there is to know about it.
pub trait RecordSource: Iterator<Item = Result<Record, FormatError>> {
    /// The floor that the log says it was taken on, as [`floor_ordinal`](crate::ilc::floor_ordinal) understands it;
    /// known once the first record has been read.
    fn floor_name(&self) -> Option<&str>;

    /// What was not handed out so far.
    fn losses(&self) -> Losses;

    /// The lines left out so far, by cause; `None` for a log that is no text. [`Losses::n_malformed`] is their number.
    fn line_rejections(&self) -> Option<&LineRejections> {
        None
    }

    /// What the log says about itself; known once the first record has been read.
    fn info(&self) -> RecordingInfo {
        RecordingInfo { floor: self.floor_name().unwrap_or_default().to_owned(), ..RecordingInfo::default() }
    }

    /// Whether waypoints are in the floor's frame; otherwise they are in metres east and north of the first.
    fn is_in_floor_frame(&self) -> bool {
        true
    }
}

/// Opens the log at `path`, whichever format it is in: an MCAP recording, a text trace of the
/// indoor-location-competition-20 collection, a GetSensorData log, an export of Sensor Logger, JSON or a folder of CSV,
/// or a walk of UJIIndoorLoc-Mag.
///
/// Records come in the file's order, which is that of arrival: see [`InOrder`](super::InOrder).
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
    open_recording_on(path, None)
}

/// As [`open_recording`], where waypoints that are given in degrees are placed on the floor at `georeference`.
///
/// # Errors
/// As [`open_recording`].
pub fn open_recording_on(
    path: &Path,
    georeference: Option<Georeference>,
) -> Result<Box<dyn RecordSource + Send>, FormatError> {
    let failed = |error| FormatError::io("open the recording", path, error);
    if path.is_dir() {
        if !is_export(path) {
            let message = "a folder that is no export of Sensor Logger";
            return Err(FormatError::malformed(
                message,
                "give a recording, or a folder with the app's CSV files",
            )
            .at_path(path));
        }
        return Ok(Box::new(SensorLoggerReader::open(path)?));
    }
    let file = File::open(path).map_err(failed)?;
    let mut reader = BufReader::with_capacity(64 * 1024, file);
    let head = reader.fill_buf().map_err(failed)?;
    if head.is_empty() {
        return Err(FormatError::malformed("an empty file", "give a recording").at_path(path));
    }
    // What some editors put before a text. JSON is opened anew, and its reader knows it.
    if head.starts_with(BYTE_ORDER_MARK) && !is_json(head) {
        reader.consume(BYTE_ORDER_MARK.len());
    }
    let head = reader.fill_buf().map_err(failed)?;
    let first_line = head.split(|&byte| byte == b'\n').next().unwrap_or_default();
    if first_line.windows(LOGGER_COLUMN.len()).any(|bytes| bytes == LOGGER_COLUMN) && !is_json(head) {
        let message = "one file of an export of Sensor Logger";
        return Err(FormatError::malformed(message, "give its folder").at_path(path));
    }
    let n_compared = head.len().min(mcap::MAGIC.len());
    if head.starts_with(b"PK") {
        let message = "a zip archive";
        return Err(FormatError::malformed(message, "unpack it, and give the folder").at_path(path));
    }
    if is_json(head) {
        return Ok(Box::new(SensorLoggerReader::open(path)?));
    }
    Ok(if head[..n_compared] == mcap::MAGIC[..n_compared] {
        Box::new(RecordingReader::new(reader, path))
    } else if is_get_sensor_data(head) {
        let log = GetSensorDataReader::new(reader, path);
        Box::new(match georeference {
            Some(georeference) => log.with_georeference(georeference),
            None => log,
        })
    } else if is_uji_mag(head) {
        let walk = UjiMagReader::new(reader, path);
        Box::new(match georeference {
            Some(georeference) => walk.with_georeference(georeference),
            None => walk,
        })
    } else {
        Box::new(TraceReader::new(reader, path).guessing())
    })
}

impl<R: Read> RecordSource for RecordingReader<R> {
    fn floor_name(&self) -> Option<&str> {
        self.info().map(|info| info.floor.as_str()).filter(|floor| !floor.is_empty())
    }

    fn losses(&self) -> Losses {
        *RecordingReader::losses(self)
    }

    fn info(&self) -> RecordingInfo {
        RecordingReader::info(self).cloned().unwrap_or_default()
    }
}

impl<R: BufRead> RecordSource for TraceReader<R> {
    fn info(&self) -> RecordingInfo {
        TraceReader::info(self).clone()
    }

    fn floor_name(&self) -> Option<&str> {
        TraceReader::floor_name(self)
    }

    fn losses(&self) -> Losses {
        Losses { n_malformed: self.rejections().total(), ..Losses::default() }
    }

    fn line_rejections(&self) -> Option<&LineRejections> {
        Some(self.rejections())
    }
}

impl<R: BufRead> RecordSource for GetSensorDataReader<R> {
    fn floor_name(&self) -> Option<&str> {
        GetSensorDataReader::floor_name(self)
    }

    fn losses(&self) -> Losses {
        Losses { n_malformed: self.rejections().total(), ..Losses::default() }
    }

    fn line_rejections(&self) -> Option<&LineRejections> {
        Some(self.rejections())
    }

    fn is_in_floor_frame(&self) -> bool {
        GetSensorDataReader::is_in_floor_frame(self)
    }
}

impl<R: BufRead> RecordSource for UjiMagReader<R> {
    fn floor_name(&self) -> Option<&str> {
        None
    }

    fn losses(&self) -> Losses {
        Losses { n_malformed: self.rejections().total(), ..Losses::default() }
    }

    fn line_rejections(&self) -> Option<&LineRejections> {
        Some(self.rejections())
    }

    fn is_in_floor_frame(&self) -> bool {
        UjiMagReader::is_in_floor_frame(self)
    }
}
