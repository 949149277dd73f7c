//! Error percentiles and how true the stated accuracy is.

use serde::{Deserialize, Serialize};

/// One scored fix: how far off it was and what it said of itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScoredFix {
    /// Distance to the truth, in metres.
    pub error_m: f64,
    /// The stated 68 % radius, in metres.
    pub radius_68_m: f64,
    /// The stated 95 % radius, in metres.
    pub radius_95_m: f64,
}

/// A summary of errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorSummary {
    /// Number of scored fixes.
    pub n_points: usize,
    /// Median error, in metres.
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
}

/// The `p`-quantile (0 to 1) of `sorted`, linear between order statistics; NaN when empty.
///
/// # Source
/// Hyndman and Fan 1996, definition 7 (the default of numpy and R).
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = p.clamp(0.0, 1.0) * last as f64;
    let low = at as usize;
    let high = (low + 1).min(last);
    sorted[low] + (sorted[high] - sorted[low]) * (at - low as f64)
}

impl ErrorSummary {
    /// The summary of `fixes`; nothing when there are none.
    pub fn of(fixes: &[ScoredFix]) -> Option<Self> {
        if fixes.is_empty() {
            return None;
        }
        let n = fixes.len() as f64;
        let sorted = |value: fn(&ScoredFix) -> f64| {
            let mut values: Vec<f64> = fixes.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let share = |radius: fn(&ScoredFix) -> f64| {
            fixes.iter().filter(|fix| fix.error_m <= radius(fix)).count() as f64 / n
        };
        let errors_m = sorted(|fix| fix.error_m);
        Some(Self {
            n_points: fixes.len(),
            median_m: quantile(&errors_m, 0.5),
            mean_m: errors_m.iter().sum::<f64>() / n,
            p80_m: quantile(&errors_m, 0.8),
            p90_m: quantile(&errors_m, 0.9),
            inside_68: share(|fix| fix.radius_68_m),
            inside_95: share(|fix| fix.radius_95_m),
            radius_68_median_m: quantile(&sorted(|fix| fix.radius_68_m), 0.5),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_shares_by_hand() {
        let fixes = [1.0, 2.0, 3.0, 4.0, 10.0].map(|error_m| ScoredFix {
            error_m,
            radius_68_m: 3.0,
            radius_95_m: 5.0,
        });
        let summary = ErrorSummary::of(&fixes).unwrap();
        assert_eq!((summary.median_m, summary.mean_m), (3.0, 4.0));
        assert!((summary.p80_m - 5.2).abs() < 1e-12 && (summary.p90_m - 7.6).abs() < 1e-12);
        assert_eq!((summary.inside_68, summary.inside_95, summary.radius_68_median_m), (0.6, 0.8, 3.0));
        assert_eq!(ErrorSummary::of(&[]), None);
        assert!(quantile(&[], 0.5).is_nan());
    }
}
