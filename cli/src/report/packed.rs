//! Arrays of whole numbers as base64 of their little-endian bytes: a third of what digits would take.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use fieldwalk::time::Timestamp;
use serde::{Serialize, Serializer};

/// A packed array; the page knows from the field what its numbers are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Packed(Vec<u8>);

impl Packed {
    /// Bytes as they are.
    pub fn u8s(values: impl IntoIterator<Item = u8>) -> Self {
        Self(values.into_iter().collect())
    }

    /// Two bytes a number.
    pub fn u16s(values: impl IntoIterator<Item = u16>) -> Self {
        Self(values.into_iter().flat_map(u16::to_le_bytes).collect())
    }

    /// Four bytes a number.
    pub fn u32s(values: impl IntoIterator<Item = u32>) -> Self {
        Self(values.into_iter().flat_map(u32::to_le_bytes).collect())
    }

    /// Four bytes a number, signed.
    pub fn i32s(values: impl IntoIterator<Item = i32>) -> Self {
        Self(values.into_iter().flat_map(i32::to_le_bytes).collect())
    }
}

impl Serialize for Packed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&STANDARD.encode(&self.0))
    }
}

/// Whole centimetres; those beyond ± 21 474 km are cut, and NaN is 0.
pub fn cm(m: f64) -> i32 {
    (100.0 * m).round() as i32
}

/// Whole centimetres of a length, 655.34 m at most.
pub fn length_cm(m: f64) -> u16 {
    (100.0 * m).round().min(f64::from(NO_LENGTH - 1)) as u16
}

/// Stands for a length that is not known.
pub const NO_LENGTH: u16 = u16::MAX;

/// Milliseconds after `began`, 0 before it.
pub fn ms_after(began: Timestamp, time: Timestamp) -> u32 {
    (1e3 * time.secs_since(began)).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_packed_little_endian() {
        let text = |packed: &Packed| serde_json::to_string(packed).unwrap();
        assert_eq!(text(&Packed::u8s([1, 2, 255])), "\"AQL/\"");
        assert_eq!(text(&Packed::u16s([258])), "\"AgE=\"");
        assert_eq!(text(&Packed::i32s([-2])), "\"/v///w==\"");
        assert_eq!(text(&Packed::default()), "\"\"");
    }

    #[test]
    fn quantities_are_cut_not_wrapped() {
        assert_eq!((cm(1.234), cm(-0.005), cm(1e12), cm(f64::NAN)), (123, -1, i32::MAX, 0));
        assert_eq!((length_cm(2.0), length_cm(1e9), length_cm(-1.0)), (200, NO_LENGTH - 1, 0));
        let time = Timestamp::from_millis;
        assert_eq!((ms_after(time(5), time(1_505)), ms_after(time(5), time(1))), (1_500, 0));
    }
}
