//! Observations: how well each particle's place explains what was sensed, as log-likelihoods.

pub mod ble_filter;
pub mod candidates;
pub mod field_vector;
pub mod history;
pub mod mass_centered;
pub mod radio;
pub mod strength;
pub mod three_factors;
