//! Kwak 2018:its card, its access points, its office.

use crate::reproduce::Experiment;

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[];
