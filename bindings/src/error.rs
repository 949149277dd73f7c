//! The one error of the boundary.

mod conversions;

use std::sync::{Mutex, MutexGuard};

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
    /// The hint's point or radius is not a place on the plan, or its direction is none.
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
    /// The recording does not exist.
    #[error("{explanation} ({remedy})")]
    RecordingNotFound {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The operating system refused to read the recording.
    #[error("{explanation} ({remedy})")]
    RecordingUnreadable {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// A file is not a recording, or holds what cannot be used.
    #[error("{explanation} ({remedy})")]
    RecordingMalformed {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The recording has changed since it was written, so that its rest cannot be found.
    #[error("{explanation} ({remedy})")]
    RecordingCorrupt {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The recording was written by a newer version of Fieldwalk.
    #[error("{explanation} ({remedy})")]
    RecordingTooNew {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// There is a file already where a new one was to be written.
    #[error("{explanation} ({remedy})")]
    FileExists {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The operating system refused to write.
    #[error("{explanation} ({remedy})")]
    FileUnwritable {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// There is no room left on the device.
    #[error("{explanation} ({remedy})")]
    StorageFull {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The floor plan cannot be read, or no map can be made of it.
    #[error("{explanation} ({remedy})")]
    PlanMalformed {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The waypoint is not a place on the plan, or not after the last one.
    #[error("{explanation} ({remedy})")]
    BadWaypoint {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The call does not fit what went before, such as samples without a walk.
    #[error("{explanation} ({remedy})")]
    OutOfTurn {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The recording has been finished; nothing can be added to it.
    #[error("{explanation} ({remedy})")]
    Finished {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// What was walked so far gives no map.
    #[error("{explanation} ({remedy})")]
    SurveyIncomplete {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The advertisement is of some other sender: most of those in the air are.
    #[error("{explanation} ({remedy})")]
    AdvertisementForeign {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The advertisement is torn or contradicts itself.
    #[error("{explanation} ({remedy})")]
    AdvertisementMalformed {
        /// What is wrong.
        explanation: String,
        /// What to do about it.
        remedy: String,
    },
    /// The advertisement is of a card that a newer version of Fieldwalk reads.
    #[error("{explanation} ({remedy})")]
    AdvertisementTooNew {
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

/// The state behind `mutex`, for one call.
///
/// # Errors
/// [`ApiError::Broken`] when a call has panicked while it had the state.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> Result<MutexGuard<'_, T>, ApiError> {
    mutex.lock().map_err(|_poisoned| ApiError::broken())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn state_that_a_panic_left_in_doubt_is_an_error_and_no_other_panic() {
        let state = Mutex::new(1);
        assert_eq!(locked(&state).map(|state| *state), Ok(1));
        let panicked = std::thread::scope(|scope| {
            let in_the_middle = scope.spawn(|| {
                let _state = locked(&state);
                panic!("in the middle of a call");
            });
            in_the_middle.join().is_err()
        });
        assert!(panicked);
        assert_eq!(locked(&state).map(|state| *state), Err(ApiError::broken()));
    }
}
