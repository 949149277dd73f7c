//! What the tests of all text logs share.
#![allow(dead_code, clippy::expect_used)]

use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::ilc::LineRejections;
use fieldwalk_formats::recording::RecordSource;
use fieldwalk_formats::{FormatError, Record};

/// Everything that `log` gives, what it rejected, and the error that ended it.
pub fn read_all(mut log: impl RecordSource) -> (Vec<Record>, LineRejections, Option<FormatError>) {
    let (mut records, mut last_error) = (Vec::new(), None);
    for item in log.by_ref() {
        assert!(last_error.is_none(), "an error is the last item");
        match item {
            Ok(record) => records.push(record),
            Err(error) => last_error = Some(error),
        }
    }
    let rejections = log.line_rejections().cloned().expect("a text log counts its lines");
    assert_eq!(log.losses().n_malformed, rejections.total());
    (records, rejections, last_error)
}

/// A sample `ns` nanoseconds after the origin.
pub fn sample_at_ns(ns: i64, reading: Reading) -> Record {
    Record::Sample(Sample { time: Timestamp::from_nanos(ns), reading })
}

/// A sample `ms` milliseconds after the origin.
pub fn sample(ms: i64, reading: Reading) -> Record {
    sample_at_ns(ms * 1_000_000, reading)
}

/// A sighting.
pub fn radio(transmitter: TransmitterId, rssi_dbm: f32) -> Reading {
    Reading::Radio(RadioSighting { transmitter, rssi_dbm })
}
