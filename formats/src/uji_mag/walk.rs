//! One file: its rows and the segments that they walk.

use std::io::BufRead;
use std::path::Path;

use fieldwalk::floor_plan::Georeference;
use fieldwalk::time::Timestamp;

use super::motion;
use super::rows::{self, Row, SegmentLine};
use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::recording::Record;
use crate::text_lines::{Advance, TextLines};

/// The most rows of a file: an hour at 10 Hz, 2 MB.
pub const MAX_ROWS: usize = 36_000;
/// The most segments of a file.
pub const MAX_SEGMENTS: usize = 1_000;
/// Nearer than this, in metres, the end of a segment and the start of the next are one place.
const SAME_PLACE_M: f64 = 0.05;
const REMEDY: &str =
    "give a file of UJIIndoorLoc-Mag: rows of ten numbers, a line such as `<2>`, a line a segment";

/// A walk: its readings, and the segments along which it went.
#[derive(Clone, Debug, PartialEq)]
pub struct UjiMagWalk {
    rows: Vec<Row>,
    segments: Vec<UjiMagSegment>,
    rejections: LineRejections,
}

/// A straight segment of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UjiMagSegment {
    /// Latitude and longitude of its start, in degrees.
    pub start_deg: [f64; 2],
    /// Latitude and longitude of its end, in degrees.
    pub end_deg: [f64; 2],
    /// The time of its first row.
    pub start: Timestamp,
    /// The time of its last row.
    pub end: Timestamp,
}

impl UjiMagWalk {
    /// Reads a walk; `name` stands for it in errors. A malformed row is counted and left out.
    ///
    /// # Errors
    /// When reading fails; when there is no row, or more than [`MAX_ROWS`]; when the segments are missing, malformed or
    /// of rows that are not there.
    pub fn read(reader: impl BufRead, name: &Path) -> Result<Self, FormatError> {
        let mut walk = Self { rows: Vec::new(), segments: Vec::new(), rejections: LineRejections::default() };
        let mut lines = TextLines::new(reader);
        let n_segments = walk.read_rows(&mut lines).map_err(|error| error.at_path(name))?;
        walk.read_segments(&mut lines, n_segments).map_err(|error| error.at_path(name))?;
        Ok(walk)
    }

    /// The segments, in the file's order.
    pub fn segments(&self) -> &[UjiMagSegment] {
        &self.segments
    }

    /// The rows left out.
    pub fn rejections(&self) -> &LineRejections {
        &self.rejections
    }

    /// Whether linear acceleration or orientation never changes: the walk then has a magnetic field alone.
    pub fn is_motion_stuck(&self) -> bool {
        motion::is_stuck(&self.rows)
    }

    /// The readings, and the ends of the segments as waypoints in the frame at `georeference`, in order of time.
    pub fn records(&self, georeference: Georeference) -> Vec<Record> {
        let mut records: Vec<Record> = motion::samples(&self.rows).into_iter().map(Record::Sample).collect();
        let point = |[latitude_deg, longitude_deg]: [f64; 2]| georeference.point(latitude_deg, longitude_deg);
        let mut last = None;
        for segment in &self.segments {
            let (from, to) = (point(segment.start_deg), point(segment.end_deg));
            match last {
                // One place: the walker was there between the last row before and the first row after it.
                Some((end, place)) if from.distance_m(place) < SAME_PLACE_M => {
                    if let Some(Record::Waypoint { time, .. }) = records.last_mut() {
                        *time = segment.start.midpoint(end);
                    }
                }
                _ => records.push(Record::Waypoint { time: segment.start, point: from }),
            }
            records.push(Record::Waypoint { time: segment.end, point: to });
            last = Some((segment.end, to));
        }
        records.sort_by_key(Record::time);
        records
    }

    /// Reads up to the mark after the rows; gives the number of segments that it announces.
    fn read_rows(&mut self, lines: &mut TextLines<impl BufRead>) -> Result<usize, FormatError> {
        let mut index = 0;
        while index <= MAX_ROWS {
            let fault = match lines.advance() {
                Ok(Advance::End) => return Err(self.foreign(lines, "it ends before its segments")),
                Ok(Advance::TooLong) => Err(LineFault::TooLong),
                Ok(Advance::Line) if lines.line().trim_ascii().is_empty() => continue,
                Ok(Advance::Line) => {
                    // In one file of the collection the mark stands behind the remains of a row.
                    if let Some(at) = lines.line().iter().position(|&byte| byte == b'<') {
                        let (torn, mark) = lines.line().split_at(at);
                        if !torn.trim_ascii().is_empty() {
                            self.rejections.add(lines.number(), LineFault::FieldCount);
                        }
                        return self.announced(lines, mark);
                    }
                    rows::row(index, lines.line()).and_then(|row| self.push(row))
                }
                Err(error) => return Err(failed(lines, error)),
            };
            if let Err(fault) = fault {
                self.rejections.add(lines.number(), fault);
            }
            index += 1;
        }
        Err(malformed(lines, format!("more than {MAX_ROWS} rows")))
    }

    fn announced(&self, lines: &TextLines<impl BufRead>, mark: &[u8]) -> Result<usize, FormatError> {
        match rows::n_segments(mark) {
            Ok(n) if (1..=MAX_SEGMENTS).contains(&n) && !self.rows.is_empty() => Ok(n),
            _ => Err(self.foreign(lines, "a mark that announces no segments, or no row before it")),
        }
    }

    /// Keeps a row, which must be later than those before.
    fn push(&mut self, row: Row) -> Result<(), LineFault> {
        if self.rows.last().is_some_and(|last| last.time >= row.time) {
            return Err(LineFault::Time);
        }
        self.rows.push(row);
        Ok(())
    }

    fn read_segments(
        &mut self,
        lines: &mut TextLines<impl BufRead>,
        n_announced: usize,
    ) -> Result<(), FormatError> {
        loop {
            match lines.advance() {
                Ok(Advance::End) => break,
                Ok(Advance::Line) if lines.line().trim_ascii().is_empty() => continue,
                Ok(Advance::Line) => {}
                Ok(Advance::TooLong) => return Err(malformed(lines, LineFault::TooLong.to_string())),
                Err(error) => return Err(failed(lines, error)),
            }
            let segment = rows::segment(lines.line()).map_err(|fault| malformed(lines, fault.to_string()))?;
            let segment = self.timed(&segment).map_err(|message| malformed(lines, message))?;
            self.segments.push(segment);
            if self.segments.len() > n_announced {
                break;
            }
        }
        if self.segments.len() == n_announced {
            return Ok(());
        }
        Err(malformed(lines, format!("{n_announced} segments announced, and others given")))
    }

    /// A segment with the times of its rows; of a row that was left out, that of its neighbour.
    ///
    /// The last row may be one beyond the file's, as it is in some files of the collection.
    fn timed(&self, line: &SegmentLine) -> Result<UjiMagSegment, String> {
        let [first, last] = line.rows;
        let from = self.rows.partition_point(|row| row.index < first);
        let to = self.rows.partition_point(|row| row.index <= last);
        let n_rows = self.rows.last().map_or(0, |row| row.index + 1);
        let is_within = last <= n_rows + self.rejections.total() as usize;
        let is_after = |start| self.segments.last().is_none_or(|before| before.end <= start);
        match (self.rows.get(from), to.checked_sub(1).and_then(|to| self.rows.get(to))) {
            (Some(start), Some(end)) if start.time < end.time && is_within => {
                let SegmentLine { start_deg, end_deg, .. } = *line;
                let segment = UjiMagSegment { start_deg, end_deg, start: start.time, end: end.time };
                match is_after(segment.start) {
                    true => Ok(segment),
                    false => Err("a segment that begins before the last one ends".into()),
                }
            }
            _ => Err(format!("a segment of the rows {first} to {last}, of {n_rows}")),
        }
    }

    /// An error with `cause`, or with what is wrong with the first line where no row was understood.
    fn foreign(&self, lines: &TextLines<impl BufRead>, cause: &str) -> FormatError {
        match self.rejections.first() {
            Some((line, fault)) if self.rows.is_empty() => {
                FormatError::malformed(format!("no walk of UJIIndoorLoc-Mag: {fault}"), REMEDY).at_line(line)
            }
            _ => malformed(lines, cause.to_owned()),
        }
    }
}

fn malformed(lines: &TextLines<impl BufRead>, message: String) -> FormatError {
    FormatError::malformed(message, REMEDY).at_line(lines.number().max(1))
}

fn failed(lines: &TextLines<impl BufRead>, error: std::io::Error) -> FormatError {
    FormatError::io("read the walk", Path::new(""), error).at_line(lines.number() + 1)
}
