//! What caused an interrupt.

/// Axes and directions of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionAxes {
    /// Motion in the negative direction along x, y and z.
    pub negative: [bool; 3],
    /// Motion in the positive direction along x, y and z.
    pub positive: [bool; 3],
}

impl MotionAxes {
    /// All axes in both directions.
    pub const ALL: Self = Self { negative: [true; 3], positive: [true; 3] };

    /// Decodes INS2 or INS3; bits 7 and 6 are ignored.
    pub const fn from_bits(bits: u8) -> Self {
        Self {
            negative: [bits & 1 << 5 != 0, bits & 1 << 3 != 0, bits & 1 << 1 != 0],
            positive: [bits & 1 << 4 != 0, bits & 1 << 2 != 0, bits & 1 << 0 != 0],
        }
    }

    /// As INC4 and INC5 have them.
    pub const fn bits(self) -> u8 {
        let [nx, ny, nz] = self.negative;
        let [px, py, pz] = self.positive;
        (nx as u8) << 5 | (px as u8) << 4 | (ny as u8) << 3 | (py as u8) << 2 | (nz as u8) << 1 | pz as u8
    }
}

/// What interrupts are pending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interrupts {
    /// Any.
    pub any: bool,
    /// The buffer is full.
    pub buffer_full: bool,
    /// The buffer's watermark is reached.
    pub watermark: bool,
    /// There is a new acceleration.
    pub acceleration_ready: bool,
    /// There is a new field.
    pub field_ready: bool,
    /// Free fall.
    pub free_fall: bool,
    /// The accelerometer saw motion: along which axes.
    pub acceleration_motion: Option<MotionAxes>,
    /// The magnetometer saw motion: along which axes.
    pub field_motion: Option<MotionAxes>,
}

impl Interrupts {
    /// Decodes INS1 to INS3.
    pub const fn from_bytes([first, second, third]: [u8; 3]) -> Self {
        const fn motion(is_set: bool, bits: u8) -> Option<MotionAxes> {
            if is_set { Some(MotionAxes::from_bits(bits)) } else { None }
        }
        Self {
            any: first & 1 << 7 != 0,
            buffer_full: first & 1 << 6 != 0,
            watermark: first & 1 << 5 != 0,
            acceleration_ready: first & 1 << 4 != 0,
            field_ready: first & 1 << 3 != 0,
            free_fall: first & 1 << 2 != 0,
            acceleration_motion: motion(first & 1 << 1 != 0, second),
            field_motion: motion(first & 1 << 0 != 0, third),
        }
    }
}
