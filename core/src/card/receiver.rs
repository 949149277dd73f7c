//! A card's frames, as they arrive, to its rounds in order.

use std::collections::VecDeque;

use fieldwalk_codec::{CardFrame, CardRepr, CardRound};
use serde::{Deserialize, Serialize};

use crate::attitude::AttitudeEstimate;
use crate::geometry::wrap_rad;
use crate::magnetic::feature::{FieldRead, LevelField};
use crate::pedestrian::StepEvent;
use crate::step::{CardStepCounter, MaxMin, StepCycle};
use crate::time::{Duration, Timestamp};

/// Time from frame to frame, in seconds: a second and the five milliseconds by which Bluetooth delays on average.
const ROUND_S: f64 = 1.005;
/// After more lost rounds in a row the next frame begins anew.
const MAX_LOST: i64 = 5;
/// A frame may come so many rounds before or after its time, and this share of the time that has passed: receivers'
/// networks delay, clocks differ.
const TOLERANCE: i64 = 3;
const TOLERANCE_SHARE: f64 = 0.02;
/// Least duration of a round: frames that were delayed may come at once.
const SHORTEST: Duration = Duration::from_millis(1);

/// What became of the frames of a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CardCounts {
    /// Frames that became a round.
    pub n_rounds: u64,
    /// Frames heard again, as when several access points hear one.
    pub n_repeated: u64,
    /// Frames that came after a later one.
    pub n_late: u64,
    /// Bytes that are no card frame.
    pub n_malformed: u64,
    /// Frames of another card than the first that was heard.
    pub n_foreign: u64,
    /// Lost rounds of which the next frame told the field's strength.
    pub n_refilled: u64,
    /// Lost rounds of which nothing is known.
    pub n_unknown: u64,
    /// Times that the stream began anew: a card that was reset, or a silence too long to bridge.
    pub n_restarts: u64,
}

/// Puts the frames of one card in order and makes each a round.
///
/// A frame is placed by its sequence number and by the receiver's clock, which tells how often the number has wrapped. It
/// is taken when it comes; one that comes after a later one is lost. Of one lost round, or of the last of up to five, the
/// next frame tells `|B|`; its steps and its orientation are unknown, and taken to be the mean of the rounds on either
/// side. The same holds for a round whose card measured no motion, with the round before in place of the mean.
///
/// # Source
/// Kwak 2018, §4.1: "to make up for missing a single beacon frame, the device also sends the magnetic field data of the
/// previous round". What is assumed of its steps is ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardReceiver {
    card_id: Option<u16>,
    last: Option<Round>,
    counter: CardStepCounter,
    ready: VecDeque<StepEvent>,
    counts: CardCounts,
}

/// The latest round that was heard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Round {
    time: Timestamp,
    sequence: u8,
    n_steps: u8,
    heading_rad: f32,
}

/// Where a frame belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// So many rounds after the last that was heard.
    After(i64),
    Repeated,
    Late,
    Anew,
}

impl Default for CardReceiver {
    fn default() -> Self {
        Self {
            card_id: None,
            last: None,
            counter: CardStepCounter::default(),
            ready: VecDeque::with_capacity(MAX_LOST as usize + 3),
            counts: CardCounts::default(),
        }
    }
}

impl CardReceiver {
    /// Takes in the bytes of an advertisement, received at `time`: a frame, or anything else, which is counted.
    pub fn push(&mut self, time: Timestamp, bytes: &[u8]) {
        let Ok(repr) = CardFrame::new_checked(bytes).and_then(|frame| CardRepr::parse(&frame)) else {
            self.counts.n_malformed += 1;
            return;
        };
        if *self.card_id.get_or_insert(repr.header.card_id) != repr.header.card_id {
            self.counts.n_foreign += 1;
            return;
        }
        // Within what networks delay a clock that goes backwards stands still; by more, it was set back.
        let held = self.last.map_or(time, |last| time.max(last.time));
        let time = if held.secs_since(time) > TOLERANCE as f64 * ROUND_S { time } else { held };
        match self.place_of(time, &repr) {
            Place::Repeated => self.counts.n_repeated += 1,
            Place::Late => self.counts.n_late += 1,
            Place::Anew => self.begin(time, &repr),
            Place::After(n) => self.follow(time, &repr, n - 1),
        }
    }

    /// The next round in order of time.
    pub fn pop(&mut self) -> Option<StepEvent> {
        self.ready.pop_front()
    }

    /// The latest orientation, clockwise from magnetic north, in radians; 0 before any.
    pub fn heading_rad(&self) -> f32 {
        self.last.map_or(0.0, |last| last.heading_rad)
    }

    /// What became of the frames so far.
    pub fn counts(&self) -> CardCounts {
        self.counts
    }

    fn place_of(&self, time: Timestamp, repr: &CardRepr) -> Place {
        let Some(last) = self.last else { return Place::Anew };
        let since_s = time.secs_since(last.time);
        if since_s < 0.0 {
            return Place::Anew;
        }
        let expected = (since_s / ROUND_S).round() as i64;
        let number = i64::from(repr.header.sequence.wrapping_sub(last.sequence));
        // Of all numbers of rounds that the sequence number may stand for, the one nearest to what the clock says.
        let advance = number + 256 * (expected.saturating_sub(number) + 128).div_euclid(256);
        let off = (advance.saturating_sub(expected)).abs();
        let is_timely = off <= TOLERANCE + (TOLERANCE_SHARE * since_s) as i64;
        match advance {
            0 if is_timely => Place::Repeated,
            ..0 if is_timely => Place::Late,
            _ if repr.header.flags.just_woke => Place::Anew,
            1.. if is_timely && advance <= MAX_LOST + 1 => Place::After(advance),
            _ => Place::Anew,
        }
    }

    fn begin(&mut self, time: Timestamp, repr: &CardRepr) {
        self.counts.n_restarts += u64::from(self.last.is_some());
        self.counter = CardStepCounter::default();
        self.last = None;
        self.hear(time, repr, true);
    }

    fn follow(&mut self, time: Timestamp, repr: &CardRepr, n_lost: i64) {
        let Some(before) = self.last else { return };
        if n_lost == 0 {
            self.hear(time, repr, false);
            return;
        }
        // The thirds on either side of a hole do not follow each other.
        self.counter = CardStepCounter::default();
        self.hear(time, repr, false);
        let (Some(heard), Some(after)) = (self.ready.pop_back(), self.last) else { return };
        let turn_rad = wrap_rad(f64::from(after.heading_rad) - f64::from(before.heading_rad)) as f32;
        let span_ns = (time - before.time).as_nanos();
        let at = |k: i64| before.time + Duration::from_nanos(span_ns / (n_lost + 1) * k);
        for k in 1..=n_lost {
            let reads = if k == n_lost {
                self.counts.n_refilled += 1;
                repr.to_physical().previous_b_ut.map(strength_alone)
            } else {
                self.counts.n_unknown += 1;
                [None; 3]
            };
            let n_steps = (before.n_steps + after.n_steps).div_ceil(2);
            let heading_rad = before.heading_rad + turn_rad * (k as f32 / (n_lost + 1) as f32);
            self.ready.push_back(event([at(k - 1), at(k)], n_steps, heading_rad, reads, 0.0, false));
        }
        let start = at(n_lost).min(heard.cycle.end - SHORTEST);
        self.ready.push_back(StepEvent { cycle: StepCycle { start, ..heard.cycle }, ..heard });
    }

    fn hear(&mut self, time: Timestamp, repr: &CardRepr, is_first: bool) {
        let round = repr.to_physical();
        let assumed = self.last;
        let (n_steps, heading_rad) = if repr.header.flags.motion_missing {
            assumed.map_or((0, 0.0), |last| (last.n_steps, last.heading_rad))
        } else {
            (self.count(repr), round.orientation_rad)
        };
        let reads = [0, 1, 2].map(|third| level_read(&round, third));
        let start = assumed.map_or(time - Duration::from_secs_f64(ROUND_S), |last| last.time);
        let amplitude_m_s2 = repr.acceleration_max.iter().max().zip(repr.acceleration_min.iter().min());
        let amplitude_m_s2 = amplitude_m_s2.map_or(0.0, |(max, min)| f32::from(max.saturating_sub(*min)));
        self.ready.push_back(event([start, time], n_steps, heading_rad, reads, amplitude_m_s2, is_first));
        self.last = Some(Round { time, sequence: repr.header.sequence, n_steps, heading_rad });
        self.counts.n_rounds += 1;
    }

    fn count(&mut self, repr: &CardRepr) -> u8 {
        let thirds = repr.acceleration_max.into_iter().zip(repr.acceleration_min);
        thirds.map(|(max_m_s2, min_m_s2)| u8::from(self.counter.push(MaxMin { max_m_s2, min_m_s2 }))).sum()
    }
}

fn strength_alone(strength_ut: f32) -> Option<FieldRead> {
    (!strength_ut.is_nan()).then_some(FieldRead { strength_ut, horizontal_vertical_ut: None })
}

fn level_read(round: &CardRound, third: usize) -> Option<FieldRead> {
    let [h, v] = [round.b_h_ut[third], round.b_v_ut[third]];
    let strength_ut = (h * h + v * v).sqrt();
    (!strength_ut.is_nan()).then_some(FieldRead { strength_ut, horizontal_vertical_ut: Some([h, v]) })
}

fn event(
    [start, end]: [Timestamp; 2],
    n_steps: u8,
    heading_rad: f32,
    reads: [Option<FieldRead>; 3],
    amplitude_m_s2: f32,
    is_first: bool,
) -> StepEvent {
    let start = start.min(end - SHORTEST);
    let frequency_hz = (f64::from(n_steps) / end.secs_since(start)) as f32;
    StepEvent {
        cycle: StepCycle { start, end, frequency_hz, amplitude_m_s2, is_first },
        n_steps,
        level_heading_rad: heading_rad,
        forward_field: forward_field(&reads, heading_rad),
        end_strength_ut: reads[2].map(|read| read.strength_ut),
        reads,
        attitude: AttitudeEstimate::default(),
        field_bias_reset: false,
    }
}

/// The field of a card in its forward frame, by its orientation: as much of a vector as a frame holds.
fn forward_field(reads: &[Option<FieldRead>; 3], heading_rad: f32) -> Option<LevelField> {
    let level = || reads.iter().flatten().filter_map(|read| read.horizontal_vertical_ut);
    let n = level().count() as f32;
    let mean = |c: usize| level().map(|read_ut| read_ut[c]).sum::<f32>() / n;
    let (sin, cos) = libm::sincosf(heading_rad);
    (n > 0.0).then(|| LevelField { field_ut: [-mean(0) * sin, mean(0) * cos, mean(1)] })
}

#[cfg(test)]
mod tests;
