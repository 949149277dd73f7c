//! What a recording holds, whatever its file format.

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::Sample;
use fieldwalk::time::Timestamp;

/// One entry of a recording: a sensor reading, or a place at which the walker said to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Record {
    /// A sensor reading.
    Sample(Sample),
    /// The walker stood at a known point of the floor frame.
    Waypoint {
        /// When the walker stood there.
        time: Timestamp,
        /// Where, in the floor frame.
        point: Point2,
    },
}

impl Record {
    /// When the record was taken.
    pub fn time(&self) -> Timestamp {
        match self {
            Record::Sample(sample) => sample.time,
            Record::Waypoint { time, .. } => *time,
        }
    }
}
