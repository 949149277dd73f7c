//! Mass-centred 2019: the attitude by itself, systems in the office and in a mall, the field.

mod attitude;
mod field;
mod mall;
mod office;
mod step_lengths;
mod sweeps;
mod timing;

use crate::reproduce::Experiment;

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "the office, its users and phones",
        claims: &[
            "mc-80",
            "mc-magicol-cross",
            "mc-window",
            "mc-threshold",
            "mc-users",
            "mc-phones",
            "mc-steps-order",
            "mc-azimuth",
        ],
        is_timed: false,
        run: office::run,
    },
    Experiment { name: "a mall", claims: &["mc-mall-worse"], is_timed: false, run: mall::run },
    Experiment {
        name: "attitudes",
        claims: &["mc-auc-nu", "mc-auc-unf", "mc-auc-ufnh", "mc-auc-ufh"],
        is_timed: false,
        run: attitude::run,
    },
    Experiment { name: "the field's spectrum", claims: &["mc-spectrum"], is_timed: false, run: field::run },
    Experiment { name: "time of a step", claims: &["mc-time"], is_timed: true, run: timing::run },
];
