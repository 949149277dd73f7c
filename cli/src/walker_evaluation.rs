//! The walker's half scored by itself, on recordings whose truth is known: steps, attitude, heading.
//!
//! A data set is a module with a `score` from folders to [`MetricScores`]; a metric is a variant of [`Metric`].

mod auc;
pub mod oxford_steps;
mod row;
pub mod segments;
pub mod step_strips;
pub mod tyrex;

pub use auc::auc;
pub use row::{ALL, Metric, MetricRow, MetricScores, Plot};
