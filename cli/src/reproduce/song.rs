//! Song 2014: the ring of corridors.

use crate::reproduce::Experiment;

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[];
