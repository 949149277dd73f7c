//! Buildings, walkers, phones and radio to test Fieldwalk on: seeded, physical, the same bits on every machine.
//!
//! A [`scenario::Scenario`] holds a building with its magnetic field and its transmitters, and makes recordings of
//! walks in it together with the truth. Everything is a pure function of its seeds.
//!
//! # Example: a walk that no survey saw
//! ```
//! use fieldwalk_sim::scenario::Scenario;
//!
//! let office = Scenario::office(1);
//! let walk = &office.test_walks(1, 20.0)[0];
//! let recorded = office.simulate(walk);
//! assert!(recorded.samples.windows(2).all(|pair| pair[0].time <= pair[1].time));
//! let end = recorded.truth_at(recorded.samples[recorded.samples.len() - 1].time);
//! assert!(end.is_some_and(|end| office.building.plan.contains(end.position)));
//! ```
//!
//! # What is not simulated
//! Lifts that are ridden, crowds.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod noise;
mod vector;

pub mod air;
pub mod building;
pub mod card;
pub mod magnetic_field;
pub mod phone;
pub mod radio;
pub mod scenario;
pub mod walker;
