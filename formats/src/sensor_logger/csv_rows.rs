//! Rows of a CSV file with a header, in bounded memory.

use std::io::{self, BufRead};
use std::str;

use csv_core::{ReadRecordResult, Reader};

use super::entry::{Entry, Fields, Sensor};
use crate::ilc::LineFault;
use crate::text_lines::MAX_LINE_BYTES;

/// The most fields that a row may have; the app's have up to 20.
const MAX_FIELDS: usize = 256;

/// Reads a file row by row.
#[derive(Debug)]
pub(super) struct CsvRows<R> {
    reader: R,
    core: Reader,
    header: Vec<String>,
    bytes: Vec<u8>,
    ends: Vec<usize>,
    n_rows: u64,
}

/// What [`CsvRows::advance`] came upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Advance {
    /// A row of so many fields.
    Row(usize),
    TooLong,
    End,
}

impl<R: BufRead> CsvRows<R> {
    /// Reads the header.
    pub(super) fn new(reader: R) -> io::Result<Self> {
        let (bytes, ends) = (vec![0; 1_024], vec![0; MAX_FIELDS]);
        let mut rows = Self { reader, core: Reader::new(), header: Vec::new(), bytes, ends, n_rows: 0 };
        if let Advance::Row(n) = rows.advance()? {
            rows.header =
                (0..n).map(|k| rows.field(k).trim_start_matches('\u{feff}').trim().to_owned()).collect();
        }
        Ok(rows)
    }

    /// The next row, with its number, counted from 1 at the header.
    pub(super) fn next_entry(
        &mut self,
        sensor: Sensor,
    ) -> io::Result<Option<(u64, Result<Entry, LineFault>)>> {
        let parsed = match self.advance()? {
            Advance::End => return Ok(None),
            Advance::TooLong => Err(LineFault::TooLong),
            Advance::Row(n) if n != self.header.len() => Err(LineFault::FieldCount),
            Advance::Row(_) => {
                let mut fields = Fields::default();
                for (k, name) in self.header.iter().enumerate() {
                    fields.set(name, self.field(k));
                }
                fields.entry(sensor)
            }
        };
        Ok(Some((self.n_rows, parsed)))
    }

    /// The next row's fields, each with its name.
    pub(super) fn next_named(&mut self) -> io::Result<Option<Vec<(String, String)>>> {
        match self.advance()? {
            Advance::Row(n) => {
                let named = self.header.iter().take(n).enumerate();
                Ok(Some(named.map(|(k, name)| (name.clone(), self.field(k).to_owned())).collect()))
            }
            _ => Ok(None),
        }
    }

    fn field(&self, k: usize) -> &str {
        let begin = k.checked_sub(1).map_or(0, |k| self.ends[k]);
        str::from_utf8(&self.bytes[begin..self.ends[k]]).unwrap_or_default()
    }

    /// Takes the next row apart; a row that is too long is passed over.
    fn advance(&mut self) -> io::Result<Advance> {
        let (mut n_bytes, mut n_ends, mut is_too_long) = (0, 0, false);
        loop {
            let input = self.reader.fill_buf()?;
            let (result, n_in, n_out, n_end) =
                self.core.read_record(input, &mut self.bytes[n_bytes..], &mut self.ends[n_ends..]);
            self.reader.consume(n_in);
            n_bytes += n_out;
            n_ends += n_end;
            match result {
                ReadRecordResult::InputEmpty => {}
                ReadRecordResult::OutputFull if self.bytes.len() < MAX_LINE_BYTES => {
                    self.bytes.resize(2 * self.bytes.len(), 0);
                }
                ReadRecordResult::OutputFull | ReadRecordResult::OutputEndsFull => {
                    is_too_long = true;
                    (n_bytes, n_ends) = (0, 0);
                }
                ReadRecordResult::Record => {
                    self.n_rows += 1;
                    return Ok(if is_too_long { Advance::TooLong } else { Advance::Row(n_ends) });
                }
                ReadRecordResult::End => return Ok(Advance::End),
            }
        }
    }
}
