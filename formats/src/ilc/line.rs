//! One line of a trace: `<ms>\tTYPE_…\t<fields>`, parsed from bytes without allocating.

use std::str;

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::Timestamp;

use super::rejections::LineFault;
use crate::recording::Record;
use crate::transmitter_id::{parse_address, parse_uuid};

/// What one well-formed line says.
#[derive(Debug)]
pub(super) enum Line {
    Record(Record),
    /// A WiFi row whose access point was last heard too long ago.
    StaleWifi,
    /// A type that carries nothing for positioning.
    Skipped,
}

/// A WiFi row last heard longer ago than this is left out.
///
/// A scan repeats rows that the system still remembers. In the public collection two rows in five are older than
/// this, up to a minute, in which the walker has gone 30 m; 85 % of those repeat an earlier scan word for word and
/// 9 % were heard before the walk began.
const WIFI_STALE_MS: i64 = 5_000;

/// Digits of a time in milliseconds since 1970, from 2001 to 2286.
const TIME_DIGITS: usize = 13;

const TYPE_PREFIX: &[u8] = b"TYPE_";

/// Parses the first record of `line`, which has no line ending, and tells where in the line the record ends.
///
/// The collection's logger sometimes lost the newline between two records. Two glued records never pass for one, so
/// that only lines that fail need a closer look, and those whose fields are skipped.
pub(super) fn parse_first(line: &[u8]) -> (Result<Line, LineFault>, usize) {
    let parsed = parse(line);
    if matches!(parsed, Ok(Line::Record(_) | Line::StaleWifi)) {
        return (parsed, line.len());
    }
    match record_end(line) {
        end if end < line.len() => (parse(&line[..end]), end),
        end => (parsed, end),
    }
}

/// The value of `key`, such as `FloorName:`, in a header line, `#\tSiteID:…\tSiteName:…\tFloorId:…\tFloorName:F1`.
pub(super) fn header_field(comment: &[u8], key: &[u8]) -> Option<String> {
    let mut fields = comment.split(|&byte| byte == b'\t');
    let value = str::from_utf8(fields.find_map(|field| field.strip_prefix(key))?).ok()?.trim();
    (!value.is_empty()).then(|| value.to_owned())
}

/// Where the first record of `line` ends: at a second `<13 digits>\tTYPE_`, or at the line's end.
fn record_end(line: &[u8]) -> usize {
    let first_type = TIME_DIGITS + 1;
    let mut from = first_type + TYPE_PREFIX.len();
    while let Some(tail) = line.get(from..) {
        let Some(offset) = tail.iter().position(|&byte| byte == b'\t') else { break };
        let tab = from + offset;
        let is_glued = line[tab + 1..].starts_with(TYPE_PREFIX)
            && tab >= first_type + TIME_DIGITS
            && line[tab - TIME_DIGITS..tab].iter().all(u8::is_ascii_digit);
        if is_glued {
            return tab - TIME_DIGITS;
        }
        from = tab + 1;
    }
    line.len()
}

/// Parses one record.
fn parse(line: &[u8]) -> Result<Line, LineFault> {
    if !line.is_ascii() && str::from_utf8(line).is_err() {
        return Err(LineFault::NotUtf8);
    }
    let mut fields = Fields { rest: Some(line) };
    let time_ms = parse_time_ms(fields.next()?)?;
    let time = Timestamp::from_millis(time_ms);
    let kind = fields.next()?.strip_prefix(TYPE_PREFIX).ok_or(LineFault::UnknownType)?;
    let reading = match kind {
        b"ACCELEROMETER" => Reading::SpecificForce(fields.vector_with_accuracy()?),
        b"GYROSCOPE" => Reading::AngularRate(fields.vector_with_accuracy()?),
        b"MAGNETIC_FIELD" => Reading::MagneticField(fields.vector_with_accuracy()?),
        b"MAGNETIC_FIELD_UNCALIBRATED" => {
            let field_ut = fields.vector()?;
            Reading::UncalibratedMagneticField { field_ut, bias_ut: fields.vector_with_accuracy()? }
        }
        b"PRESSURE" => {
            let pressure_hpa = fields.number()?;
            fields.accuracy()?;
            Reading::Pressure { pressure_hpa }
        }
        b"BEACON" => Reading::Radio(beacon(&mut fields)?),
        b"WIFI" => match wifi(&mut fields, time_ms)? {
            Some(sighting) => Reading::Radio(sighting),
            None => return Ok(Line::StaleWifi),
        },
        b"WAYPOINT" => {
            let point = Point2::new(fields.number()?, fields.number()?);
            fields.end()?;
            return Ok(Line::Record(Record::Waypoint { time, point }));
        }
        _ if is_skipped(kind) => return Ok(Line::Skipped),
        _ => return Err(LineFault::UnknownType),
    };
    Ok(Line::Record(Record::Sample(Sample { time, reading })))
}

/// Types that the collection's logger writes and that carry nothing for positioning.
fn is_skipped(kind: &[u8]) -> bool {
    matches!(
        kind,
        b"ROTATION_VECTOR"
            | b"GAME_ROTATION_VECTOR"
            | b"GEOMAGNETIC_ROTATION_VECTOR"
            | b"ORIENTATION"
            | b"GRAVITY"
            | b"LINEAR_ACCELERATION"
            | b"ACCELEROMETER_UNCALIBRATED"
            | b"GYROSCOPE_UNCALIBRATED"
            | b"STEP_COUNTER"
            | b"STEP_DETECTOR"
            | b"LIGHT"
            | b"PROXIMITY"
            | b"BLE"
            | b"BLUETOOTH"
            | b"DIST1"
            | b"DIST2"
    ) || kind.starts_with(b"SENSOR_") && kind.ends_with(b"_ACCURACY_CHANGED")
}

/// `uuid major minor txpower rssi distance mac time`.
fn beacon(fields: &mut Fields<'_>) -> Result<RadioSighting, LineFault> {
    let (uuid, major, minor) = (fields.next()?, fields.next()?, fields.next()?);
    let _tx_power_dbm: f32 = fields.number()?;
    let rssi_dbm = fields.number()?;
    let _distance_m = fields.next()?;
    let address = fields.next()?;
    parse_time_ms(fields.next()?)?;
    fields.end()?;
    let transmitter = match parse_address(address) {
        Some(address) => TransmitterId::BleAddress(address),
        None => TransmitterId::Ibeacon {
            uuid: parse_uuid(uuid).ok_or(LineFault::Identity)?,
            major: parse_number(major).map_err(|_| LineFault::Identity)?,
            minor: parse_number(minor).map_err(|_| LineFault::Identity)?,
        },
    };
    Ok(RadioSighting { transmitter, rssi_dbm })
}

/// `ssid bssid rssi frequency last-seen`; `None` if last seen too long before `time_ms`.
fn wifi(fields: &mut Fields<'_>, time_ms: i64) -> Result<Option<RadioSighting>, LineFault> {
    let _ssid = fields.next()?;
    let bssid = fields.next()?;
    let rssi_dbm = fields.number()?;
    let _frequency_mhz: f32 = fields.number()?;
    let last_seen_ms = parse_time_ms(fields.next()?)?;
    fields.end()?;
    let bssid = parse_address(bssid).ok_or(LineFault::Identity)?;
    let is_fresh = time_ms - last_seen_ms <= WIFI_STALE_MS;
    Ok(is_fresh.then_some(RadioSighting { transmitter: TransmitterId::WifiBssid(bssid), rssi_dbm }))
}

fn parse_time_ms(field: &[u8]) -> Result<i64, LineFault> {
    if field.len() != TIME_DIGITS || !field.iter().all(u8::is_ascii_digit) {
        return Err(LineFault::Time);
    }
    Ok(field.iter().fold(0, |ms, digit| ms * 10 + i64::from(digit - b'0')))
}

fn parse_number<T: str::FromStr>(field: &[u8]) -> Result<T, LineFault> {
    str::from_utf8(field).ok().and_then(|text| text.parse().ok()).ok_or(LineFault::Number)
}

/// The tab-separated fields of a line, left to right.
struct Fields<'a> {
    rest: Option<&'a [u8]>,
}

impl<'a> Fields<'a> {
    fn next(&mut self) -> Result<&'a [u8], LineFault> {
        let rest = self.rest.ok_or(LineFault::FieldCount)?;
        match rest.iter().position(|&byte| byte == b'\t') {
            Some(tab) => {
                self.rest = Some(&rest[tab + 1..]);
                Ok(&rest[..tab])
            }
            None => {
                self.rest = None;
                Ok(rest)
            }
        }
    }

    /// One finite number.
    fn number<T: str::FromStr + Into<f64> + Copy>(&mut self) -> Result<T, LineFault> {
        let number: T = parse_number(self.next()?)?;
        if number.into().is_finite() { Ok(number) } else { Err(LineFault::NotFinite) }
    }

    fn vector(&mut self) -> Result<[f32; 3], LineFault> {
        Ok([self.number()?, self.number()?, self.number()?])
    }

    /// Three components and the accuracy class that ends the line.
    fn vector_with_accuracy(&mut self) -> Result<[f32; 3], LineFault> {
        let vector = self.vector()?;
        self.accuracy()?;
        Ok(vector)
    }

    /// The sensor's accuracy class, which ends the line.
    ///
    /// It is not used, but a line without it was torn, and the number before it cannot be trusted.
    fn accuracy(&mut self) -> Result<(), LineFault> {
        let _class: i8 = parse_number(self.next()?)?;
        self.end()
    }

    fn end(&self) -> Result<(), LineFault> {
        if self.rest.is_none() { Ok(()) } else { Err(LineFault::FieldCount) }
    }
}
