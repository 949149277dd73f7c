//! A wearable at the waist: vertical acceleration into steps, gyroscope and compass into a heading, and nothing else.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::attitude::AttitudeEstimate;
use crate::gravity::LevelParams;
use crate::heading::{HeadingEstimator as _, ScalarKalmanParams, WilaHeading};
use crate::pedestrian::StepEvent;
use crate::sensor::{Reading, Sample};
use crate::step::{StepDetector as _, WilaStepDetector, WilaStepParams};
use crate::time::{Duration, Timestamp};

/// Steps and headings of a device that keeps its place on the body, its forward axis pointing where the wearer goes.
///
/// A step's heading is clockwise from magnetic north, the mean over its period. Its field is not told: the azimuth is
/// what this system takes from the magnetometer, and steps are known half a second late.
///
/// # Source
/// WILA 2016, §3.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaistFrontEnd {
    heading: WilaHeading,
    detector: WilaStepDetector,
    /// Sine and cosine of the heading, every 20 ms.
    headings: VecDeque<(Timestamp, [f32; 2])>,
}

/// Readings of the heading are kept this far apart.
const HEADING_PERIOD: Duration = Duration::from_millis(20);
/// So many: three seconds, more than the longest step and the filter's delay.
const N_HEADINGS: usize = 150;

impl Default for WaistFrontEnd {
    fn default() -> Self {
        Self {
            heading: WilaHeading::new(ScalarKalmanParams::default(), LevelParams::default()),
            detector: WilaStepDetector::new(WilaStepParams::default()),
            headings: VecDeque::with_capacity(N_HEADINGS),
        }
    }
}

impl WaistFrontEnd {
    /// Consumes a sample (in order of time); returns the step that it completes, if it does.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        self.heading.push(sample);
        let Reading::SpecificForce(force) = sample.reading else { return None };
        let level_force = self.heading.level().to_level(force)?;
        self.note_heading(sample.time);
        let cycle = self.detector.push(sample.time, level_force)?.cycle;
        let (sin, cos) = self
            .headings
            .iter()
            .filter(|(time, _)| *time > cycle.start && *time <= cycle.end)
            .fold((0.0, 0.0), |(sin, cos), (_, heading)| (sin + heading[0], cos + heading[1]));
        let heading_rad = if sin == 0.0 && cos == 0.0 { self.heading_rad() } else { libm::atan2f(sin, cos) };
        Some(StepEvent {
            cycle,
            n_steps: 1,
            level_heading_rad: heading_rad,
            forward_field: None,
            end_strength_ut: None,
            reads: [None; 3],
            attitude: AttitudeEstimate::default(),
            field_bias_reset: false,
        })
    }

    /// Heading of the device's forward axis now, clockwise from magnetic north, in radians; 0 while it is not known.
    pub fn heading_rad(&self) -> f32 {
        self.headings.back().map_or(0.0, |(_, [sin, cos])| libm::atan2f(*sin, *cos))
    }

    fn note_heading(&mut self, now: Timestamp) {
        let since = self.headings.back().map(|(last, _)| now - *last);
        if since.is_some_and(|since| since.as_nanos() < 0) {
            self.headings.clear();
        } else if since.is_some_and(|since| since < HEADING_PERIOD) {
            return;
        }
        let Some(forward) = self.heading.forward() else { return };
        while self.headings.len() >= N_HEADINGS {
            self.headings.pop_front();
        }
        self.headings.push_back((now, forward));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gravity::STANDARD_GRAVITY_M_S2;
    use core::f32::consts::TAU;

    /// Steps at 1.8 Hz of a level device that turns clockwise by `turn_rad` between the tenth and the eleventh second.
    fn walk(turn_rad: f32, with_magnetometer: bool, with_gyroscope: bool) -> Vec<StepEvent> {
        let mut waist = WaistFrontEnd::default();
        let mut events = Vec::new();
        for k in 0..1_000i64 {
            let t = 0.02 * k as f32;
            let rate = if (10.0..11.0).contains(&t) { turn_rad } else { 0.0 };
            let heading = turn_rad * (t - 10.0).clamp(0.0, 1.0);
            let (sin, cos) = libm::sincosf(heading);
            let bob = 2.0 * libm::sinf(TAU * 1.8 * t);
            let mut readings = vec![Reading::SpecificForce([0.0, 0.0, STANDARD_GRAVITY_M_S2 + bob])];
            if with_gyroscope {
                readings.push(Reading::AngularRate([0.0, 0.0, -rate]));
            }
            if with_magnetometer {
                readings.push(Reading::MagneticField([-20.0 * sin, 20.0 * cos, -40.0]));
            }
            let time = Timestamp::from_millis(20 * k);
            events.extend(readings.into_iter().filter_map(|reading| waist.push(&Sample { time, reading })));
        }
        events
    }

    #[test]
    fn steps_have_the_heading_of_their_own_time() {
        let events = walk(1.5, true, true);
        assert!((32..=36).contains(&events.len()), "{}", events.len());
        for event in &events {
            let at_s = 0.5 * (event.cycle.start.as_nanos() + event.cycle.end.as_nanos()) as f32 * 1e-9;
            let expected = 1.5 * (at_s - 10.0).clamp(0.0, 1.0);
            assert!((event.level_heading_rad - expected).abs() < 0.1, "{at_s}: {event:?}");
        }
    }

    #[test]
    fn a_missing_sensor_leaves_the_other_its_heading() {
        for (with_magnetometer, with_gyroscope) in [(true, false), (false, true)] {
            let events = walk(1.5, with_magnetometer, with_gyroscope);
            let turned = events[events.len() - 1].level_heading_rad - events[3].level_heading_rad;
            assert!((turned - 1.5).abs() < 0.1, "{with_magnetometer} {turned}");
        }
        assert!(walk(1.5, false, false).iter().all(|event| event.level_heading_rad.is_finite()));
    }
}
