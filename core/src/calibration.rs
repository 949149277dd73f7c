//! Hard and soft iron of a magnetometer, found from a swing of the device, and jumps of a stream that is calibrated
//! elsewhere.
//!
//! A calibrated field is `matrix · (raw − offset)`: as strong in every direction. [`fit_ellipsoid`] finds both from
//! readings in many directions, [`MagnetometerCalibrator`] collects such readings from a stream in bounded memory,
//! and either says why a swing was not good enough. [`FieldJumpDetector`] tells when the operating system has
//! recalibrated, so that whoever learnt the old bias can learn anew.
//!
//! # Source
//! Kwak 2018, §3.2 asks for an ellipsoid fit on a simple swing gesture; the fit is ours.

mod calibrator;
mod coverage;
mod ellipsoid;
mod jump;

pub use calibrator::{CalibratorParams, MagnetometerCalibrator};
pub use ellipsoid::{EllipsoidParams, fit_ellipsoid};
pub use jump::{FieldJumpDetector, FieldJumpParams};

use core::fmt;

use serde::{Deserialize, Serialize};

/// What turns a raw field into one that is as strong in every direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MagnetometerCalibration {
    /// Hard iron, in µT, device frame: what the raw field is too much.
    pub offset_ut: [f64; 3],
    /// Soft iron undone: symmetric, rows first, without unit; its determinant is 1 when the strength was unknown.
    pub matrix: [[f64; 3]; 3],
    /// How good it is.
    pub quality: CalibrationQuality,
}

/// How good a calibration is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationQuality {
    /// Strength of the calibrated field, in µT: as given, or as found.
    pub strength_ut: f64,
    /// Root mean square of the calibrated strengths about that, in µT.
    pub residual_ut: f64,
    /// Share of the directions in which there were readings, 0 to 1.
    pub coverage: f64,
    /// Standard deviation of the worst-known direction of the offset, in µT.
    pub offset_sd_ut: f64,
    /// Longest over shortest axis of the ellipsoid, at least 1.
    pub axis_ratio: f64,
    /// Readings used.
    pub n_readings: usize,
}

/// Why a swing gave no calibration: swing again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum SwingAgain {
    /// Too few readings that differ.
    TooShort {
        /// Readings that there were.
        n_readings: usize,
        /// Readings that it takes.
        n_needed: usize,
    },
    /// Too little of the sphere was covered: the offset stays unknown along some direction.
    TooLittleCovered {
        /// Share of the directions with readings, 0 to 1.
        coverage: f64,
        /// Standard deviation of the worst-known direction of the offset, in µT; infinite where it is unknown.
        offset_sd_ut: f64,
    },
    /// The readings lie on no ellipsoid: iron or currents nearby, or the device was carried through the field.
    TooDisturbed {
        /// Root mean square of the calibrated strengths about their mean, in µT.
        residual_ut: f64,
    },
    /// The sensor was at the end of its range.
    Saturated {
        /// Readings at the end of the range.
        n_saturated: usize,
    },
}

impl MagnetometerCalibration {
    /// The calibrated field of a raw one, both in µT, device frame.
    pub fn apply(&self, raw_ut: [f32; 3]) -> [f32; 3] {
        let centred = [0, 1, 2].map(|c| f64::from(raw_ut[c]) - self.offset_ut[c]);
        self.matrix.map(|row| (row[0] * centred[0] + row[1] * centred[1] + row[2] * centred[2]) as f32)
    }
}

impl fmt::Display for SwingAgain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort { n_readings, n_needed } => {
                write!(
                    f,
                    "swing again: {n_readings} readings of {n_needed}; keep turning the device for longer"
                )
            }
            Self::TooLittleCovered { coverage, .. } => write!(
                f,
                "swing again: only {:.0} % of the directions were covered; turn the device about every axis",
                100.0 * coverage
            ),
            Self::TooDisturbed { residual_ut } => write!(
                f,
                "swing again: the field varied by {residual_ut:.1} µT; move away from steel and cables and keep to \
                 one place"
            ),
            Self::Saturated { n_saturated } => write!(
                f,
                "swing again: the sensor was at the end of its range {n_saturated} times; take magnets away"
            ),
        }
    }
}

impl core::error::Error for SwingAgain {}
