//! The objects of a JSON array, one after the other, in bounded memory.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead};

use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, de};

use super::entry::Fields;
use crate::ilc::LineFault;
use crate::text_lines::MAX_LINE_BYTES;

/// Finds the objects of an array, of which arrays there may be several and nested.
#[derive(Debug)]
pub(super) struct Elements<R> {
    reader: R,
    /// The object found, its braces included.
    element: Vec<u8>,
    position: u64,
}

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// An object that begins at this byte.
    Object(u64),
    /// An object longer than any of the app's; its content is not kept.
    TooLong(u64),
    End,
    /// The file ends within an object.
    Torn,
    /// A byte that does not belong between objects.
    Foreign(u64),
}

impl<R: BufRead> Elements<R> {
    /// Reads on from `reader`, which stands at byte `position` of its file, outside of any object.
    pub(super) fn new(reader: R, position: u64) -> Self {
        Self { reader, element: Vec::new(), position }
    }

    pub(super) fn element(&self) -> &[u8] {
        &self.element
    }

    pub(super) fn next(&mut self) -> io::Result<Found> {
        self.element.clear();
        let begin = loop {
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                return Ok(Found::End);
            }
            let n_between = buffer.iter().take_while(|byte| is_between(**byte)).count();
            let next = buffer.get(n_between).copied();
            self.reader.consume(n_between);
            self.position += n_between as u64;
            match next {
                None => {}
                Some(b'{') => break self.position,
                // The byte order mark that some editors put first.
                Some(0xef | 0xbb | 0xbf) if self.position < 3 => {
                    self.reader.consume(1);
                    self.position += 1;
                }
                Some(_) => return Ok(Found::Foreign(self.position)),
            }
        };
        let (mut depth, mut is_string, mut is_escaped, mut is_too_long) = (0_u32, false, false, false);
        loop {
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                return Ok(Found::Torn);
            }
            let mut n_used = 0;
            let mut is_whole = false;
            for &byte in buffer {
                n_used += 1;
                match byte {
                    _ if is_escaped => is_escaped = false,
                    b'\\' if is_string => is_escaped = true,
                    b'"' => is_string = !is_string,
                    b'{' if !is_string => depth += 1,
                    b'}' if !is_string => {
                        depth -= 1;
                        is_whole = depth == 0;
                    }
                    _ => {}
                }
                if is_whole {
                    break;
                }
            }
            is_too_long |= self.element.len() + n_used > MAX_LINE_BYTES;
            if !is_too_long {
                self.element.extend_from_slice(&buffer[..n_used]);
            }
            self.reader.consume(n_used);
            self.position += n_used as u64;
            if is_whole {
                return Ok(if is_too_long { Found::TooLong(begin) } else { Found::Object(begin) });
            }
        }
    }
}

fn is_between(byte: u8) -> bool {
    byte.is_ascii_whitespace() || matches!(byte, b',' | b'[' | b']')
}

/// The name of the sensor of an object, if it names one.
pub(super) fn sensor_name(object: &[u8]) -> Result<Option<Cow<'_, str>>, LineFault> {
    #[derive(Deserialize)]
    struct Named<'a> {
        #[serde(borrow, default)]
        sensor: Option<Cow<'a, str>>,
    }
    serde_json::from_slice(object).map(|named: Named<'_>| named.sensor).map_err(|_| LineFault::FieldCount)
}

/// The fields of an object that positioning reads.
pub(super) fn fields(object: &[u8]) -> Result<Fields, LineFault> {
    let taken: Taken = serde_json::from_slice(object).map_err(|_| LineFault::FieldCount)?;
    Ok(taken.0)
}

/// All fields of an object as text.
pub(super) fn texts(object: &[u8]) -> BTreeMap<String, String> {
    let object: BTreeMap<String, serde_json::Value> = serde_json::from_slice(object).unwrap_or_default();
    let text = |value: serde_json::Value| match value {
        serde_json::Value::String(text) => text,
        other => other.to_string(),
    };
    object.into_iter().map(|(name, value)| (name, text(value))).collect()
}

struct Taken(Fields);

impl<'de> Deserialize<'de> for Taken {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Object;
        impl<'de> Visitor<'de> for Object {
            type Value = Taken;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Taken, A::Error> {
                let mut fields = Fields::default();
                while let Some(name) = map.next_key::<Cow<'de, str>>()? {
                    let field: Field<'de> = map.next_value()?;
                    fields.set(&name, &field.0);
                }
                Ok(Taken(fields))
            }
        }
        deserializer.deserialize_map(Object)
    }
}

/// A value as text: the app writes numbers as strings, other programs as numbers.
struct Field<'de>(Cow<'de, str>);

impl<'de> Deserialize<'de> for Field<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Value;
        impl<'de> Visitor<'de> for Value {
            type Value = Field<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value")
            }

            fn visit_borrowed_str<E: de::Error>(self, text: &'de str) -> Result<Self::Value, E> {
                Ok(Field(text.into()))
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
                Ok(Field(text.to_owned().into()))
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Self::Value, E> {
                Ok(Field(number.to_string().into()))
            }

            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Self::Value, E> {
                Ok(Field(number.to_string().into()))
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<Self::Value, E> {
                Ok(Field(number.to_string().into()))
            }

            fn visit_bool<E: de::Error>(self, _: bool) -> Result<Self::Value, E> {
                Ok(Field("".into()))
            }

            fn visit_unit<E: de::Error>(self) -> Result<Self::Value, E> {
                Ok(Field("".into()))
            }

            fn visit_seq<A: de::SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                while seq.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Field("".into()))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Field("".into()))
            }
        }
        deserializer.deserialize_any(Value)
    }
}
