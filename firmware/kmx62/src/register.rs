//! The registers' addresses and bits.

/// A register that this driver uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Register {
    /// Identifies the part.
    WhoAmI = 0x00,
    /// What caused an interrupt; INS2 and INS3, which axis, follow.
    Ins1 = 0x01,
    /// Reading it releases latched interrupts.
    Inl = 0x05,
    /// First of the outputs: acceleration, field, temperature, low bytes first.
    AccelXL = 0x0A,
    /// First of the field's outputs.
    MagXL = 0x10,
    /// What drives pin GPIO1.
    Inc1 = 0x2A,
    /// Polarity and latching of the pins.
    Inc3 = 0x2C,
    /// Axes that may set off the acceleration's motion interrupt.
    Inc4 = 0x2D,
    /// Threshold of the motion engine; counter and control follow.
    AmiCntl1 = 0x2F,
    /// Control of the motion engine.
    AmiCntl3 = 0x31,
    /// Rates of both sensors.
    OdCntl = 0x38,
    /// Reset and self-test.
    Cntl1 = 0x39,
    /// Range, resolution, and which sensors are on.
    Cntl2 = 0x3A,
    /// 0x55, or 0xAA once after a command test.
    Cotr = 0x3C,
    /// Watermark; mode follows, and what goes in.
    BufCtrl1 = 0x77,
    /// Any write empties the buffer.
    BufClear = 0x7A,
    /// How full the buffer is, in three bytes.
    BufStatus1 = 0x7B,
    /// The buffer's oldest bytes.
    BufRead = 0x7E,
}

/// CNTL1: software reset.
pub(crate) const CNTL1_SRST: u8 = 1 << 7;
/// CNTL1: the next read of COTR gives 0xAA.
pub(crate) const CNTL1_COTC: u8 = 1 << 3;
/// CNTL2: temperature, magnetometer, accelerometer on.
pub(crate) const CNTL2_TEMP_EN: u8 = 1 << 6;
pub(crate) const CNTL2_MAG_EN: u8 = 1 << 1;
pub(crate) const CNTL2_ACCEL_EN: u8 = 1 << 0;
/// AMI_CNTL3: the motion engine on.
pub(crate) const AMI_EN: u8 = 1 << 7;
/// INC1: the motion engine drives GPIO1.
pub(crate) const INC1_AMI1: u8 = 1 << 1;
/// INC3: GPIO1 active high, push-pull, latched; GPIO2 as it is after a reset.
pub(crate) const INC3_ACTIVE_HIGH_LATCHED: u8 = 1 << 2;
/// BUF_CTRL_2: stream, in which the oldest make room.
pub(crate) const BUF_MODE_STREAM: u8 = 1 << 1;
/// BUF_CTRL_3: which axes go into the buffer.
pub(crate) const BUF_ACCELERATION: u8 = 0b0111_0000;
pub(crate) const BUF_FIELD: u8 = 0b0000_1110;
