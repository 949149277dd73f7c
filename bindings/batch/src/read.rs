//! Reads a batch in place.

use core::fmt;

use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::Timestamp;

use crate::layout::{
    ANGULAR_RATE, BLE_SIGHTING, CARD_FRAME, HEADER_BYTES, IBEACON_SIGHTING, MAGIC, MAGNETIC_FIELD,
    N_BYTES_AT, N_RECORDS_AT, PRESSURE, RECORD_HEADER_BYTES, RECORDS, SPECIFIC_FORCE,
    UNCALIBRATED_MAGNETIC_FIELD, VERSION, VERSION_AT, WIFI_SIGHTING,
};

/// Why a batch is refused whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BatchError {
    /// The bytes do not begin as a batch does, or the header contradicts itself.
    NotABatch,
    /// The batch is shorter or longer than its header says.
    Torn,
    /// The batch is of a version that only a newer build reads.
    NewerVersion {
        /// The batch's version.
        found: u16,
    },
}

impl fmt::Display for BatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotABatch => write!(f, "not a sample batch: make it with an encoder of this library"),
            Self::Torn => {
                write!(f, "the batch is not as long as its header says: pass all of its bytes and no more")
            }
            Self::NewerVersion { found } => {
                write!(f, "a batch of version {found}, this build reads up to {VERSION}: update the library")
            }
        }
    }
}

impl core::error::Error for BatchError {}

/// Why one record of a batch gives no sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RecordFault {
    /// The record is of a kind that this build does not know; the records after it can be read.
    UnknownKind,
    /// The record's length is not that of its kind, or runs over the end of the batch; where such a length leaves no
    /// way to the next record, the records after it are counted as malformed too.
    Malformed,
}

/// A batch whose header has been checked.
#[derive(Clone, Copy, Debug)]
pub struct SampleBatch<'a> {
    n_records: u32,
    records: &'a [u8],
}

impl<'a> SampleBatch<'a> {
    /// Checks the header of `bytes`.
    ///
    /// # Errors
    /// When `bytes` are no batch, are of a newer version, or are not as many as the header says.
    pub fn new(bytes: &'a [u8]) -> Result<Self, BatchError> {
        let short = if bytes.len() >= MAGIC.len() { BatchError::Torn } else { BatchError::NotABatch };
        if !bytes.starts_with(&MAGIC) {
            return Err(BatchError::NotABatch);
        }
        let version = u16::from_le_bytes(array_at(bytes, VERSION_AT).ok_or(short)?);
        if version > VERSION {
            return Err(BatchError::NewerVersion { found: version });
        }
        let n_records = u32::from_le_bytes(array_at(bytes, N_RECORDS_AT).ok_or(short)?);
        let n_bytes = u32::from_le_bytes(array_at(bytes, N_BYTES_AT).ok_or(short)?);
        let records = bytes.get(HEADER_BYTES..).ok_or(short)?;
        if u64::from(n_bytes) != bytes.len() as u64 {
            return Err(BatchError::Torn);
        }
        // No record is shorter than its header: a larger count is a lie, and counting to it would take long.
        if version == 0 || u64::from(n_records) * RECORD_HEADER_BYTES as u64 > records.len() as u64 {
            return Err(BatchError::NotABatch);
        }
        Ok(Self { n_records, records })
    }

    /// Number of records, good or bad, by the header.
    pub fn n_records(&self) -> u32 {
        self.n_records
    }

    /// The records in their order: a sample or a fault for each, and one fault more for bytes after the last.
    pub fn samples(&self) -> Samples<'a> {
        Samples { n_left: self.n_records, rest: self.records }
    }
}

/// The samples of a batch.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    n_left: u32,
    rest: &'a [u8],
}

impl Iterator for Samples<'_> {
    type Item = Result<Sample, RecordFault>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.n_left == 0 {
            let is_clean = self.rest.is_empty();
            self.rest = &[];
            return (!is_clean).then_some(Err(RecordFault::Malformed));
        }
        self.n_left -= 1;
        let n_bytes = self.rest.get(1).map_or(0, |&n_bytes| usize::from(n_bytes));
        let split = if n_bytes < RECORD_HEADER_BYTES { None } else { self.rest.split_at_checked(n_bytes) };
        let Some((record, rest)) = split else {
            self.rest = &[];
            return Some(Err(RecordFault::Malformed));
        };
        self.rest = rest;
        Some(parse(record))
    }
}

/// The sample of a whole record.
fn parse(record: &[u8]) -> Result<Sample, RecordFault> {
    let mut fields = Fields { rest: record };
    let (code, _n_bytes) = (fields.byte()?, fields.byte()?);
    if !RECORDS.iter().any(|layout| layout.code == code) {
        return Err(RecordFault::UnknownKind);
    }
    let time = Timestamp::from_nanos(i64::from_le_bytes(fields.take()?));
    let reading = match code {
        _ if code == SPECIFIC_FORCE.code => Reading::SpecificForce(fields.vector()?),
        _ if code == ANGULAR_RATE.code => Reading::AngularRate(fields.vector()?),
        _ if code == MAGNETIC_FIELD.code => Reading::MagneticField(fields.vector()?),
        _ if code == UNCALIBRATED_MAGNETIC_FIELD.code => {
            Reading::UncalibratedMagneticField { field_ut: fields.vector()?, bias_ut: fields.vector()? }
        }
        _ if code == PRESSURE.code => Reading::Pressure { pressure_hpa: fields.f32()? },
        _ if code == BLE_SIGHTING.code => {
            let rssi_dbm = fields.f32()?;
            Reading::Radio(RadioSighting { transmitter: TransmitterId::BleAddress(fields.take()?), rssi_dbm })
        }
        _ if code == IBEACON_SIGHTING.code => {
            let rssi_dbm = fields.f32()?;
            let transmitter =
                TransmitterId::Ibeacon { uuid: fields.take()?, major: fields.u16()?, minor: fields.u16()? };
            Reading::Radio(RadioSighting { transmitter, rssi_dbm })
        }
        _ if code == WIFI_SIGHTING.code => {
            let rssi_dbm = fields.f32()?;
            Reading::Radio(RadioSighting { transmitter: TransmitterId::WifiBssid(fields.take()?), rssi_dbm })
        }
        _ if code == CARD_FRAME.code => Reading::CardFrame(fields.take()?),
        _ => return Err(RecordFault::UnknownKind),
    };
    if fields.rest.is_empty() { Ok(Sample { time, reading }) } else { Err(RecordFault::Malformed) }
}

/// The fields of a record, from left to right.
struct Fields<'a> {
    rest: &'a [u8],
}

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], RecordFault> {
        let (bytes, rest) = self.rest.split_first_chunk().ok_or(RecordFault::Malformed)?;
        self.rest = rest;
        Ok(*bytes)
    }

    fn byte(&mut self) -> Result<u8, RecordFault> {
        self.take().map(|[byte]| byte)
    }

    fn u16(&mut self) -> Result<u16, RecordFault> {
        self.take().map(u16::from_le_bytes)
    }

    fn f32(&mut self) -> Result<f32, RecordFault> {
        self.take().map(f32::from_le_bytes)
    }

    fn vector(&mut self) -> Result<[f32; 3], RecordFault> {
        Ok([self.f32()?, self.f32()?, self.f32()?])
    }
}

fn array_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}
