//! The position-annotated BLE collection: an emitter carried about a room, twelve receivers, and where it truly was.
//!
//! A folder with `cnf/` (where the receivers hang, how large the room is), `hst/` (one file per receiver and fixed point,
//! the point in the file's name) and `trk/` (one file per track, the place on every line). A line is
//! `seconds,receiver,emitter,rssi` and, on tracks, the emitter's `x,y,z` and nine numbers of its orientation. Both frames
//! are the floor's: x to the right, y up on its picture, in metres.
//!
//! # Source
//! Daniş, Naskali, Cemgil and Ersoy 2022, *An indoor localization dataset and data collection framework with high
//! precision position annotation*; the data set is in the public domain (CC0).

mod area;
mod files;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use fieldwalk::geometry::Point2;
use fieldwalk::time::Timestamp;

use crate::comma_rows::{Fields, Rows};
use crate::error::FormatError;
use crate::ilc::{LineFault, LineRejections};
use crate::text_lines::MAX_LINE_BYTES;

pub use area::{Area, Receiver, open_area, read_receivers};
pub use files::{FixedPoint, Track, find_points, find_tracks};

/// Numbers of a track's line that tell the emitter's orientation.
const N_ORIENTATION: usize = 9;
/// Farther than this from the origin no place of the collection is, in metres.
const MAX_PLACE_M: f64 = 1_000.0;

/// One packet of the emitter, as one receiver heard it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterSighting {
    /// When, since 1970.
    pub time: Timestamp,
    /// The receiver's hardware address.
    pub receiver: [u8; 6],
    /// The emitter's hardware address.
    pub emitter: [u8; 6],
    /// Received power, in dBm; −127 to 20.
    pub rssi_dbm: f32,
    /// Where the emitter was, and how high, in metres; told on tracks only.
    pub truth: Option<(Point2, f64)>,
}

/// Streams the sightings of one `.mbd` file.
///
/// A malformed line is counted in [`rejections`](Self::rejections) and left out. Memory is one line, of 64 KiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails or when none of the first 200 lines is of the format.
///
/// # Example
/// ```
/// use fieldwalk_formats::ble_annotated::SightingReader;
///
/// let text = "1568979940.637430906,b827eb4521b4,e78f135624ce,-73\n";
/// let sightings = SightingReader::new(text.as_bytes(), "a.mbd").collect::<Result<Vec<_>, _>>()?;
/// assert_eq!(sightings[0].rssi_dbm, -73.0);
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct SightingReader<R> {
    rows: Rows<R>,
}

impl SightingReader<BufReader<File>> {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the file", path, error))?;
        Ok(Self::new(BufReader::with_capacity(MAX_LINE_BYTES, file), path))
    }
}

impl<R: BufRead> SightingReader<R> {
    /// Reads what `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        let remedy = "give an .mbd file of the collection, with lines such as \
                      `1568979940.637430906,b827eb4521b4,e78f135624ce,-73`";
        Self { rows: Rows::new(reader, name.into(), "an .mbd file", remedy) }
    }

    /// The lines left out so far.
    pub fn rejections(&self) -> &LineRejections {
        self.rows.rejections()
    }
}

impl<R: BufRead> Iterator for SightingReader<R> {
    type Item = Result<EmitterSighting, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.rows.next_row(sighting)
    }
}

fn sighting(line: &[u8]) -> Result<EmitterSighting, LineFault> {
    let mut fields = Fields::new(line)?;
    let time = fields.unix_seconds()?;
    let (receiver, emitter) = (fields.address()?, fields.address()?);
    let rssi_dbm: f32 = fields.number()?;
    if !(-127.0..=20.0).contains(&rssi_dbm) {
        return Err(LineFault::OutOfRange);
    }
    let truth = if fields.is_at_end() { None } else { Some(place(&mut fields)?) };
    fields.end()?;
    Ok(EmitterSighting { time, receiver, emitter, rssi_dbm, truth })
}

fn place(fields: &mut Fields<'_>) -> Result<(Point2, f64), LineFault> {
    let [x_m, y_m, z_m]: [f64; 3] = [fields.number()?, fields.number()?, fields.number()?];
    for _ in 0..N_ORIENTATION {
        let _: f64 = fields.number()?;
    }
    if [x_m, y_m, z_m].iter().any(|m| m.abs() > MAX_PLACE_M) {
        return Err(LineFault::OutOfRange);
    }
    Ok((Point2::new(x_m, y_m), z_m))
}
