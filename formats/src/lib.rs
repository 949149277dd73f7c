//! Files: recordings in, maps and floor plans in and out.
//!
//! Everything read here may come from a stranger: bad bytes give a [`FormatError`] or a counted rejection, never a
//! panic and never more memory than a small multiple of the file.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod ble_annotated;
pub mod error;
pub mod geojson_plan;
pub mod get_sensor_data;
pub mod ilc;
pub mod map;
pub mod oxford_steps;
pub mod recording;
pub mod sensor_logger;
pub mod tyrex;
pub mod uji_mag;

mod comma_rows;
mod text_lines;
mod transmitter_id;

pub use error::FormatError;
pub use geojson_plan::{read_plan, write_plan};
pub use map::{decode_floor, encode_floor, open_building, pack_building, unpack_building, write_building};
pub use recording::{Record, open_recording};
