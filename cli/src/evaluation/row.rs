//! The error table: one row per floor, system and kind of point.

use fieldwalk::metrics::{ErrorSummary, ScoredFix, quantile};
use serde::Serialize;

use crate::evaluation::WalkScore;

/// Where the truth is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PointKind {
    /// At a waypoint.
    Waypoint,
    /// Midway between two waypoints, by the steps made.
    Midpoint,
    /// At a moment inside a walk, chosen by chance.
    CutOff,
    /// At any time of a simulated walk.
    Truth,
}

impl PointKind {
    /// All, in the order in which tables list them.
    pub const ALL: [Self; 4] = [Self::Waypoint, Self::Midpoint, Self::CutOff, Self::Truth];
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The data set.
    pub dataset: String,
    /// The floor; `all` pools them.
    pub floor: String,
    /// The system.
    pub system: String,
    /// What was known of the start.
    pub start: String,
    /// Which points are scored.
    pub points: PointKind,
    /// Number of walks, seeds not counted.
    pub n_walks: usize,
    /// Number of scored points, seeds counted.
    pub n_points: usize,
    /// Points of this kind at which there was no fix, seeds counted; they are not among the scored ones.
    pub n_without_fix: usize,
    /// Median error, in metres; like all errors, NaN (in JSON, null) when there was never a fix.
    pub median_m: f64,
    /// Mean error, in metres.
    pub mean_m: f64,
    /// 80th percentile, in metres.
    pub p80_m: f64,
    /// 90th percentile, in metres.
    pub p90_m: f64,
    /// Share of errors within the stated 68 % radius.
    pub inside_68: f64,
    /// Share of errors within the stated 95 % radius.
    pub inside_95: f64,
    /// Median of the stated 68 % radii, in metres.
    pub radius_68_median_m: f64,
    /// Median time of a call that consumed a step, in µs.
    pub step_us_median: f64,
    /// Number of seeds.
    pub seeds: usize,
}

/// What the rows of one floor (or of all, pooled) and one system have in common.
#[derive(Clone, Copy, Debug)]
pub struct RowGroup<'a> {
    /// The data set.
    pub dataset: &'a str,
    /// The floor; `all` pools them.
    pub floor: &'a str,
    /// The system.
    pub system: &'a str,
    /// What was known of the start.
    pub start: &'a str,
    /// Number of walks, seeds not counted.
    pub n_walks: usize,
    /// Number of seeds.
    pub seeds: usize,
}

impl RowGroup<'_> {
    /// The rows of `scores`, one per kind of point; none when there was no point to score.
    pub fn rows(&self, scores: &[&WalkScore]) -> Vec<Row> {
        let mut step_us: Vec<f64> = scores.iter().flat_map(|score| score.step_us.iter().copied()).collect();
        step_us.sort_by(f64::total_cmp);
        let step_us_median = quantile(&step_us, 0.5);
        PointKind::ALL.into_iter().filter_map(|points| self.row(points, scores, step_us_median)).collect()
    }

    fn row(&self, points: PointKind, scores: &[&WalkScore], step_us_median: f64) -> Option<Row> {
        let of_kind = scores.iter().flat_map(|score| &score.points).filter(|(kind, _)| *kind == points);
        let (fixes, without_fix): (Vec<_>, Vec<_>) = of_kind.map(|(_, fix)| *fix).partition(Option::is_some);
        if fixes.is_empty() && without_fix.is_empty() {
            return None;
        }
        let fixes: Vec<ScoredFix> = fixes.into_iter().flatten().collect();
        let summary = ErrorSummary::of(&fixes).unwrap_or(NO_FIX);
        Some(Row {
            dataset: self.dataset.into(),
            floor: self.floor.into(),
            system: self.system.into(),
            start: self.start.into(),
            points,
            n_walks: self.n_walks,
            n_points: summary.n_points,
            n_without_fix: without_fix.len(),
            median_m: summary.median_m,
            mean_m: summary.mean_m,
            p80_m: summary.p80_m,
            p90_m: summary.p90_m,
            inside_68: summary.inside_68,
            inside_95: summary.inside_95,
            radius_68_median_m: summary.radius_68_median_m,
            step_us_median,
            seeds: self.seeds,
        })
    }
}

const NO_FIX: ErrorSummary = ErrorSummary {
    n_points: 0,
    median_m: f64::NAN,
    mean_m: f64::NAN,
    p80_m: f64::NAN,
    p90_m: f64::NAN,
    inside_68: f64::NAN,
    inside_95: f64::NAN,
    radius_68_median_m: f64::NAN,
};

#[cfg(test)]
mod tests {
    use super::*;

    const GROUP: RowGroup<'_> =
        RowGroup { dataset: "ilc", floor: "F1", system: "fused", start: "cold", n_walks: 1, seeds: 2 };

    fn scored(error_m: f64) -> Option<ScoredFix> {
        Some(ScoredFix { error_m, radius_68_m: 2.0, radius_95_m: 4.0 })
    }

    #[test]
    fn points_are_summed_up_by_kind() {
        let (waypoint, midpoint) = (PointKind::Waypoint, PointKind::Midpoint);
        let one = WalkScore {
            points: vec![(midpoint, None), (waypoint, scored(1.0)), (waypoint, scored(3.0))],
            step_us: vec![10.0, 30.0],
            ..WalkScore::default()
        };
        let other =
            WalkScore { points: vec![(waypoint, scored(5.0))], step_us: vec![20.0], ..WalkScore::default() };
        let rows = GROUP.rows(&[&one, &other]);
        let [at_waypoints, at_midpoints] = &rows[..] else { panic!("{rows:?}") };
        assert_eq!((at_waypoints.n_points, at_waypoints.n_without_fix), (3, 0));
        assert_eq!(
            (at_waypoints.median_m, at_waypoints.mean_m, at_waypoints.step_us_median),
            (3.0, 3.0, 20.0)
        );
        assert_eq!((at_midpoints.n_points, at_midpoints.n_without_fix), (0, 1));
        assert!(serde_json::to_value(at_midpoints).unwrap()["median_m"].is_null());
        assert!(GROUP.rows(&[]).is_empty());
    }
}
