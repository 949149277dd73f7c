//! One line of a file: a row of readings, or a segment's ends and rows.

use std::str::{self, FromStr};

use fieldwalk::time::Timestamp;

use crate::ilc::LineFault;

/// The readings of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// The row's number in the file, counted from 0, lines that are no row included.
    pub(super) index: usize,
    pub(super) time: Timestamp,
    pub(super) field_ut: [f32; 3],
    pub(super) linear_m_s2: [f32; 3],
    /// Azimuth, pitch and roll as Android's `getOrientation` has them.
    pub(super) orientation_deg: [f32; 3],
}

/// A segment as written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SegmentLine {
    /// Latitude and longitude.
    pub(super) start_deg: [f64; 2],
    pub(super) end_deg: [f64; 2],
    /// First and last row.
    pub(super) rows: [usize; 2],
}

/// Before the year 3000, in ms.
const MAX_TIME_MS: i64 = 32_503_680_000_000;
/// Far beyond what the sensors can read, in µT and m/s².
const MAX_FIELD_UT: f32 = 10_000.0;
const MAX_LINEAR_M_S2: f32 = 1_000.0;

/// Whether a file that begins with `head` looks like one of this format: ten numbers in its first line.
pub(crate) fn is_uji_mag(head: &[u8]) -> bool {
    let text = head.trim_ascii_start();
    let line = text.split(|&byte| byte == b'\n').next().unwrap_or_default();
    row(0, line).is_ok()
}

/// Parses a row.
pub(super) fn row(index: usize, line: &[u8]) -> Result<Row, LineFault> {
    let mut fields = Fields::new(line)?;
    let time_ms: i64 = fields.next()?.parse().map_err(|_| LineFault::Time)?;
    if !(0..=MAX_TIME_MS).contains(&time_ms) {
        return Err(LineFault::Time);
    }
    let (field_ut, linear_m_s2) = (fields.vector(MAX_FIELD_UT)?, fields.vector(MAX_LINEAR_M_S2)?);
    let orientation_deg = fields.vector(360.0)?;
    fields.end()?;
    Ok(Row { index, time: Timestamp::from_millis(time_ms), field_ut, linear_m_s2, orientation_deg })
}

/// Parses a segment.
pub(super) fn segment(line: &[u8]) -> Result<SegmentLine, LineFault> {
    let mut fields = Fields::new(line)?;
    let (start_deg, end_deg) = (fields.place()?, fields.place()?);
    let rows = [fields.integer()?, fields.integer()?];
    fields.end()?;
    if rows[0] > rows[1] {
        return Err(LineFault::OutOfRange);
    }
    Ok(SegmentLine { start_deg, end_deg, rows })
}

/// The number in `<2>`.
pub(super) fn n_segments(mark: &[u8]) -> Result<usize, LineFault> {
    let digits = mark.trim_ascii().strip_prefix(b"<").and_then(|mark| mark.strip_suffix(b">"));
    Fields::new(digits.ok_or(LineFault::FieldCount)?)?.integer()
}

/// The fields of a line, left to right, separated by blanks.
struct Fields<'a> {
    fields: str::SplitAsciiWhitespace<'a>,
}

impl<'a> Fields<'a> {
    fn new(line: &'a [u8]) -> Result<Self, LineFault> {
        let text = str::from_utf8(line).map_err(|_| LineFault::NotUtf8)?;
        Ok(Self { fields: text.split_ascii_whitespace() })
    }

    fn next(&mut self) -> Result<&'a str, LineFault> {
        self.fields.next().ok_or(LineFault::FieldCount)
    }

    fn integer(&mut self) -> Result<usize, LineFault> {
        self.next()?.parse().map_err(|_| LineFault::Number)
    }

    /// One finite number of at most `limit` in magnitude.
    fn number<T: FromStr + Into<f64> + Copy>(&mut self, limit: T) -> Result<T, LineFault> {
        let number: T = self.next()?.parse().map_err(|_| LineFault::Number)?;
        let magnitude = number.into().abs();
        match magnitude.is_finite() {
            true if magnitude <= limit.into() => Ok(number),
            true => Err(LineFault::OutOfRange),
            false => Err(LineFault::NotFinite),
        }
    }

    fn vector(&mut self, limit: f32) -> Result<[f32; 3], LineFault> {
        Ok([self.number(limit)?, self.number(limit)?, self.number(limit)?])
    }

    /// Latitude and longitude; at the poles a degree of longitude has no length.
    fn place(&mut self) -> Result<[f64; 2], LineFault> {
        Ok([self.number(89.0)?, self.number(180.0)?])
    }

    fn end(&mut self) -> Result<(), LineFault> {
        if self.fields.next().is_none() { Ok(()) } else { Err(LineFault::FieldCount) }
    }
}
