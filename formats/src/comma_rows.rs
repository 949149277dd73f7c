//! Comma-separated rows, read one line at a time.

use std::io::BufRead;
use std::path::PathBuf;
use std::str;

use fieldwalk::time::Timestamp;

use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::text_lines::{Advance, TextLines};

/// A file without a valid line among this many is something else.
const MAX_FOREIGN_LINES: u64 = 200;

/// The rows of a file, what was wrong with the others, and whether the file is one of the format at all.
#[derive(Debug)]
pub(super) struct Rows<R> {
    lines: TextLines<R>,
    name: PathBuf,
    kind: &'static str,
    remedy: &'static str,
    has_valid_line: bool,
    is_done: bool,
    rejections: LineRejections,
}

impl<R: BufRead> Rows<R> {
    pub(super) fn new(reader: R, name: PathBuf, kind: &'static str, remedy: &'static str) -> Self {
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

    pub(super) fn rejections(&self) -> &LineRejections {
        &self.rejections
    }

    /// What `parse` makes of the next line that it accepts; empty lines are passed over.
    pub(super) fn next_row<T>(
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
        FormatError::malformed(format!("not the {} of a walk: {cause}", self.kind), self.remedy)
            .at_path(&self.name)
            .at_line(line)
    }
}

/// The comma-separated fields of a line, left to right.
pub(super) struct Fields<'a> {
    rest: Option<&'a str>,
}

impl<'a> Fields<'a> {
    pub(super) fn new(line: &'a [u8]) -> Result<Self, LineFault> {
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
    pub(super) fn time(&mut self) -> Result<Timestamp, LineFault> {
        let nanos: i64 = self.next()?.parse().map_err(|_| LineFault::Time)?;
        if nanos < 0 { Err(LineFault::Time) } else { Ok(Timestamp::from_nanos(nanos)) }
    }

    pub(super) fn integer<T: str::FromStr>(&mut self) -> Result<T, LineFault> {
        self.next()?.parse().map_err(|_| LineFault::Number)
    }

    /// One finite number.
    pub(super) fn number(&mut self) -> Result<f32, LineFault> {
        let number: f32 = self.next()?.parse().map_err(|_| LineFault::Number)?;
        if number.is_finite() { Ok(number) } else { Err(LineFault::NotFinite) }
    }

    /// `0`, open, or `1`, closed.
    pub(super) fn switch(&mut self) -> Result<bool, LineFault> {
        match self.integer::<u8>()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(LineFault::OutOfRange),
        }
    }

    pub(super) fn end(&self) -> Result<(), LineFault> {
        if self.rest.is_none() { Ok(()) } else { Err(LineFault::FieldCount) }
    }
}
