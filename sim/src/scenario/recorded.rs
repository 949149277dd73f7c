//! A recording with its truth.

use fieldwalk::geometry::{Point2, wrap_rad};
use fieldwalk::sensor::Sample;
use fieldwalk::survey::{SurveyWalk, Waypoint};
use fieldwalk::time::Timestamp;

use crate::walker::Step;

/// Where the walker truly was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthPoint {
    /// When.
    pub time: Timestamp,
    /// Where the trunk was, without the sway of the gait.
    pub position: Point2,
    /// Where it faced, clockwise from +y, in radians.
    pub heading_rad: f64,
    /// Height of the feet over the ground floor, in metres.
    pub height_m: f64,
    /// The floor's number; on stairs, that of the nearer one.
    pub floor: i32,
}

/// A walk as a phone records it, with the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// The walk's name.
    pub name: String,
    /// All samples, in order of time.
    pub samples: Vec<Sample>,
    /// What the walker tapped.
    pub waypoints: Vec<Waypoint>,
    /// The truth, ten times a second from the first instant to the last.
    pub truth: Vec<TruthPoint>,
    /// The steps taken, in seconds after the beginning ([`crate::scenario::ORIGIN`]).
    pub steps: Vec<Step>,
}

impl Recorded {
    /// The truth at `time`, between the points told; at the ends outside. Nothing when there is no truth at all.
    pub fn truth_at(&self, time: Timestamp) -> Option<TruthPoint> {
        let k = self.truth.partition_point(|point| point.time <= time);
        let before = self.truth.get(k.saturating_sub(1))?;
        let after = self.truth.get(k).unwrap_or(before);
        let span_s = after.time.secs_since(before.time);
        let share = if span_s > 0.0 { (time.secs_since(before.time) / span_s).clamp(0.0, 1.0) } else { 0.0 };
        Some(TruthPoint {
            time,
            position: before.position.lerp(after.position, share),
            heading_rad: wrap_rad(
                before.heading_rad + share * wrap_rad(after.heading_rad - before.heading_rad),
            ),
            height_m: before.height_m + share * (after.height_m - before.height_m),
            floor: if share < 0.5 { before.floor } else { after.floor },
        })
    }

    /// The recording as a survey takes it in.
    pub fn survey_walk(&self) -> SurveyWalk {
        let mut walk = SurveyWalk::new(self.name.clone());
        for sample in &self.samples {
            walk.push(sample);
        }
        for waypoint in &self.waypoints {
            walk.push_waypoint(*waypoint);
        }
        walk.finish();
        walk
    }
}
