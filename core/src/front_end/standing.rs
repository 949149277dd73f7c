//! A phone whose wearer may stand: what the sensors say then is told too.

use serde::{Deserialize, Serialize};

use crate::pedestrian::{Pedestrian, PedestrianParams, StepEvent};
use crate::sensor::{Reading, Sample};
use crate::time::{Duration, Timestamp};

/// A [`Pedestrian`] that tells of every second without a step by an event of no steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StandingPhone {
    pedestrian: Pedestrian,
    last_event: Option<Timestamp>,
}

const ROUND: Duration = Duration::from_millis(1_000);

impl StandingPhone {
    /// A phone of which nothing is known.
    pub fn new(params: PedestrianParams) -> Self {
        Self { pedestrian: Pedestrian::new(params), last_event: None }
    }

    /// The walker's half of it.
    pub fn pedestrian(&self) -> &Pedestrian {
        &self.pedestrian
    }

    /// Consumes a sample (in order of time); returns the next step, or a second without one.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        if let Some(event) = self.pedestrian.push(sample) {
            self.last_event = Some(sample.time);
            return Some(event);
        }
        let last = *self.last_event.get_or_insert(sample.time);
        let since = sample.time - last;
        if since.as_nanos() < 0 {
            self.last_event = Some(sample.time);
        }
        if since < ROUND || !matches!(sample.reading, Reading::SpecificForce(_)) {
            return None;
        }
        self.last_event = Some(sample.time);
        Some(self.pedestrian.standing(last, sample.time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gravity::STANDARD_GRAVITY_M_S2;

    #[test]
    fn standing_is_told_once_a_second_and_steps_as_they_come() {
        let mut phone = StandingPhone::new(PedestrianParams::default());
        let mut events = Vec::new();
        for k in 0..1_000i64 {
            let time = Timestamp::from_millis(20 * k);
            let sway = if k < 500 { 0.0 } else { libm::sinf(2.0 * core::f32::consts::TAU * 0.02 * k as f32) };
            let readings = [
                Reading::AngularRate([0.0; 3]),
                Reading::SpecificForce([0.0, 0.0, STANDARD_GRAVITY_M_S2 + 2.5 * sway]),
                Reading::MagneticField([3.0, 4.0, -12.0]),
            ];
            events.extend(readings.into_iter().filter_map(|reading| phone.push(&Sample { time, reading })));
        }
        let standing: Vec<&StepEvent> = events.iter().filter(|event| event.n_steps == 0).collect();
        // Ten seconds, and those in which a walk's first steps are held back.
        assert!((9..=13).contains(&standing.len()), "{}", standing.len());
        assert!(
            standing[1..].iter().all(|event| event.end_strength_ut.is_some_and(|ut| (ut - 13.0).abs() < 0.1))
        );
        assert!((15..=20).contains(&events.iter().filter(|event| event.n_steps == 1).count()));
    }
}
