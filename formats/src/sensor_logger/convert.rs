//! Rows become records.

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::{Duration, Timestamp};

use super::convention::{Convention, Force};
use super::entry::{Entry, Sensor};
use crate::ilc::LineFault;
use crate::recording::Record;
use crate::transmitter_id::{parse_address, parse_uuid};

/// A row of gravity counts for accelerations up to this much later.
const MAX_GRAVITY_AGE: Duration = Duration::from_millis(20);

/// How an iBeacon's manufacturer data begin: Apple's number, the kind, the length.
const IBEACON_PREFIX: &str = "4c000215";

/// A place in metres beyond this is no place.
const MAX_PLACE_M: f64 = 100_000.0;

/// What a row becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Converted {
    Record(Record),
    /// It serves another row, or nothing.
    Nothing,
    Rejected(LineFault),
}

/// Turns rows, in order of time, into records.
#[derive(Debug)]
pub(super) struct Converter {
    convention: Convention,
    has_magnetometer: bool,
    gravity: Option<(Timestamp, [f64; 3])>,
}

impl Converter {
    pub(super) fn new(convention: Convention, has_magnetometer: bool) -> Self {
        Self { convention, has_magnetometer, gravity: None }
    }

    pub(super) fn convert(&mut self, entry: &Entry) -> Converted {
        let Convention { force, factor } = self.convention;
        let Entry { time, axes, .. } = *entry;
        let scaled = || Reading::SpecificForce(axes.map(|axis| (factor * axis) as f32));
        let reading = match entry.sensor {
            Sensor::Gyroscope => Ok(Reading::AngularRate(axes.map(|axis| axis as f32))),
            Sensor::Gravity => {
                self.gravity = Some((time, axes));
                return Converted::Nothing;
            }
            Sensor::Accelerometer if force == Force::UserAndGravity => self.total(time, axes),
            Sensor::TotalAcceleration if force == Force::Total => Ok(scaled()),
            Sensor::AccelerometerUncalibrated if force == Force::Uncalibrated => Ok(scaled()),
            Sensor::Accelerometer | Sensor::TotalAcceleration | Sensor::AccelerometerUncalibrated => {
                return Converted::Nothing;
            }
            // What iOS gives while it has not calibrated: nowhere is the field zero.
            Sensor::Magnetometer if axes == [0.0; 3] => Err(LineFault::OutOfRange),
            Sensor::Magnetometer => Ok(Reading::MagneticField(axes.map(|axis| axis as f32))),
            Sensor::MagnetometerUncalibrated if self.has_magnetometer => return Converted::Nothing,
            Sensor::MagnetometerUncalibrated => Err(LineFault::Unpaired),
            Sensor::Barometer => Ok(Reading::Pressure { pressure_hpa: entry.value as f32 }),
            Sensor::Bluetooth => bluetooth(entry).map(Reading::Radio),
            Sensor::Wifi => match parse_address(entry.address.as_bytes()) {
                Some(bssid) => Ok(Reading::Radio(RadioSighting {
                    transmitter: TransmitterId::WifiBssid(bssid),
                    rssi_dbm: entry.value as f32,
                })),
                None => Err(LineFault::Identity),
            },
            Sensor::Annotation => {
                return match place(&entry.text) {
                    Ok(Some(point)) => Converted::Record(Record::Waypoint { time, point }),
                    Ok(None) => Converted::Nothing,
                    Err(fault) => Converted::Rejected(fault),
                };
            }
        };
        match reading {
            Ok(reading) => Converted::Record(Record::Sample(Sample { time, reading })),
            Err(fault) => Converted::Rejected(fault),
        }
    }

    /// Acceleration without gravity, and gravity.
    fn total(&self, time: Timestamp, user: [f64; 3]) -> Result<Reading, LineFault> {
        let is_fresh = |at: Timestamp| at <= time && time - at <= MAX_GRAVITY_AGE;
        let (_, gravity) = self.gravity.filter(|(at, _)| is_fresh(*at)).ok_or(LineFault::Unpaired)?;
        let factor = self.convention.factor;
        Ok(Reading::SpecificForce([0, 1, 2].map(|k| (factor * (user[k] + gravity[k])) as f32)))
    }
}

fn bluetooth(entry: &Entry) -> Result<RadioSighting, LineFault> {
    let transmitter = match ibeacon(&entry.payload) {
        Some(ibeacon) => ibeacon,
        None => {
            TransmitterId::BleAddress(parse_address(entry.address.as_bytes()).ok_or(LineFault::Identity)?)
        }
    };
    Ok(RadioSighting { transmitter, rssi_dbm: entry.value as f32 })
}

/// The iBeacon of manufacturer data: prefix, UUID, major, minor, power.
fn ibeacon(payload: &str) -> Option<TransmitterId> {
    let (prefix, rest) = payload.split_at_checked(IBEACON_PREFIX.len())?;
    let number = |from: usize| u16::from_str_radix(rest.get(from..from + 4)?, 16).ok();
    if !prefix.eq_ignore_ascii_case(IBEACON_PREFIX) || rest.len() < 42 {
        return None;
    }
    let uuid = parse_uuid(rest.get(..32)?.as_bytes())?;
    Some(TransmitterId::Ibeacon { uuid, major: number(32)?, minor: number(36)? })
}

/// A place such as `12.5, 40`; nothing for a remark. What has a digit and is no place is likely a waypoint mistyped:
/// that one has gone must not pass in silence.
fn place(text: &str) -> Result<Option<Point2>, LineFault> {
    let numbers =
        text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    let Some((x_m, y_m)) = numbers else {
        let is_remark = !text.contains(|c: char| c.is_ascii_digit());
        return if is_remark { Ok(None) } else { Err(LineFault::Number) };
    };
    let point = Point2::new(x_m, y_m);
    let is_within = point.x_m.abs() <= MAX_PLACE_M && point.y_m.abs() <= MAX_PLACE_M;
    if is_within { Ok(Some(point)) } else { Err(LineFault::OutOfRange) }
}
