//! Sensor samples packed for the way across a language boundary: one call carries many.
//!
//! A batch is a header and records, little-endian throughout; [`layout`] describes every byte, and from it come the
//! table in `bindings/BATCH.md` and the encoders of the other languages. [`SampleBatch`] reads a batch in place
//! without allocating; [`SampleBatchWriter`] is the encoder for Rust.
//!
//! Reading is total. A batch whose header is not as it should be is refused whole. From then on every record gives a
//! sample or a [`RecordFault`] to be counted, and never disturbs the records before it.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod layout;
mod read;
mod write;

pub use read::{BatchError, RecordFault, SampleBatch, Samples};
pub use write::SampleBatchWriter;
