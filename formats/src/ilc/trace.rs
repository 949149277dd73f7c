//! One walk: a text trace read as a stream of records.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::line::{self, Line};
use super::rejections::{LineFault, LineRejections};
use crate::error::FormatError;
use crate::recording::{Record, RecordingInfo};
use crate::text_lines::{Advance, MAX_LINE_BYTES, TextLines};

/// Streams the records of one trace of the indoor-location-competition-20 collection.
///
/// A malformed line is counted in [`rejections`](Self::rejections) and left out; two records glued onto one line are
/// taken apart. Records come in the file's order, duplicates included. Memory is one line, of 64 KiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails or when none of the first 200 lines is of the format.
///
/// # Example
/// ```
/// use fieldwalk_formats::{Record, ilc::TraceReader};
///
/// let text = "1574559495263\tTYPE_WAYPOINT\t81.5\t93.25\n";
/// let records: Vec<Record> = TraceReader::new(text.as_bytes(), "walk.txt").collect::<Result<_, _>>()?;
/// assert!(matches!(records[..], [Record::Waypoint { point, .. }] if point.x_m == 81.5));
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct TraceReader<R> {
    lines: TextLines<R>,
    name: PathBuf,
    /// Records of the current line before this byte have been handed out.
    cursor: usize,
    has_valid_line: bool,
    is_done: bool,
    info: RecordingInfo,
    rejections: LineRejections,
    /// Whether nobody said that it is a trace.
    is_guess: bool,
}

/// A file without a valid line among this many is something else.
const MAX_FOREIGN_LINES: u64 = 200;

impl TraceReader<BufReader<File>> {
    /// Opens the trace at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the trace", path, error))?;
        Ok(Self::new(BufReader::with_capacity(MAX_LINE_BYTES, file), path))
    }
}

impl<R: BufRead> TraceReader<R> {
    /// Reads the trace that `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        Self {
            lines: TextLines::new(reader),
            name: name.into(),
            cursor: 0,
            has_valid_line: false,
            is_done: false,
            info: RecordingInfo::default(),
            rejections: LineRejections::default(),
            is_guess: false,
        }
    }

    /// As a reader of what is of no other known format: what is no trace either is told so.
    pub(crate) fn guessing(self) -> Self {
        Self { is_guess: true, ..self }
    }

    /// The floor that the header names, such as `F1`; known once the first record has been read.
    ///
    /// `None` before that, and for a trace whose header says nothing. A map of another floor does not fit the trace.
    pub fn floor_name(&self) -> Option<&str> {
        Some(self.info.floor.as_str()).filter(|floor| !floor.is_empty())
    }

    /// What the header says about the walk; known once the first record has been read.
    pub fn info(&self) -> &RecordingInfo {
        &self.info
    }

    /// The lines left out so far.
    pub fn rejections(&self) -> &LineRejections {
        &self.rejections
    }

    /// Goes on to the next line; false at the end of the file.
    fn read_line(&mut self) -> io::Result<bool> {
        self.cursor = 0;
        let advance = self.lines.advance()?;
        if advance == Advance::TooLong {
            self.rejections.add(self.lines.number(), LineFault::TooLong);
        }
        Ok(advance != Advance::End)
    }

    /// The next record of the current line.
    fn next_of_line(&mut self) -> Option<Record> {
        while self.cursor < self.lines.line().len() {
            let rest = &self.lines.line()[self.cursor..];
            if rest[0] == b'#' {
                // A comment: the header, or the `endTime` that closes a trace.
                take_header(&mut self.info, rest);
                break;
            }
            let (parsed, end) = line::parse_first(rest);
            self.cursor += end;
            self.has_valid_line |= parsed.is_ok();
            match parsed {
                Ok(Line::Record(record)) => return Some(record),
                Ok(Line::StaleWifi) => self.rejections.n_stale_wifi += 1,
                Ok(Line::Skipped) => {}
                Err(fault) => self.rejections.add(self.lines.number(), fault),
            }
        }
        self.cursor = self.lines.line().len();
        None
    }

    fn foreign(&self) -> FormatError {
        let (line, cause) = match self.rejections.first() {
            Some((line, fault)) => (line, fault.to_string()),
            None => (self.lines.number().max(1), "no record in it".to_owned()),
        };
        let error = if self.is_guess {
            FormatError::malformed(
                format!("of no known format; as an indoor-location-competition trace: {cause}"),
                "give MCAP, a text trace of indoor-location-competition-20, a log of GetSensorData, a walk of \
                 UJIIndoorLoc-Mag, or an export of Sensor Logger: its folder, or its JSON file",
            )
        } else {
            FormatError::malformed(
                format!("not an indoor-location-competition trace: {cause}"),
                "give a text file of the collection, with lines such as \
                 `1574559495263<tab>TYPE_WAYPOINT<tab>x<tab>y`",
            )
        };
        error.at_path(&self.name).at_line(line)
    }
}

/// Takes from a header line what is not known yet: `startTime:`, `FloorName:`, `Brand:` and `Model:`.
fn take_header(info: &mut RecordingInfo, comment: &[u8]) {
    let field = |key: &[u8]| line::header_field(comment, key);
    if info.floor.is_empty() {
        info.floor = field(b"FloorName:").unwrap_or_default();
    }
    if info.device.is_empty() {
        let words = [field(b"Brand:"), field(b"Model:")];
        info.device = words.into_iter().flatten().collect::<Vec<_>>().join(" ");
    }
    info.start_unix_ms = info.start_unix_ms.or_else(|| field(b"startTime:")?.parse().ok());
}

impl<R: BufRead> Iterator for TraceReader<R> {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.is_done {
            return None;
        }
        loop {
            if let Some(record) = self.next_of_line() {
                return Some(Ok(record));
            }
            let is_foreign_so_far = !self.has_valid_line;
            if is_foreign_so_far && self.lines.number() >= MAX_FOREIGN_LINES {
                self.is_done = true;
                return Some(Err(self.foreign()));
            }
            match self.read_line() {
                Ok(true) => {}
                Ok(false) => {
                    self.is_done = true;
                    return is_foreign_so_far.then(|| Err(self.foreign()));
                }
                Err(error) => {
                    self.is_done = true;
                    let error = FormatError::io("read the trace", &self.name, error);
                    return Some(Err(error.at_line(self.lines.number() + 1)));
                }
            }
        }
    }
}
