//! Logs of GetSensorData, the Android logger of the IPIN competitions: one text line a reading.
//!
//! `ACCE`, `GYRO`, `MAGN`, `PRES`, `WIFI` and `BLE4` lines become samples and `POSI` lines waypoints; the logger's
//! other types carry nothing for positioning. Lines are stamped with the application's clock, in seconds, the one
//! that all sensors share; the sensors' own clocks differ in origin.

mod line;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::Georeference;

use self::line::{Line, Position};
use crate::error::FormatError;
use crate::geojson_plan::georeference_at;
use crate::ilc::{LineFault, LineRejections};
use crate::recording::Record;
use crate::text_lines::{Advance, MAX_LINE_BYTES, TextLines};

/// Streams the records of one GetSensorData log.
///
/// A malformed line is counted in [`rejections`](Self::rejections) and left out. Waypoints are given in degrees; they
/// come in the floor frame of [`with_georeference`](Self::with_georeference), or else in metres east and north of the
/// log's first. Memory is one line, of 64 KiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails or when none of the first 200 lines is of the format.
///
/// # Example
/// ```
/// use fieldwalk::sensor::Reading;
/// use fieldwalk_formats::{Record, get_sensor_data::GetSensorDataReader};
///
/// let text = "% LogFile\nPRES;0.125;9563.5;1013.25;3\n";
/// let records: Vec<Record> = GetSensorDataReader::new(text.as_bytes(), "log.txt").collect::<Result<_, _>>()?;
/// let [Record::Sample(sample)] = records[..] else { unreachable!() };
/// assert_eq!(sample.reading, Reading::Pressure { pressure_hpa: 1013.25 });
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct GetSensorDataReader<R> {
    lines: TextLines<R>,
    name: PathBuf,
    georeference: Option<Georeference>,
    is_in_floor_frame: bool,
    floor_name: Option<String>,
    has_valid_line: bool,
    is_done: bool,
    rejections: LineRejections,
}

/// A file without a valid line among this many, comments apart, is something else.
const MAX_FOREIGN_LINES: u64 = 200;

/// Whether a file that begins with `head` looks like one of this format: comments, or a type of four letters.
pub(crate) fn is_get_sensor_data(head: &[u8]) -> bool {
    let text = head.trim_ascii_start();
    let is_typed = text.get(..4).is_some_and(|kind| kind.iter().all(u8::is_ascii_alphanumeric));
    text.starts_with(b"%") || is_typed && text.get(4) == Some(&b';')
}

impl GetSensorDataReader<BufReader<File>> {
    /// Opens the log at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the log", path, error))?;
        Ok(Self::new(BufReader::with_capacity(MAX_LINE_BYTES, file), path))
    }
}

impl<R: BufRead> GetSensorDataReader<R> {
    /// Reads the log that `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        Self {
            lines: TextLines::new(reader),
            name: name.into(),
            georeference: None,
            is_in_floor_frame: false,
            floor_name: None,
            has_valid_line: false,
            is_done: false,
            rejections: LineRejections::default(),
        }
    }

    /// The same reader, giving waypoints in the frame of the floor that lies at `georeference`.
    #[must_use]
    pub fn with_georeference(mut self, georeference: Georeference) -> Self {
        self.georeference = Some(georeference);
        self.is_in_floor_frame = true;
        self
    }

    /// Whether waypoints are in the frame of a georeferenced floor, not in metres from the first.
    pub fn is_in_floor_frame(&self) -> bool {
        self.is_in_floor_frame
    }

    /// The floor of the first waypoint; known once that has been read.
    ///
    /// The log numbers floors from the ground floor, 0; they are named so that
    /// [`floor_ordinal`](crate::ilc::floor_ordinal) gives that number: `F1` is 0, `F2` is 1, `B1` is -1.
    pub fn floor_name(&self) -> Option<&str> {
        self.floor_name.as_deref()
    }

    /// The lines left out so far.
    pub fn rejections(&self) -> &LineRejections {
        &self.rejections
    }

    /// The record of the current line, if it has one.
    fn record(&mut self) -> Option<Record> {
        let line = self.lines.line().trim_ascii();
        if line.is_empty() || line.starts_with(b"%") {
            return None;
        }
        let parsed = line::parse(line);
        self.has_valid_line |= parsed.is_ok();
        match parsed {
            Ok(Line::Sample(sample)) => Some(Record::Sample(sample)),
            Ok(Line::Position(position)) => Some(self.waypoint(position)),
            Ok(Line::Skipped) => None,
            Err(fault) => {
                self.rejections.add(self.lines.number(), fault);
                None
            }
        }
    }

    fn waypoint(&mut self, position: Position) -> Record {
        let Position { time, latitude_deg, longitude_deg, floor } = position;
        self.floor_name.get_or_insert_with(|| match floor {
            0.. => format!("F{}", floor + 1),
            _ => format!("B{}", -floor),
        });
        let georeference =
            self.georeference.get_or_insert_with(|| georeference_at([latitude_deg, longitude_deg]));
        Record::Waypoint { time, point: georeference.point(latitude_deg, longitude_deg) }
    }

    fn foreign(&self) -> FormatError {
        let (line, cause) = match self.rejections.first() {
            Some((line, fault)) => (line, fault.to_string()),
            None => (self.lines.number().max(1), "no record in it".to_owned()),
        };
        FormatError::malformed(
            format!("not a GetSensorData log: {cause}"),
            "give a text file of the logger, with lines such as `GYRO;0.125;9563.5;0.1;0.2;0.3;3`",
        )
        .at_path(&self.name)
        .at_line(line)
    }
}

impl<R: BufRead> Iterator for GetSensorDataReader<R> {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_done {
            let is_foreign_so_far = !self.has_valid_line;
            if is_foreign_so_far && self.rejections.total() >= MAX_FOREIGN_LINES {
                self.is_done = true;
                return Some(Err(self.foreign()));
            }
            match self.lines.advance() {
                Ok(Advance::Line) => {
                    if let Some(record) = self.record() {
                        return Some(Ok(record));
                    }
                }
                Ok(Advance::TooLong) => self.rejections.add(self.lines.number(), LineFault::TooLong),
                Ok(Advance::End) => {
                    self.is_done = true;
                    return is_foreign_so_far.then(|| Err(self.foreign()));
                }
                Err(error) => {
                    self.is_done = true;
                    let error = FormatError::io("read the log", &self.name, error);
                    return Some(Err(error.at_line(self.lines.number() + 1)));
                }
            }
        }
        None
    }
}
