//! The Oxford step-counting collection: walks with a phone carried in several ways, and foot switches as the truth.
//!
//! A folder a walk, `<phone>_<person>_<ground>_<placement>_<n>`, with `accelerometer.csv` (time in ns, accuracy class,
//! x, y, z in m/s², 100 to 400 Hz) and `stepcounter.csv` (time in ns, left switch, right switch, about 10 Hz). Both
//! times are of one clock.
//!
//! # Source
//! Salvi 2018, *An optimised algorithm for accurate steps counting from smart-phone accelerometry*; the data set is
//! licensed under CC BY 4.0.

mod folder;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;

use crate::comma_rows::{Fields, Rows};
use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::text_lines::MAX_LINE_BYTES;

pub use folder::{Placement, RunFolder, find_runs};

/// Streams the samples of one `accelerometer.csv`.
///
/// A malformed line is counted in [`rejections`](Self::rejections) and left out. Memory is one line, of 64 KiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails or when none of the first 200 lines is of the format.
///
/// # Example
/// ```
/// use fieldwalk_formats::oxford_steps::AccelerometerReader;
///
/// let text = "199833203154243,3,0.378,8.738,4.960\n";
/// let samples = AccelerometerReader::new(text.as_bytes(), "accelerometer.csv").collect::<Result<Vec<_>, _>>()?;
/// assert_eq!(samples.len(), 1);
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct AccelerometerReader<R> {
    rows: Rows<R>,
}

/// Which foot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Foot {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

/// A foot switch that has just closed: a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// The first row in which the switch is closed.
    pub time: Timestamp,
    /// The foot.
    pub foot: Foot,
}

/// Streams the contacts of one `stepcounter.csv`: the rows in which a switch goes from 0 to 1.
///
/// When both feet come down in one row, the left contact is given first. The state of the first row is no contact. A
/// malformed line is counted in [`rejections`](Self::rejections) and left out. Memory is one line, of 64 KiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails or when none of the first 200 lines is of the format.
///
/// # Example
/// ```
/// use fieldwalk_formats::oxford_steps::{ContactReader, Foot};
///
/// let text = "100,1,0\n200,0,1\n300,1,1\n";
/// let contacts = ContactReader::new(text.as_bytes(), "stepcounter.csv").collect::<Result<Vec<_>, _>>()?;
/// assert_eq!(contacts.iter().map(|contact| contact.foot).collect::<Vec<_>>(), [Foot::Right, Foot::Left]);
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct ContactReader<R> {
    rows: Rows<R>,
    /// Left and right switch in the last row.
    closed: Option<[bool; 2]>,
    /// The right contact of a row that had both.
    pending: Option<Contact>,
}

const ACCELEROMETER_REMEDY: &str =
    "give an accelerometer.csv of the collection, with lines such as `199833203154243,3,0.378,8.738,4.960`";
const CONTACTS_REMEDY: &str =
    "give a stepcounter.csv of the collection, with lines such as `199833275849618,1,0`";

impl AccelerometerReader<BufReader<File>> {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        Ok(Self::new(opened(path)?, path))
    }
}

impl<R: BufRead> AccelerometerReader<R> {
    /// Reads what `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        Self { rows: Rows::new(reader, name.into(), "the accelerometer.csv of a walk", ACCELEROMETER_REMEDY) }
    }

    /// The lines left out so far.
    pub fn rejections(&self) -> &LineRejections {
        self.rows.rejections()
    }
}

impl<R: BufRead> Iterator for AccelerometerReader<R> {
    type Item = Result<Sample, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.rows.next_row(|line| {
            let mut fields = Fields::new(line)?;
            let time = fields.time()?;
            let _accuracy_class: i8 = fields.integer()?;
            let force = [fields.number()?, fields.number()?, fields.number()?];
            fields.end()?;
            Ok(Sample { time, reading: Reading::SpecificForce(force) })
        })
    }
}

impl ContactReader<BufReader<File>> {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        Ok(Self::new(opened(path)?, path))
    }
}

impl<R: BufRead> ContactReader<R> {
    /// Reads what `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        let rows = Rows::new(reader, name.into(), "the stepcounter.csv of a walk", CONTACTS_REMEDY);
        Self { rows, closed: None, pending: None }
    }

    /// The lines left out so far.
    pub fn rejections(&self) -> &LineRejections {
        self.rows.rejections()
    }
}

impl<R: BufRead> Iterator for ContactReader<R> {
    type Item = Result<Contact, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(contact) = self.pending.take() {
            return Some(Ok(contact));
        }
        loop {
            let (time, closed) = match self.rows.next_row(switches)? {
                Ok(row) => row,
                Err(error) => return Some(Err(error)),
            };
            let was_closed = self.closed.replace(closed).unwrap_or(closed);
            let contact = |foot: Foot| {
                let k = foot as usize;
                (closed[k] && !was_closed[k]).then_some(Contact { time, foot })
            };
            let (left, right) = (contact(Foot::Left), contact(Foot::Right));
            if left.is_some() {
                self.pending = right;
            }
            if let Some(first) = left.or(right) {
                return Some(Ok(first));
            }
        }
    }
}

fn switches(line: &[u8]) -> Result<(Timestamp, [bool; 2]), LineFault> {
    let mut fields = Fields::new(line)?;
    let time = fields.time()?;
    let closed = [fields.switch()?, fields.switch()?];
    fields.end()?;
    Ok((time, closed))
}

fn opened(path: &Path) -> Result<BufReader<File>, FormatError> {
    let file = File::open(path).map_err(|error| FormatError::io("open the file", path, error))?;
    Ok(BufReader::with_capacity(MAX_LINE_BYTES, file))
}
