//! Records in order of time: logs are written in the order in which readings arrive.
//!
//! In the public collection beacons arrive up to 2.3 s and waypoints up to 21 s after what was read at their time. A
//! log is no stream from a phone: nobody waits for its next fix, so nothing needs to be lost for being late.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use fieldwalk::time::Timestamp;

use super::Record;
use crate::error::FormatError;

/// Records held back, a minute of a phone's at 50 Hz; about 1 MB.
const MAX_WAITING: usize = 16_384;

/// Puts the records of a log in order of time, holding back a bounded number of them.
///
/// A waypoint comes after the samples of its instant; equal records otherwise keep the log's order. A number of
/// records, not a span of time, is held back: one stamp far in the future then does not push all others out. A record
/// that comes later than that is passed on out of order.
///
/// An error comes after all records that were read before it.
///
/// # Example
/// ```no_run
/// use fieldwalk_formats::recording::{InOrder, open_recording};
///
/// let mut log = InOrder::new(open_recording("walk.txt".as_ref())?);
/// for record in log.by_ref() {
///     println!("{:?}", record?);
/// }
/// println!("{}", log.source().losses());
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
#[derive(Debug)]
pub struct InOrder<I> {
    records: I,
    waiting: BinaryHeap<Reverse<Waiting>>,
    n_taken: u64,
    failed: Option<FormatError>,
}

impl<I: Iterator<Item = Result<Record, FormatError>>> InOrder<I> {
    /// Orders `records`.
    pub fn new(records: I) -> Self {
        Self { records, waiting: BinaryHeap::with_capacity(MAX_WAITING + 1), n_taken: 0, failed: None }
    }

    /// Where the records come from: the log, to ask what it lost.
    pub fn source(&self) -> &I {
        &self.records
    }
}

impl<I: Iterator<Item = Result<Record, FormatError>>> Iterator for InOrder<I> {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.failed.is_none() && self.waiting.len() <= MAX_WAITING {
            match self.records.next() {
                Some(Ok(record)) => {
                    self.waiting.push(Reverse(Waiting { record, order: self.n_taken }));
                    self.n_taken += 1;
                }
                Some(Err(error)) => self.failed = Some(error),
                None => break,
            }
        }
        match self.waiting.pop() {
            Some(Reverse(next)) => Some(Ok(next.record)),
            None => self.failed.take().map(Err),
        }
    }
}

/// A record and its place in the log.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    record: Record,
    order: u64,
}

impl Waiting {
    fn key(&self) -> (Timestamp, bool, u64) {
        (self.record.time(), matches!(self.record, Record::Waypoint { .. }), self.order)
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::geometry::Point2;
    use fieldwalk::sensor::{Reading, Sample};

    fn sample(ms: i64) -> Record {
        let reading = Reading::Pressure { pressure_hpa: 1_000.0 };
        Record::Sample(Sample { time: Timestamp::from_millis(ms), reading })
    }

    fn waypoint(ms: i64) -> Record {
        Record::Waypoint { time: Timestamp::from_millis(ms), point: Point2::default() }
    }

    fn ordered(records: impl IntoIterator<Item = Record>) -> Vec<Record> {
        InOrder::new(records.into_iter().map(Ok)).collect::<Result<_, _>>().unwrap()
    }

    #[test]
    fn records_come_in_order_of_time_and_waypoints_last() {
        let records = [waypoint(20), sample(10), sample(30), waypoint(10), sample(20)];
        assert_eq!(ordered(records), [sample(10), waypoint(10), sample(20), waypoint(20), sample(30)]);
    }

    #[test]
    fn one_broken_stamp_disturbs_no_other_record() {
        let n = 3 * MAX_WAITING as i64;
        let late_by_100 = |k: i64| sample(if k % 7 == 0 { k - 100 } else { k });
        let records = std::iter::once(sample(1 << 40)).chain((0..n).map(late_by_100));
        let times: Vec<_> = ordered(records).iter().map(Record::time).collect();
        assert_eq!(times.len() as i64, n + 1);
        assert!(times.is_sorted());
    }

    #[test]
    fn a_log_is_never_held_whole() {
        let mut log = InOrder::new((0..).map(|k| Ok(sample(k))));
        for _ in 0..5 * MAX_WAITING {
            assert!(log.next().is_some() && log.waiting.len() <= MAX_WAITING);
        }
        assert!(log.waiting.capacity() < 3 * MAX_WAITING);
    }

    #[test]
    fn an_error_comes_after_what_was_read_before_it() {
        let error = FormatError::malformed("torn", "");
        let log = InOrder::new([Ok(sample(2)), Ok(sample(1)), Err(error)].into_iter());
        let (records, errors): (Vec<_>, Vec<_>) = log.partition(Result::is_ok);
        assert_eq!((records.len(), errors.len()), (2, 1));
    }
}
