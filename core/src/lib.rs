//! Indoor positioning from the magnetic field, the walker's steps and radio beacons.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod floor_plan;
pub mod geometry;
pub mod map;
pub mod sensor;
pub mod time;
