//! What the papers claim, and when each claim holds.
//!
//! Orders need the whole 95 % interval of a paired difference on their side; figures have the tolerance stated here. A
//! test is set before anything is measured and follows from the paper alone.

use crate::reproduce::{Claim, Paper, Part, Test};

/// One comparison, which the claim itself describes.
const fn whole(test: Test) -> [Part; 1] {
    [Part { what: "", test }]
}

const fn part(what: &'static str, test: Test) -> Part {
    Part { what, test }
}

/// The difference of what should be greater and what should be less.
const ORDER: &[Part] = &whole(Test::IntervalAbove(0.0));

/// All claims, paper by paper.
pub const CLAIMS: &[Claim] = &[
    Claim {
        id: "kwak-median",
        paper: Paper::Kwak2018,
        text: "median error of the card system over the trajectories",
        unit: "m",
        paper_value: Some(1.62),
        parts: &whole(Test::AtMost(1.62 * 1.15)),
    },
    Claim {
        id: "kwak-mean",
        paper: Paper::Kwak2018,
        text: "mean error of the card system over the trajectories",
        unit: "m",
        paper_value: Some(1.96),
        parts: &whole(Test::AtMost(1.96 * 1.15)),
    },
    Claim {
        id: "kwak-euc-as-dtw",
        paper: Paper::Kwak2018,
        text: "EUC with 3000 particles is as good as DTW with 3000",
        unit: "m difference of means",
        paper_value: Some(-0.11),
        parts: &whole(Test::IntervalBelow(0.3)),
    },
    Claim {
        id: "kwak-euc500-worse",
        paper: Paper::Kwak2018,
        text: "EUC with 500 particles is worse than EUC with 3000",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "kwak-time-ratio",
        paper: Paper::Kwak2018,
        text: "a round of DTW3000 costs 15 times EUC3000",
        unit: "ratio",
        paper_value: Some(15.0),
        parts: &whole(Test::AtLeast(15.0)),
    },
    Claim {
        id: "kwak-dtw500-slower",
        paper: Paper::Kwak2018,
        text: "DTW500 costs more than EUC3000",
        unit: "ratio",
        paper_value: Some(2.7),
        parts: &whole(Test::AtLeast(1.0)),
    },
    Claim {
        id: "kwak-motion-model",
        paper: Paper::Kwak2018,
        text: "motion model follows the heading over 11 turns with a distorted compass",
        unit: "% of time within 45 deg",
        paper_value: Some(84.0),
        parts: &whole(Test::AtLeast(84.0)),
    },
    Claim {
        id: "kwak-no-motion-model-worse",
        paper: Paper::Kwak2018,
        text: "without the motion model (PDR_RAW) worse",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "kwak-radar-worse",
        paper: Paper::Kwak2018,
        text: "BLE_RADAR alone worse",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "kwak-heuristics",
        paper: Paper::Kwak2018,
        text: "without replenishment and spread much worse",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "kwak-history",
        paper: Paper::Kwak2018,
        text: "history longer than 20 s reaches about 2 m, shorter is worse",
        unit: "m",
        paper_value: Some(2.0),
        parts: &[part("30 s", Test::AtMost(2.0)), part("5 s − 30 s", Test::IntervalAbove(0.0))],
    },
    Claim {
        id: "kwak-ble-filter",
        paper: Paper::Kwak2018,
        text: "BLE filtering shortens convergence",
        unit: "s",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "kwak-steps",
        paper: Paper::Kwak2018,
        text: "6 Hz step counting above 90 %",
        unit: "%",
        paper_value: Some(90.0),
        parts: &whole(Test::AtLeast(90.0)),
    },
    Claim {
        id: "kwak-3hz",
        paper: Paper::Kwak2018,
        text: "3 Hz field loses almost nothing against 50 Hz, 0.5 Hz much",
        unit: "correlation",
        paper_value: None,
        parts: &[
            part("3 Hz", Test::AtLeast(0.97)),
            part("3 Hz − 1 Hz", Test::IntervalAbove(0.0)),
            part("1 Hz − 0.5 Hz", Test::IntervalAbove(0.0)),
        ],
    },
    Claim {
        id: "kwak-mean-removal",
        paper: Paper::Kwak2018,
        text: "mean removal makes different devices' fingerprints alike",
        unit: "ratio of RMS difference",
        paper_value: None,
        parts: &whole(Test::AtMost(0.5)),
    },
    Claim {
        id: "kwak-cards",
        paper: Paper::Kwak2018,
        text: "cards a desktop sustains at 1 Hz",
        unit: "cards",
        paper_value: Some(60.0),
        parts: &whole(Test::AtLeast(60.0)),
    },
    Claim {
        id: "mc-80",
        paper: Paper::MassCentered,
        text: "about 1 m at 80 % in the office",
        unit: "m",
        paper_value: Some(1.0),
        parts: &whole(Test::AtMost(1.2)),
    },
    Claim {
        id: "mc-auc-nu",
        paper: Paper::MassCentered,
        text: "AUC non-upward",
        unit: "AUC",
        paper_value: Some(0.99),
        parts: &whole(Test::AtLeast(0.99 - 0.02)),
    },
    Claim {
        id: "mc-auc-unf",
        paper: Paper::MassCentered,
        text: "AUC upward non forward",
        unit: "AUC",
        paper_value: Some(0.95),
        parts: &whole(Test::AtLeast(0.95 - 0.02)),
    },
    Claim {
        id: "mc-auc-ufnh",
        paper: Paper::MassCentered,
        text: "AUC UFNH",
        unit: "AUC",
        paper_value: Some(0.98),
        parts: &whole(Test::AtLeast(0.98 - 0.02)),
    },
    Claim {
        id: "mc-auc-ufh",
        paper: Paper::MassCentered,
        text: "AUC UFH",
        unit: "AUC",
        paper_value: Some(0.97),
        parts: &whole(Test::AtLeast(0.97 - 0.02)),
    },
    Claim {
        id: "mc-steps-order",
        paper: Paper::MassCentered,
        text: "step models: static worse than normal worse than frequency worse than genetic on the 600-step loop",
        unit: "m",
        paper_value: None,
        parts: &[
            part("static − normal", Test::IntervalAbove(0.0)),
            part("normal − frequency", Test::IntervalAbove(0.0)),
            part("frequency − genetic", Test::IntervalAbove(0.0)),
        ],
    },
    Claim {
        id: "mc-azimuth",
        paper: Paper::MassCentered,
        text: "azimuth compensation clearly better than none",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "mc-window",
        paper: Paper::MassCentered,
        text: "windows of 1 to 5 steps better than 6 to 15",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "mc-threshold",
        paper: Paper::MassCentered,
        text: "T from 0.01 to 0.5 alike, 1.1 worst",
        unit: "m",
        paper_value: None,
        parts: &[
            part("1.1 − 0.01", Test::IntervalAbove(0.0)),
            part("1.1 − 0.05", Test::IntervalAbove(0.0)),
            part("1.1 − 0.1", Test::IntervalAbove(0.0)),
            part("1.1 − 0.5", Test::IntervalAbove(0.0)),
        ],
    },
    Claim {
        id: "mc-magicol-cross",
        paper: Paper::MassCentered,
        text: "DTW better below 60 % of the CDF, mass-centred above",
        unit: "fraction",
        paper_value: Some(0.6),
        parts: &[
            part("DTW − mass-centred at 80 %", Test::IntervalAbove(0.0)),
            part("DTW − mass-centred at 90 %", Test::IntervalAbove(0.0)),
        ],
    },
    Claim {
        id: "mc-users",
        paper: Paper::MassCentered,
        text: "six users alike",
        unit: "ratio worst/best p80",
        paper_value: None,
        parts: &whole(Test::AtMost(1.5)),
    },
    Claim {
        id: "mc-phones",
        paper: Paper::MassCentered,
        text: "four phones alike",
        unit: "ratio worst/best p80",
        paper_value: None,
        parts: &whole(Test::AtMost(1.5)),
    },
    Claim {
        id: "mc-time",
        paper: Paper::MassCentered,
        text: "18 times less than DTW a step",
        unit: "ratio",
        paper_value: Some(18.0),
        parts: &whole(Test::AtLeast(18.0)),
    },
    Claim {
        id: "mc-mall-worse",
        paper: Paper::MassCentered,
        text: "the mall is worse than the office",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "mc-spectrum",
        paper: Paper::MassCentered,
        text: "0.765 samples/m hold more than 98 % of the field's energy",
        unit: "%",
        paper_value: Some(98.0),
        parts: &whole(Test::AtLeast(95.0)),
    },
    Claim {
        id: "ibill-90",
        paper: Paper::Ibill,
        text: "90 % within 3.5 m in the hall",
        unit: "m",
        paper_value: Some(3.5),
        parts: &whole(Test::AtMost(3.5 * 1.15)),
    },
    Claim {
        id: "ibill-beats-magicol",
        paper: Paper::Ibill,
        text: "Magicol 12 m, dead reckoning 17 m at 90 %",
        unit: "m",
        paper_value: Some(12.0),
        parts: &[
            part("magicol-like − ibill", Test::IntervalAbove(0.0)),
            part("dead reckoning − magicol-like", Test::IntervalAbove(0.0)),
        ],
    },
    Claim {
        id: "ibill-cluster",
        paper: Paper::Ibill,
        text: "within 0.5 m inside a cluster of beacons 4 m apart",
        unit: "m",
        paper_value: Some(0.5),
        parts: &whole(Test::AtMost(0.5)),
    },
    Claim {
        id: "ibill-unbiased",
        paper: Paper::Ibill,
        text: "the corrected range is unbiased",
        unit: "ratio of means",
        paper_value: Some(1.0),
        parts: &whole(Test::Within(0.97, 1.03)),
    },
    Claim {
        id: "ibill-users",
        paper: Paper::Ibill,
        text: "five users, the worst (1.95 m tall) within 9 m at 90 %",
        unit: "m",
        paper_value: Some(9.0),
        parts: &whole(Test::AtMost(9.0)),
    },
    Claim {
        id: "ibill-early",
        paper: Paper::Ibill,
        text: "the improved filter beats Magicol's early on a trace, later they converge",
        unit: "m",
        paper_value: None,
        parts: ORDER,
    },
    Claim {
        id: "wila-steps",
        paper: Paper::Wila,
        text: "50 steps: at most 3 missed slow, 1 normal, 0 fast",
        unit: "steps",
        paper_value: Some(3.0),
        parts: &[
            part("slow", Test::AtMost(3.0)),
            part("normal", Test::AtMost(1.0)),
            part("fast", Test::AtMost(0.0)),
        ],
    },
    Claim {
        id: "wila-distance",
        paper: Paper::Wila,
        text: "30 m within 6 % at any speed after training K",
        unit: "%",
        paper_value: Some(6.0),
        parts: &whole(Test::AtMost(6.0)),
    },
    Claim {
        id: "wila-turns",
        paper: Paper::Wila,
        text: "ten right angles seen",
        unit: "turns",
        paper_value: Some(10.0),
        parts: &whole(Test::Within(10.0, 10.0)),
    },
    Claim {
        id: "wila-bend",
        paper: Paper::Wila,
        text: "a half circle read with about 10 deg error",
        unit: "deg",
        paper_value: Some(10.0),
        parts: &whole(Test::AtMost(10.0)),
    },
    Claim {
        id: "song-nn",
        paper: Paper::Song,
        text: "nearest neighbour, standing, mean",
        unit: "m",
        paper_value: Some(1.48),
        parts: &whole(Test::AtMost(1.48 * 1.25)),
    },
    Claim {
        id: "song-pf",
        paper: Paper::Song,
        text: "ordinary filter, 100 particles, 15 steps, mean",
        unit: "m",
        paper_value: Some(1.13),
        parts: &whole(Test::AtMost(1.13 * 1.25)),
    },
    Claim {
        id: "song-modified",
        paper: Paper::Song,
        text: "modified filter, 10 candidates, 10 steps, mean",
        unit: "m",
        paper_value: Some(0.95),
        parts: &whole(Test::AtMost(0.95 * 1.25)),
    },
    Claim {
        id: "song-order",
        paper: Paper::Song,
        text: "modified better than ordinary better than nearest neighbour",
        unit: "m",
        paper_value: None,
        parts: &[
            part("ordinary − modified", Test::IntervalAbove(0.0)),
            part("nearest − ordinary", Test::IntervalAbove(0.0)),
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique_and_stand_by_paper() {
        for (k, claim) in CLAIMS.iter().enumerate() {
            assert!(CLAIMS[..k].iter().all(|other| other.id != claim.id), "{}", claim.id);
            assert!(!claim.parts.is_empty(), "{}", claim.id);
            assert!(
                claim.parts.len() == 1 || claim.parts.iter().all(|part| !part.what.is_empty()),
                "{}",
                claim.id
            );
        }
        assert!(CLAIMS.windows(2).all(|pair| pair[0].paper <= pair[1].paper));
    }
}
