//! What a positioner lacks, what it has left out, and why.

use fieldwalk_batch::RecordFault;

use crate::missing::Missing;

/// How a positioner fares.
#[derive(Clone, Debug, Default, PartialEq, Eq, uniffi::Record)]
pub struct Status {
    /// Samples refused, by cause.
    pub rejections: Rejections,
    /// Records of batches that gave no sample, by cause.
    pub batch_faults: BatchFaults,
    /// Times that every particle died and the cloud was spread anew.
    pub n_recoveries: u32,
    /// What is missing now, and how to mend it; empty when all is well.
    pub missing: Vec<Missing>,
}

/// Samples refused, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, uniffi::Record)]
pub struct Rejections {
    /// NaN, infinite or beyond what the sensor's physics allows.
    pub implausible: u64,
    /// More than 200 ms older than the newest.
    pub late: u64,
    /// The same sensor and time again.
    pub duplicate: u64,
    /// Stamped far ahead of every other sample: by seconds where there are sensors of motion, else by a minute.
    pub jumped: u64,
}

/// Records of batches that gave no sample, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, uniffi::Record)]
pub struct BatchFaults {
    /// Of a kind that this version does not know.
    pub unknown_kind: u64,
    /// Of a length that is not its kind's, cut off, or after the last record announced.
    pub malformed: u64,
}

impl BatchFaults {
    /// Counts `fault`.
    pub(crate) fn count(&mut self, fault: RecordFault) {
        match fault {
            RecordFault::UnknownKind => self.unknown_kind += 1,
            _ => self.malformed += 1,
        }
    }
}

impl From<fieldwalk::Rejections> for Rejections {
    fn from(rejections: fieldwalk::Rejections) -> Self {
        let fieldwalk::Rejections { implausible, late, duplicate, jumped } = rejections;
        Self { implausible, late, duplicate, jumped }
    }
}
