//! The JSON part of a floor's file, under the metadata key `fieldwalk`.

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::map::GridFrame;
use serde::{Deserialize, Serialize};

use super::MAP_VERSION;
use crate::error::FormatError;

pub(super) const FLOOR_FORMAT: &str = "fieldwalk-floor";

/// What stands in place of the digest while the digest is taken.
pub(super) const NO_DIGEST: [u8; 64] = [b'0'; 64];

/// Everything about a floor that is not a tensor.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct FloorMetadata {
    pub(super) format: String,
    pub(super) frame: GridFrame,
    pub(super) name: String,
    pub(super) ordinal: i32,
    pub(super) plan: FloorPlan,
    /// SHA-256 of the whole file with these 64 digits as zeros.
    pub(super) sha256: String,
    /// Who the rows of the radio table are.
    pub(super) transmitters: Vec<String>,
    pub(super) version: u64,
}

impl FloorMetadata {
    /// Reads the JSON; the version first, so that a newer file is not taken for a broken one.
    pub(super) fn from_json(text: &str) -> Result<Self, FormatError> {
        check_version(text.as_bytes(), FLOOR_FORMAT)?;
        serde_json::from_str(text).map_err(|error| malformed_json(FLOOR_FORMAT, &error))
    }

    /// The JSON, keys sorted at every depth.
    pub(super) fn to_json(&self) -> Result<String, FormatError> {
        let fail = |error| malformed_json(FLOOR_FORMAT, &error);
        let mut value = serde_json::to_value(self).map_err(fail)?;
        value.sort_all_objects();
        serde_json::to_string(&value).map_err(fail)
    }
}

/// Checks that `json` declares the format `expected` in a version that this build reads.
pub(super) fn check_version(json: &[u8], expected: &str) -> Result<(), FormatError> {
    #[derive(Deserialize)]
    struct Declaration {
        format: String,
        version: u64,
    }
    let found: Declaration =
        serde_json::from_slice(json).map_err(|error| malformed_json(expected, &error))?;
    if found.format != expected {
        let message = format!("format is `{}`, not `{expected}`", found.format);
        return Err(FormatError::malformed(message, "give a map that Fieldwalk exported"));
    }
    if found.version > MAP_VERSION {
        return Err(FormatError::newer_version(found.version, MAP_VERSION));
    }
    if found.version == 0 {
        return Err(FormatError::malformed("format version 0", "give a map that Fieldwalk exported"));
    }
    Ok(())
}

pub(super) fn malformed_json(format: &str, error: &serde_json::Error) -> FormatError {
    FormatError::malformed(format!("not {format}: {error}"), "give a map that Fieldwalk exported")
}
