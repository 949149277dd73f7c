//! Puts samples that arrive a little late back into the order of time.

use std::cmp::Ordering;
use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::sensor::{Reading, Sample};
use crate::time::{Duration, Timestamp};

/// How long a sample may be late, by default.
pub const DEFAULT_REORDER_WINDOW: Duration = Duration::from_millis(200);
/// A step back longer than this, or forward before any sensor of motion was heard, is taken for a broken stamp until others
/// agree with it: cards and beacons are heard once in a while.
const JUMP: Duration = Duration::from_millis(60_000);
/// The same for a step forward once there are sensors of motion, which are silent only when all are. A stamp that were
/// believed would make everything late until its time has come.
const JUMP_AHEAD_OF_MOTION: Duration = Duration::from_millis(2_000);
/// So many samples in a row must agree with a jump before the clock is believed to have jumped, or three over
/// `JUMP_WITNESSED` where samples are rare. They are kept until then, so that none is lost.
const JUMP_WITNESSES: usize = 20;
const JUMP_WITNESSED: Duration = Duration::from_millis(2_000);
/// Witnesses are no farther apart: a card sends a frame a second, and some are lost.
const WITNESSES_APART: Duration = Duration::from_millis(3_500);

/// What was refused, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rejections {
    /// NaN, infinite or beyond what the sensor's physics allows.
    pub implausible: u64,
    /// Older than the reorder window.
    pub late: u64,
    /// The same sensor and time again.
    pub duplicate: u64,
    /// Stamped far ahead of every other sample: by seconds where there are sensors of motion, else by a minute.
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
    /// Samples in a row that agree with each other but not with the clock so far.
    witnesses: Vec<Sample>,
    /// Whether a sensor of motion was ever heard.
    has_motion: bool,
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
            witnesses: Vec::with_capacity(JUMP_WITNESSES),
            has_motion: false,
            rejections: Rejections::default(),
        }
    }

    /// Takes a sample in, or counts why not.
    pub fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            self.rejections.implausible += 1;
            return;
        }
        let ahead = if self.has_motion { JUMP_AHEAD_OF_MOTION } else { JUMP };
        let mut sample = *sample;
        if sample.time <= self.released {
            if self.newest.is_some_and(|newest| newest - sample.time > JUMP) {
                self.doubt(&sample);
                return;
            }
            if !self.is_heard_beside(&sample) {
                self.rejections.late += 1;
                return;
            }
            sample.time = self.released + Duration::from_nanos(1);
        } else if self.newest.is_some_and(|newest| sample.time - newest > ahead) {
            self.doubt(&sample);
            return;
        }
        self.disbelieve();
        self.insert(&sample);
    }

    /// Whether `sample` is what another access point, or the same, heard a moment before a card's frame that did not wait.
    fn is_heard_beside(&self, sample: &Sample) -> bool {
        matches!(sample.reading, Reading::Radio(_))
            && !self.has_motion
            && self.released - sample.time < self.window
    }

    fn insert(&mut self, sample: &Sample) {
        self.has_motion |= matches!(
            sample.reading,
            Reading::SpecificForce(_)
                | Reading::AngularRate(_)
                | Reading::MagneticField(_)
                | Reading::UncalibratedMagneticField { .. }
        );
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

    /// Keeps a sample whose stamp contradicts the clock, and follows its clock once enough agree with it.
    fn doubt(&mut self, sample: &Sample) {
        let is_near = |last: &Sample| {
            let apart = sample.time - last.time;
            apart.max(-apart) <= WITNESSES_APART
        };
        if !self.witnesses.last().is_some_and(is_near) {
            self.disbelieve();
        }
        self.witnesses.push(*sample);
        let (n, first) = (self.witnesses.len(), self.witnesses[0].time);
        if n < JUMP_WITNESSES && (n < 3 || sample.time - first < JUMP_WITNESSED) {
            return;
        }
        if first <= self.released {
            self.waiting.clear();
            self.newest = None;
            self.released = Timestamp::MIN;
        }
        for k in 0..n {
            let witness = self.witnesses[k];
            self.insert(&witness);
        }
        self.witnesses.clear();
    }

    /// Refuses what contradicted the clock: a sample that agrees with it came.
    fn disbelieve(&mut self) {
        for witness in self.witnesses.drain(..) {
            if witness.time <= self.released {
                self.rejections.late += 1;
            } else {
                self.rejections.jumped += 1;
            }
        }
    }

    /// The next sample in order, once it is older than the window.
    pub fn pop(&mut self) -> Option<Sample> {
        let due = self.newest? - self.window;
        self.pop_until(due)
    }

    /// The next sample in order, however young: nothing earlier will come.
    pub fn pop_all(&mut self) -> Option<Sample> {
        self.disbelieve();
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
    use crate::sensor::{RadioSighting, TransmitterId};
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
        window.push(&force(410, 0.0));
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
        assert_eq!(window.rejections(), Rejections { jumped: 1, ..Rejections::default() });
        assert_eq!(window.newest, Some(Timestamp::from_millis(900_990)));
        let out: Vec<i64> =
            core::iter::from_fn(|| window.pop_all()).map(|s| s.time.as_nanos() / 1_000_000).collect();
        assert_eq!(out, [0, 10].into_iter().chain((0..100).map(|k| 900_000 + 10 * k)).collect::<Vec<_>>());
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
        assert_eq!(window.rejections(), Rejections::default());
        assert_eq!(out.first(), Some(&0));
        assert!(out.is_sorted());
    }

    #[test]
    fn a_sensor_on_another_clock_does_not_make_the_others_late() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        let heard = |ms| {
            let sighting = RadioSighting { transmitter: TransmitterId::BleAddress([1; 6]), rssi_dbm: -70.0 };
            Sample { time: Timestamp::from_millis(ms), reading: Reading::Radio(sighting) }
        };
        let mut n_out = 0;
        for k in 0..1_000 {
            window.push(&force(10 * k, 0.0));
            if k % 10 == 0 {
                window.push(&heard(30_000 + 10 * k));
            }
            n_out += drain(&mut window).len();
        }
        assert_eq!(window.rejections(), Rejections { jumped: 100, ..Rejections::default() });
        assert!(n_out > 970, "{n_out}");
    }

    #[test]
    fn a_pause_of_all_sensors_loses_no_sample() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        let times = (0..100).chain(800..900).map(|k| 10 * k);
        let mut out: Vec<i64> = Vec::new();
        for ms in times.clone() {
            window.push(&force(ms, 0.0));
            out.extend(drain(&mut window));
        }
        out.extend(core::iter::from_fn(|| window.pop_all()).map(|s| s.time.as_nanos() / 1_000_000));
        assert_eq!(out, times.collect::<Vec<_>>());
        assert_eq!(window.rejections(), Rejections::default());
    }

    #[test]
    fn a_card_that_was_away_for_minutes_is_heard_again() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        let frame = |ms| Sample { time: Timestamp::from_millis(ms), reading: Reading::CardFrame([0; 31]) };
        // A round takes 1.005 s in the mean; one access point alone hears it.
        let times: Vec<i64> = (0..50).chain(350..400).map(|k| 1_005 * k).collect();
        let mut out = Vec::new();
        for &ms in &times {
            window.push(&frame(ms));
            out.extend(core::iter::from_fn(|| window.pop_now()).map(|s| s.time.as_nanos() / 1_000_000));
        }
        assert_eq!(out, times);
        assert_eq!(window.rejections(), Rejections::default());
    }

    #[test]
    fn what_a_second_access_point_heard_a_little_before_is_kept() {
        let mut window = ReorderWindow::new(DEFAULT_REORDER_WINDOW);
        let at = |ms, reading| Sample { time: Timestamp::from_millis(ms), reading };
        let heard = |k| RadioSighting { transmitter: TransmitterId::BleAddress([k; 6]), rssi_dbm: -70.0 };
        window.push(&at(1_000, Reading::CardFrame([0; 31])));
        assert!(window.pop_now().is_some());
        window.push(&at(996, Reading::Radio(heard(2))));
        window.push(&at(500, Reading::Radio(heard(3))));
        assert!(window.pop_now().is_some_and(|sample| sample.reading == Reading::Radio(heard(2))));
        assert_eq!(window.rejections(), Rejections { late: 1, ..Rejections::default() });
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
