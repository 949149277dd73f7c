//! The public layout of Inria Tyrex' attitude benchmark: phones carried in known ways under motion capture.
//!
//! A folder holds `android/` and `ios/` with one folder of text logs a trial, and `qualisys/` with one capture a trial
//! under the same name, `PERSON_PHONE_(Dist|NoDist)_MOTION`. [`find_trials`] lists them; [`Trial::samples`] reads what
//! the phone said and [`Trial::truth`] where it was, both on the clock of the capture.
//!
//! Frames: the capture's earth frame has z up and y close to north (in the undisturbed trials of one person, the
//! magnetic field points 1° to 5° clockwise of it); its rigid body is the device frame of
//! [`fieldwalk::sensor`], on both phones.
//!
//! # Source
//! Michel, Genevès, Fourati and Layaïda, "On attitude estimation with smartphones", 2017, and its recordings.

mod log;
mod mat5;
mod trial;
mod truth;

pub use log::{LogKind, Platform, SensorLogReader, specific_force_of_ios};
pub use trial::{Motion, Trial, TrialSamples, Trials, find_trials};
pub use truth::{Pose, Truth};
