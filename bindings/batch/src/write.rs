//! Writes a batch; the encoder for Rust, and what the encoders of other languages are compared with.

use fieldwalk::sensor::{Reading, Sample, TransmitterId};

use crate::layout::{
    ANGULAR_RATE, BLE_SIGHTING, CARD_FRAME, HEADER_BYTES, IBEACON_SIGHTING, MAGIC, MAGNETIC_FIELD,
    N_BYTES_AT, N_RECORDS_AT, PRESSURE, RecordLayout, SPECIFIC_FORCE, UNCALIBRATED_MAGNETIC_FIELD, VERSION,
    VERSION_AT, WIFI_SIGHTING,
};

/// Packs samples into a batch.
#[derive(Clone, Debug)]
pub struct SampleBatchWriter {
    bytes: Vec<u8>,
    n_records: u32,
}

impl Default for SampleBatchWriter {
    fn default() -> Self {
        Self::new()
    }
}

impl SampleBatchWriter {
    /// An empty batch.
    pub fn new() -> Self {
        let mut bytes = vec![0; HEADER_BYTES];
        bytes[..MAGIC.len()].copy_from_slice(&MAGIC);
        bytes[VERSION_AT..][..2].copy_from_slice(&VERSION.to_le_bytes());
        Self { bytes, n_records: 0 }
    }

    /// Adds `sample` at the end; false, and nothing added, for a kind of reading that batches do not carry.
    pub fn push(&mut self, sample: &Sample) -> bool {
        match &sample.reading {
            Reading::SpecificForce(force) => self.record(&SPECIFIC_FORCE, sample, &[force], &[]),
            Reading::AngularRate(rate) => self.record(&ANGULAR_RATE, sample, &[rate], &[]),
            Reading::MagneticField(field) => self.record(&MAGNETIC_FIELD, sample, &[field], &[]),
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                self.record(&UNCALIBRATED_MAGNETIC_FIELD, sample, &[field_ut, bias_ut], &[]);
            }
            Reading::Pressure { pressure_hpa } => self.record(&PRESSURE, sample, &[&[*pressure_hpa]], &[]),
            Reading::Radio(sighting) => {
                let rssi: &[f32] = &[sighting.rssi_dbm];
                match sighting.transmitter {
                    TransmitterId::BleAddress(address) => {
                        self.record(&BLE_SIGHTING, sample, &[rssi], &[&address]);
                    }
                    TransmitterId::Ibeacon { uuid, major, minor } => {
                        let numbers = [major.to_le_bytes(), minor.to_le_bytes()];
                        self.record(&IBEACON_SIGHTING, sample, &[rssi], &[&uuid, numbers.as_flattened()]);
                    }
                    TransmitterId::WifiBssid(bssid) => {
                        self.record(&WIFI_SIGHTING, sample, &[rssi], &[&bssid]);
                    }
                    _ => return false,
                }
            }
            Reading::CardFrame(frame) => self.record(&CARD_FRAME, sample, &[], &[frame]),
            _ => return false,
        }
        true
    }

    /// Number of records so far.
    pub fn n_records(&self) -> u32 {
        self.n_records
    }

    /// The whole batch.
    pub fn finish(mut self) -> Vec<u8> {
        let n_bytes = self.bytes.len() as u32;
        self.bytes[N_RECORDS_AT..][..4].copy_from_slice(&self.n_records.to_le_bytes());
        self.bytes[N_BYTES_AT..][..4].copy_from_slice(&n_bytes.to_le_bytes());
        self.bytes
    }

    /// A record: its numbers, then its bytes.
    fn record(&mut self, layout: &RecordLayout, sample: &Sample, numbers: &[&[f32]], identity: &[&[u8]]) {
        let start = self.bytes.len();
        self.bytes.extend([layout.code, layout.n_bytes() as u8]);
        self.bytes.extend(sample.time.as_nanos().to_le_bytes());
        self.bytes.extend(numbers.iter().copied().flatten().flat_map(|number| number.to_le_bytes()));
        self.bytes.extend(identity.iter().copied().flatten());
        self.n_records += 1;
        debug_assert_eq!(self.bytes.len() - start, layout.n_bytes(), "{}", layout.name);
    }
}
