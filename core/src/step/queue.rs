//! Steps held back until they count.

use serde::{Deserialize, Serialize};

use crate::step::{StepCycle, StepFinding};
use crate::time::Timestamp;

/// Keeps what a detector finds, with what was measured meanwhile, and gives out the steps that count, in order.
///
/// Room is for twelve; a detector holds back far fewer. Were it to run over, the oldest would go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepQueue<T> {
    /// The first `n` are used, of which the first `n_ready` count.
    steps: [Option<(StepCycle, T)>; CAPACITY],
    n: usize,
    n_ready: usize,
    /// The end of the step before which nobody stood.
    under_way: Option<Timestamp>,
}

const CAPACITY: usize = 12;

impl<T: Copy> StepQueue<T> {
    /// A queue without steps.
    pub fn new() -> Self {
        Self { steps: [None; CAPACITY], n: 0, n_ready: 0, under_way: None }
    }

    /// Takes in `finding` and what was `measured` during it; a stride becomes two steps that share it.
    ///
    /// `first_period_s` is how long the first step of a walk is taken to last.
    pub fn push(&mut self, finding: &StepFinding, measured: T, first_period_s: f64) {
        self.drop_all_held_but(usize::from(finding.n_held));
        let cycle = finding.cycle;
        if finding.is_under_way {
            self.under_way = Some(cycle.end);
        }
        if finding.is_stride {
            let middle = cycle.start.midpoint(cycle.end);
            self.append(StepCycle::between(cycle.start, middle, cycle.amplitude_m_s2), measured);
            self.append(StepCycle::between(middle, cycle.end, cycle.amplitude_m_s2), measured);
        } else {
            self.append(cycle, measured);
        }
        if finding.is_confirmed {
            if finding.starts_walk
                && let Some((first, _)) = &mut self.steps[self.n_ready]
                && self.under_way != Some(first.end)
            {
                *first = first.as_first(first_period_s);
            }
            self.n_ready = self.n;
        }
    }

    /// The next step that counts.
    pub fn pop(&mut self) -> Option<(StepCycle, T)> {
        if self.n_ready == 0 {
            return None;
        }
        self.n_ready -= 1;
        self.remove(0)
    }

    /// Keeps the latest `n_held` of the steps held back.
    fn drop_all_held_but(&mut self, n_held: usize) {
        while self.n - self.n_ready > n_held {
            self.remove(self.n_ready);
        }
    }

    fn append(&mut self, cycle: StepCycle, measured: T) {
        if self.n == CAPACITY {
            self.n_ready = self.n_ready.saturating_sub(1);
            self.remove(0);
        }
        // Only a step that starts a walk is a first one, which is not known yet.
        self.steps[self.n] = Some((StepCycle { is_first: false, ..cycle }, measured));
        self.n += 1;
    }

    fn remove(&mut self, k: usize) -> Option<(StepCycle, T)> {
        let removed = self.steps[k].take();
        self.steps[k..self.n].rotate_left(1);
        self.n -= 1;
        removed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(end_ms: i64, n_held: u8, is_confirmed: bool) -> StepFinding {
        let at = Timestamp::from_millis;
        StepFinding {
            cycle: StepCycle::between(at(end_ms - 1_000), at(end_ms), 3.0),
            is_stride: false,
            is_under_way: false,
            n_held,
            is_confirmed,
            starts_walk: false,
        }
    }

    fn drain(queue: &mut StepQueue<u32>) -> Vec<(i64, u32, bool)> {
        core::iter::from_fn(|| queue.pop())
            .map(|(cycle, measured)| (cycle.end.as_nanos() / 1_000_000, measured, cycle.is_first))
            .collect()
    }

    #[test]
    fn steps_come_out_once_confirmed_oldest_first() {
        let mut queue = StepQueue::new();
        queue.push(&finding(1_000, 0, false), 1, 0.5);
        queue.push(&finding(2_000, 1, false), 2, 0.5);
        assert_eq!(queue.pop(), None);
        // The first one no longer counts.
        queue.push(&StepFinding { starts_walk: true, ..finding(3_000, 1, true) }, 3, 0.5);
        assert_eq!(drain(&mut queue), [(2_000, 2, true), (3_000, 3, false)]);
        queue.push(&finding(4_000, 0, true), 4, 0.5);
        assert_eq!(drain(&mut queue), [(4_000, 4, false)]);
    }

    #[test]
    fn a_first_step_has_the_assumed_duration() {
        let mut queue = StepQueue::new();
        queue.push(&StepFinding { starts_walk: true, ..finding(3_000, 0, true) }, 0, 0.5);
        let (first, _) = queue.pop().unwrap();
        assert!(first.is_first && (first.frequency_hz - 2.0).abs() < 1e-6);
        assert_eq!(first.start, Timestamp::from_millis(2_500));
    }

    #[test]
    fn a_step_amid_a_walk_is_no_first_one_and_lasts_since_the_recording_began() {
        let mut queue = StepQueue::new();
        queue.push(&StepFinding { is_under_way: true, ..finding(3_000, 0, false) }, 0, 0.5);
        queue.push(&StepFinding { starts_walk: true, ..finding(4_000, 1, true) }, 1, 0.5);
        assert_eq!(drain(&mut queue), [(3_000, 0, false), (4_000, 1, false)]);
        // Had it not come to count, the next would have been the first.
        let mut queue = StepQueue::new();
        queue.push(&StepFinding { is_under_way: true, ..finding(3_000, 0, false) }, 0, 0.5);
        queue.push(&StepFinding { starts_walk: true, ..finding(4_000, 0, true) }, 1, 0.5);
        assert_eq!(drain(&mut queue), [(4_000, 1, true)]);
    }

    #[test]
    fn a_stride_is_two_steps() {
        let mut queue = StepQueue::new();
        queue.push(&StepFinding { is_stride: true, ..finding(3_000, 0, true) }, 7, 0.5);
        let steps: Vec<_> = core::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(steps.len(), 2);
        assert_eq!((steps[0].0.end, steps[1].0.start), (Timestamp::from_millis(2_500), steps[0].0.end));
        assert!(steps.iter().all(|(cycle, measured)| *measured == 7 && cycle.frequency_hz == 2.0));
    }

    #[test]
    fn too_many_push_the_oldest_out() {
        let mut queue = StepQueue::new();
        for k in 0..20 {
            queue.push(&finding(1_000 * i64::from(k), 0, true), k, 0.5);
        }
        let out: Vec<u32> = drain(&mut queue).into_iter().map(|(_, measured, _)| measured).collect();
        assert_eq!(out, (8..20).collect::<Vec<_>>());
    }
}
