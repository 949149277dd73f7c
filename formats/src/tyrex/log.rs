//! The phones' text logs: one reading a line, numbers set apart by spaces, seconds first.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::str;

use fieldwalk::gravity::STANDARD_GRAVITY_M_S2;
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::{Duration, Timestamp};

use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::text_lines::{Advance, MAX_LINE_BYTES, TextLines};

/// Whose sensors, and so whose signs and units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Platform {
    /// m/s², rad/s and µT in the device frame; raw rates and fields come with the system's bias.
    Android,
    /// Acceleration in units of g and of the opposite sign; rad/s and µT in the same device frame.
    Ios,
}

/// What a log holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LogKind {
    /// `accelerometer.txt`.
    SpecificForce,
    /// `gyroscope.txt`; on Android, the system's bias is taken off.
    AngularRate,
    /// On Android `magnetometer.txt`, raw with the system's bias; on iOS `magnetometer-calibrated.txt`, without the
    /// lines that the system calls uncalibrated.
    MagneticField,
    /// `magnetometer.txt`: on Android the same as [`MagneticField`](Self::MagneticField), on iOS the field without any
    /// correction, whose bias the log does not tell and is read as 0.
    RawMagneticField,
}

/// Streams the samples of one log.
///
/// A malformed line is counted in [`rejections`](Self::rejections) and left out. Memory is one line, of 64 KiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails or when none of the first 200 lines is of the format.
#[derive(Debug)]
pub struct SensorLogReader<R> {
    lines: TextLines<R>,
    name: PathBuf,
    platform: Platform,
    kind: LogKind,
    capture_from_phone_s: f64,
    has_valid_line: bool,
    is_done: bool,
    rejections: LineRejections,
}

/// A file without a valid line among this many is something else.
const MAX_FOREIGN_LINES: u64 = 200;

/// Three years: phones count from their start or from the log's.
const MAX_TIME_S: f64 = 1e8;

/// The most numbers of a line.
const MAX_COLUMNS: usize = 7;

/// Specific force in m/s² from what iOS calls acceleration, in units of g.
///
/// At rest iOS reports -1 on the axis that points up, the rest of this project +9.81 m/s².
pub fn specific_force_of_ios(acceleration_g: [f32; 3]) -> [f32; 3] {
    acceleration_g.map(|c| -STANDARD_GRAVITY_M_S2 * c)
}

impl LogKind {
    /// The kinds that every trial has.
    pub const ALL: [Self; 3] = [Self::AngularRate, Self::SpecificForce, Self::MagneticField];

    /// The log's file name.
    pub fn file_name(self, platform: Platform) -> &'static str {
        match (self, platform) {
            (Self::SpecificForce, _) => "accelerometer.txt",
            (Self::AngularRate, _) => "gyroscope.txt",
            (Self::MagneticField, Platform::Android) | (Self::RawMagneticField, _) => "magnetometer.txt",
            (Self::MagneticField, Platform::Ios) => "magnetometer-calibrated.txt",
        }
    }

    fn n_columns(self, platform: Platform) -> usize {
        match (self, platform) {
            (Self::SpecificForce, _) | (Self::AngularRate | Self::RawMagneticField, Platform::Ios) => 4,
            (Self::MagneticField, Platform::Ios) => 5,
            (_, Platform::Android) => MAX_COLUMNS,
        }
    }
}

impl SensorLogReader<BufReader<File>> {
    /// Opens the log at `path`; `capture_from_phone_s` is added to its times.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(
        path: &Path,
        platform: Platform,
        kind: LogKind,
        capture_from_phone_s: f64,
    ) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the log", path, error))?;
        Ok(Self::new(
            BufReader::with_capacity(MAX_LINE_BYTES, file),
            path,
            platform,
            kind,
            capture_from_phone_s,
        ))
    }
}

impl<R: BufRead> SensorLogReader<R> {
    /// Reads the log that `reader` gives; `name` stands for it in errors.
    pub fn new(
        reader: R,
        name: impl Into<PathBuf>,
        platform: Platform,
        kind: LogKind,
        capture_from_phone_s: f64,
    ) -> Self {
        Self {
            lines: TextLines::new(reader),
            name: name.into(),
            platform,
            kind,
            capture_from_phone_s,
            has_valid_line: false,
            is_done: false,
            rejections: LineRejections::default(),
        }
    }

    /// The lines left out so far.
    pub fn rejections(&self) -> &LineRejections {
        &self.rejections
    }

    /// The current line's sample; nothing for an empty line and one that the system calls uncalibrated.
    fn parse(&self) -> Result<Option<Sample>, LineFault> {
        let mut columns = [0.0; MAX_COLUMNS];
        let n_columns = self.kind.n_columns(self.platform);
        let mut n = 0;
        let fields = self.lines.line().split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
        for field in fields {
            let text = str::from_utf8(field).map_err(|_| LineFault::NotUtf8)?;
            let number: f64 = text.parse().map_err(|_| LineFault::Number)?;
            if !number.is_finite() {
                return Err(LineFault::NotFinite);
            }
            *columns.get_mut(n).ok_or(LineFault::FieldCount)? = number;
            n += 1;
        }
        if n == 0 {
            return Ok(None);
        }
        if n != n_columns {
            return Err(LineFault::FieldCount);
        }
        let time_s = columns[0] + self.capture_from_phone_s;
        if time_s.is_nan() || time_s.abs() > MAX_TIME_S {
            return Err(LineFault::Time);
        }
        let vector = |from: usize| [0, 1, 2].map(|c| columns[from + c] as f32);
        let (first, second) = (vector(1), vector(4));
        let reading = match (self.kind, self.platform) {
            (LogKind::SpecificForce, Platform::Android) => Reading::SpecificForce(first),
            (LogKind::SpecificForce, Platform::Ios) => Reading::SpecificForce(specific_force_of_ios(first)),
            (LogKind::AngularRate, Platform::Ios) => Reading::AngularRate(first),
            (LogKind::AngularRate, Platform::Android) => {
                Reading::AngularRate([0, 1, 2].map(|c| first[c] - second[c]))
            }
            (LogKind::MagneticField | LogKind::RawMagneticField, Platform::Android) => {
                Reading::UncalibratedMagneticField { field_ut: first, bias_ut: second }
            }
            (LogKind::RawMagneticField, Platform::Ios) => {
                Reading::UncalibratedMagneticField { field_ut: first, bias_ut: [0.0; 3] }
            }
            // The system's class of accuracy: -1 before it has calibrated.
            (LogKind::MagneticField, Platform::Ios) if columns[4] < 0.0 => return Ok(None),
            (LogKind::MagneticField, Platform::Ios) => Reading::MagneticField(first),
        };
        let sample = Sample { time: Timestamp::default() + Duration::from_secs_f64(time_s), reading };
        if sample.is_plausible() { Ok(Some(sample)) } else { Err(LineFault::OutOfRange) }
    }

    fn foreign(&self) -> FormatError {
        let (line, cause) = match self.rejections.first() {
            Some((line, fault)) => (line, fault.to_string()),
            None => (self.lines.number().max(1), "no reading in it".to_owned()),
        };
        let n = self.kind.n_columns(self.platform);
        FormatError::malformed(
            format!("not a log of {n} numbers a line: {cause}"),
            "give a folder of the benchmark as it was published",
        )
        .at_path(&self.name)
        .at_line(line)
    }
}

impl<R: BufRead> Iterator for SensorLogReader<R> {
    type Item = Result<Sample, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_done {
            match self.lines.advance() {
                Ok(Advance::Line) => match self.parse() {
                    Ok(sample) => {
                        self.has_valid_line = true;
                        if let Some(sample) = sample {
                            return Some(Ok(sample));
                        }
                    }
                    Err(fault) => self.rejections.add(self.lines.number(), fault),
                },
                Ok(Advance::TooLong) => self.rejections.add(self.lines.number(), LineFault::TooLong),
                Ok(Advance::End) => {
                    self.is_done = true;
                    if !self.has_valid_line {
                        return Some(Err(self.foreign()));
                    }
                }
                Err(error) => {
                    self.is_done = true;
                    let error = FormatError::io("read the log", &self.name, error);
                    return Some(Err(error.at_line(self.lines.number() + 1)));
                }
            }
            if !self.has_valid_line && self.lines.number() >= MAX_FOREIGN_LINES && !self.is_done {
                self.is_done = true;
                return Some(Err(self.foreign()));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(text: &str, platform: Platform, kind: LogKind) -> (Vec<Sample>, LineRejections) {
        let mut reader = SensorLogReader::new(text.as_bytes(), "log.txt", platform, kind, -0.5);
        let samples = reader.by_ref().collect::<Result<_, _>>().unwrap();
        (samples, reader.rejections().clone())
    }

    #[test]
    fn both_phones_feel_the_table_push_upwards() {
        // Lying on its back: Android writes +9.81 on z, iOS -1.
        let (android, _) = samples("1.5 0.0 0.0 9.81\n", Platform::Android, LogKind::SpecificForce);
        let (ios, _) = samples("1.5 0.1 -0.0 -1.0\n", Platform::Ios, LogKind::SpecificForce);
        assert_eq!(android[0].reading, Reading::SpecificForce([0.0, 0.0, 9.81]));
        assert_eq!(android[0].time, Timestamp::from_millis(1000));
        let Reading::SpecificForce(force) = ios[0].reading else { panic!("{:?}", ios[0]) };
        assert!(
            (force[2] - STANDARD_GRAVITY_M_S2).abs() < 1e-6 && (force[0] + 0.980_665).abs() < 1e-5,
            "{force:?}"
        );
    }

    #[test]
    fn biases_and_classes_of_accuracy_are_read() {
        let (rates, _) = samples("1 0.5 0 0 0.25 0 -1\n", Platform::Android, LogKind::AngularRate);
        assert_eq!(rates[0].reading, Reading::AngularRate([0.25, 0.0, 1.0]));
        let (fields, _) = samples("1 35 -71 375 59 -74 412\n", Platform::Android, LogKind::MagneticField);
        let expected = Reading::UncalibratedMagneticField {
            field_ut: [35.0, -71.0, 375.0],
            bias_ut: [59.0, -74.0, 412.0],
        };
        assert_eq!(fields[0].reading, expected);
        let (fields, _) = samples("1 7 -26 -32 -1\n2 7 -26 -32 2\n", Platform::Ios, LogKind::MagneticField);
        assert_eq!(fields.len(), 1);
        assert_eq!(fields[0].reading, Reading::MagneticField([7.0, -26.0, -32.0]));
    }

    #[test]
    fn bad_lines_are_counted_and_a_foreign_file_is_refused() {
        let text = "1 0 0 9.8\n2 0 0\n3 0 NaN 9.8\n4 0 x 9.8\n5 0 0 1e9\n1e300 0 0 9.8\n\n6 0 0 9.8\n";
        let (good, rejections) = samples(text, Platform::Android, LogKind::SpecificForce);
        assert_eq!((good.len(), rejections.total()), (2, 5));
        assert_eq!(rejections.first(), Some((2, LineFault::FieldCount)));
        for fault in [LineFault::NotFinite, LineFault::Number, LineFault::OutOfRange, LineFault::Time] {
            assert_eq!(rejections.count(fault), 1, "{fault}");
        }
        let mut foreign =
            SensorLogReader::new("a,b\n".as_bytes(), "x.csv", Platform::Ios, LogKind::SpecificForce, 0.0);
        let error = foreign.next().unwrap().unwrap_err();
        assert!(error.to_string().contains("x.csv:1") && !error.remedy().is_empty(), "{error}");
        assert!(foreign.next().is_none());
    }
}
