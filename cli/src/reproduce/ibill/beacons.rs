//! Ranges and positions from beacons alone.

use crate::reproduce::Experiment;

/// What is measured of beacons.
pub const EXPERIMENTS: &[Experiment] = &[];
