//! One line of a log: `TYPE;time;…`, parsed from bytes without allocating.

use std::str::{self, FromStr};

use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::{Duration, Timestamp};

use crate::ilc::LineFault;
use crate::transmitter_id::parse_address;

/// What one well-formed line says.
#[derive(Debug)]
pub(super) enum Line {
    Sample(Sample),
    Position(Position),
    /// A type that carries nothing for positioning.
    Skipped,
}

/// A `POSI` line.
#[derive(Debug)]
pub(super) struct Position {
    pub(super) time: Timestamp,
    pub(super) latitude_deg: f64,
    pub(super) longitude_deg: f64,
    pub(super) floor: i32,
}

/// Ten years: the application's clock starts with the log.
const MAX_TIME_S: f64 = 3.2e8;

/// Parses `line`, which has no line ending.
pub(super) fn parse(line: &[u8]) -> Result<Line, LineFault> {
    let (kind, rest) = split(line).ok_or(LineFault::FieldCount)?;
    let is_skipped = matches!(
        kind,
        b"LIGH"
            | b"PROX"
            | b"HUMI"
            | b"TEMP"
            | b"AHRS"
            | b"GNSS"
            | b"BLUE"
            | b"SOUN"
            | b"RFID"
            | b"IMUX"
            | b"IMUL"
            | b"IMUI"
    );
    if is_skipped {
        return Ok(Line::Skipped);
    }
    let mut fields = Fields { rest: Some(rest) };
    if !matches!(kind, b"ACCE" | b"GYRO" | b"MAGN" | b"PRES" | b"WIFI" | b"BLE4" | b"POSI") {
        return Err(LineFault::UnknownType);
    }
    let time = fields.time()?;
    if kind == b"POSI" {
        return fields.position(time).map(Line::Position);
    }
    let reading = match kind {
        b"BLE4" => Reading::Radio(fields.ble()?),
        _ => {
            let _sensor_time_s: f64 = fields.number()?;
            match kind {
                b"ACCE" => Reading::SpecificForce(fields.vector()?),
                b"GYRO" => Reading::AngularRate(fields.vector()?),
                b"MAGN" => Reading::MagneticField(fields.vector()?),
                b"PRES" => {
                    let pressure_hpa = fields.number()?;
                    fields.accuracy()?;
                    Reading::Pressure { pressure_hpa }
                }
                _ => Reading::Radio(fields.wifi()?),
            }
        }
    };
    Ok(Line::Sample(Sample { time, reading }))
}

fn split(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = line.iter().position(|&byte| byte == b';')?;
    Some((&line[..end], &line[end + 1..]))
}

fn parse_number<T: FromStr>(field: &[u8]) -> Result<T, LineFault> {
    str::from_utf8(field.trim_ascii()).ok().and_then(|text| text.parse().ok()).ok_or(LineFault::Number)
}

/// The fields of a line, left to right, separated by semicolons.
struct Fields<'a> {
    rest: Option<&'a [u8]>,
}

impl<'a> Fields<'a> {
    fn next(&mut self) -> Result<&'a [u8], LineFault> {
        let rest = self.rest.ok_or(LineFault::FieldCount)?;
        let (field, rest) = split(rest).map_or((rest, None), |(field, rest)| (field, Some(rest)));
        self.rest = rest;
        Ok(field)
    }

    /// One finite number.
    fn number<T: FromStr + Into<f64> + Copy>(&mut self) -> Result<T, LineFault> {
        let number: T = parse_number(self.next()?)?;
        if number.into().is_finite() { Ok(number) } else { Err(LineFault::NotFinite) }
    }

    fn time(&mut self) -> Result<Timestamp, LineFault> {
        let time_s: f64 = self.number().map_err(|_| LineFault::Time)?;
        if time_s.abs() > MAX_TIME_S {
            return Err(LineFault::Time);
        }
        // Rounded: the log has milliseconds, which binary fractions of a second miss by a little.
        Ok(Timestamp::from_nanos(0) + Duration::from_nanos((time_s * 1e9).round() as i64))
    }

    /// Three components and the accuracy class that ends the line.
    fn vector(&mut self) -> Result<[f32; 3], LineFault> {
        let vector = [self.number()?, self.number()?, self.number()?];
        self.accuracy()?;
        Ok(vector)
    }

    /// The accuracy class, not used; a line without it was torn, and the number before it cannot be trusted.
    fn accuracy(&mut self) -> Result<(), LineFault> {
        let _class: i8 = parse_number(self.next()?)?;
        self.end()
    }

    /// The line's end, with or without a last semicolon.
    fn end(&self) -> Result<(), LineFault> {
        match self.rest {
            None | Some([]) => Ok(()),
            Some(_) => Err(LineFault::FieldCount),
        }
    }

    /// `ssid;bssid;[frequency;]rssi`, where a network may have semicolons in its name: read from the right.
    fn wifi(&mut self) -> Result<RadioSighting, LineFault> {
        let rest = self.rest.take().ok_or(LineFault::FieldCount)?;
        let rest = rest.strip_suffix(b";").unwrap_or(rest);
        let mut from_right = rest.rsplit(|&byte| byte == b';');
        let rssi_dbm: f32 = parse_number(from_right.next().unwrap_or_default())?;
        let bssid = from_right.take(2).find_map(parse_address).ok_or(LineFault::Identity)?;
        sighting(TransmitterId::WifiBssid(bssid), rssi_dbm)
    }

    /// `kind;address;rssi;…`, or in older logs `major;minor;rssi`, which names no transmitter.
    fn ble(&mut self) -> Result<RadioSighting, LineFault> {
        let _kind = self.next()?;
        let address = parse_address(self.next()?).ok_or(LineFault::Identity)?;
        let rssi_dbm = self.number()?;
        sighting(TransmitterId::BleAddress(address), rssi_dbm)
    }

    /// `counter;latitude;longitude;floor;building`.
    fn position(&mut self, time: Timestamp) -> Result<Position, LineFault> {
        let _counter = self.next()?;
        let (latitude_deg, longitude_deg): (f64, f64) = (self.number()?, self.number()?);
        let floor: f64 = self.number()?;
        let _building = self.next()?;
        self.end()?;
        // At the poles a degree of longitude has no length.
        if latitude_deg.abs() > 89.0 || longitude_deg.abs() > 180.0 || floor.abs() > 1_000.0 {
            return Err(LineFault::OutOfRange);
        }
        Ok(Position { time, latitude_deg, longitude_deg, floor: floor as i32 })
    }
}

fn sighting(transmitter: TransmitterId, rssi_dbm: f32) -> Result<RadioSighting, LineFault> {
    if !rssi_dbm.is_finite() {
        return Err(LineFault::NotFinite);
    }
    Ok(RadioSighting { transmitter, rssi_dbm })
}
