//! Comma-separated rows, read one line at a time.

use std::io::BufRead;
use std::path::PathBuf;
use std::{iter, str};

use fieldwalk::time::Timestamp;

use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::text_lines::{Advance, TextLines};

/// A file without a valid line among this many is something else.
const MAX_FOREIGN_LINES: u64 = 200;

/// The rows of a file, what was wrong with the others, and whether the file is one of the format at all.
#[derive(Debug)]
pub(crate) struct Rows<R> {
    lines: TextLines<R>,
    name: PathBuf,
    kind: &'static str,
    remedy: &'static str,
    has_valid_line: bool,
    is_done: bool,
    rejections: LineRejections,
}

impl<R: BufRead> Rows<R> {
    pub(crate) fn new(reader: R, name: PathBuf, kind: &'static str, remedy: &'static str) -> Self {
        Self {
            lines: TextLines::new(reader),
            name,
            kind,
            remedy,
            has_valid_line: false,
            is_done: false,
            rejections: LineRejections::default(),
        }
    }

    pub(crate) fn rejections(&self) -> &LineRejections {
        &self.rejections
    }

    /// What `parse` makes of the next line that it accepts; empty lines are passed over.
    pub(crate) fn next_row<T>(
        &mut self,
        parse: impl Fn(&[u8]) -> Result<T, LineFault>,
    ) -> Option<Result<T, FormatError>> {
        while !self.is_done {
            if !self.has_valid_line && self.rejections.total() >= MAX_FOREIGN_LINES {
                self.is_done = true;
                return Some(Err(self.foreign()));
            }
            let fault = match self.lines.advance() {
                Ok(Advance::Line) if self.lines.line().trim_ascii().is_empty() => continue,
                Ok(Advance::Line) => match parse(self.lines.line()) {
                    Ok(row) => {
                        self.has_valid_line = true;
                        return Some(Ok(row));
                    }
                    Err(fault) => fault,
                },
                Ok(Advance::TooLong) => LineFault::TooLong,
                Ok(Advance::End) => {
                    self.is_done = true;
                    return (!self.has_valid_line).then(|| Err(self.foreign()));
                }
                Err(error) => {
                    self.is_done = true;
                    let error = FormatError::io("read the file", &self.name, error);
                    return Some(Err(error.at_line(self.lines.number() + 1)));
                }
            };
            self.rejections.add(self.lines.number(), fault);
        }
        None
    }

    fn foreign(&self) -> FormatError {
        let (line, cause) = match self.rejections.first() {
            Some((line, fault)) => (line, fault.to_string()),
            None => (self.lines.number().max(1), "no row in it".to_owned()),
        };
        FormatError::malformed(format!("not {}: {cause}", self.kind), self.remedy)
            .at_path(&self.name)
            .at_line(line)
    }
}

/// The comma-separated fields of a line, left to right.
pub(crate) struct Fields<'a> {
    rest: Option<&'a str>,
}

impl<'a> Fields<'a> {
    pub(crate) fn new(line: &'a [u8]) -> Result<Self, LineFault> {
        Ok(Self { rest: Some(str::from_utf8(line).map_err(|_| LineFault::NotUtf8)?) })
    }

    fn next(&mut self) -> Result<&'a str, LineFault> {
        let rest = self.rest.ok_or(LineFault::FieldCount)?;
        let (field, rest) = match rest.split_once(',') {
            Some((field, rest)) => (field, Some(rest)),
            None => (rest, None),
        };
        self.rest = rest;
        Ok(field.trim())
    }

    /// Nanoseconds on the phone's clock since it was started, never negative.
    pub(crate) fn time(&mut self) -> Result<Timestamp, LineFault> {
        let nanos: i64 = self.next()?.parse().map_err(|_| LineFault::Time)?;
        if nanos < 0 { Err(LineFault::Time) } else { Ok(Timestamp::from_nanos(nanos)) }
    }

    pub(crate) fn integer<T: str::FromStr>(&mut self) -> Result<T, LineFault> {
        self.next()?.parse().map_err(|_| LineFault::Number)
    }

    /// One finite number, an `f32` or an `f64`.
    pub(crate) fn number<T: str::FromStr + Copy + Into<f64>>(&mut self) -> Result<T, LineFault> {
        let number: T = self.integer()?;
        if number.into().is_finite() { Ok(number) } else { Err(LineFault::NotFinite) }
    }

    /// Seconds since 1970, never negative, to the nanosecond: `1568979940.637430906`.
    pub(crate) fn unix_seconds(&mut self) -> Result<Timestamp, LineFault> {
        let field = self.next()?;
        let (whole, decimals) = field.split_once('.').unwrap_or((field, ""));
        let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if !is_digits(whole) || !is_digits(decimals) {
            return Err(LineFault::Time);
        }
        let seconds: i64 = whole.parse().map_err(|_| LineFault::Time)?;
        let digits = decimals.bytes().chain(iter::repeat(b'0')).take(9);
        let nanos = digits.fold(0, |nanos, digit| 10 * nanos + i64::from(digit - b'0'));
        let time = seconds.checked_mul(1_000_000_000).and_then(|time| time.checked_add(nanos));
        time.map(Timestamp::from_nanos).ok_or(LineFault::Time)
    }

    /// A hardware address as twelve hexadecimal digits.
    pub(crate) fn address(&mut self) -> Result<[u8; 6], LineFault> {
        address(self.next()?).ok_or(LineFault::Identity)
    }

    /// Whether no field is left.
    pub(crate) fn is_at_end(&self) -> bool {
        self.rest.is_none()
    }

    /// `0`, open, or `1`, closed.
    pub(crate) fn switch(&mut self) -> Result<bool, LineFault> {
        match self.integer::<u8>()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(LineFault::OutOfRange),
        }
    }

    pub(crate) fn end(&self) -> Result<(), LineFault> {
        if self.rest.is_none() { Ok(()) } else { Err(LineFault::FieldCount) }
    }
}

/// The hardware address that twelve hexadecimal digits spell.
pub(crate) fn address(text: &str) -> Option<[u8; 6]> {
    if text.len() != 12 || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let number = u64::from_str_radix(text, 16).ok()?;
    let [_, _, address @ ..] = number.to_be_bytes();
    Some(address)
}
