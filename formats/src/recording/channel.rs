//! The channels of a recording: topic, schema and fields of each kind of record.

use serde_json::json;

/// One kind of record, and the channel that carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Channel {
    SpecificForce,
    AngularRate,
    MagneticField,
    UncalibratedMagneticField,
    Radio,
    Pressure,
    Waypoint,
    CardFrame,
}

impl Channel {
    pub(super) const ALL: [Self; 8] = [
        Self::SpecificForce,
        Self::AngularRate,
        Self::MagneticField,
        Self::UncalibratedMagneticField,
        Self::Radio,
        Self::Pressure,
        Self::Waypoint,
        Self::CardFrame,
    ];

    /// The channel's number and its schema's.
    ///
    /// Fixed by format version 1, so that a file whose declarations were damaged can still be read.
    pub(super) fn id(self) -> u16 {
        self as u16 + 1
    }

    pub(super) fn topic(self) -> &'static str {
        match self {
            Self::SpecificForce => "/specific_force",
            Self::AngularRate => "/angular_rate",
            Self::MagneticField => "/magnetic_field",
            Self::UncalibratedMagneticField => "/uncalibrated_magnetic_field",
            Self::Radio => "/radio",
            Self::Pressure => "/pressure",
            Self::Waypoint => "/waypoint",
            Self::CardFrame => "/card_frame",
        }
    }

    pub(super) fn schema_name(self) -> &'static str {
        match self {
            Self::SpecificForce => "fieldwalk.SpecificForce",
            Self::AngularRate => "fieldwalk.AngularRate",
            Self::MagneticField => "fieldwalk.MagneticField",
            Self::UncalibratedMagneticField => "fieldwalk.UncalibratedMagneticField",
            Self::Radio => "fieldwalk.RadioSighting",
            Self::Pressure => "fieldwalk.Pressure",
            Self::Waypoint => "fieldwalk.Waypoint",
            Self::CardFrame => "fieldwalk.CardFrame",
        }
    }

    /// The names of the message's numbers, in the order in which they are written.
    pub(super) fn fields(self) -> &'static [&'static str] {
        match self {
            Self::SpecificForce => &["x_m_s2", "y_m_s2", "z_m_s2"],
            Self::AngularRate => &["x_rad_s", "y_rad_s", "z_rad_s"],
            Self::MagneticField => &["x_ut", "y_ut", "z_ut"],
            Self::UncalibratedMagneticField => {
                &["x_ut", "y_ut", "z_ut", "bias_x_ut", "bias_y_ut", "bias_z_ut"]
            }
            Self::Radio => &["rssi_dbm"],
            Self::Pressure => &["pressure_hpa"],
            Self::Waypoint => &["x_m", "y_m"],
            Self::CardFrame => &[],
        }
    }

    /// Whether the numbers are f64; those of all sensors are f32.
    pub(super) fn is_double(self) -> bool {
        self == Self::Waypoint
    }

    /// The name and the meaning of the message's text, where it has one.
    pub(super) fn text(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Radio => Some(("transmitter", TRANSMITTER)),
            Self::CardFrame => Some(("frame", FRAME)),
            _ => None,
        }
    }

    /// The JSON Schema of the messages.
    ///
    /// Every property has one plain type, as viewers that plot by schema expect; what is not a finite number
    /// therefore stands in a property of its own.
    pub(super) fn json_schema(self) -> Vec<u8> {
        let mut properties = serde_json::Map::new();
        let mut not_finite = serde_json::Map::new();
        if let Some((name, description)) = self.text() {
            properties.insert(name.to_owned(), json!({ "type": "string", "description": description }));
        }
        for &field in self.fields() {
            properties.insert(field.to_owned(), json!({ "type": "number" }));
            not_finite.insert(
                field.to_owned(),
                json!({ "type": "string", "enum": ["NaN", "Infinity", "-Infinity"] }),
            );
        }
        properties.insert(
            "not_finite".to_owned(),
            json!({ "type": "object", "description": NOT_FINITE, "properties": not_finite }),
        );
        properties.insert("time_ns".to_owned(), json!({ "type": "integer", "description": TIME }));
        let schema = json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": self.schema_name(),
            "description": self.description(),
            "type": "object",
            "properties": properties,
        });
        schema.to_string().into_bytes()
    }

    fn description(self) -> &'static str {
        match self {
            Self::SpecificForce => {
                "Specific force in m/s², device frame: +9.81 on the axis that points up at rest."
            }
            Self::AngularRate => "Angular rate in rad/s, device frame, right-handed.",
            Self::MagneticField => {
                "Magnetic field in µT, device frame, with the operating system's hard-iron correction applied."
            }
            Self::UncalibratedMagneticField => {
                "Magnetic field in µT, device frame, as the sensor gives it, and the operating system's estimate of \
                 the hard-iron bias: field minus bias is corrected."
            }
            Self::Radio => "One packet of a radio transmitter, or one row of a WiFi scan.",
            Self::Pressure => "Static air pressure in hPa.",
            Self::Waypoint => {
                "The walker stood at this point of the floor frame: x right, y up on the plan, metres."
            }
            Self::CardFrame => "An ID card's advertisement as one access point or several heard it.",
        }
    }
}

const TRANSMITTER: &str = "`ble:` or `wifi:` and six bytes in hexadecimal, or `ibeacon:UUID/major/minor`";

const FRAME: &str = "the 31 bytes of the advertisement, in hexadecimal";

const NOT_FINITE: &str = "the numbers that are not finite, by name; they are left out above";

const TIME: &str = "nanoseconds, where the record was taken before the clock's origin; log_time is then 0";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_has_its_own_number_topic_and_schema() {
        for (index, channel) in Channel::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(channel.id()), index + 1);
            for other in &Channel::ALL[..index] {
                assert_ne!(channel.topic(), other.topic());
                assert_ne!(channel.schema_name(), other.schema_name());
            }
            let schema: serde_json::Value = serde_json::from_slice(&channel.json_schema()).unwrap();
            for field in channel.fields() {
                assert_eq!(schema["properties"][field]["type"], "number");
            }
        }
    }
}
