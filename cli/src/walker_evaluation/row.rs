//! Metric rows: one number of one system on one part of a data set.

use fieldwalk_formats::FormatError;
use serde::Serialize;

/// The subset that pools all others.
pub const ALL: &str = "all";

/// What is measured; the name ends in the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean over walks of `100·|counted − true| / true` steps.
    CountErrorAbsPercent,
    /// Mean over walks of `100·(counted − true) / true` steps.
    CountErrorSignedPercent,
    /// Mean over straight segments of `100·|modelled − true| / true` metres.
    SegmentLengthErrorPercent,
    /// Area under the receiver's curve: upward, forward and horizontal against the rest.
    AucUfh,
    /// Area under the receiver's curve: not upward against upward.
    AucNonUpward,
    /// The same as `auc_ufh` over the moments at which the capture agrees with the trial's name.
    AucUfhCaptured,
    /// The same as `auc_non_upward` with the screen's side taken from the capture.
    AucNonUpwardCaptured,
    /// Area under the receiver's curve: top edge ahead against the same walks with the phone turned in quarters.
    AucForwardTurned,
    /// Share of moments at which UFH is decided rightly, in percent.
    UfhCorrectPercent,
    /// Share of moments at which the carry mode is the trial's, in percent.
    CarryModeCorrectPercent,
    /// Median of the absolute heading error, in degrees.
    HeadingErrorMedianDeg,
    /// Mean over receivers and rounds of range minus true distance, in metres.
    RangeBiasM,
    /// Median of the ranges' absolute errors, in metres.
    RangeErrorMedianM,
    /// Median distance of places from the truth, in metres.
    PlaceErrorMedianM,
    /// 80th percentile of the distances of places from the truth, in metres.
    PlaceErrorP80M,
    /// Share of rounds with a place, in percent.
    PlacedPercent,
    /// Share of rounds whose beacons are said to stand well, in percent.
    ReliablePercent,
    /// Share of rounds whose truth lies within 6 m of the matched cell, in percent.
    TruthNearMatchPercent,
    /// Share of rounds in which the true place lay outside those 6 m for the second time in a row, in percent.
    TruthDroppedPercent,
}

impl Metric {
    /// The name in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::CountErrorAbsPercent => "count_error_abs_percent",
            Self::CountErrorSignedPercent => "count_error_signed_percent",
            Self::SegmentLengthErrorPercent => "segment_length_error_percent",
            Self::AucUfh => "auc_ufh",
            Self::AucNonUpward => "auc_non_upward",
            Self::AucUfhCaptured => "auc_ufh_captured",
            Self::AucNonUpwardCaptured => "auc_non_upward_captured",
            Self::AucForwardTurned => "auc_forward_turned",
            Self::UfhCorrectPercent => "ufh_correct_percent",
            Self::CarryModeCorrectPercent => "carry_mode_correct_percent",
            Self::HeadingErrorMedianDeg => "heading_error_median_deg",
            Self::RangeBiasM => "range_bias_m",
            Self::RangeErrorMedianM => "range_error_median_m",
            Self::PlaceErrorMedianM => "place_error_median_m",
            Self::PlaceErrorP80M => "place_error_p80_m",
            Self::PlacedPercent => "placed_percent",
            Self::ReliablePercent => "reliable_percent",
            Self::TruthNearMatchPercent => "truth_near_match_percent",
            Self::TruthDroppedPercent => "truth_dropped_percent",
        }
    }
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MetricRow {
    /// The data set.
    pub dataset: &'static str,
    /// The part of it, such as a way to carry the phone; [`ALL`] pools them.
    pub subset: String,
    /// What is scored, such as a step detector.
    pub system: String,
    /// What is measured.
    pub metric: Metric,
    /// Its value; NaN (in JSON, null) where there is none.
    pub value: f64,
    /// Number of walks, strides or moments behind it.
    pub n: usize,
}

/// What scoring a data set gave.
#[derive(Debug, Default)]
pub struct MetricScores {
    /// The rows, grouped by subset, the pooled ones last.
    pub rows: Vec<MetricRow>,
    /// Pictures of what failed, the worst first.
    pub plots: Vec<Plot>,
    /// What was left out because the data set itself has no truth or no signal there.
    pub warnings: Vec<String>,
    /// Files that should have been readable and were not.
    pub errors: Vec<FormatError>,
}

/// A picture of a failure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plot {
    /// Its file's name, without a folder.
    pub file_name: String,
    /// The SVG.
    pub svg: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_the_agreed_keys_and_the_metric_its_name() {
        for metric in [
            Metric::CountErrorAbsPercent,
            Metric::CountErrorSignedPercent,
            Metric::SegmentLengthErrorPercent,
            Metric::AucUfh,
            Metric::AucNonUpward,
            Metric::AucUfhCaptured,
            Metric::AucNonUpwardCaptured,
            Metric::AucForwardTurned,
            Metric::UfhCorrectPercent,
            Metric::CarryModeCorrectPercent,
            Metric::HeadingErrorMedianDeg,
            Metric::RangeBiasM,
            Metric::RangeErrorMedianM,
            Metric::PlaceErrorMedianM,
            Metric::PlaceErrorP80M,
            Metric::PlacedPercent,
            Metric::ReliablePercent,
            Metric::TruthNearMatchPercent,
            Metric::TruthDroppedPercent,
        ] {
            let row =
                MetricRow { dataset: "d", subset: ALL.into(), system: "s".into(), metric, value: 1.5, n: 2 };
            let name = metric.name();
            assert_eq!(
                serde_json::to_string(&row).unwrap(),
                format!(
                    r#"{{"dataset":"d","subset":"all","system":"s","metric":"{name}","value":1.5,"n":2}}"#
                )
            );
        }
    }
}
