//! Estimates the table of feature events from walks with the phone held upward and forward.

use fieldwalk::attitude::{EventCounts, EventTable, Pointing};
use fieldwalk::gravity::STANDARD_GRAVITY_M_S2;
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk::sensor::Sample;
use fieldwalk::time::Timestamp;

/// What an estimated table expects before any stride: to hold the phone forward is, as the paper says, the most common
/// way; the others share the rest.
pub const PRIOR: [f32; 4] = [0.7, 0.1, 0.1, 0.1];

/// The table of what was counted.
pub fn table_of(counts: &EventCounts) -> EventTable {
    counts.table(PRIOR)
}

/// Counts the strides of one walk during which the phone was held upward and forward.
///
/// Each stride counts for all four ways to point, by turning it in quarters about the screen's normal: the hand moves
/// alike whichever edge is ahead, and only so are there four ways in recordings that have one. Strides in which the
/// screen did not face up are left out.
#[derive(Clone, Debug)]
pub struct StrideCounter {
    pedestrian: Pedestrian,
    upward_m_s2: f32,
    last_end: Option<Timestamp>,
    counts: EventCounts,
}

impl Default for StrideCounter {
    fn default() -> Self {
        Self::new(PedestrianParams::default().attitude.upward_g)
    }
}

impl StrideCounter {
    /// A counter that takes the screen to face up when the force out of it is greater than `upward_g`, in units of g.
    pub fn new(upward_g: f32) -> Self {
        Self {
            pedestrian: Pedestrian::new(PedestrianParams::default()),
            upward_m_s2: upward_g * STANDARD_GRAVITY_M_S2,
            last_end: None,
            counts: EventCounts::default(),
        }
    }

    /// Takes in a sample, in order of time; an implausible one changes nothing.
    pub fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() || self.pedestrian.push(sample).is_none() {
            return;
        }
        let Some(stride) = self.pedestrian.last_stride().filter(|stride| Some(stride.end) != self.last_end)
        else {
            return;
        };
        self.last_end = Some(stride.end);
        if stride.mean_m_s2[2] <= self.upward_m_s2 {
            return;
        }
        let left = stride.turned_left();
        let back = left.turned_left();
        self.counts.add(stride.events(), Pointing::Forward);
        self.counts.add(left.events(), Pointing::Leftward);
        self.counts.add(back.events(), Pointing::Backward);
        self.counts.add(back.turned_left().events(), Pointing::Rightward);
    }

    /// What was counted so far.
    pub fn counts(&self) -> &EventCounts {
        &self.counts
    }
}

/// The counts of a walk's `samples`, in order of time.
pub fn count_strides(samples: &[Sample]) -> EventCounts {
    let mut counter = StrideCounter::default();
    samples.iter().for_each(|sample| counter.push(sample));
    *counter.counts()
}
