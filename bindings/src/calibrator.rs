//! The magnetometer calibrated by a swing of the device.

use std::sync::{Arc, Mutex};

use fieldwalk::calibration::{self as core, CalibratorParams};
use fieldwalk_batch::SampleBatch;

use crate::error::{ApiError, locked};
use crate::samples::take_each;
use crate::status::BatchFaults;

/// Three numbers along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Vector3 {
    /// Along x: to the right of the screen in the device frame.
    pub x: f64,
    /// Along y: to the top of the screen in the device frame.
    pub y: f64,
    /// Along z: out of the screen in the device frame.
    pub z: f64,
}

/// What turns a raw field into one that is as strong in every direction: `matrix · (raw - offset)`.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct MagnetometerCalibration {
    /// Hard iron, in µT, device frame: what the raw field is too much.
    pub offset_ut: Vector3,
    /// The first row of the symmetric matrix that undoes soft iron, without unit.
    pub matrix_row_x: Vector3,
    /// The second row.
    pub matrix_row_y: Vector3,
    /// The third row.
    pub matrix_row_z: Vector3,
    /// How good it is.
    pub quality: CalibrationQuality,
}

/// How good a calibration is.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct CalibrationQuality {
    /// Strength of the calibrated field, in µT.
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
    pub n_readings: u32,
}

/// What a swing has given so far.
#[derive(Clone, Debug, PartialEq, uniffi::Enum)]
pub enum SwingVerdict {
    /// It was good enough.
    Calibrated {
        /// The calibration.
        calibration: MagnetometerCalibration,
    },
    /// It was not, or not yet.
    SwingAgain {
        /// Why.
        fault: SwingFault,
        /// What to tell the user, in English.
        remedy: String,
    },
}

/// Why a swing gives no calibration; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
#[non_exhaustive]
pub enum SwingFault {
    /// Too few readings that differ.
    TooShort,
    /// Too few directions.
    TooLittleCovered,
    /// Iron or currents nearby, or the device was carried through the field.
    TooDisturbed,
    /// The sensor was at the end of its range.
    Saturated,
    /// Something that this boundary has no name for yet.
    Other,
}

/// Finds hard and soft iron of a magnetometer while the device is turned about every axis in one place.
#[derive(Debug, uniffi::Object)]
pub struct MagnetometerCalibrator {
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    calibrator: core::MagnetometerCalibrator,
    batch_faults: BatchFaults,
}

#[uniffi::export]
impl MagnetometerCalibrator {
    /// A calibrator that has seen nothing.
    #[uniffi::constructor]
    pub fn new() -> Arc<Self> {
        let calibrator = core::MagnetometerCalibrator::new(CalibratorParams::default());
        Arc::new(Self { state: Mutex::new(State { calibrator, batch_faults: BatchFaults::default() }) })
    }

    /// Takes a batch in: of its samples, uncalibrated (or else calibrated) fields and angular rates count. Memory stays
    /// bounded however long the swing is.
    ///
    /// # Errors
    /// When `batch` is no sample batch, is torn or is too new; nothing of it is taken in then.
    pub fn push_samples(&self, batch: &[u8]) -> Result<(), ApiError> {
        let batch = SampleBatch::new(batch)?;
        let mut state = locked(&self.state)?;
        let State { calibrator, batch_faults } = &mut *state;
        take_each(&batch, batch_faults, |sample| {
            calibrator.push(&sample);
            Ok(())
        })
    }

    /// What the swing has given so far; it may be asked after every batch, and the swing go on.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn verdict(&self) -> Result<SwingVerdict, ApiError> {
        Ok(match locked(&self.state)?.calibrator.calibration() {
            Ok(calibration) => SwingVerdict::Calibrated { calibration: calibration.into() },
            Err(again) => SwingVerdict::SwingAgain { fault: again.into(), remedy: again.to_string() },
        })
    }

    /// Readings kept so far: they grow only while the device points where it has not pointed yet.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn n_readings(&self) -> Result<u32, ApiError> {
        Ok(locked(&self.state)?.calibrator.n_readings() as u32)
    }

    /// Records of batches that gave no sample, by cause.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn batch_faults(&self) -> Result<BatchFaults, ApiError> {
        Ok(locked(&self.state)?.batch_faults)
    }
}

impl From<[f64; 3]> for Vector3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<core::MagnetometerCalibration> for MagnetometerCalibration {
    fn from(calibration: core::MagnetometerCalibration) -> Self {
        let core::MagnetometerCalibration { offset_ut, matrix: [x, y, z], quality } = calibration;
        let core::CalibrationQuality {
            strength_ut,
            residual_ut,
            coverage,
            offset_sd_ut,
            axis_ratio,
            n_readings,
        } = quality;
        Self {
            offset_ut: offset_ut.into(),
            matrix_row_x: x.into(),
            matrix_row_y: y.into(),
            matrix_row_z: z.into(),
            quality: CalibrationQuality {
                strength_ut,
                residual_ut,
                coverage,
                offset_sd_ut,
                axis_ratio,
                n_readings: n_readings as u32,
            },
        }
    }
}

impl From<core::SwingAgain> for SwingFault {
    fn from(again: core::SwingAgain) -> Self {
        match again {
            core::SwingAgain::TooShort { .. } => Self::TooShort,
            core::SwingAgain::TooLittleCovered { .. } => Self::TooLittleCovered,
            core::SwingAgain::TooDisturbed { .. } => Self::TooDisturbed,
            core::SwingAgain::Saturated { .. } => Self::Saturated,
            _ => Self::Other,
        }
    }
}
