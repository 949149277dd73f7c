//! How a card's sensor is as noisy as it is frugal.

use fieldwalk_kmx62::{Rate, Resolution, Sensor};

/// Conversions a second of the magnetometer and the accelerometer while they are on, in Hz.
///
/// # Source
/// The part's debug rates (fieldwalk-kmx62): that they are the rates of conversion is a guess.
const FIELD_CONVERSIONS_HZ: f64 = 12_800.0;
const ACCELERATION_CONVERSIONS_HZ: f64 = 25_600.0;

/// What a reading's noise consists of: a part that no averaging lessens, and one that it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorNoise {
    /// Standard deviation that stays, in the sensor's unit.
    pub floor_sd: f64,
    /// Standard deviation of one conversion, in the sensor's unit.
    pub conversion_sd: f64,
}

impl SensorNoise {
    /// Standard deviation of a reading that averages `n` conversions.
    pub fn sd(&self, n: f64) -> f64 {
        (self.floor_sd * self.floor_sd + self.conversion_sd * self.conversion_sd / n).sqrt()
    }
}

/// A KMX62's noise.
///
/// The maker's figures could not be had; of the magnetometer 0.3 µT at full resolution is remembered. How much of that is
/// white decides what resolution costs, so there are three: [`CardNoise::LOW`], [`CardNoise::MIDDLE`], [`CardNoise::HIGH`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardNoise {
    /// The magnetometer, in µT.
    pub field: SensorNoise,
    /// The accelerometer, in m/s².
    pub acceleration: SensorNoise,
}

impl CardNoise {
    /// Hardly anything is white.
    pub const LOW: Self = Self::of(0.3, 0.6);
    /// A conversion errs by 2 µT, as magnetometers of phones do that convert once.
    pub const MIDDLE: Self = Self::of(0.3, 2.0);
    /// All of 0.3 µT is white, over as many conversions as fit into 320 ms: the worst that agrees with it.
    pub const HIGH: Self = Self::of(0.0, 19.2);

    const fn of(floor_ut: f64, conversion_ut: f64) -> Self {
        Self {
            field: SensorNoise { floor_sd: floor_ut, conversion_sd: conversion_ut },
            // 0.75 mg at full resolution, as remembered, and as much of it white.
            acceleration: SensorNoise { floor_sd: 0.005, conversion_sd: 0.05 },
        }
    }

    /// Standard deviations of a reading of the field, in µT, and of the acceleration, in m/s².
    pub fn sd(&self, resolution: Resolution, [field_rate, acceleration_rate]: [Rate; 2]) -> [f64; 2] {
        [
            self.field.sd(conversions(resolution, field_rate, Sensor::Magnetometer)),
            self.acceleration.sd(conversions(resolution, acceleration_rate, Sensor::Accelerometer)),
        ]
    }
}

/// Conversions that a reading of `sensor` averages: at full resolution as many as fit into a period.
pub fn conversions(resolution: Resolution, rate: Rate, sensor: Sensor) -> f64 {
    resolution.n_averaged(sensor).map_or(conversions_hz(sensor) / rate.hz(), f64::from)
}

/// Conversions a second of `sensor` while it is on, in Hz.
pub fn conversions_hz(sensor: Sensor) -> f64 {
    match sensor {
        Sensor::Accelerometer => ACCELERATION_CONVERSIONS_HZ,
        Sensor::Magnetometer => FIELD_CONVERSIONS_HZ,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_by_hand() {
        let [field_ut, acceleration_m_s2] =
            CardNoise::MIDDLE.sd(Resolution::Averages32And16, [Rate::Hz12_5; 2]);
        // √(0.3² + 2²/16) and √(0.005² + 0.05²/32)
        assert!((field_ut - 0.583).abs() < 1e-3 && (acceleration_m_s2 - 0.010_155).abs() < 1e-5);
        assert_eq!(conversions(Resolution::Maximum, Rate::Hz12_5, Sensor::Magnetometer), 1_024.0);
        let [worst_ut, _] = CardNoise::HIGH.sd(Resolution::Maximum, [Rate::Hz3_125; 2]);
        assert!((worst_ut - 0.3).abs() < 1e-9);
    }
}
