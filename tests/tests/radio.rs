//! Ranges and places by radio, on the recordings of an emitter among receivers.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use fieldwalk_cli::walker_evaluation::{Metric, ble_annotated};
use fieldwalk_tests::recordings::collection;

#[test]
fn ranges_are_unbiased_and_places_near_three_receivers_are_within_a_metre_and_a_half() {
    let Some(dir) = collection("ble-annotated") else { return };
    let scores = ble_annotated::score(&[dir]).unwrap();
    assert!(scores.errors.is_empty() && scores.warnings.is_empty(), "{:?}", (scores.errors, scores.warnings));
    let value = |subset: &str, system: &str, metric: Metric| {
        let is_it = |row: &&fieldwalk_cli::walker_evaluation::MetricRow| {
            row.subset == subset && row.system == system && row.metric == metric
        };
        let row = scores.rows.iter().find(is_it).unwrap();
        assert!(row.n > 200, "{row:?}");
        row.value
    };
    for window in ["1s", "5s"] {
        let bias_m = |kind: &str| value("fixed", &format!("{kind}_range_{window}"), Metric::RangeBiasM);
        let (raw_m, unbiased_m) = (bias_m("raw"), bias_m("unbiased"));
        assert!(unbiased_m.abs() <= 0.5 * raw_m, "{window}: {raw_m} {unbiased_m}");
    }
    for subset in ["fixed_near", "tracks_near"] {
        let robust_m = value(subset, "trilateration_5s", Metric::PlaceErrorMedianM);
        let printed_m = value(subset, "trilateration_printed_5s", Metric::PlaceErrorMedianM);
        assert!(robust_m <= 1.5 && robust_m < printed_m, "{subset}: {robust_m} {printed_m}");
        let kept = value(subset, "ble_filter", Metric::TruthNearMatchPercent);
        assert!(kept > 85.0, "{subset}: {kept}");
    }
}
