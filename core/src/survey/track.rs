//! Where the surveyor was between waypoints, and which way the device then looked.

use crate::geometry::{Point2, wrap_rad};
use crate::pedestrian::StepEvent;
use crate::survey::{SurveyWalk, Waypoint};
use crate::system::Recipe;
use crate::time::Timestamp;

/// Segments shorter than this, in metres, or of fewer steps than three, say nothing of the direction.
const MIN_SEGMENT_M: f64 = 2.0;
const MIN_SEGMENT_STEPS: usize = 3;
/// Time constant over which neighbouring segments share their direction offset, in seconds.
const OFFSET_TAU_S: f64 = 15.0;

/// A step of a walk, placed on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackStep {
    /// The step.
    pub event: StepEvent,
    /// Where the surveyor was in the middle of it.
    pub position: Point2,
    /// Walking direction, clockwise from +y, in radians.
    pub heading_rad: f64,
}

/// A walk laid along the straight lines between its waypoints, by its steps.
#[derive(Clone, Debug)]
pub struct SurveyTrack {
    waypoints: Vec<Waypoint>,
    /// Start, end and length of each step.
    steps: Vec<(Timestamp, Timestamp, f64)>,
    placed: Vec<TrackStep>,
}

impl SurveyTrack {
    /// Lays `walk` out; nothing when it has fewer than two waypoints.
    pub fn of(walk: &SurveyWalk) -> Option<Self> {
        if walk.waypoints().len() < 2 {
            return None;
        }
        let model = Recipe::fused().length;
        let steps = walk
            .steps()
            .iter()
            .map(|step| {
                let cycle = step.cycle;
                (cycle.start, cycle.end, f64::from(model.advance_m(&cycle)))
            })
            .collect();
        let mut track = Self { waypoints: walk.waypoints().to_vec(), steps, placed: Vec::new() };
        let offsets = track.direction_offsets(walk.steps());
        track.placed = walk
            .steps()
            .iter()
            .filter_map(|event| {
                let middle = event.cycle.start.midpoint(event.cycle.end);
                let position = track.position(middle)?;
                let offset_rad = offset_at(&offsets, middle)?;
                let heading_rad = wrap_rad(f64::from(event.level_heading_rad) + offset_rad);
                Some(TrackStep { event: *event, position, heading_rad })
            })
            .collect();
        Some(track)
    }

    /// The waypoints that the track joins.
    pub fn waypoints(&self) -> &[Waypoint] {
        &self.waypoints
    }

    /// The steps between the first and the last waypoint.
    pub fn steps(&self) -> &[TrackStep] {
        &self.placed
    }

    /// Metres walked by the step model up to `time`; a step counts evenly over its duration.
    pub fn walked_m(&self, time: Timestamp) -> f64 {
        self.steps
            .iter()
            .take_while(|(start, _, _)| *start < time)
            .map(|&(start, end, length_m)| {
                length_m * (time.secs_since(start) / end.secs_since(start)).clamp(0.0, 1.0)
            })
            .sum()
    }

    /// Where the surveyor was at `time`: along the line between two waypoints, by the steps made; evenly in time
    /// where there were no steps. Nothing before the first or after the last waypoint.
    pub fn position(&self, time: Timestamp) -> Option<Point2> {
        let (from, to) = self.segment(time)?;
        let (start_m, end_m) = (self.walked_m(from.time), self.walked_m(to.time));
        let share = if end_m - start_m > 0.1 {
            (self.walked_m(time) - start_m) / (end_m - start_m)
        } else {
            time.secs_since(from.time) / to.time.secs_since(from.time)
        };
        Some(from.point.lerp(to.point, share))
    }

    fn segment(&self, time: Timestamp) -> Option<(Waypoint, Waypoint)> {
        self.waypoints
            .windows(2)
            .map(|w| (w[0], w[1]))
            .find(|(from, to)| from.time <= time && time <= to.time)
    }

    /// Per segment: its middle, the line's direction minus the steps' direction, and how much that counts.
    fn direction_offsets(&self, events: &[StepEvent]) -> Vec<(Timestamp, f64, f64)> {
        let segments = self.waypoints.windows(2).filter_map(|w| {
            let line = w[1].point - w[0].point;
            let inside = events
                .iter()
                .zip(&self.steps)
                .filter(|(_, (start, end, _))| (w[0].time..w[1].time).contains(&start.midpoint(*end)));
            let (mut walked, mut walked_m, mut n) = (Point2::default(), 0.0, 0);
            for (event, &(_, _, length_m)) in inside {
                walked = walked + Point2::from_polar(length_m, f64::from(event.level_heading_rad));
                walked_m += length_m;
                n += 1;
            }
            if line.norm_m() < MIN_SEGMENT_M || n < MIN_SEGMENT_STEPS {
                return None;
            }
            let straightness = walked.norm_m() / walked_m;
            let offset_rad = wrap_rad(line.heading_rad() - walked.heading_rad());
            let middle = w[0].time.midpoint(w[1].time);
            Some((middle, offset_rad, line.norm_m() * straightness * straightness * straightness))
        });
        segments.collect()
    }
}

/// The direction offset at `time`: a circular mean over segments, nearer ones counting more.
fn offset_at(offsets: &[(Timestamp, f64, f64)], time: Timestamp) -> Option<f64> {
    let (mut sin, mut cos) = (0.0, 0.0);
    for &(middle, offset_rad, weight) in offsets {
        let apart = time.secs_since(middle) / OFFSET_TAU_S;
        let weight = weight * (libm::exp(-0.5 * apart * apart) + 1e-3);
        sin += weight * libm::sin(offset_rad);
        cos += weight * libm::cos(offset_rad);
    }
    (sin != 0.0 || cos != 0.0).then(|| libm::atan2(sin, cos))
}
