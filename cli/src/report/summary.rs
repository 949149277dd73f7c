//! Errors in short, of a walk and of all walks.

use fieldwalk::metrics::{ErrorSummary, ScoredFix, quantile};
use serde::Serialize;

use crate::evaluation::{PointKind, WalkScore};

/// A curve has this many points beside its first.
const N_SHARES: usize = 200;

/// A system's errors on one walk.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WalkErrors {
    /// Mean error, in metres.
    pub mean_m: f64,
    median_m: f64,
    max_m: f64,
}

/// A system's errors on all walks: quantiles from 0 to 1 in equal shares.
#[derive(Debug, Serialize)]
pub struct ErrorCurve {
    system: String,
    points: PointKind,
    n_points: usize,
    /// In centimetres.
    quantiles_cm: Vec<i64>,
}

impl WalkErrors {
    /// The errors in `score`; nothing when nothing was scored.
    pub fn of(score: &WalkScore) -> Option<Self> {
        let fixes = main_fixes(&[score])?.1;
        let summary = ErrorSummary::of(&fixes)?;
        let max_m = fixes.iter().map(|fix| fix.error_m).fold(0.0, f64::max);
        Some(Self { mean_m: summary.mean_m, median_m: summary.median_m, max_m })
    }
}

impl ErrorCurve {
    /// The errors of `system` in `scores`; nothing when nothing was scored.
    pub fn of(system: &str, scores: &[&WalkScore]) -> Option<Self> {
        let (points, fixes) = main_fixes(scores)?;
        let mut errors: Vec<f64> = fixes.iter().map(|fix| fix.error_m).collect();
        errors.sort_by(f64::total_cmp);
        let at = |k: usize| (100.0 * quantile(&errors, k as f64 / N_SHARES as f64)).round() as i64;
        let quantiles_cm = (0..=N_SHARES).map(at).collect();
        Some(Self { system: system.into(), points, n_points: errors.len(), quantiles_cm })
    }
}

/// The scored fixes of the kind of point that counts most: known at all times, else at waypoints.
fn main_fixes(scores: &[&WalkScore]) -> Option<(PointKind, Vec<ScoredFix>)> {
    [PointKind::Truth, PointKind::Waypoint].into_iter().find_map(|kind| {
        let of_kind = scores.iter().flat_map(|score| &score.points).filter(|point| point.0 == kind);
        let fixes: Vec<ScoredFix> = of_kind.filter_map(|point| point.1).collect();
        (!fixes.is_empty()).then_some((kind, fixes))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_runs_from_the_least_error_to_the_largest() {
        let fix = |error_m| Some(ScoredFix { error_m, radius_68_m: 1.0, radius_95_m: 2.0 });
        let waypoint = |error_m| (PointKind::Waypoint, fix(error_m));
        let points = vec![waypoint(4.0), (PointKind::Midpoint, fix(9.0)), waypoint(1.0), waypoint(2.0)];
        let score = WalkScore { points, ..WalkScore::default() };
        let curve = ErrorCurve::of("fused", &[&score]).unwrap();
        assert_eq!((curve.points, curve.n_points), (PointKind::Waypoint, 3));
        let quantile = |k: usize| curve.quantiles_cm[k];
        assert_eq!([quantile(0), quantile(50), quantile(100), quantile(200)], [100, 150, 200, 400]);
        let errors = WalkErrors::of(&score).unwrap();
        assert!((errors.mean_m - 7.0 / 3.0).abs() < 1e-12);
        assert_eq!((errors.median_m, errors.max_m), (2.0, 4.0));
        assert!(ErrorCurve::of("fused", &[&WalkScore::default()]).is_none());
    }
}
