//! Puts samples that arrive a little late back into the order of time.

use std::cmp::Ordering;
use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::sensor::{Reading, Sample};
use crate::time::{Duration, Timestamp};

/// How long a sample may be late, by default.
pub const DEFAULT_REORDER_WINDOW: Duration = Duration::from_millis(200);
/// A step forward or back longer than this is taken for a broken stamp until others agree with it.
const JUMP: Duration = Duration::from_millis(60_000);
/// So many samples in a row must agree with a jump before the clock is believed to have jumped.
const JUMP_WITNESSES: u32 = 20;

/// What was refused, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rejections {
    /// NaN, infinite or beyond what the sensor's physics allows.
    pub implausible: u64,
    /// Older than the reorder window.
    pub late: u64,
    /// The same sensor and time again.
    pub duplicate: u64,
    /// Stamped more than a minute ahead of every other sample.
    pub jumped: u64,
}

impl Rejections {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.implausible + self.late + self.duplicate + self.jumped
    }
}

/// A buffer that gives samples back in order of time once nothing earlier can come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReorderWindow {
    window: Duration,
    waiting: VecDeque<Sample>,
    newest: Option<Timestamp>,
    /// Everything up to here has been given out.
    released: Timestamp,
    jump: Option<(Timestamp, u32)>,
    rejections: Rejections,
}

impl ReorderWindow {
    /// An empty buffer for samples up to `window` late.
    pub fn new(window: Duration) -> Self {
        Self {
            window,
            waiting: VecDeque::with_capacity(512),
            newest: None,
            released: Timestamp::MIN,
            jump: None,
            rejections: Rejections::default(),
        }
    }

    /// Takes a sample in, or counts why not.
    pub fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            self.rejections.implausible += 1;
            return;
        }
        if sample.time <= self.released {
            let is_set_back = self.newest.is_some_and(|newest| newest - sample.time > JUMP);
            if !is_set_back || !self.is_believed_jump(sample.time) {
                self.rejections.late += 1;
                return;
            }
            self.waiting.clear();
            self.newest = None;
            self.released = Timestamp::MIN;
        }
        if self.newest.is_some_and(|newest| sample.time - newest > JUMP)
            && !self.is_believed_jump(sample.time)
        {
            self.rejections.jumped += 1;
            return;
        }
        self.jump = None;
        let mut at = self.waiting.len();
        while at > 0 && order(&self.waiting[at - 1], sample).is_gt() {
            at -= 1;
        }
        let is_same = |w: &&Sample| w.time == sample.time && w.reading.rank() == sample.reading.rank();
        let mut same = self.waiting.range(..at).rev().take_while(is_same);
        let is_radio = matches!(sample.reading, Reading::Radio(_));
        if same.any(|w| !is_radio || w.reading == sample.reading) {
            self.rejections.duplicate += 1;
            return;
        }
        self.waiting.insert(at, *sample);
        self.newest = Some(self.newest.map_or(sample.time, |newest| newest.max(sample.time)));
    }

    fn is_believed_jump(&mut self, time: Timestamp) -> bool {
        let near = self.jump.filter(|(last, _)| {
            let apart = time - *last;
            apart.max(-apart) < Duration::from_millis(1_000)
        });
        let witnesses = near.map_or(1, |(_, n)| n + 1);
        self.jump = Some((time, witnesses));
        witnesses >= JUMP_WITNESSES
    }

    /// The next sample in order, once it is older than the window.
    pub fn pop(&mut self) -> Option<Sample> {
        let due = self.newest? - self.window;
        self.pop_until(due)
    }

    /// The next sample in order, however young: nothing earlier will come.
    pub fn pop_all(&mut self) -> Option<Sample> {
        self.pop_until(Timestamp::MAX)
    }

    /// The next sample in order, however young; others of its instant may still come.
    pub fn pop_now(&mut self) -> Option<Sample> {
        let sample = self.waiting.pop_front()?;
        self.released = self.released.max(sample.time - Duration::from_nanos(1));
        Some(sample)
    }

    fn pop_until(&mut self, due: Timestamp) -> Option<Sample> {
        let is_due = self.waiting.front().is_some_and(|next| next.time <= due);
        let sample = if is_due { self.waiting.pop_front() } else { None };
        let reached = sample.map_or(due.min(self.newest.unwrap_or(Timestamp::MIN)), |s| s.time);
        self.released = self.released.max(reached);
        sample
    }

    /// What was refused so far.
    pub fn rejections(&self) -> Rejections {
        self.rejections
    }
}

/// Time first, then the sensor's rank; packets of one instant by sender, then power, so that arrival cannot matter.
fn order(a: &Sample, b: &Sample) -> Ordering {
    let packets = match (&a.reading, &b.reading) {
        (Reading::Radio(a), Reading::Radio(b)) => {
            a.transmitter.cmp(&b.transmitter).then(a.rssi_dbm.total_cmp(&b.rssi_dbm))
        }
        _ => Ordering::Equal,
    };
    (a.time, a.reading.rank()).cmp(&(b.time, b.reading.rank())).then(packets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn force(ms: i64, x: f32) -> Sample {
        Sample { time: Timestamp::from_millis(ms), reading: Reading::SpecificForce([x, 0.0, 9.8]) }
    }

    fn drain(window: &mut ReorderWindow) -> Vec<i64> {
        core::iter::from_fn(|| window.pop()).map(|s| s.time.as_nanos() / 1_000_000).collect()
    }

    #[test]
    fn late_samples_find_their_place_and_later_ones_are_counted() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        for ms in [0, 100, 250, 150, 400] {
            window.push(&force(ms, 0.0));
        }
        assert_eq!(drain(&mut window), [0, 100, 150]);
        window.push(&force(190, 0.0));
        window.push(&force(250, 1.0));
        window.push(&force(300, f32::NAN));
        window.push(&force(1_000_000_000, 0.0));
        assert_eq!(window.rejections(), Rejections { implausible: 1, late: 1, duplicate: 1, jumped: 1 });
    }

    #[test]
    fn one_broken_stamp_is_refused_but_a_clock_that_jumped_is_followed() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        window.push(&force(0, 0.0));
        window.push(&force(500_000, 0.0));
        window.push(&force(10, 0.0));
        for k in 0..100 {
            window.push(&force(900_000 + 10 * k, 0.0));
        }
        assert_eq!(window.rejections().jumped, 1 + u64::from(JUMP_WITNESSES) - 1);
        assert_eq!(window.newest, Some(Timestamp::from_millis(900_990)));
    }

    #[test]
    fn a_clock_that_was_set_back_is_followed_as_after_a_broken_first_stamp() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        window.push(&force(5_000_000, 0.0));
        assert_eq!(drain(&mut window), []);
        let mut out = Vec::new();
        for k in 0..100 {
            window.push(&force(10 * k, 0.0));
            out.extend(drain(&mut window));
        }
        assert_eq!(window.rejections().late, u64::from(JUMP_WITNESSES) - 1);
        assert_eq!(out.first(), Some(&190));
        assert!(out.is_sorted());
    }

    proptest! {
        #[test]
        fn what_comes_out_is_in_order_whatever_goes_in(times in proptest::collection::vec(0i64..3_000, 1..80)) {
            let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
            let mut out = Vec::new();
            for &ms in &times {
                window.push(&force(ms, ms as f32));
                out.extend(drain(&mut window));
            }
            out.extend(core::iter::from_fn(|| window.pop_all()).map(|s| s.time.as_nanos() / 1_000_000));
            prop_assert!(out.windows(2).all(|w| w[0] < w[1]));
            prop_assert_eq!(out.len() as u64 + window.rejections().total(), times.len() as u64);
        }
    }
}
