//! The one error of the boundary.

use fieldwalk::positioner::PositionError;
use fieldwalk_batch::BatchError;
use fieldwalk_formats::FormatError;

/// Why a call was refused; the object is unchanged then.
///
/// The case is a stable code: it keeps its name and meaning, and new ones may join it. The texts are for developers'
/// logs, in English; they name no position, path, transmitter or person, so that they may leave the device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, uniffi::Error)]
#[non_exhaustive]
pub enum ApiError {
    /// A file or folder of the map does not exist.
    #[error("{explanation} ({remedy})")]
    MapNotFound {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The operating system refused to read a file of the map.
    #[error("{explanation} ({remedy})")]
    MapUnreadable {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// A file is not a map.
    #[error("{explanation} ({remedy})")]
    MapMalformed {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// A file of the map has changed since it was written.
    #[error("{explanation} ({remedy})")]
    MapCorrupt {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The map was written by a newer version of Fieldwalk.
    #[error("{explanation} ({remedy})")]
    MapTooNew {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The building has no floor of that ordinal.
    #[error("{explanation} ({remedy})")]
    UnknownFloor {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// There is no system of that name.
    #[error("{explanation} ({remedy})")]
    UnknownSystem {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The hint is on another floor than the positioner's.
    #[error("{explanation} ({remedy})")]
    WrongFloor {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The hint's point or radius is not a place on the plan.
    #[error("{explanation} ({remedy})")]
    BadHint {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The time asked for is before the last consumed sample.
    #[error("{explanation} ({remedy})")]
    TimeInPast {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The bytes are no sample batch.
    #[error("{explanation} ({remedy})")]
    BatchMalformed {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The sample batch is shorter or longer than it says.
    #[error("{explanation} ({remedy})")]
    BatchTorn {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The sample batch was made by a newer version of Fieldwalk.
    #[error("{explanation} ({remedy})")]
    BatchTooNew {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The bytes are no snapshot, or not all of one.
    #[error("{explanation} ({remedy})")]
    SnapshotMalformed {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The snapshot is of another version of Fieldwalk, or of another system, seed or floor.
    #[error("{explanation} ({remedy})")]
    SnapshotForeign {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// An earlier call on this object failed in the middle: a fault of Fieldwalk itself.
    #[error("{explanation} ({remedy})")]
    Broken {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
}

/// Makes the named case of [`ApiError`].
macro_rules! api_error {
    ($case:ident, $explanation:expr, $remedy:expr) => {
        $crate::error::ApiError::$case { explanation: $explanation.into(), remedy: $remedy.into() }
    };
}
pub(crate) use api_error;

impl ApiError {
    /// The object's state is in doubt since a call on it failed in the middle.
    pub(crate) fn broken() -> Self {
        api_error!(
            Broken,
            "an earlier call on this object failed in the middle",
            "make a new one or restore a snapshot, and report this with the log"
        )
    }
}

impl From<FormatError> for ApiError {
    /// The message of a [`FormatError`] may name paths, floors and transmitters; only its kind and remedy pass.
    fn from(error: FormatError) -> Self {
        let remedy = |otherwise: &str| {
            if error.remedy().is_empty() { otherwise.to_owned() } else { error.remedy().to_owned() }
        };
        if error.is_not_found() {
            api_error!(MapNotFound, "a file or folder of the map does not exist", remedy("check the path"))
        } else if error.is_io() {
            api_error!(
                MapUnreadable,
                "the operating system refused to read the map",
                remedy("check that the app may read it")
            )
        } else if error.is_newer_version() {
            api_error!(MapTooNew, "the map is of a newer version", remedy("update Fieldwalk"))
        } else if error.is_corrupt() {
            api_error!(MapCorrupt, "the map has changed since it was written", remedy("copy it again"))
        } else {
            api_error!(MapMalformed, "not a map", remedy("give a map that Fieldwalk exported"))
        }
    }
}

impl From<PositionError> for ApiError {
    fn from(error: PositionError) -> Self {
        match error {
            PositionError::WrongFloor { .. } => api_error!(
                WrongFloor,
                "the hint is on another floor than this positioner",
                "make a positioner for the hint's floor"
            ),
            PositionError::BadHint => api_error!(
                BadHint,
                "the hint is not a place on this plan",
                "check that its point is in metres in the floor's frame, and its radius from 0.1 to 1000 m"
            ),
            PositionError::TimeInPast { .. } => api_error!(
                TimeInPast,
                "the time is before the last consumed sample",
                "ask for now or later, on the clock of the samples"
            ),
            PositionError::ForeignSnapshot => api_error!(
                SnapshotForeign,
                "the snapshot is of another system, seed or floor",
                "restore it into a positioner with those"
            ),
            // `NoFix` is no error at the boundary: a fix is absent.
            _ => ApiError::broken(),
        }
    }
}

impl From<BatchError> for ApiError {
    fn from(error: BatchError) -> Self {
        match error {
            BatchError::Torn => api_error!(
                BatchTorn,
                "the batch is not as long as its header says",
                "pass all of its bytes and no more"
            ),
            BatchError::NewerVersion { .. } => {
                api_error!(BatchTooNew, "the batch is of a newer version", "update Fieldwalk")
            }
            _ => api_error!(BatchMalformed, "not a sample batch", "make it with SampleBatch"),
        }
    }
}
