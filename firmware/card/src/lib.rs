//! What an ID card does, without the chip that it does it on.
//!
//! Once a second a card takes what its sensor has buffered, makes a round of it and advertises a frame:
//!
//! ```text
//! sensor's buffer ─▶ calibration ─▶ RoundBuilder ─▶ CardRound ─▶ 31 bytes ─▶ advertiser
//! 25 forces/s,       hard, soft     gravity, B_h,   fieldwalk-   three channels
//! 3 fields/s         iron           B_v, |acc|      codec
//! ```
//!
//! [`RoundBuilder`] is the arithmetic, which the simulator and a phone read as a card use too: the same bits on every
//! machine. [`Card`] is the application: generic over [`Hardware`], it runs on the chip, in an emulator and on a host.
//! It holds a swing's calibration in flash, sleeps when it lies still, tells of its battery, feeds a watchdog and keeps
//! the numbers of its rounds apart over resets.
//!
//! All arithmetic of a round is in `f32`, which the Cortex-M4 has in hardware; only the fit of a swing, which a card
//! does a few times in its life, is in `f64`.
//!
//! # Source
//! Kwak 2018, §4. What the paper leaves open is ours and stands where it is decided.

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod level;
mod round;

#[cfg(feature = "application")]
mod application;
#[cfg(feature = "application")]
mod battery;
#[cfg(feature = "application")]
mod calibration;
#[cfg(feature = "application")]
mod ellipsoid;
#[cfg(feature = "application")]
mod hardware;
#[cfg(feature = "application")]
mod pace;
#[cfg(feature = "application")]
pub mod replay;
#[cfg(feature = "application")]
mod sequence;
#[cfg(feature = "application")]
mod stillness;
#[cfg(feature = "application")]
mod store;
#[cfg(feature = "application")]
mod swing;

pub use level::{LevelReading, low_pass_factor};
pub use round::RoundBuilder;

#[cfg(feature = "application")]
pub use application::{Card, CardParams, RoundOutcome};
#[cfg(feature = "application")]
pub use battery::{BatteryMonitor, Charge};
#[cfg(feature = "application")]
pub use calibration::Calibration;
#[cfg(feature = "application")]
pub use ellipsoid::{SwingRejection, fit};
#[cfg(feature = "application")]
pub use hardware::{Advertiser, Board, Clock, Hardware, MotionSensor, Retained, Supply, Watchdog};
#[cfg(feature = "application")]
pub use pace::{LOOKS, MAX_DELAY_US, Pace, ROUND_US};
#[cfg(feature = "application")]
pub use sequence::{DISCONTINUITY, SequenceCounter};
#[cfg(feature = "application")]
pub use stillness::StillnessDetector;
#[cfg(feature = "application")]
pub use store::{CalibrationStore, StoreError};
#[cfg(feature = "application")]
pub use swing::{SwingCollector, SwingWatch};
