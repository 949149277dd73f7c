//! Kwak 2018: its card, its access points, its office.

pub(crate) mod office;
mod signals;
mod time;
mod walks;

use crate::reproduce::Experiment;

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "the card in its office",
        claims: &[
            "kwak-median",
            "kwak-mean",
            "kwak-euc-as-dtw",
            "kwak-euc500-worse",
            "kwak-motion-model",
            "kwak-no-motion-model-worse",
            "kwak-radar-worse",
            "kwak-heuristics",
            "kwak-history",
            "kwak-ble-filter",
            "kwak-steps",
        ],
        is_timed: false,
        run: walks::run,
    },
    Experiment {
        name: "rates and devices",
        claims: &["kwak-3hz", "kwak-mean-removal"],
        is_timed: false,
        run: signals::run,
    },
    Experiment {
        name: "time of a round",
        claims: &["kwak-time-ratio", "kwak-dtw500-slower", "kwak-cards"],
        is_timed: true,
        run: time::run,
    },
];
