//! Indoor positioning from the magnetic field, the walker's steps and radio beacons.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod floor_plan;
pub mod geometry;
pub mod gravity;
pub mod magnetic;
pub mod map;
pub mod metrics;
pub mod observation;
pub mod particle;
pub mod pedestrian;
pub mod positioner;
pub mod random;
mod reorder;
pub mod sensor;
pub mod step;
pub mod survey;
pub mod system;
pub mod time;
pub mod tracker;

pub use reorder::{DEFAULT_REORDER_WINDOW, Rejections};
