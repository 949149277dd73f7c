//! Where the walker truly was, as far as anybody knows.

use fieldwalk::geometry::Point2;
use fieldwalk::survey::{SurveyTrack, Waypoint};
use fieldwalk::time::{Duration, Timestamp};
use serde::Serialize;

use crate::evaluation::{PointKind, TruthPoint};
use crate::report::model::points_cm;
use crate::report::packed::{Packed, ms_after};

/// Between waypoints the truth is laid out this often.
const EVERY: Duration = Duration::from_millis(250);

/// The truth over time.
#[derive(Clone, Debug, Default)]
pub struct Truth {
    line: Vec<(Timestamp, Point2)>,
    marks: Vec<Waypoint>,
    kind: TruthKind,
}

/// How the truth is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum TruthKind {
    /// Not at all.
    #[default]
    None,
    /// At waypoints; between them along straight lines by the steps made.
    Waypoints,
    /// At any time.
    Continuous,
}

/// The truth on the page.
#[derive(Debug, Serialize)]
pub struct TruthTrack {
    kind: TruthKind,
    /// In milliseconds, u32.
    time: Packed,
    /// x and y in centimetres, i32.
    place: Packed,
    /// As `time`, of the waypoints.
    mark_time: Packed,
    /// As `place`, of the waypoints.
    mark_place: Packed,
}

impl Truth {
    /// A truth known at all times between the first and the last of `line`, which are in order of time.
    pub fn continuous(line: impl IntoIterator<Item = (Timestamp, Point2)>) -> Self {
        let mut thinned: Vec<(Timestamp, Point2)> = Vec::new();
        let mut last = None;
        for point in line {
            if thinned.last().is_none_or(|kept| point.0 - kept.0 >= EVERY) {
                thinned.push(point);
            }
            last = Some(point);
        }
        thinned.extend(last.filter(|last| thinned.last().is_some_and(|kept| kept.0 < last.0)));
        let kind = if thinned.is_empty() { TruthKind::None } else { TruthKind::Continuous };
        Self { line: thinned, marks: Vec::new(), kind }
    }

    /// A truth known at the waypoints of `track`.
    pub fn of_track(track: &SurveyTrack) -> Self {
        let marks = track.waypoints().to_vec();
        let mut line = Vec::new();
        for pair in marks.windows(2) {
            line.push((pair[0].time, pair[0].point));
            let mut time = pair[0].time + EVERY;
            while time < pair[1].time {
                line.extend(track.position(time).map(|point| (time, point)));
                time = time + EVERY;
            }
        }
        line.extend(marks.last().map(|mark| (mark.time, mark.point)));
        Self { line, marks, kind: TruthKind::Waypoints }
    }

    /// What is known of a walk with one waypoint, or none.
    pub fn of_marks(marks: &[Waypoint]) -> Self {
        let kind = if marks.is_empty() { TruthKind::None } else { TruthKind::Waypoints };
        Self { line: Vec::new(), marks: marks.to_vec(), kind }
    }

    /// Where the walker was at `time`; nothing outside the time that the truth is known for.
    pub fn at(&self, time: Timestamp) -> Option<Point2> {
        let k = self.line.partition_point(|point| point.0 <= time);
        let before = self.line.get(k.checked_sub(1)?)?;
        let Some(after) = self.line.get(k) else { return (before.0 == time).then_some(before.1) };
        Some(before.1.lerp(after.1, time.secs_since(before.0) / after.0.secs_since(before.0)))
    }

    /// Points to score, a second apart, from `first_s` after the beginning on.
    pub fn every_second(&self, first_s: i64) -> Vec<TruthPoint> {
        let (Some(first), Some(last)) = (self.line.first(), self.line.last()) else { return Vec::new() };
        let times = (first_s..).map(|after_s| first.0 + Duration::from_millis(1_000 * after_s));
        let times = times.take_while(|&time| time <= last.0);
        let point = |time| self.at(time).map(|point| TruthPoint { kind: PointKind::Truth, time, point });
        times.filter_map(point).collect()
    }

    /// The last instant of which anything is known.
    pub(super) fn ended(&self) -> Option<Timestamp> {
        self.line.last().map(|point| point.0).max(self.marks.last().map(|mark| mark.time))
    }

    pub(super) fn track(&self, began: Timestamp) -> TruthTrack {
        TruthTrack {
            kind: self.kind,
            time: Packed::u32s(self.line.iter().map(|point| ms_after(began, point.0))),
            place: points_cm(self.line.iter().map(|point| point.1)),
            mark_time: Packed::u32s(self.marks.iter().map(|mark| ms_after(began, mark.time))),
            mark_place: points_cm(self.marks.iter().map(|mark| mark.point)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_continuous_truth_is_thinned_and_read_between_its_points() {
        let time = Timestamp::from_millis;
        let line = (0..=13).map(|k| (time(100 * k), Point2::new(0.1 * k as f64, 2.0)));
        let truth = Truth::continuous(line);
        let times: Vec<i64> = truth.line.iter().map(|point| point.0.as_nanos() / 1_000_000).collect();
        assert_eq!(times, [0, 300, 600, 900, 1_200, 1_300]);
        let at = truth.at(time(750)).unwrap();
        assert!(at.distance_m(Point2::new(0.75, 2.0)) < 1e-12, "{at:?}");
        assert!(truth.at(time(1_300)).is_some());
        let scored: Vec<Timestamp> = truth.every_second(1).iter().map(|point| point.time).collect();
        assert_eq!(scored, [time(1_000)]);
        assert_eq!((truth.at(time(1_301)), truth.at(time(-1))), (None, None));
    }

    #[test]
    fn no_truth_is_no_error() {
        let truth = Truth::continuous([]);
        assert_eq!(
            (truth.kind, truth.at(Timestamp::from_millis(0)), truth.ended()),
            (TruthKind::None, None, None)
        );
    }
}
