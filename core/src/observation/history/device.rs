//! What the device has read lately.

use serde::{Deserialize, Serialize};

use crate::magnetic::feature::FieldRead;
use crate::observation::history::{HistoryFeature, HistoryParams, strength_ut};

/// What the device has read lately.
///
/// The slots of a full history are a ring: the oldest read makes room for the newest, and the particles' reads stand in
/// the same slots.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DeviceHistory {
    /// The components of the feature in each slot, a plane each; of a read of which the strength alone is known, that
    /// and 0.
    pub(super) planes_ut: [Vec<f32>; 2],
    pub(super) is_strength_alone: Vec<bool>,
    /// Where the next read goes once all slots are used.
    next: usize,
}

/// A read that was taken in: its slot, and what is known of the components of the read that made room, and of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taken {
    pub slot: usize,
    pub removed_ut: Option<[f32; 2]>,
    pub added_ut: Option<[f32; 2]>,
}

impl DeviceHistory {
    /// Number of reads held.
    pub fn len(&self) -> usize {
        self.is_strength_alone.len()
    }

    /// Whether nothing has been read.
    pub fn is_empty(&self) -> bool {
        self.is_strength_alone.is_empty()
    }

    /// Forgets everything, with room for a history of `params`.
    pub(crate) fn start_anew(&mut self, params: &HistoryParams) {
        for plane in &mut self.planes_ut {
            plane.clear();
            plane.reserve_exact(params.n_slots());
        }
        self.is_strength_alone.clear();
        self.is_strength_alone.reserve_exact(params.n_slots());
        self.next = 0;
    }

    /// Whether this is a history of `n_slots` at most: a torn snapshot's is not.
    pub(crate) fn fits(&self, n_slots: usize) -> bool {
        let n = self.len();
        n <= n_slots && self.next <= n && self.planes_ut.iter().all(|plane| plane.len() == n)
    }

    /// Takes a read in and tells where it went; nothing when it holds no number that is compared.
    pub(super) fn push(&mut self, params: &HistoryParams, read: &FieldRead) -> Option<Taken> {
        let (read_ut, is_strength_alone) = match (params.feature, read.horizontal_vertical_ut) {
            (HistoryFeature::Strength, _) => ([read.strength_ut, 0.0], false),
            (HistoryFeature::HorizontalVertical, None) => ([read.strength_ut, 0.0], true),
            (HistoryFeature::HorizontalVertical, Some(read_ut)) => (read_ut, false),
        };
        if !read_ut.iter().all(|component_ut| component_ut.is_finite()) {
            return None;
        }
        let n = self.len();
        let added_ut = (!is_strength_alone).then_some(read_ut);
        if n < params.n_slots() {
            for (plane, component_ut) in self.planes_ut.iter_mut().zip(read_ut) {
                plane.push(component_ut);
            }
            self.is_strength_alone.push(is_strength_alone);
            return Some(Taken { slot: n, removed_ut: None, added_ut });
        }
        let slot = self.next;
        let removed_ut = (!*self.is_strength_alone.get(slot)?).then(|| self.read_ut(slot));
        for (plane, component_ut) in self.planes_ut.iter_mut().zip(read_ut) {
            *plane.get_mut(slot)? = component_ut;
        }
        *self.is_strength_alone.get_mut(slot)? = is_strength_alone;
        self.next = (slot + 1) % n;
        Some(Taken { slot, removed_ut, added_ut })
    }

    /// The slots from the oldest to the newest.
    pub(super) fn order(&self) -> impl Iterator<Item = usize> + '_ {
        let n = self.len();
        (0..n).map(move |k| (self.next + k) % n)
    }

    pub(super) fn has_strength_alone(&self) -> bool {
        self.is_strength_alone.contains(&true)
    }

    pub(super) fn read_ut(&self, slot: usize) -> [f32; 2] {
        [self.planes_ut[0][slot], self.planes_ut[1][slot]]
    }

    pub(super) fn strength_ut(&self, slot: usize) -> f32 {
        let read_ut = self.read_ut(slot);
        if self.is_strength_alone[slot] { read_ut[0] } else { strength_ut(read_ut) }
    }
}
