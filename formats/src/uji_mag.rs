//! UJIIndoorLoc-Mag: walks along the corridors of a laboratory at 10 Hz, with the places where they turn.
//!
//! A file is a walk. Each row is the time (Unix, in ms) and nine readings, separated by blanks: magnetic field in µT,
//! linear acceleration in m/s², and the orientation as azimuth, pitch and roll in degrees, all by Android's fused
//! sensors. After the rows a line such as `<2>` says how many straight segments the walk has, and a line each gives
//! latitude and longitude of a segment's start and of its end, and its first and last row, counted from 0.
//!
//! # What is recovered, and how
//! The linear acceleration has no gravity. The orientation says which way is up in the device's frame, so the
//! *specific force* is the linear acceleration with 9.81 m/s² along it. There is no gyroscope either, but Android's
//! orientation rests on one: the *angular rate* is the turn from one orientation to the next over the time between.
//! It is as good as that fusion, which compasses beside steel pull by some degrees. An orientation comes about five
//! times a second; between two of them the device is taken to turn evenly, so that a rate is known up to 0.2 s before a
//! phone could have known it.
//!
//! The first row of a quantity holds what an earlier walk left behind, until the value changes: those rows are left out
//! (but for the tilt, which is that of the first orientation). Some files have linear acceleration and orientation
//! that never change: such a walk has a magnetic field alone.
//!
//! # Source
//! Torres-Sospedra et al. 2015, *UJIIndoorLoc-Mag: a new database for magnetic field-based localization problems*,
//! <https://archive.ics.uci.edu/dataset/343/ujiindoorloc+mag>.

mod folder;
mod motion;
mod rows;
mod walk;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::Georeference;

use crate::error::FormatError;
use crate::geojson_plan::georeference_at;
use crate::ilc::LineRejections;
use crate::recording::Record;
use crate::text_lines::MAX_LINE_BYTES;

pub use folder::UjiMagCollection;
pub use walk::{MAX_ROWS, MAX_SEGMENTS, UjiMagSegment, UjiMagWalk};

pub(crate) use rows::is_uji_mag;

/// The records of one walk, in order of time.
///
/// The places come last in the file and apply to its rows, so that the walk is read whole, at most [`MAX_ROWS`] rows,
/// before the first record. Waypoints come in the floor frame of [`with_georeference`](Self::with_georeference), or
/// else in metres east and north of the first.
///
/// # Errors
/// The only item is an error when reading fails or when [`UjiMagWalk::read`] does.
///
/// # Example
/// ```
/// use fieldwalk_formats::{Record, uji_mag::UjiMagReader};
///
/// let text = "\
/// 1000 0 20 -40 0.0 0.0 0.0 90 0 0
/// 1100 1 21 -40 0.1 0.2 0.3 91 0 0
/// 1200 1 21 -40 0.2 0.1 0.0 91 0 0
/// <1>
/// 39.9938 -0.0738 39.9939 -0.0738 0 2
/// ";
/// let records: Vec<Record> = UjiMagReader::new(text.as_bytes(), "l1n_01.txt").collect::<Result<_, _>>()?;
/// let n_waypoints = records.iter().filter(|record| matches!(record, Record::Waypoint { .. })).count();
/// assert_eq!(n_waypoints, 2);
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct UjiMagReader<R> {
    source: Option<R>,
    name: PathBuf,
    georeference: Option<Georeference>,
    is_in_floor_frame: bool,
    records: std::vec::IntoIter<Record>,
    rejections: LineRejections,
}

impl UjiMagReader<BufReader<File>> {
    /// Opens the walk at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the walk", path, error))?;
        Ok(Self::new(BufReader::with_capacity(MAX_LINE_BYTES, file), path))
    }
}

impl<R: BufRead> UjiMagReader<R> {
    /// Reads the walk that `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        Self {
            source: Some(reader),
            name: name.into(),
            georeference: None,
            is_in_floor_frame: false,
            records: Vec::new().into_iter(),
            rejections: LineRejections::default(),
        }
    }

    /// The same reader, giving waypoints in the frame of the floor that lies at `georeference`.
    #[must_use]
    pub fn with_georeference(mut self, georeference: Georeference) -> Self {
        self.georeference = Some(georeference);
        self.is_in_floor_frame = true;
        self
    }

    /// Whether waypoints are in the frame of a georeferenced floor, not in metres from the first.
    pub fn is_in_floor_frame(&self) -> bool {
        self.is_in_floor_frame
    }

    /// The lines left out; known once the first record has been read.
    pub fn rejections(&self) -> &LineRejections {
        &self.rejections
    }
}

impl<R: BufRead> Iterator for UjiMagReader<R> {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(reader) = self.source.take() {
            let walk = match UjiMagWalk::read(reader, &self.name) {
                Ok(walk) => walk,
                Err(error) => return Some(Err(error)),
            };
            self.rejections = walk.rejections().clone();
            let of_first = |segment: &UjiMagSegment| georeference_at(segment.start_deg);
            let georeference = self.georeference.or_else(|| walk.segments().first().map(of_first));
            self.records = walk.records(georeference.unwrap_or_default()).into_iter();
        }
        self.records.next().map(Ok)
    }
}
