//! What the sensors say, and its units.

/// Field a step, in µT: ±1200 µT over 16 bits.
///
/// # Source
/// KMX62-1031 Rev 4.0, first page: 0.0366 µT.
pub const FIELD_UT_PER_LSB: f32 = 1_200.0 / 32_768.0;
/// Standard gravity, in m/s².
pub const STANDARD_GRAVITY_M_S2: f32 = 9.806_65;

/// Largest acceleration that is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum AccelerationRange {
    /// ±2 g: 16384 steps a g.
    G2 = 0,
    /// ±4 g: 8192 steps a g. Default: walking stays below 3 g.
    #[default]
    G4 = 1,
    /// ±8 g: 4096 steps a g.
    G8 = 2,
    /// ±16 g: 2048 steps a g.
    G16 = 3,
}

impl AccelerationRange {
    /// Acceleration a step, in m/s².
    pub const fn m_s2_per_lsb(self) -> f32 {
        STANDARD_GRAVITY_M_S2 * (2 << self as u8) as f32 / 32_768.0
    }
}

/// One reading of both sensors and of the temperature, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Acceleration along x, y and z, specific force: positive on the axis that points up at rest.
    pub acceleration: [i16; 3],
    /// Magnetic field along x, y and z.
    pub field: [i16; 3],
    /// Temperature; its scale, 256 steps a degree, is not certain.
    pub temperature: i16,
}

impl Sample {
    /// Bytes of a reading.
    pub const LEN: usize = 14;

    /// Decodes what a read of [`Register::AccelXL`](crate::Register::AccelXL) gives.
    pub fn from_bytes(bytes: [u8; Self::LEN]) -> Self {
        let word = |k: usize| i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]);
        Self { acceleration: [0, 1, 2].map(word), field: [3, 4, 5].map(word), temperature: word(6) }
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
