//! Exports of Sensor Logger, the app by Kelvin Choi for Android and iOS: a folder of CSV files, or one JSON file.
//!
//! `TotalAcceleration`, or `Accelerometer` and `Gravity`, or `AccelerometerUncalibrated`, whichever comes first, become
//! the specific force; `Gyroscope`, `Magnetometer`, `Barometer`, `Bluetooth` and `WiFi` become samples. An `Annotation` whose
//! text is a place, such as `12.5, 40` (metres in the floor frame), is a waypoint; another with a digit counts as rejected.
//! The app's other sensors carry nothing for positioning.
//!
//! * **Units and signs.** `Accelerometer` (which has gravity removed), `Gravity` and `TotalAcceleration` are in m/s². iOS
//!   gives them, and `AccelerometerUncalibrated`, the opposite sign of Android, and the latter in g, unless the setting
//!   "Standardise Units & Frames" was on: the export's metadata say which. Where they do not say it, the export is
//!   refused, for a wrong sign would put the phone upside down.
//! * **Gravity** is taken from the last row up to 20 ms before the acceleration; iOS stamps both alike.
//! * **Hard iron.** The app does not log the bias that the system has estimated, so `MagnetometerUncalibrated` is of no
//!   use: it is passed over, and where there is no `Magnetometer` beside it, its rows are counted.
//! * **Identities.** iOS hides the addresses of Bluetooth devices: such rows are left out and counted. An iBeacon, which
//!   only Android shows, is known by its UUID, major and minor.
//!
//! # Source
//! `UNITS.md`, `COORDINATES.md` and `CROSSPLATFORM.md` of the app's repository, `tszheichoi/awesome-sensor-logger`.

mod convention;
mod convert;
mod csv_rows;
mod entry;
mod files;
mod json_elements;
mod lanes;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::convert::{Converted, Converter};
use self::files::{Disk, Files, Memory};
use self::lanes::Lanes;
use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::recording::{Losses, Record, RecordSource, RecordingInfo};

/// Streams the records of one export of Sensor Logger, merged by time.
///
/// A malformed row is counted in [`line_rejections`](RecordSource::line_rejections), by its number in its file, and left
/// out. Memory is 8 KiB for each file of a folder or each group of a JSON file's entries, 1024 of them at most, and one
/// row of 64 KiB at most; a JSON file whose sensors are mixed more finely comes in its own order.
///
/// # Errors
/// An item is an error, and the last one, when reading fails.
#[derive(Debug)]
pub struct SensorLoggerReader {
    lanes: Lanes,
    converter: Converter,
    info: RecordingInfo,
    rejections: LineRejections,
    is_done: bool,
}

/// The file that names the platform.
const METADATA_FILE: &str = "Metadata.csv";

impl SensorLoggerReader {
    /// Opens the export at `path`: a folder of CSV files, or a JSON file.
    ///
    /// # Errors
    /// When it cannot be read, is no export of the app, or does not tell the sign of its accelerations.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let (files, is_folder) = Disk::open(path)?;
        Self::of(Arc::new(files), is_folder, path)
    }

    /// Reads an export in memory: the files of a folder with their names, or one file of JSON, called `*.json`. `name`
    /// stands for it in errors.
    ///
    /// # Errors
    /// As [`SensorLoggerReader::open`].
    pub fn in_memory(files: Vec<(String, Vec<u8>)>, name: impl Into<PathBuf>) -> Result<Self, FormatError> {
        let is_json = matches!(&files[..], [(name, _)] if name.ends_with(".json"));
        Self::of(Arc::new(Memory(files)), !is_json, &name.into())
    }

    fn of(files: Arc<dyn Files>, is_folder: bool, name: &Path) -> Result<Self, FormatError> {
        let (lanes, metadata) = match is_folder {
            true => Lanes::of_folder(&files),
            false => Lanes::of_json(&files),
        }
        .map_err(|error| if error.path().is_some() { error } else { error.at_path(name) })?;
        let is_present = |sensor| lanes.has(sensor);
        if !entry::Sensor::ALL.into_iter().any(is_present) {
            let message = "not an export of Sensor Logger: none of its sensors is in it";
            let remedy = "give a folder of the app's CSV files, or its JSON file";
            return Err(FormatError::malformed(message, remedy).at_path(name));
        }
        let convention = convention::of(&metadata, is_present).map_err(|error| error.at_path(name))?;
        let mut rejections = LineRejections::default();
        for _ in 0..lanes.n_refused() {
            rejections.add(0, LineFault::FieldCount);
        }
        let info = metadata.info();
        let converter = Converter::new(convention, lanes.has(entry::Sensor::Magnetometer));
        Ok(Self { lanes, converter, info, rejections, is_done: false })
    }
}

impl Iterator for SensorLoggerReader {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_done {
            match self.lanes.next() {
                Ok(Some((row, Ok(entry)))) => match self.converter.convert(&entry) {
                    Converted::Record(record) => return Some(Ok(record)),
                    Converted::Nothing => {}
                    Converted::Rejected(fault) => self.rejections.add(row, fault),
                },
                Ok(Some((row, Err(fault)))) => self.rejections.add(row, fault),
                Ok(None) => self.is_done = true,
                Err(error) => {
                    self.is_done = true;
                    return Some(Err(error));
                }
            }
        }
        None
    }
}

impl RecordSource for SensorLoggerReader {
    fn floor_name(&self) -> Option<&str> {
        None
    }

    fn losses(&self) -> Losses {
        Losses { was_cut: self.lanes.was_cut(), n_malformed: self.rejections.total(), ..Losses::default() }
    }

    fn line_rejections(&self) -> Option<&LineRejections> {
        Some(&self.rejections)
    }

    fn info(&self) -> RecordingInfo {
        self.info.clone()
    }
}

/// Whether the folder `dir` is an export: it has the app's metadata, or one of its sensors' files.
pub fn is_export(dir: &Path) -> bool {
    dir.join(METADATA_FILE).is_file()
        || entry::Sensor::ALL.into_iter().any(|sensor| dir.join(format!("{}.csv", sensor.name())).is_file())
}

/// Whether a file that begins with `head` looks like JSON.
pub(crate) fn is_json(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    matches!(head.first(), Some(b'[' | b'{'))
}
