//! What the tests across crates share. The tests themselves stand in this package's `tests` folder.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod browser;
pub mod recordings;
pub mod skipped;
pub mod synthetic;

/// The README's example compiles.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
