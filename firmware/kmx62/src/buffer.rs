//! The buffer: what it holds and how full it is.

use crate::register::{BUF_ACCELERATION, BUF_FIELD};
use crate::sample::{AccelerationRange, FIELD_UT_PER_LSB};

/// Bytes that the buffer holds: 32 readings of six axes, 64 of three.
pub const BUFFER_LEN: usize = 384;

/// What goes into the buffer for each reading.
pub trait Entry: Copy + Default {
    /// Bytes of an entry.
    const LEN: usize;
    /// Which axes go in: BUF_CTRL_3.
    const AXES: u8;

    /// Decodes the first [`Self::LEN`] bytes; nothing for fewer, and nothing for the filler that an empty buffer gives.
    fn from_slice(bytes: &[u8]) -> Option<Self>;
}

/// A reading of the acceleration alone, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AccelerationEntry(pub [i16; 3]);

impl Entry for AccelerationEntry {
    const LEN: usize = 6;
    const AXES: u8 = BUF_ACCELERATION;

    fn from_slice(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; 6] = bytes.first_chunk()?;
        let entry = [0, 1, 2].map(|k| i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]));
        (entry != [i16::MAX; 3]).then_some(Self(entry))
    }
}

impl AccelerationEntry {
    /// Specific force in m/s².
    pub fn acceleration_m_s2(&self, range: AccelerationRange) -> [f32; 3] {
        self.0.map(|steps| f32::from(steps) * range.m_s2_per_lsb())
    }
}

impl Entry for BufferEntry {
    const LEN: usize = 12;
    const AXES: u8 = BUF_ACCELERATION | BUF_FIELD;

    fn from_slice(bytes: &[u8]) -> Option<Self> {
        bytes.first_chunk().and_then(|bytes| Self::from_bytes(*bytes))
    }
}

/// A reading of six axes from the buffer, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BufferEntry {
    /// Acceleration along x, y and z.
    pub acceleration: [i16; 3],
    /// Magnetic field along x, y and z.
    pub field: [i16; 3],
}

impl BufferEntry {
    /// Decodes an entry; nothing for the filler that an empty buffer gives, 0x7FFF on every axis.
    pub fn from_bytes(bytes: [u8; 12]) -> Option<Self> {
        let word = |k: usize| i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]);
        let entry = Self { acceleration: [0, 1, 2].map(word), field: [3, 4, 5].map(word) };
        (entry.acceleration != [i16::MAX; 3] || entry.field != [i16::MAX; 3]).then_some(entry)
    }

    /// The bytes of an entry, as for a recording.
    pub fn to_bytes(self) -> [u8; 12] {
        let mut bytes = [0; 12];
        for (pair, word) in bytes.chunks_exact_mut(2).zip(self.acceleration.into_iter().chain(self.field)) {
            pair.copy_from_slice(&word.to_le_bytes());
        }
        bytes
    }

    /// Specific force in m/s².
    pub fn acceleration_m_s2(&self, range: AccelerationRange) -> [f32; 3] {
        self.acceleration.map(|steps| f32::from(steps) * range.m_s2_per_lsb())
    }

    /// Magnetic field in µT.
    pub fn field_ut(&self) -> [f32; 3] {
        self.field.map(|steps| f32::from(steps) * FIELD_UT_PER_LSB)
    }
}

/// How full the buffer is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BufferStatus {
    /// Bytes that it holds, at most 511.
    pub level: u16,
    /// Whether the trigger has come, where one is used.
    pub is_triggered: bool,
    /// Bytes that were lost since it was full.
    pub n_lost: u16,
}

impl BufferStatus {
    /// Decodes BUF_STATUS_1 to 3.
    pub fn from_bytes([first, second, third]: [u8; 3]) -> Self {
        Self {
            level: u16::from(first) | u16::from(second & 1) << 8,
            is_triggered: second & 2 != 0,
            n_lost: u16::from(second >> 2) | u16::from(third) << 6,
        }
    }

    /// Whole entries that it holds: of six axes 32 at most, of three 64.
    pub fn n_entries<E: Entry>(&self) -> usize {
        usize::from(self.level).min(BUFFER_LEN) / E::LEN
    }
}
