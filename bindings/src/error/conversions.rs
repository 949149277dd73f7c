//! Inner errors at the boundary: their kind and their remedy pass, their message does not.

use std::error::Error as _;
use std::io;

use fieldwalk::positioner::PositionError;
use fieldwalk::survey::SurveyError;
use fieldwalk_batch::BatchError;
use fieldwalk_formats::FormatError;

use super::{ApiError, api_error};

/// The remedy of `error`, or `otherwise` where it has none.
fn remedy_of(error: &FormatError, otherwise: &str) -> String {
    if error.remedy().is_empty() { otherwise.to_owned() } else { error.remedy().to_owned() }
}

impl ApiError {
    /// Why a recording could not be read.
    pub(crate) fn of_recording(error: &FormatError) -> Self {
        let remedy = |otherwise| remedy_of(error, otherwise);
        if error.is_not_found() {
            api_error!(RecordingNotFound, "the recording does not exist", remedy("check the path"))
        } else if error.is_io() {
            api_error!(
                RecordingUnreadable,
                "the operating system refused to read the recording",
                remedy("check that the app may read it")
            )
        } else if error.is_newer_version() {
            api_error!(RecordingTooNew, "the recording is of a newer version", remedy("update Fieldwalk"))
        } else if error.is_corrupt() {
            let explanation = "the recording has changed since it was written";
            api_error!(RecordingCorrupt, explanation, remedy("copy it again"))
        } else {
            let explanation = "not a recording, or one that cannot be used";
            api_error!(RecordingMalformed, explanation, remedy("give a recording of a walk"))
        }
    }

    /// Why a file could not be written.
    pub(crate) fn of_writing(error: &FormatError) -> Self {
        let cause = error.source().and_then(|cause| cause.downcast_ref::<io::Error>()).map(io::Error::kind);
        match cause {
            Some(io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded) => {
                api_error!(StorageFull, "there is no room left on the device", "free some space")
            }
            Some(io::ErrorKind::AlreadyExists) => api_error!(
                FileExists,
                "there is a file already",
                "give another name, or delete it first: nothing is replaced"
            ),
            _ => api_error!(
                FileUnwritable,
                "the operating system refused to write",
                remedy_of(error, "check that the folder exists and that the app may write there")
            ),
        }
    }

    /// Why a floor plan could not be read.
    pub(crate) fn of_plan(error: &FormatError) -> Self {
        let remedy = remedy_of(error, "give a GeoJSON plan with an outline");
        api_error!(PlanMalformed, "not a floor plan that can be used", remedy)
    }

    /// Why an advertisement gave nothing.
    pub(crate) fn of_advertisement(error: fieldwalk_codec::Error) -> Self {
        use fieldwalk_codec::Error;
        match error {
            Error::UnknownVersion(_) => {
                api_error!(AdvertisementTooNew, "a card of a newer version", "update Fieldwalk")
            }
            Error::Truncated { .. } | Error::Overrun { .. } | Error::WrongLength { .. } => api_error!(
                AdvertisementMalformed,
                "the advertisement is torn, or not as long as it says",
                "pass all of its bytes; one that stays so is to be ignored"
            ),
            _ => api_error!(
                AdvertisementForeign,
                "the advertisement is of another sender",
                "ignore it: most of those in the air are"
            ),
        }
    }
}

impl From<SurveyError> for ApiError {
    fn from(error: SurveyError) -> Self {
        match error {
            SurveyError::NoTrack { .. } => api_error!(
                SurveyIncomplete,
                "no walk has steps between two waypoints",
                "tap a waypoint at the start and at the end of every line, and walk between them"
            ),
            SurveyError::NoField => api_error!(
                SurveyIncomplete,
                "no walk holds magnetometer readings",
                "survey with a device that has a magnetometer, and push its samples"
            ),
            SurveyError::BadPlan => api_error!(
                PlanMalformed,
                "the plan has no extent in metres, or one beyond 10 km",
                "give its width and height in metres"
            ),
            SurveyError::TooManyNodes { .. } => api_error!(
                PlanMalformed,
                "the plan needs too large a map",
                "check that its units are metres, or divide it"
            ),
            _ => api_error!(SurveyIncomplete, "the survey gives no map", "survey again"),
        }
    }
}

impl From<FormatError> for ApiError {
    /// The message of a [`FormatError`] may name paths, floors and transmitters; only its kind and remedy pass.
    fn from(error: FormatError) -> Self {
        let remedy = |otherwise| remedy_of(&error, otherwise);
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
                "check that its point is in metres in the floor's frame, its radius from 0.1 to 1000 m, and the standard \
                 deviation of its direction from 0.01 to π rad"
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
