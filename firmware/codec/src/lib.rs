//! The bytes on the air.
