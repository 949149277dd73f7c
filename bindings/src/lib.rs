//! Fieldwalk for Kotlin, Swift and Python: maps, positioners and fixes over UniFFI.
//!
//! This crate mirrors the core's types and adds no algorithm. A mirror takes the core's type apart field by field, so
//! that a new field of the core fails to compile here until somebody decides what becomes of it.
//!
//! # Threads
//!
//! Every object may be used from any thread. A call is synchronous, runs on the caller's thread and returns its
//! result; nothing is called back, no thread is started. An object does one call at a time: a second one waits. Samples
//! of one wearer should come from one thread, for two threads that push at once leave their order open: what then comes
//! more than 200 ms late is refused and counted, and a thread that is more than a minute behind the other passes for a clock
//! that was set back, as one whose samples lie seconds after all others does for one that was set forward. After a panic inside a call, later calls on the object give [`ApiError::Broken`].
//!
//! # Bits
//!
//! The same map, system, seed and samples give the same fixes to the bit, in every language and on every machine,
//! however the samples are spread over batches.
//!
//! # Unsafe code
//!
//! There is none here but for the module `sensor_loop` of the feature `jni`, and the compiler refuses it; what else crosses
//! the boundary unsafely is inside `uniffi` and what its macros expand to.
#![deny(missing_docs)]

mod building_map;
mod calibrator;
mod card;
mod carrying;
mod error;
mod fix;
mod floor_drawing;
mod heard_transmitters;
mod missing;
mod positioner;
mod recorder;
mod recording_reader;
mod samples;
#[cfg(feature = "jni")]
mod sensor_loop;
mod snapshot;
mod status;
mod survey_status;
mod surveyed_floor;
mod surveyor;

pub use building_map::{BuildingMap, FloorInfo};
pub use calibrator::{
    CalibrationQuality, MagnetometerCalibration, MagnetometerCalibrator, SwingFault, SwingVerdict, Vector3,
};
pub use card::{CardDecoder, CardRound, Ibeacon, decode_ibeacon, decode_ibeacon_manufacturer_data};
pub use carrying::{CarryFault, CarryWarning};
pub use error::ApiError;
pub use fix::{Attitude, CarryMode, Fix, FixMode, HintedDirection, LatitudeLongitude, Point2, PositionHint};
pub use floor_drawing::{DrawnUnit, FloorDrawing};
pub use missing::{Missing, MissingInput};
pub use positioner::{Positioner, PositionerOptions};
pub use recorder::{Recorder, RecorderStatus, RecordingDetails, Waypoint};
pub use recording_reader::{RecordingLosses, RecordingPart, RecordingReader};
pub use status::{BatchFaults, Rejections, Status};
pub use survey_status::{SurveyStatus, WalkRefusal, WalkReport};
pub use surveyed_floor::{CoverageTotals, ExpectedAccuracy, ScoredPlace, SurveyedFloor};
pub use surveyor::{SurveyCoverage, Surveyor};

#[cfg(feature = "unwinder")]
extern crate unwinding as _;

uniffi::setup_scaffolding!();

/// The version of this library, such as `0.1.0`.
#[uniffi::export]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// The names of all systems that a positioner can run, such as `fused`.
#[uniffi::export]
pub fn systems() -> Vec<String> {
    fieldwalk::system::Recipe::NAMES.iter().map(|&name| name.to_owned()).collect()
}
