//! What the tests across crates share. The tests themselves stand in this package's `tests` folder.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod recordings;
pub mod synthetic;
