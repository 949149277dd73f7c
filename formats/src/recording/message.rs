//! One record as a JSON message, exact in both directions.

use std::collections::BTreeMap;
use std::fmt;
use std::io::Write as _;

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::Timestamp;
use serde::de::{DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, Visitor};

use super::Record;
use super::channel::Channel;
use crate::error::FormatError;
use crate::transmitter_id;

/// The most numbers that a message has.
const MAX_NUMBERS: usize = 6;

/// Puts `record` into `json`, replacing what was there; gives its channel and its time in the file.
///
/// f32 are printed with the fewest digits that read back as the same f32.
///
/// # Errors
/// When the record is of a kind that this version cannot write.
pub(super) fn encode(record: &Record, json: &mut Vec<u8>) -> Result<(Channel, u64), FormatError> {
    let (channel, numbers, text) = take_apart(record).ok_or_else(|| {
        FormatError::malformed(
            "a record of a kind that recordings do not hold",
            "leave it out, or update Fieldwalk",
        )
    })?;
    json.clear();
    json.push(b'{');
    if let Some((text, (name, _))) = text.zip(channel.text()) {
        // Neither an identity's spelling nor hexadecimal has anything that JSON escapes.
        push(json, format_args!("\"{name}\":\"{text}\","));
    }
    let mut has_not_finite = false;
    for (name, &number) in channel.fields().iter().zip(&numbers) {
        if number.is_finite() {
            push(json, format_args!("\"{name}\":"));
            push_number(json, number, channel.is_double());
            json.push(b',');
        }
        has_not_finite |= !number.is_finite();
    }
    if has_not_finite {
        json.extend_from_slice(b"\"not_finite\":{");
        for (name, number) in channel.fields().iter().zip(numbers) {
            let word = match number {
                number if number.is_finite() => continue,
                number if number.is_nan() => "NaN",
                f64::INFINITY => "Infinity",
                _ => "-Infinity",
            };
            push(json, format_args!("\"{name}\":\"{word}\","));
        }
        json.pop_if(|byte| *byte == b',');
        json.extend_from_slice(b"},");
    }
    let time_ns = record.time().as_nanos();
    if time_ns < 0 {
        push(json, format_args!("\"time_ns\":{time_ns}"));
    } else {
        json.pop_if(|byte| *byte == b',');
    }
    json.push(b'}');
    Ok((channel, u64::try_from(time_ns).unwrap_or(0)))
}

/// The record of `channel` that `json` holds; `log_time` is its time in the file.
///
/// # Errors
/// When the message is not of the channel's form.
pub(super) fn decode(channel: Channel, log_time: u64, json: &[u8]) -> Result<Record, serde_json::Error> {
    let mut deserializer = serde_json::Deserializer::from_slice(json);
    let message = MessageOf(channel).deserialize(&mut deserializer)?;
    deserializer.end()?;
    let time_ns = match message.time_ns {
        Some(time_ns) => time_ns,
        None => i64::try_from(log_time).map_err(|_| serde_json::Error::custom("log_time out of range"))?,
    };
    let mut numbers = [0.0; MAX_NUMBERS];
    for (number, (found, name)) in numbers.iter_mut().zip(message.numbers.iter().zip(channel.fields())) {
        *number = found.ok_or_else(|| serde_json::Error::missing_field(name))?;
    }
    let time = Timestamp::from_nanos(time_ns);
    let [a, b, c, d, e, f] = numbers.map(|number| number as f32);
    let reading = match channel {
        Channel::SpecificForce => Reading::SpecificForce([a, b, c]),
        Channel::AngularRate => Reading::AngularRate([a, b, c]),
        Channel::MagneticField => Reading::MagneticField([a, b, c]),
        Channel::UncalibratedMagneticField => {
            Reading::UncalibratedMagneticField { field_ut: [a, b, c], bias_ut: [d, e, f] }
        }
        Channel::Radio => {
            let transmitter =
                message.transmitter.ok_or_else(|| serde_json::Error::missing_field("transmitter"))?;
            Reading::Radio(RadioSighting { transmitter, rssi_dbm: a })
        }
        Channel::Pressure => Reading::Pressure { pressure_hpa: a },
        Channel::CardFrame => {
            Reading::CardFrame(message.frame.ok_or_else(|| serde_json::Error::missing_field("frame"))?)
        }
        Channel::Waypoint => {
            return Ok(Record::Waypoint { time, point: Point2::new(numbers[0], numbers[1]) });
        }
    };
    Ok(Record::Sample(Sample { time, reading }))
}

type Parts = (Channel, [f64; MAX_NUMBERS], Option<String>);

/// The record's channel, numbers and text; `None` for a kind that this version cannot write.
fn take_apart(record: &Record) -> Option<Parts> {
    let mut numbers = [0.0; MAX_NUMBERS];
    let mut fill = |from: usize, values: &[f32]| {
        numbers.iter_mut().skip(from).zip(values).for_each(|(number, &value)| *number = f64::from(value));
    };
    let mut text = None;
    let channel = match record {
        Record::Waypoint { point, .. } => {
            numbers[..2].copy_from_slice(&[point.x_m, point.y_m]);
            Channel::Waypoint
        }
        Record::Sample(sample) => match &sample.reading {
            Reading::SpecificForce(force) => {
                fill(0, force);
                Channel::SpecificForce
            }
            Reading::AngularRate(rate) => {
                fill(0, rate);
                Channel::AngularRate
            }
            Reading::MagneticField(field) => {
                fill(0, field);
                Channel::MagneticField
            }
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                fill(0, field_ut);
                fill(3, bias_ut);
                Channel::UncalibratedMagneticField
            }
            Reading::Radio(sighting) => {
                fill(0, &[sighting.rssi_dbm]);
                text = Some(transmitter_id::to_text(&sighting.transmitter)?);
                Channel::Radio
            }
            Reading::Pressure { pressure_hpa } => {
                fill(0, &[*pressure_hpa]);
                Channel::Pressure
            }
            Reading::CardFrame(frame) => {
                text = Some(frame.iter().map(|byte| format!("{byte:02x}")).collect());
                Channel::CardFrame
            }
            _ => return None,
        },
    };
    Some((channel, numbers, text))
}

fn push(json: &mut Vec<u8>, text: fmt::Arguments<'_>) {
    let written = json.write_fmt(text);
    debug_assert!(written.is_ok(), "memory takes every byte");
}

fn push_number(json: &mut Vec<u8>, number: f64, is_double: bool) {
    let written = match is_double {
        true => serde_json::to_writer(json, &number),
        false => serde_json::to_writer(json, &(number as f32)),
    };
    debug_assert!(written.is_ok(), "memory takes every byte");
}

/// The bytes that `hexadecimal` spells, two digits each.
fn bytes<const N: usize>(hexadecimal: &str) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    let (pairs, []) = hexadecimal.as_bytes().as_chunks::<2>() else { return None };
    if pairs.len() != N {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(pairs) {
        let [high, low] = pair.map(|digit| char::from(digit).to_digit(16));
        *byte = (high? << 4 | low?) as u8;
    }
    Some(bytes)
}

/// What a message says, field by field.
#[derive(Default)]
struct Message {
    numbers: [Option<f64>; MAX_NUMBERS],
    transmitter: Option<TransmitterId>,
    frame: Option<[u8; 31]>,
    time_ns: Option<i64>,
}

/// Reads a message of the channel; f32 are read as such, for a detour by f64 would round twice.
struct MessageOf(Channel);

impl<'de> DeserializeSeed<'de> for MessageOf {
    type Value = Message;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Message, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for MessageOf {
    type Value = Message;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a message of {}", self.0.topic())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Message, A::Error> {
        let mut message = Message::default();
        while let Some(key) = map.next_key_seed(KeyOf(self.0))? {
            match key {
                Key::Number(index) => {
                    let number: f64 =
                        if self.0.is_double() { map.next_value()? } else { map.next_value::<f32>()?.into() };
                    if !number.is_finite() {
                        return Err(A::Error::custom("number out of range"));
                    }
                    message.numbers[index] = Some(number);
                }
                Key::NotFinite => {
                    let words: BTreeMap<String, String> = map.next_value()?;
                    for (number, name) in message.numbers.iter_mut().zip(self.0.fields()) {
                        match words.get(*name).map(String::as_str) {
                            None => {}
                            Some("NaN") => *number = Some(f64::NAN),
                            Some("Infinity") => *number = Some(f64::INFINITY),
                            Some("-Infinity") => *number = Some(f64::NEG_INFINITY),
                            Some(_) => return Err(A::Error::custom("neither NaN nor an infinity")),
                        }
                    }
                }
                Key::Transmitter => {
                    let text: String = map.next_value()?;
                    let id = transmitter_id::from_text(&text);
                    message.transmitter =
                        Some(id.ok_or_else(|| A::Error::custom("no transmitter identity"))?);
                }
                Key::Frame => {
                    let text: String = map.next_value()?;
                    message.frame = Some(bytes(&text).ok_or_else(|| A::Error::custom("no 31 bytes"))?);
                }
                Key::Time => message.time_ns = Some(map.next_value()?),
                Key::Other => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        Ok(message)
    }
}

/// A property's name, understood.
enum Key {
    Number(usize),
    NotFinite,
    Transmitter,
    Frame,
    Time,
    Other,
}

struct KeyOf(Channel);

impl<'de> DeserializeSeed<'de> for KeyOf {
    type Value = Key;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Key, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl Visitor<'_> for KeyOf {
    type Value = Key;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a property's name")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Key, E> {
        Ok(match self.0.fields().iter().position(|field| *field == name) {
            Some(index) => Key::Number(index),
            None => match name {
                "not_finite" => Key::NotFinite,
                "transmitter" => Key::Transmitter,
                "frame" => Key::Frame,
                "time_ns" => Key::Time,
                _ => Key::Other,
            },
        })
    }
}
