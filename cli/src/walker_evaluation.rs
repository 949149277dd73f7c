//! The walker's half and the radio scored by themselves, on recordings whose truth is known: steps, attitude, heading,
//! ranges and places by beacons.
//!
//! A data set is a module with a `score` from folders to [`MetricScores`]; a metric is a variant of [`Metric`].

mod auc;
pub mod ble_annotated;
pub mod oxford_steps;
mod row;
pub mod segments;
pub mod step_strips;
pub mod tyrex;

pub use auc::auc;
pub use row::{ALL, Metric, MetricRow, MetricScores, Plot};
