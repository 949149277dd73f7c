//! Units and signs of an export's accelerations, and what else its metadata say.

use std::collections::BTreeMap;

use super::entry::Sensor;
use crate::error::FormatError;
use crate::recording::RecordingInfo;

/// What the app says of the recording and the device.
#[derive(Clone, Debug, Default)]
pub(super) struct Metadata(pub(super) BTreeMap<String, String>);

/// Which rows are the specific force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Force {
    /// `TotalAcceleration`.
    Total,
    /// `Accelerometer` and `Gravity`.
    UserAndGravity,
    /// `AccelerometerUncalibrated`.
    Uncalibrated,
    /// There is none.
    None,
}

/// How an export's accelerations become specific forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Convention {
    pub(super) force: Force,
    /// What to multiply by: the sign, and the unit in m/s².
    pub(super) factor: f64,
}

/// Standard gravity, the app's g, in m/s².
const STANDARD_GRAVITY_M_S2: f64 = 9.80665;

/// The first version of the app with the setting "Standardise Units & Frames".
const FIRST_STANDARDISED: (u32, u32) = (1, 29);

impl Metadata {
    fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(|text| text.trim()).filter(|text| !text.is_empty())
    }

    pub(super) fn info(&self) -> RecordingInfo {
        RecordingInfo {
            device: self.get("device name").unwrap_or_default().to_owned(),
            software: match self.get("appVersion") {
                Some(version) => format!("Sensor Logger {version}"),
                None => "Sensor Logger".to_owned(),
            },
            floor: String::new(),
            start_unix_ms: self.get("recording epoch time").and_then(|time| time.parse().ok()),
        }
    }

    /// Whether the phone was one of Apple's; nothing where it is not said.
    fn is_ios(&self) -> Option<bool> {
        match self.get("platform")?.to_ascii_lowercase().as_str() {
            "ios" | "ipados" => Some(true),
            "android" => Some(false),
            _ => None,
        }
    }

    /// Whether all phones' units and signs are Android's; nothing where it is not said.
    fn is_standardised(&self) -> Option<bool> {
        match self.get("standardisation") {
            Some("true") => Some(true),
            Some("false") => Some(false),
            Some(_) => None,
            None => (self.version()? < FIRST_STANDARDISED).then_some(false),
        }
    }

    fn version(&self) -> Option<(u32, u32)> {
        let mut numbers = self.get("appVersion")?.split('.');
        Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
    }
}

/// The convention of an export with such metadata and sensors.
///
/// # Errors
/// When there is an acceleration whose sign or unit cannot be known, or only one without gravity.
pub(super) fn of(
    metadata: &Metadata,
    is_present: impl Fn(Sensor) -> bool,
) -> Result<Convention, FormatError> {
    let has_total = is_present(Sensor::TotalAcceleration);
    let has_user = is_present(Sensor::Accelerometer);
    let has_uncalibrated = is_present(Sensor::AccelerometerUncalibrated);
    if !has_total && !has_user && !has_uncalibrated {
        return Ok(Convention { force: Force::None, factor: 1.0 });
    }
    // Only Android's app logs the total acceleration.
    let is_ios = metadata.is_ios().or(has_total.then_some(false)).ok_or_else(|| {
        unknown(
            "does not say whether it was recorded on Android or on iOS",
            "keep the app's Metadata with it, or add one with `platform`, android or ios",
        )
    })?;
    let is_standardised = if is_ios {
        metadata.is_standardised().ok_or_else(|| {
            unknown(
                "from iOS, does not say whether \"Standardise Units & Frames\" was on",
                "add `standardisation`, true or false, to its Metadata",
            )
        })?
    } else {
        true
    };
    let force = if has_total && !is_ios {
        Force::Total
    } else if has_user && is_present(Sensor::Gravity) {
        Force::UserAndGravity
    } else if has_uncalibrated {
        Force::Uncalibrated
    } else {
        return Err(FormatError::malformed(
            "the export has accelerations without gravity only",
            "record Gravity, or TotalAcceleration, as well",
        ));
    };
    let factor = match (is_standardised, force) {
        (true, _) => 1.0,
        (false, Force::Uncalibrated) => -STANDARD_GRAVITY_M_S2,
        (false, _) => -1.0,
    };
    Ok(Convention { force, factor })
}

fn unknown(what: &str, remedy: &'static str) -> FormatError {
    FormatError::malformed(format!("the export {what}, so the sign of its accelerations is unknown"), remedy)
}
