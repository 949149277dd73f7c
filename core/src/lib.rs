//! Indoor positioning from the magnetic field, the walker's steps and radio beacons.
//!
//! A [`positioner::Positioner`] takes stamped [`sensor::Sample`]s and gives [`positioner::Fix`]es on a surveyed
//! [`map::FloorMap`]; [`survey::build_floor`] makes that map from walks with waypoints. A system is a
//! [`system::Recipe`]: data that names the parts.
//!
//! Nothing here reads a file, a clock or a thread: time comes with the samples, randomness from a seed. The same map,
//! recipe, seed and samples give the same bits on every machine.
//!
//! # Example: start from a place that somebody tapped
//!
//! ```
//! use std::sync::Arc;
//!
//! use fieldwalk::floor_plan::FloorPlan;
//! use fieldwalk::geometry::Point2;
//! use fieldwalk::map::{FloorIndex, FloorMap};
//! use fieldwalk::positioner::{PositionError, PositionHint, Positioner};
//! use fieldwalk::system::Recipe;
//! use fieldwalk::time::Timestamp;
//!
//! let plan = FloorPlan { width_m: 40.0, height_m: 25.0, ..FloorPlan::default() };
//! let floor = FloorIndex::new(FloorMap { name: "F1".into(), plan, ..FloorMap::default() });
//! let mut positioner = Positioner::new(Arc::new(floor), Recipe::fused(), 1);
//!
//! let tapped = Point2::new(12.0, 7.5);
//! positioner.hint(PositionHint { point: tapped, radius_m: 1.0, floor: 0, time: Timestamp::from_millis(0), direction: None })?;
//! // From here on: positioner.push(sample) for every sample, a fix for every step.
//! let fix = positioner.fix().ok_or(PositionError::NoFix)?;
//! assert!(fix.position.distance_m(tapped) < 0.2);
//! # Ok::<(), PositionError>(())
//! ```
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod attitude;
pub mod beacon_mode;
pub mod calibration;
pub mod card;
pub mod floor_plan;
pub mod front_end;
pub mod geometry;
pub mod gravity;
pub mod heading;
pub mod magnetic;
pub mod map;
pub mod metrics;
pub mod observation;
pub mod particle;
pub mod pedestrian;
pub mod positioner;
pub mod radio;
pub mod random;
mod reorder;
pub mod rotation;
pub mod sensor;
pub mod step;
pub mod survey;
pub mod system;
pub mod time;
pub mod tracker;

pub use reorder::{DEFAULT_REORDER_WINDOW, Rejections};
