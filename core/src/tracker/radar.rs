//! What radio fingerprints do: positions by them alone, and a start that they filter.

use crate::observation::ble_filter;
use crate::observation::radio::RadioObservation;
use crate::particle::CloudEstimate;
use crate::pedestrian::StepEvent;
use crate::time::Timestamp;
use crate::tracker::Tracker;

impl Tracker {
    /// Puts the estimate where the fingerprint of a round matches best, spread over what matches about as well; false
    /// when the recipe does not ask for it, or nothing known was heard.
    pub(super) fn match_fingerprint(&mut self, now: Timestamp, radio: &[RadioObservation]) -> bool {
        let Some(params) = self.recipe.radar else { return false };
        let fingerprints = &self.floor.map().fingerprints;
        let matcher = &mut self.scratch.matcher;
        let Some(found) = matcher.nearest(&params, fingerprints, radio) else { return false };
        let places = matcher.likelihoods(&params, fingerprints);
        let estimate = CloudEstimate::about(found.place, places, &mut self.scratch.estimate);
        if !self.state.is_placed {
            self.place(found.place, 0.0);
        }
        let particles = &mut self.state.particles;
        particles.x_m.fill(found.place.x_m as f32);
        particles.y_m.fill(found.place.y_m as f32);
        self.state.estimate = estimate;
        self.state.matched_at = Some(now);
        true
    }

    /// During the first seconds after a start, lets particles die that stay far from the matched fingerprint.
    pub(super) fn filter_start(&mut self, event: &StepEvent, radio: &[RadioObservation]) {
        let Some(params) = &self.recipe.ble_filter else { return };
        let first = *self.state.first_round.get_or_insert(event.cycle.end);
        if event.cycle.end.secs_since(first) >= params.duration_s {
            return;
        }
        let fingerprints = &self.floor.map().fingerprints;
        if let Some(found) = self.scratch.matcher.nearest(&params.fingerprint, fingerprints, radio) {
            ble_filter::update(params, found.place, &mut self.state.particles);
        }
    }

    /// For a recipe that rests on radio alone, when it last knew a place by it.
    pub(crate) fn last_match(&self) -> Option<Option<Timestamp>> {
        self.recipe.radar.map(|_| self.state.matched_at)
    }
}
