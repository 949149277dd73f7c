//! One row of an export: a sensor's reading, field by field.

use fieldwalk::time::{Duration, Timestamp};

use crate::ilc::LineFault;

/// A sensor that positioning uses, by its name in the app.
///
/// In the order in which rows of one instant are taken: what others are paired with comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sensor {
    Gyroscope,
    Gravity,
    Accelerometer,
    TotalAcceleration,
    AccelerometerUncalibrated,
    Magnetometer,
    MagnetometerUncalibrated,
    Barometer,
    Bluetooth,
    Wifi,
    Annotation,
}

impl Sensor {
    pub(super) const ALL: [Self; 11] = [
        Self::Gyroscope,
        Self::Gravity,
        Self::Accelerometer,
        Self::TotalAcceleration,
        Self::AccelerometerUncalibrated,
        Self::Magnetometer,
        Self::MagnetometerUncalibrated,
        Self::Barometer,
        Self::Bluetooth,
        Self::Wifi,
        Self::Annotation,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Gyroscope => "Gyroscope",
            Self::Gravity => "Gravity",
            Self::Accelerometer => "Accelerometer",
            Self::TotalAcceleration => "TotalAcceleration",
            Self::AccelerometerUncalibrated => "AccelerometerUncalibrated",
            Self::Magnetometer => "Magnetometer",
            Self::MagnetometerUncalibrated => "MagnetometerUncalibrated",
            Self::Barometer => "Barometer",
            Self::Bluetooth => "Bluetooth",
            Self::Wifi => "WiFi",
            Self::Annotation => "Annotation",
        }
    }

    /// The sensor of that name in either case; older versions call Bluetooth `bluetooth-` and an address.
    pub(super) fn named(name: &str) -> Option<Self> {
        let is_bluetooth = name.get(..10).is_some_and(|head| head.eq_ignore_ascii_case("bluetooth-"));
        if is_bluetooth {
            return Some(Self::Bluetooth);
        }
        Self::ALL.into_iter().find(|sensor| sensor.name().eq_ignore_ascii_case(name))
    }
}

/// A row of a sensor: what it holds of the fields that positioning reads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) sensor: Sensor,
    pub(super) time: Timestamp,
    pub(super) axes: [f64; 3],
    /// The pressure, or the received power.
    pub(super) value: f64,
    /// The transmitter's address.
    pub(super) address: String,
    /// What a Bluetooth device says of its maker, hexadecimal.
    pub(super) payload: String,
    /// What was written down.
    pub(super) text: String,
}

/// A row while its fields come in.
#[derive(Debug, Default)]
pub(super) struct Fields {
    time: Option<Result<Timestamp, LineFault>>,
    axes: [Option<Result<f64, LineFault>>; 3],
    value: Option<Result<f64, LineFault>>,
    address: String,
    payload: String,
    text: String,
}

impl Fields {
    /// Takes in the field called `name`; empty ones and `null` do not count.
    pub(super) fn set(&mut self, name: &str, field: &str) {
        let field = field.trim();
        if field.is_empty() || field == "null" {
            return;
        }
        match name {
            "time" => self.time = Some(time(field)),
            "x" => self.axes[0] = Some(number(field)),
            "y" => self.axes[1] = Some(number(field)),
            "z" => self.axes[2] = Some(number(field)),
            "pressure" | "rssi" | "level" => self.value = Some(number(field)),
            "id" | "bssid" => field.clone_into(&mut self.address),
            "manufacturerData" => field.clone_into(&mut self.payload),
            "text" => field.clone_into(&mut self.text),
            _ => {}
        }
    }

    /// The row as one of `sensor`.
    pub(super) fn entry(self, sensor: Sensor) -> Result<Entry, LineFault> {
        let time = self.time.unwrap_or(Err(LineFault::FieldCount))?;
        let missing = || Err(LineFault::FieldCount);
        let (mut axes, mut value) = ([0.0; 3], 0.0);
        match sensor {
            Sensor::Barometer | Sensor::Bluetooth | Sensor::Wifi => {
                value = self.value.unwrap_or_else(missing)?;
            }
            Sensor::Annotation => {}
            _ => {
                for (axis, field) in axes.iter_mut().zip(self.axes) {
                    *axis = field.unwrap_or_else(missing)?;
                }
            }
        }
        let Self { address, payload, text, .. } = self;
        Ok(Entry { sensor, time, axes, value, address, payload, text })
    }
}

/// Nanoseconds since 1970, of this century.
fn time(field: &str) -> Result<Timestamp, LineFault> {
    let nanos: i64 = field.parse().map_err(|_| LineFault::Time)?;
    if nanos < 946_684_800_000_000_000 {
        return Err(LineFault::Time);
    }
    Ok(Timestamp::from_nanos(0) + Duration::from_nanos(nanos))
}

fn number(field: &str) -> Result<f64, LineFault> {
    let number: f64 = field.parse().map_err(|_| LineFault::Number)?;
    if number.is_finite() { Ok(number) } else { Err(LineFault::NotFinite) }
}
