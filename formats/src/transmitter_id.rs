//! Transmitter identities as text: hardware addresses, UUIDs, and one spelling for maps.

use std::fmt::Write as _;

use fieldwalk::sensor::TransmitterId;

/// The identity as maps spell it: `ble:…`, `wifi:…` or `ibeacon:UUID/major/minor`, in lower case.
///
/// `None` for a kind of transmitter that this version cannot write.
pub(crate) fn to_text(id: &TransmitterId) -> Option<String> {
    let address = |kind: &str, bytes: &[u8; 6]| {
        let mut text = String::from(kind);
        for byte in bytes {
            let _ = write!(text, ":{byte:02x}");
        }
        text
    };
    Some(match id {
        TransmitterId::BleAddress(bytes) => address("ble", bytes),
        TransmitterId::WifiBssid(bytes) => address("wifi", bytes),
        TransmitterId::Ibeacon { uuid, major, minor } => {
            let mut text = String::from("ibeacon:");
            for (i, byte) in uuid.iter().enumerate() {
                let dash = if matches!(i, 4 | 6 | 8 | 10) { "-" } else { "" };
                let _ = write!(text, "{dash}{byte:02x}");
            }
            let _ = write!(text, "/{major}/{minor}");
            text
        }
        _ => return None,
    })
}

/// The identity that [`to_text`] spelled.
pub(crate) fn from_text(text: &str) -> Option<TransmitterId> {
    let (kind, rest) = text.split_once(':')?;
    match kind {
        "ble" => Some(TransmitterId::BleAddress(parse_address(rest.as_bytes())?)),
        "wifi" => Some(TransmitterId::WifiBssid(parse_address(rest.as_bytes())?)),
        "ibeacon" => {
            let mut parts = rest.split('/');
            let uuid = parse_uuid(parts.next()?.as_bytes())?;
            let (major, minor) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
            parts.next().is_none().then_some(TransmitterId::Ibeacon { uuid, major, minor })
        }
        _ => None,
    }
}

/// Six bytes from `aa:bb:cc:dd:ee:ff`, either case.
pub(crate) fn parse_address(text: &[u8]) -> Option<[u8; 6]> {
    let text: &[u8; 17] = text.try_into().ok()?;
    let mut bytes = [0; 6];
    for (byte, digits) in bytes.iter_mut().zip(text.chunks(3)) {
        *byte = hex_byte(digits[0], digits[1])?;
        if digits.get(2).is_some_and(|&separator| separator != b':') {
            return None;
        }
    }
    Some(bytes)
}

/// Sixteen bytes from 32 hexadecimal digits, either case, dashes ignored.
pub(crate) fn parse_uuid(text: &[u8]) -> Option<[u8; 16]> {
    let mut bytes = [0; 16];
    let mut digits = text.iter().copied().filter(|&digit| digit != b'-');
    for byte in &mut bytes {
        *byte = hex_byte(digits.next()?, digits.next()?)?;
    }
    digits.next().is_none().then_some(bytes)
}

fn hex_byte(high: u8, low: u8) -> Option<u8> {
    let digit = |c: u8| match c {
        b'0'..=b'9' => Some(c - b'0'),
        b'a'..=b'f' => Some(c - b'a' + 10),
        b'A'..=b'F' => Some(c - b'A' + 10),
        _ => None,
    };
    Some(digit(high)? << 4 | digit(low)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identities_survive_their_spelling() {
        let uuid = [0x91, 0x95, 0xb3, 0xad, 0xa9, 0xd0, 0x45, 0, 0x85, 0xff, 0x9f, 0xb0, 0xf6, 0x5a, 0x52, 1];
        let ids = [
            (TransmitterId::BleAddress([0xe0, 0x78, 0xa3, 0x3d, 0xb5, 0xd6]), "ble:e0:78:a3:3d:b5:d6"),
            (TransmitterId::WifiBssid([0, 1, 2, 3, 4, 255]), "wifi:00:01:02:03:04:ff"),
            (
                TransmitterId::Ibeacon { uuid, major: 7, minor: 65_535 },
                "ibeacon:9195b3ad-a9d0-4500-85ff-9fb0f65a5201/7/65535",
            ),
        ];
        for (id, text) in ids {
            assert_eq!(to_text(&id).as_deref(), Some(text));
            assert_eq!(from_text(text), Some(id));
        }
    }

    #[test]
    fn foreign_spellings_are_refused() {
        for text in
            ["", "ble", "ble:", "ble:00:01:02:03:04", "ble:00-01-02-03-04-05", "usb:00:01:02:03:04:05"]
        {
            assert_eq!(from_text(text), None, "{text}");
        }
        assert_eq!(from_text("ibeacon:9195b3ad-a9d0-4500-85ff-9fb0f65a5201/7/65536"), None);
        assert_eq!(from_text("ibeacon:9195b3ad/7/6"), None);
        assert_eq!(parse_address(b"0g:00:00:00:00:00"), None);
    }
}
