//! How the part is set.

use crate::interrupt::MotionAxes;
use crate::register::{CNTL2_ACCEL_EN, CNTL2_MAG_EN, CNTL2_TEMP_EN};
use crate::sample::AccelerationRange;

/// Which of the two sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// The accelerometer.
    Accelerometer,
    /// The magnetometer.
    Magnetometer,
}

/// Readings a second, by the part's own clock, whose tolerance is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Rate {
    /// 0.781 Hz.
    Hz0_781 = 8,
    /// 1.563 Hz.
    Hz1_563 = 9,
    /// 3.125 Hz.
    Hz3_125 = 10,
    /// 6.25 Hz.
    Hz6_25 = 11,
    /// 12.5 Hz.
    #[default]
    Hz12_5 = 0,
    /// 25 Hz.
    Hz25 = 1,
    /// 50 Hz.
    Hz50 = 2,
    /// 100 Hz.
    Hz100 = 3,
    /// 200 Hz.
    Hz200 = 4,
    /// 400 Hz.
    Hz400 = 5,
    /// 800 Hz.
    Hz800 = 6,
    /// 1600 Hz.
    Hz1600 = 7,
}

impl Rate {
    /// In Hz.
    pub const fn hz(self) -> f64 {
        let code = self as u8;
        if code < 8 { 12.5 * (1 << code) as f64 } else { 0.781_25 * (1 << (code - 8)) as f64 }
    }
}

/// How many conversions a reading averages: one field of the part, for both sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Resolution {
    /// 4 conversions of the acceleration, 2 of the field: least current, most noise.
    Averages4And2 = 0,
    /// 32 and 16.
    #[default]
    Averages32And16 = 1,
    /// As many as fit between two readings: the sensors never pause.
    Maximum = 3,
}

impl Resolution {
    /// All, from the most frugal.
    pub const ALL: [Self; 3] = [Self::Averages4And2, Self::Averages32And16, Self::Maximum];

    /// Conversions that a reading of `sensor` averages; nothing for as many as fit.
    pub const fn n_averaged(self, sensor: Sensor) -> Option<u16> {
        match (self, sensor) {
            (Self::Averages4And2, Sensor::Accelerometer) => Some(4),
            (Self::Averages4And2, Sensor::Magnetometer) => Some(2),
            (Self::Averages32And16, Sensor::Accelerometer) => Some(32),
            (Self::Averages32And16, Sensor::Magnetometer) => Some(16),
            (Self::Maximum, _) => None,
        }
    }
}

/// How both sensors read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Readings of the acceleration a second.
    pub acceleration_rate: Rate,
    /// Readings of the field a second. If both go into the buffer, only equal rates are known to interleave.
    pub field_rate: Rate,
    /// Largest acceleration.
    pub range: AccelerationRange,
    /// Averaging.
    pub resolution: Resolution,
    /// Whether the temperature is read with the field.
    pub reads_temperature: bool,
}

impl Default for Config {
    /// Both at 12.5 Hz, ±4 g, the middle resolution, no temperature.
    fn default() -> Self {
        Self {
            acceleration_rate: Rate::Hz12_5,
            field_rate: Rate::Hz12_5,
            range: AccelerationRange::G4,
            resolution: Resolution::Averages32And16,
            reads_temperature: false,
        }
    }
}

impl Config {
    pub(crate) const fn odcntl(&self) -> u8 {
        (self.field_rate as u8) << 4 | self.acceleration_rate as u8
    }

    pub(crate) const fn cntl2(&self) -> u8 {
        let temperature = if self.reads_temperature { CNTL2_TEMP_EN } else { 0 };
        temperature | self.standby() | CNTL2_MAG_EN | CNTL2_ACCEL_EN
    }

    /// Range and resolution alone.
    pub(crate) const fn standby(&self) -> u8 {
        (self.range as u8) << 4 | (self.resolution as u8) << 2
    }
}

/// How often the motion engine looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum WakeUpRate {
    /// 0.781 Hz.
    Hz0_781 = 0,
    /// 1.563 Hz.
    Hz1_563 = 1,
    /// 3.125 Hz.
    #[default]
    Hz3_125 = 2,
    /// 6.25 Hz.
    Hz6_25 = 3,
    /// 12.5 Hz.
    Hz12_5 = 4,
    /// 25 Hz.
    Hz25 = 5,
    /// 50 Hz.
    Hz50 = 6,
    /// 100 Hz.
    Hz100 = 7,
}

impl WakeUpRate {
    /// In Hz.
    pub const fn hz(self) -> f64 {
        0.781_25 * (1 << self as u8) as f64
    }

    /// The accelerometer's own rate, which must not be lower.
    pub(crate) const fn acceleration_rate(self) -> Rate {
        match self {
            Self::Hz0_781 => Rate::Hz0_781,
            Self::Hz1_563 => Rate::Hz1_563,
            Self::Hz3_125 => Rate::Hz3_125,
            Self::Hz6_25 => Rate::Hz6_25,
            Self::Hz12_5 => Rate::Hz12_5,
            Self::Hz25 => Rate::Hz25,
            Self::Hz50 => Rate::Hz50,
            Self::Hz100 => Rate::Hz100,
        }
    }
}

/// What wakes a host up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WakeUp {
    /// How often the engine looks.
    pub rate: WakeUpRate,
    /// Threshold in the engine's steps, of a fixed range of 4 g: 16 or 31 mg each, which has to be measured.
    pub threshold: u8,
    /// Looks in a row that must exceed it.
    pub n_looks: u8,
    /// Along which axes.
    pub axes: MotionAxes,
}

impl Default for WakeUp {
    /// As the maker's example: 3 steps; but at 3.125 Hz and at the first look, so that a card wakes within 0.4 s.
    fn default() -> Self {
        Self { rate: WakeUpRate::Hz3_125, threshold: 3, n_looks: 1, axes: MotionAxes::ALL }
    }
}
