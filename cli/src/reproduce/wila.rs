//! WILA 2016: steps, distance and turns at the waist.

use crate::reproduce::Experiment;

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[];
