//! What a recording says about itself.

use std::collections::BTreeMap;

use mcap::records::Metadata;

use crate::error::FormatError;

/// The version of the recordings that this build writes, and the newest that it reads.
pub(super) const RECORDING_VERSION: u64 = 1;

/// The name of the metadata record, and the profile of the file.
pub(super) const FIELDWALK: &str = "fieldwalk";

/// Where a recording comes from: the metadata record `fieldwalk` at the head of the file.
///
/// What is empty or `None` is unknown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordingInfo {
    /// The device that recorded, such as `Pixel 8`.
    pub device: String,
    /// The program that recorded, and its version.
    pub software: String,
    /// The floor walked, as its map names it.
    pub floor: String,
    /// When the recording started, in milliseconds since 1970 UTC.
    ///
    /// Records are stamped by a clock whose origin may be anything, such as the device's last start.
    pub start_unix_ms: Option<i64>,
}

const DEVICE: &str = "device";
const SOFTWARE: &str = "software";
const FLOOR: &str = "floor";
const START: &str = "start_unix_ms";
const VERSION: &str = "format_version";

impl RecordingInfo {
    pub(super) fn to_metadata(&self) -> Metadata {
        let mut metadata = BTreeMap::from([(VERSION.to_owned(), RECORDING_VERSION.to_string())]);
        for (key, value) in [(DEVICE, &self.device), (SOFTWARE, &self.software), (FLOOR, &self.floor)] {
            if !value.is_empty() {
                metadata.insert(key.to_owned(), value.clone());
            }
        }
        if let Some(start) = self.start_unix_ms {
            metadata.insert(START.to_owned(), start.to_string());
        }
        Metadata { name: FIELDWALK.to_owned(), metadata }
    }

    /// `None` for another program's metadata.
    pub(super) fn from_metadata(record: Metadata) -> Result<Option<Self>, FormatError> {
        let Metadata { name, mut metadata } = record;
        if name != FIELDWALK {
            return Ok(None);
        }
        let version = metadata.get(VERSION).and_then(|text| text.parse().ok()).unwrap_or(RECORDING_VERSION);
        if version > RECORDING_VERSION {
            return Err(FormatError::newer_version(version, RECORDING_VERSION));
        }
        let mut take = |key: &str| metadata.remove(key).unwrap_or_default();
        Ok(Some(Self {
            device: take(DEVICE),
            software: take(SOFTWARE),
            floor: take(FLOOR),
            start_unix_ms: take(START).parse().ok(),
        }))
    }
}
