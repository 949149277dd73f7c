//! The facade: samples in, fixes out.

pub(crate) mod fix;
mod silence;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use fix::{Fix, Mode};
use silence::{Lost, Silence};

use crate::card::CardCounts;
use crate::front_end::FrontEnd;
use crate::geometry::{Point2, wrap_rad};
use crate::map::FloorIndex;
use crate::observation::radio::RadioObservation;
use crate::pedestrian::StepEvent;
use crate::reorder::{DEFAULT_REORDER_WINDOW, Rejections, ReorderWindow};
use crate::sensor::{Reading, Sample, TransmitterId};
use crate::system::Recipe;
use crate::time::{Duration, Timestamp};
use crate::tracker::{Tracker, TrackerState};

/// Where someone is said to be: a tap on the plan, a QR code, GNSS at the door.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionHint {
    /// The place, in the floor frame.
    pub point: Point2,
    /// How far off it may be along each axis, in metres; 0.1 to 1000.
    pub radius_m: f64,
    /// The floor's ordinal.
    pub floor: i32,
    /// When.
    pub time: Timestamp,
    /// Which way they walk from there, if somebody knows.
    #[serde(default)]
    pub direction: Option<HintedDirection>,
}

/// Which way someone is said to walk: an arrow on the plan, the way that leads from a door.
///
/// Systems that carry a direction on by the gyroscope begin with this one instead of the compass's; those that take every
/// step's direction from the compass make nothing of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HintedDirection {
    /// The heading at the hint's time, in radians, clockwise from the floor's y axis.
    pub heading_rad: f64,
    /// Its standard deviation, in radians; 0.01 to π.
    pub sd_rad: f64,
}

/// Why a call was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PositionError {
    /// The hint names another floor than the map's.
    WrongFloor {
        /// The hint's floor.
        hinted: i32,
        /// The map's floor.
        mapped: i32,
    },
    /// The hint's point, radius or direction is not finite or out of its range, or the point is off the plan by more than
    /// the radius.
    BadHint,
    /// The asked time is before the last consumed sample or the hint.
    TimeInPast {
        /// What was asked.
        asked: Timestamp,
        /// The last consumed sample, or a later hint.
        consumed: Timestamp,
    },
    /// Nothing is known yet: give a hint, or walk a step.
    NoFix,
    /// The snapshot was taken with another recipe, seed or floor.
    ForeignSnapshot,
}

impl core::fmt::Display for PositionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::WrongFloor { hinted, mapped } => {
                write!(f, "the hint is on floor {hinted}, the map on floor {mapped}: open that floor's map")
            }
            Self::BadHint => {
                write!(f, "the hint is not a place on this plan: check its point, radius and direction")
            }
            Self::TimeInPast { asked, consumed } => {
                let behind_ms = (*consumed - *asked).as_nanos() / 1_000_000;
                write!(
                    f,
                    "asked for a time {behind_ms} ms before the last consumed sample or hint: ask for now or later"
                )
            }
            Self::NoFix => write!(f, "no position yet: give a hint, or let the wearer walk a few steps"),
            Self::ForeignSnapshot => {
                write!(f, "the snapshot belongs to another system, seed or floor: restore it with those")
            }
        }
    }
}

impl core::error::Error for PositionError {}

/// All that a [`Positioner`] remembers; restores it to the bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    recipe: Recipe,
    seed: u64,
    floor: String,
    front_end: FrontEnd,
    reorder: ReorderWindow,
    tracker: TrackerState,
    progress: Progress,
}

/// What the facade itself remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Progress {
    last_consumed: Option<Timestamp>,
    last_step: Option<StepEvent>,
    hint_time: Option<Timestamp>,
    #[serde(default)]
    silence: Silence,
    heard: Vec<Heard>,
    /// When the open radio round began, and what was heard in it.
    round_start: Option<Timestamp>,
    heard_in_round: Vec<Heard>,
}

/// Length of a radio round: beacons are sent several times a second, cards' frames once.
const RADIO_ROUND: Duration = Duration::from_millis(1_000);

/// Sightings of one known transmitter since the last step or in a radio round.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Heard {
    transmitter: u32,
    sum_dbm: f32,
    n: u32,
}

/// Follows one wearer on one floor.
///
/// Time and randomness come in as arguments: the same map, recipe, seed and samples give the same bits, however the
/// samples are batched.
#[derive(Clone, Debug)]
pub struct Positioner {
    seed: u64,
    front_end: FrontEnd,
    reorder: ReorderWindow,
    tracker: Tracker,
    transmitters: BTreeMap<TransmitterId, u32>,
    progress: Progress,
    observations: Vec<RadioObservation>,
}

impl Positioner {
    /// A positioner that has seen nothing, on `floor`, running `recipe` with random `seed`.
    pub fn new(floor: Arc<FloorIndex>, recipe: Recipe, seed: u64) -> Self {
        let ids = floor.map().transmitters.iter().map(|t| t.id).zip(0u32..);
        Self {
            seed,
            front_end: FrontEnd::new(recipe.front_end),
            reorder: ReorderWindow::new(DEFAULT_REORDER_WINDOW),
            transmitters: ids.collect(),
            tracker: Tracker::new(recipe, floor, seed),
            progress: Progress {
                heard: Vec::with_capacity(256),
                heard_in_round: Vec::with_capacity(256),
                ..Progress::default()
            },
            observations: Vec::with_capacity(256),
        }
    }

    /// Takes a sample in; returns a fix when that completes a step.
    ///
    /// Bad samples are counted in [`Positioner::rejections`] and change nothing else.
    pub fn push(&mut self, sample: Sample) -> Option<Fix> {
        // A card's frame waits for nothing that may be late: frames have numbers, and the next one is a second away.
        let waits = !matches!(sample.reading, Reading::CardFrame(_));
        self.reorder.push(&sample);
        let mut stepped = false;
        while let Some(next) = if waits { self.reorder.pop() } else { self.reorder.pop_now() } {
            stepped |= self.consume(&next);
        }
        if stepped { self.fix() } else { None }
    }

    /// Consumes what still waits for late samples: the recording has ended.
    pub fn flush(&mut self) {
        while let Some(next) = self.reorder.pop_all() {
            self.consume(&next);
        }
    }

    /// Starts, or starts anew, from a place that somebody knows.
    ///
    /// # Errors
    /// [`PositionError::WrongFloor`] and [`PositionError::BadHint`]; the positioner is unchanged then.
    pub fn hint(&mut self, hint: PositionHint) -> Result<(), PositionError> {
        let map = self.tracker.floor().map();
        if hint.floor != map.ordinal {
            return Err(PositionError::WrongFloor { hinted: hint.floor, mapped: map.ordinal });
        }
        let PositionHint { point, radius_m, direction, .. } = hint;
        let is_near = |m: f64, extent_m: f64| (-radius_m..=extent_m + radius_m).contains(&m);
        let is_on_plan = is_near(point.x_m, map.plan.width_m) && is_near(point.y_m, map.plan.height_m);
        if !(0.1..=1_000.0).contains(&radius_m) || !is_on_plan {
            return Err(PositionError::BadHint);
        }
        let is_direction = |told: HintedDirection| {
            told.heading_rad.is_finite() && (0.01..=core::f64::consts::PI).contains(&told.sd_rad)
        };
        if !direction.is_none_or(is_direction) {
            return Err(PositionError::BadHint);
        }
        self.tracker.place(point, radius_m);
        if let Some(HintedDirection { heading_rad, sd_rad }) = direction {
            let level_rad = self.progress.last_consumed.map(|_| self.front_end.level_heading_rad());
            self.tracker.face(heading_rad, sd_rad, level_rad);
        }
        self.progress.hint_time = Some(hint.time);
        self.progress.silence.begin_anew(hint.time);
        self.progress.last_step = None;
        Ok(())
    }

    /// The fix at the last consumed sample; nothing before a hint or a first step.
    pub fn fix(&self) -> Option<Fix> {
        let now = self.progress.last_consumed.max(self.progress.hint_time)?;
        self.fix_at(now).ok()
    }

    /// The fix at `time`, the open step extrapolated; draws nothing and changes nothing.
    ///
    /// # Errors
    /// [`PositionError::TimeInPast`] before the last consumed sample or a later hint, [`PositionError::NoFix`] before a start.
    pub fn fix_at(&self, time: Timestamp) -> Result<Fix, PositionError> {
        let last_heard = self.progress.last_consumed.max(self.progress.hint_time);
        if let Some(consumed) = last_heard.filter(|&consumed| time < consumed) {
            return Err(PositionError::TimeInPast { asked: time, consumed });
        }
        let estimate = self.tracker.estimate().ok_or(PositionError::NoFix)?;
        // Where radio is all, samples of other sensors keep nothing fresh.
        let last_known = match self.tracker.last_match() {
            Some(matched_at) => matched_at.max(self.progress.hint_time),
            None => last_heard,
        };
        let turned_rad = self.progress.last_step.map_or(0.0, |step| {
            wrap_rad(f64::from(self.front_end.level_heading_rad()) - f64::from(step.level_heading_rad))
        });
        Ok(fix::assemble(&fix::Inputs {
            map: self.tracker.floor().map(),
            accuracy: self.tracker.recipe().accuracy,
            estimate,
            mode: self.tracker.mode(),
            step_length_m: self.tracker.step_length_m(),
            last_step: self.progress.last_step.as_ref().map(|step| step.cycle),
            turned_rad,
            attitude: self.front_end.attitude(),
            last_heard: last_known,
            time,
        }))
    }

    /// Each particle's place and weight, relative to the heaviest's: for displays that show what the filter weighs.
    ///
    /// They stand where the last step ended; none before a start. Their number and order mean nothing.
    pub fn particles(&self) -> impl ExactSizeIterator<Item = (Point2, f32)> + Clone {
        let particles = self.tracker.particles();
        let places = particles.x_m.iter().zip(&particles.y_m);
        places
            .zip(&particles.log_weight)
            .map(|((&x_m, &y_m), &log_weight)| (Point2::new(x_m.into(), y_m.into()), libm::expf(log_weight)))
    }

    /// What was refused so far, by cause.
    pub fn rejections(&self) -> Rejections {
        self.reorder.rejections()
    }

    /// What became of a card's frames; nothing where none are read.
    pub fn card_counts(&self) -> Option<CardCounts> {
        self.front_end.card_counts()
    }

    /// Times that every particle died and the cloud was spread anew.
    pub fn n_recoveries(&self) -> u32 {
        self.tracker.n_recoveries()
    }

    /// All that is remembered.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            recipe: self.tracker.recipe().clone(),
            seed: self.seed,
            floor: self.tracker.floor().map().name.clone(),
            front_end: self.front_end.clone(),
            reorder: self.reorder.clone(),
            tracker: self.tracker.state().clone(),
            progress: self.progress.clone(),
        }
    }

    /// Continues from `snapshot` as if nothing had happened in between.
    ///
    /// # Errors
    /// [`PositionError::ForeignSnapshot`] when recipe, seed or floor differ; the positioner is unchanged then.
    pub fn restore(&mut self, snapshot: Snapshot) -> Result<(), PositionError> {
        let Snapshot { recipe, seed, floor, front_end, reorder, tracker, progress } = snapshot;
        if !self.tracker.fits(&tracker)
            || front_end.rule() != self.front_end.rule()
            || recipe != *self.tracker.recipe()
            || seed != self.seed
            || floor != self.tracker.floor().map().name
        {
            return Err(PositionError::ForeignSnapshot);
        }
        self.front_end = front_end;
        self.reorder = reorder;
        self.progress = progress;
        self.tracker.set_state(tracker);
        Ok(())
    }

    /// Consumes a sample in order of time; true when the fix may have changed: a step ended, or a radio round that counts.
    fn consume(&mut self, sample: &Sample) -> bool {
        let has_moved = self.tracker.uses_radio_rounds() && self.close_round(sample.time);
        if self.progress.last_consumed.is_some_and(|last| sample.time < last) {
            // The clock was set back: what was stamped before says nothing about now.
            self.progress.hint_time = None;
        }
        self.progress.last_consumed = Some(sample.time);
        match self.progress.silence.ended_by(sample) {
            Some(Lost::Sight(unseen_s)) => self.tracker.lose_sight(unseen_s),
            Some(Lost::Direction(unseen_s)) => self.tracker.lose_direction(unseen_s),
            None => {}
        }
        if self.progress.silence.is_hint_on_another_clock(sample.time) {
            self.progress.hint_time = None;
        }
        if let Reading::Radio(sighting) = sample.reading {
            self.hear(sighting.transmitter, sighting.rssi_dbm);
        }
        let Some(mut event) = self.front_end.push(sample) else { return has_moved };
        observe(&mut self.progress.heard, &mut self.observations);
        loop {
            // Who was seen at the hint's place has walked what went before.
            if self.progress.hint_time.is_none_or(|hint| event.cycle.end > hint) {
                self.tracker.step(&event, &self.observations);
                self.progress.last_step = Some(event);
            }
            let Some(next) = self.front_end.pop() else { return true };
            // What was heard belongs to the first alone.
            self.observations.clear();
            event = next;
        }
    }

    /// Hands what was heard to the tracker when `now` lies a round after the open one's start; silence too.
    fn close_round(&mut self, now: Timestamp) -> bool {
        let start = *self.progress.round_start.get_or_insert(now);
        if now < start {
            // The clock was set back: the round begins anew.
            self.progress.round_start = Some(now);
        }
        if now - start < RADIO_ROUND {
            return false;
        }
        self.progress.round_start = Some(now);
        observe(&mut self.progress.heard_in_round, &mut self.observations);
        self.tracker.hear(now, &self.observations)
    }

    fn hear(&mut self, id: TransmitterId, rssi_dbm: f32) {
        let Some(&transmitter) = self.transmitters.get(&id) else { return };
        add(&mut self.progress.heard, transmitter, rssi_dbm);
        if self.tracker.uses_radio_rounds() {
            add(&mut self.progress.heard_in_round, transmitter, rssi_dbm);
        }
    }
}

fn add(heard: &mut Vec<Heard>, transmitter: u32, rssi_dbm: f32) {
    match heard.iter_mut().find(|h| h.transmitter == transmitter) {
        Some(heard) => {
            heard.sum_dbm += rssi_dbm;
            heard.n += 1;
        }
        None => heard.push(Heard { transmitter, sum_dbm: rssi_dbm, n: 1 }),
    }
}

/// Turns what was heard into means, the strongest first, and forgets it.
fn observe(heard: &mut Vec<Heard>, observations: &mut Vec<RadioObservation>) {
    observations.clear();
    observations.extend(
        heard
            .drain(..)
            .map(|h| RadioObservation { transmitter: h.transmitter, rssi_dbm: h.sum_dbm / h.n as f32 }),
    );
    observations
        .sort_unstable_by(|a, b| b.rssi_dbm.total_cmp(&a.rssi_dbm).then(a.transmitter.cmp(&b.transmitter)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::FloorPlan;
    use crate::map::FloorMap;
    use crate::sensor::RadioSighting;

    #[test]
    fn particles_are_shown_where_the_hint_put_them() {
        let plan = FloorPlan { width_m: 40.0, height_m: 25.0, ..FloorPlan::default() };
        let floor = Arc::new(FloorIndex::new(FloorMap { plan, ..FloorMap::default() }));
        let mut positioner = Positioner::new(floor, Recipe::fused(), 1);
        assert_eq!(positioner.particles().len(), 0);
        let point = Point2::new(12.0, 7.5);
        let hint =
            PositionHint { point, radius_m: 1.5, floor: 0, time: Timestamp::from_millis(0), direction: None };
        positioner.hint(hint).unwrap();
        assert_eq!(positioner.particles().len(), Recipe::fused().n_particles);
        let off = |(place, _): (Point2, f32)| place - point;
        assert!(positioner.particles().map(off).all(|d| d.x_m.abs() <= 1.5001 && d.y_m.abs() <= 1.5001));
        assert!(positioner.particles().map(off).any(|d| d.norm_m() > 1.0), "spread, not heaped");
        let heaviest = positioner.particles().map(|(_, weight)| weight).fold(0.0, f32::max);
        assert_eq!(heaviest, 1.0);
    }

    #[test]
    fn a_cards_frame_is_taken_in_at_once_and_what_else_was_heard_of_it_too() {
        let plan = FloorPlan { width_m: 20.0, height_m: 10.0, ..FloorPlan::default() };
        let floor = Arc::new(FloorIndex::new(FloorMap { plan, ..FloorMap::default() }));
        let mut positioner = Positioner::new(floor, Recipe::card(), 1);
        let mut frame = [0u8; 31];
        frame[..9].copy_from_slice(&[2, 1, 6, 27, 255, 255, 255, 16, 0]);
        let at = |ms, reading| Sample { time: Timestamp::from_millis(ms), reading };
        assert!(positioner.push(at(1_000, Reading::CardFrame(frame))).is_some());
        // Another access point heard it at the same instant.
        let sighting = RadioSighting { transmitter: TransmitterId::BleAddress([1; 6]), rssi_dbm: -70.0 };
        positioner.push(at(1_000, Reading::Radio(sighting)));
        assert_eq!(positioner.push(at(1_000, Reading::CardFrame(frame))), None);
        assert_eq!(positioner.rejections(), Rejections::default());
        let counts = positioner.card_counts().unwrap();
        assert_eq!((counts.n_rounds, counts.n_repeated), (1, 1));
    }
}
