//! What the sensors say: stamped samples, all in the device frame and in SI-based units.
//!
//! The device frame is Android's: x to the right of the screen, y to its top, z out of the screen.

use serde::{Deserialize, Serialize};

use crate::time::Timestamp;

/// One reading of one sensor at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// When the reading was taken, on the device's monotonic clock.
    pub time: Timestamp,
    /// What was read.
    pub reading: Reading,
}

/// The value of a [`Sample`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reading {
    /// Specific force in m/s², device frame: +9.81 on the axis that points up at rest.
    SpecificForce([f32; 3]),
    /// Angular rate in rad/s, device frame, right-handed.
    AngularRate([f32; 3]),
    /// Magnetic field in µT, device frame, with the operating system's hard-iron correction applied.
    MagneticField([f32; 3]),
    /// Magnetic field in µT, device frame, before correction, with the operating system's bias estimate.
    UncalibratedMagneticField {
        /// Field as the sensor gives it, in µT.
        field_ut: [f32; 3],
        /// The operating system's estimate of the hard-iron bias, in µT (`field_ut - bias_ut` is corrected).
        bias_ut: [f32; 3],
    },
    /// A radio transmitter heard: iBeacon, other BLE or WiFi.
    Radio(RadioSighting),
    /// Air pressure in hPa.
    Pressure {
        /// Static pressure in hPa, 300 to 1100.
        pressure_hpa: f32,
    },
    /// A card's advertisement as a receiver heard it. What the receivers say of its strength are [`Reading::Radio`], each
    /// under its own identity.
    CardFrame([u8; 31]),
}

/// One packet of one transmitter, or one row of a WiFi scan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadioSighting {
    /// Who sent it.
    pub transmitter: TransmitterId,
    /// Received signal strength in dBm, -120 to 20.
    pub rssi_dbm: f32,
}

/// The identity of a radio transmitter, by the most specific name that the platform reveals.
///
/// Android tells a BLE sender's address, so several beacons that share one UUID, major and minor stay apart;
/// iOS hides it and only the iBeacon triple remains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TransmitterId {
    /// A BLE device address, most significant byte first.
    BleAddress([u8; 6]),
    /// An iBeacon's triple, where the address is hidden.
    Ibeacon {
        /// Proximity UUID, in the order printed.
        uuid: [u8; 16],
        /// Major number.
        major: u16,
        /// Minor number.
        minor: u16,
    },
    /// A WiFi access point's BSSID, most significant byte first.
    WifiBssid([u8; 6]),
}

impl Sample {
    /// Whether every number of the reading is finite and within what the sensor's physics allows.
    ///
    /// The limits are generous (2 kN/kg, 200 rad/s, 10 mT): they catch broken drivers, not odd walks.
    pub fn is_plausible(&self) -> bool {
        fn within(v: &[f32; 3], limit: f32) -> bool {
            v.iter().all(|c| c.is_finite() && c.abs() <= limit)
        }
        match &self.reading {
            Reading::SpecificForce(f) => within(f, 2_000.0),
            Reading::AngularRate(w) => within(w, 200.0),
            Reading::MagneticField(b) => within(b, 10_000.0),
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                within(field_ut, 10_000.0) && within(bias_ut, 10_000.0)
            }
            Reading::Radio(r) => (-120.0..=20.0).contains(&r.rssi_dbm),
            Reading::Pressure { pressure_hpa } => (300.0..=1_100.0).contains(pressure_hpa),
            // The card's receiver judges the bytes, and counts them.
            Reading::CardFrame(_) => true,
        }
    }
}

impl Reading {
    /// The sensor's rank: ties in time are consumed in this order, so that interleaving cannot matter.
    pub(crate) fn rank(&self) -> u8 {
        match self {
            Reading::AngularRate(_) => 0,
            Reading::SpecificForce(_) => 1,
            Reading::UncalibratedMagneticField { .. } => 2,
            Reading::MagneticField(_) => 3,
            Reading::Pressure { .. } => 4,
            Reading::Radio(_) => 5,
            Reading::CardFrame(_) => 6,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(reading: Reading) -> Sample {
        Sample { time: Timestamp::from_millis(0), reading }
    }

    #[test]
    fn implausible_numbers_are_seen() {
        assert!(at(Reading::SpecificForce([0.0, 0.0, 9.81])).is_plausible());
        assert!(!at(Reading::SpecificForce([0.0, f32::NAN, 9.81])).is_plausible());
        assert!(!at(Reading::AngularRate([f32::INFINITY, 0.0, 0.0])).is_plausible());
        assert!(!at(Reading::MagneticField([2e4, 0.0, 0.0])).is_plausible());
        assert!(!at(Reading::Pressure { pressure_hpa: 0.0 }).is_plausible());
        let deaf = RadioSighting { transmitter: TransmitterId::WifiBssid([0; 6]), rssi_dbm: f32::NAN };
        assert!(!at(Reading::Radio(deaf)).is_plausible());
    }
}
