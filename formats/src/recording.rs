//! What a recording holds, whatever its file format, and recordings as MCAP.
//!
//! A recording is an [MCAP](https://mcap.dev/spec) file, version 1 of our use of it:
//!
//! * one topic for each kind of record (`/specific_force`, `/angular_rate`, `/magnetic_field`,
//!   `/uncalibrated_magnetic_field`, `/radio`, `/pressure`, `/waypoint`, `/card_frame`), numbered 1 to 8 in every file;
//! * messages are JSON objects with a JSON Schema; units stand in the names: `{"x_m_s2":0.1,"y_m_s2":0.2,"z_m_s2":9.8}`.
//!   A number that is not finite is left out and named in `not_finite`: `{"rssi_dbm":…}` becomes
//!   `{"not_finite":{"rssi_dbm":"NaN"}}`, with `NaN`, `Infinity` or `-Infinity`;
//! * `log_time` and `publish_time` are the record's time. A time before the clock's origin is 0 there, and stands in
//!   the message as `time_ns`;
//! * the metadata record `fieldwalk` before all chunks says `format_version`, `device`, `software`, `floor` and
//!   `start_unix_ms`: see [`RecordingInfo`].
//!
//! [`RecordingWriter`] writes them live, [`RecordingReader`] streams them, [`open_recording`] opens any log that this
//! crate can read, and [`InOrder`] puts its records in order of time.

mod channel;
mod chunk;
mod declared;
mod framing;
mod in_order;
mod info;
mod losses;
mod message;
mod open;
mod reader;
mod writer;

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::Sample;
use fieldwalk::time::Timestamp;

pub use in_order::InOrder;
pub use info::RecordingInfo;
pub use losses::Losses;
pub use open::{RecordSource, open_recording, open_recording_on};
pub use reader::RecordingReader;
pub use writer::RecordingWriter;

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
