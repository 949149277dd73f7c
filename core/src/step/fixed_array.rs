//! Arrays of any fixed length in a snapshot, as lists.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(super) fn serialize<S: Serializer, const N: usize>(values: &[f32; N], to: S) -> Result<S::Ok, S::Error> {
    values.as_slice().serialize(to)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f32; N], D::Error> {
    let values = Vec::<f32>::deserialize(from)?;
    <[f32; N]>::try_from(values).map_err(|values| D::Error::invalid_length(values.len(), &"another length"))
}
