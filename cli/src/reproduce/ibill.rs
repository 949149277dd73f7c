//! iBILL 2017: beacons by themselves, and walks through an open hall.

mod beacons;
mod walks;

use crate::reproduce::Experiment;

/// What is measured for this paper.
pub fn experiments() -> Vec<Experiment> {
    [beacons::EXPERIMENTS, walks::EXPERIMENTS].concat()
}
