//! The magnetic field as a place's mark.

pub mod feature;
pub mod trace;
