//! A signal read at a fixed rate, from samples that come as they please.

use serde::{Deserialize, Serialize};

use crate::step::fixed_array;
use crate::time::{Duration, Timestamp};

/// Reads `N` channels at a fixed rate by linear interpolation between samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct FixedRate<const N: usize> {
    period: Duration,
    max_gap: Duration,
    last_time: Option<Timestamp>,
    #[serde(with = "fixed_array")]
    last: [f32; N],
    next: Timestamp,
}

impl<const N: usize> FixedRate<N> {
    /// Reads every `period`; a gap longer than `max_gap` is not read across.
    pub(super) fn new(period: Duration, max_gap: Duration) -> Self {
        Self { period, max_gap, last_time: None, last: [0.0; N], next: Timestamp::MIN }
    }

    /// Whether a sample at `time` does not continue the last: it is the first, or comes after a gap.
    pub(super) fn starts_anew(&self, time: Timestamp) -> bool {
        self.last_time.is_none_or(|last| {
            let gap = time - last;
            gap > self.max_gap || gap.as_nanos() < -self.max_gap.as_nanos()
        })
    }

    /// Takes a sample in and hands each reading that it completes to `read`.
    ///
    /// A sample that does not come after the last is passed over, unless the clock was set back by more than the
    /// longest gap.
    pub(super) fn push(
        &mut self,
        time: Timestamp,
        values: [f32; N],
        mut read: impl FnMut(Timestamp, [f32; N]),
    ) {
        let continued = self.last_time.filter(|_| !self.starts_anew(time));
        let last = self.last;
        let Some(last_time) = continued else {
            read(time, values);
            self.next = time + self.period;
            (self.last_time, self.last) = (Some(time), values);
            return;
        };
        if time <= last_time {
            return;
        }
        let gap_s = time.secs_since(last_time);
        while self.next <= time && self.next < Timestamp::MAX {
            let share = (self.next.secs_since(last_time) / gap_s) as f32;
            let mut reading = last;
            for c in 0..N {
                reading[c] += share * (values[c] - last[c]);
            }
            read(self.next, reading);
            self.next = self.next + self.period;
        }
        (self.last_time, self.last) = (Some(time), values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_are_interpolated_and_gaps_are_not() {
        let ms = Timestamp::from_millis;
        let mut rate = FixedRate::new(Duration::from_millis(20), Duration::from_millis(100));
        let mut readings = Vec::new();
        let mut push = |time_ms: i64, value: f32| {
            rate.push(ms(time_ms), [value], |time, [value]| {
                readings.push((time.as_nanos() / 1_000_000, value))
            })
        };
        for (time_ms, value) in [(0, 0.0), (50, 5.0), (45, 9.0), (60, 5.0), (161, 1.0), (20, 7.0)] {
            push(time_ms, value);
        }
        assert_eq!(readings, [(0, 0.0), (20, 2.0), (40, 4.0), (60, 5.0), (161, 1.0), (20, 7.0)]);
    }
}
