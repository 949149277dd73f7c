//! Lines of a text file, each of bounded length.

use std::io::{self, BufRead, Read as _};

/// Longest line kept; the longest of the public collections has a few hundred bytes.
pub(crate) const MAX_LINE_BYTES: usize = 64 * 1024;

/// Reads a file line by line, without allocating for each.
#[derive(Debug)]
pub(crate) struct TextLines<R> {
    reader: R,
    line: Vec<u8>,
    number: u64,
}

/// What [`TextLines::advance`] came upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Advance {
    Line,
    /// A line longer than any of the format; its content is not kept.
    TooLong,
    End,
}

impl<R: BufRead> TextLines<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self { reader, line: Vec::new(), number: 0 }
    }

    /// The current line, without its ending.
    pub(crate) fn line(&self) -> &[u8] {
        &self.line
    }

    /// The current line's number, counted from 1; 0 before the first.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Goes on to the next line.
    pub(crate) fn advance(&mut self) -> io::Result<Advance> {
        self.line.clear();
        let n_read = self.reader.by_ref().take(MAX_LINE_BYTES as u64).read_until(b'\n', &mut self.line)?;
        if n_read == 0 {
            return Ok(Advance::End);
        }
        self.number += 1;
        if self.line.last() == Some(&b'\n') {
            self.line.pop();
            self.line.pop_if(|byte| *byte == b'\r');
        } else if n_read == MAX_LINE_BYTES && self.reader.skip_until(b'\n')? > 0 {
            self.line.clear();
            return Ok(Advance::TooLong);
        }
        Ok(Advance::Line)
    }
}
