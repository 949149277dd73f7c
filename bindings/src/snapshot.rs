//! Snapshots as bytes: a header, the core's snapshot in postcard, a checksum.
//!
//! A snapshot is for the same version of the library, such as over a restart of the app; it is no file format.

use fieldwalk::positioner::Snapshot;
use serde::{Deserialize, Serialize};

use crate::error::{ApiError, api_error};
use crate::status::BatchFaults;

/// The first bytes: what this is, and the layout's number.
const MAGIC: [u8; 6] = *b"FWSS\x01\0";

/// What a positioner of the boundary remembers.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Remembered {
    pub version: String,
    pub positioner: Snapshot,
    /// Faults of unknown kind, malformed.
    batch_faults: (u64, u64),
}

impl Remembered {
    pub fn new(positioner: Snapshot, batch_faults: BatchFaults) -> Self {
        let BatchFaults { unknown_kind, malformed } = batch_faults;
        Self { version: crate::version(), positioner, batch_faults: (unknown_kind, malformed) }
    }

    pub fn batch_faults(&self) -> BatchFaults {
        let (unknown_kind, malformed) = self.batch_faults;
        BatchFaults { unknown_kind, malformed }
    }

    /// # Errors
    /// Never in practice: memory takes every byte.
    pub fn encode(&self) -> Result<Vec<u8>, ApiError> {
        let mut bytes = postcard::to_extend(self, MAGIC.to_vec()).map_err(|_| ApiError::broken())?;
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        Ok(bytes)
    }

    /// # Errors
    /// When `bytes` are no snapshot or not all of one, and when another version of the library made them.
    pub fn decode(bytes: &[u8]) -> Result<Self, ApiError> {
        let malformed = || {
            api_error!(
                SnapshotMalformed,
                "not a snapshot, or not all of one",
                "keep all bytes of a snapshot; without one, start anew with a hint"
            )
        };
        let foreign = || {
            api_error!(
                SnapshotForeign,
                "the snapshot is of another version of Fieldwalk",
                "start anew with a hint"
            )
        };
        let (content, checksum) = bytes.split_last_chunk().ok_or_else(malformed)?;
        if !content.starts_with(&MAGIC[..4]) || crc32fast::hash(content) != u32::from_le_bytes(*checksum) {
            return Err(malformed());
        }
        let content = content.strip_prefix(&MAGIC).ok_or_else(foreign)?;
        // The version comes first: another one's bytes may not parse at all.
        let (version, _) = postcard::take_from_bytes::<&str>(content).map_err(|_| malformed())?;
        if version != crate::version() {
            return Err(foreign());
        }
        let (remembered, rest) = postcard::take_from_bytes(content).map_err(|_| malformed())?;
        if rest.is_empty() { Ok(remembered) } else { Err(malformed()) }
    }
}
