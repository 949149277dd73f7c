//! Whole systems in an open hall.

use crate::reproduce::Experiment;

/// What is measured on walks.
pub const EXPERIMENTS: &[Experiment] = &[];
