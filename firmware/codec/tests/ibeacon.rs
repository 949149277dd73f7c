//! The iBeacon advertisement: bytes worked by hand, foreign and hostile bytes.

use fieldwalk_codec::{Error, IbeaconFrame, IbeaconRepr};
use proptest::prelude::*;

/// Every byte by hand from [`golden_repr`].
const GOLDEN: [u8; 30] = [
    0x02, 0x01, 0x06, // flags: 2 bytes, type 1, general discoverable without BR/EDR
    0x1A, 0xFF, // 26 bytes of manufacturer data
    0x4C, 0x00, // Apple, little-endian
    0x02, 0x15, // proximity beacon, 21 bytes
    0xF7, 0x82, 0x6D, 0xA6, 0x4F, 0xA2, 0x4E, 0x98, // uuid
    0x80, 0x24, 0xBC, 0x5B, 0x71, 0xE0, 0x89, 0x3E, //
    0x01, 0x02, // major 0x0102, big-endian
    0xFF, 0xFE, // minor 0xFFFE
    0xC5, // -59 dBm
];

fn golden_repr() -> IbeaconRepr {
    IbeaconRepr {
        uuid: 0xF782_6DA6_4FA2_4E98_8024_BC5B_71E0_893E_u128.to_be_bytes(),
        major: 0x0102,
        minor: 0xFFFE,
        measured_power_dbm: -59,
    }
}

fn emitted(repr: &IbeaconRepr) -> [u8; 30] {
    // Not zeros, so that a byte left out shows.
    let mut bytes = [0xA5; 30];
    repr.emit(&mut IbeaconFrame::new_unchecked(&mut bytes));
    bytes
}

fn parsed(bytes: &[u8]) -> Result<IbeaconRepr, Error> {
    IbeaconRepr::parse(&IbeaconFrame::new_checked(bytes)?)
}

#[test]
fn golden_advertisement_both_ways() {
    assert_eq!(emitted(&golden_repr()), GOLDEN);
    assert_eq!(parsed(&GOLDEN), Ok(golden_repr()));
    assert_eq!(IbeaconRepr::parse_advertisement(&GOLDEN), Ok(golden_repr()));
    assert_eq!(IbeaconRepr::parse_manufacturer_data(0x004C, &GOLDEN[7..]), Ok(golden_repr()));
    assert_eq!(golden_repr().buffer_len(), GOLDEN.len());
}

#[test]
fn other_structures_may_come_first() {
    let mut payload = vec![0x03, 0x09, b'F', b'W', 0x02, 0x0A, 0x04];
    payload.extend_from_slice(&[0x04, 0xFF, 0x59, 0x00, 0x01]); // another company's
    payload.extend_from_slice(&[0x03, 0xFF, 0x4C, 0x00]); // Apple's, empty
    payload.extend_from_slice(&GOLDEN[3..]);
    payload.extend_from_slice(&[0x00, 0x00]);
    assert_eq!(IbeaconRepr::parse_advertisement(&payload), Ok(golden_repr()));
    // A malformed tail does not take back what was found.
    payload.truncate(payload.len() - 2);
    payload.push(0x30);
    assert_eq!(IbeaconRepr::parse_advertisement(&payload), Ok(golden_repr()));
}

#[test]
fn a_foreign_advertisement_is_told_apart() {
    let advertisement = IbeaconRepr::parse_advertisement;
    assert_eq!(advertisement(&[]), Err(Error::NoManufacturerData));
    assert_eq!(advertisement(&GOLDEN[..3]), Err(Error::NoManufacturerData));
    assert_eq!(advertisement(&[0x02, 0xFF, 0x4C]), Err(Error::NoManufacturerData));
    assert_eq!(advertisement(&[0x04, 0xFF, 0x59, 0x00, 0x01]), Err(Error::ForeignCompany(0x0059)));
    assert_eq!(advertisement(&[0x05, 0xFF, 0x4C, 0x00, 0x10, 0x05]), Err(Error::NotIbeacon(0x10)));
    assert_eq!(
        advertisement(&[0x05, 0xFF, 0x4C, 0x00, 0x02, 0x15]),
        Err(Error::WrongLength { expected: 23, actual: 2 })
    );
    assert_eq!(advertisement(&[0x03, 0xFF, 0x4C, 0x00]), Err(Error::Truncated { needed: 23, actual: 0 }));
    assert_eq!(advertisement(&GOLDEN[..29]), Err(Error::Overrun { length: 26, remaining: 25 }));
}

#[test]
fn every_truncation_is_refused() {
    for length in 0..30 {
        assert_eq!(parsed(&GOLDEN[..length]), Err(Error::Truncated { needed: 30, actual: length }));
        let unchecked = IbeaconFrame::new_unchecked(&GOLDEN[..length]);
        assert_eq!(IbeaconRepr::parse(&unchecked), Err(Error::Truncated { needed: 30, actual: length }));
        assert!(IbeaconRepr::parse_advertisement(&GOLDEN[..length]).is_err());
    }
}

#[test]
fn every_corruption_of_a_byte_is_refused_or_shown() {
    for position in 0..GOLDEN.len() {
        for value in (0..=u8::MAX).filter(|&value| value != GOLDEN[position]) {
            let mut bytes = GOLDEN;
            bytes[position] = value;
            let _ = IbeaconRepr::parse_advertisement(&bytes);
            let expected = match position {
                0 => Err(Error::WrongLength { expected: 2, actual: value.into() }),
                1 => Err(Error::WrongAdType { expected: 1, actual: value }),
                2 => Ok(golden_repr()), // beacons differ in their flags
                3 => Err(Error::WrongLength { expected: 26, actual: value.into() }),
                4 => Err(Error::WrongAdType { expected: 0xFF, actual: value }),
                5 => Err(Error::ForeignCompany(value.into())),
                6 => Err(Error::ForeignCompany(u16::from(value) << 8 | 0x4C)),
                7 => Err(Error::NotIbeacon(value)),
                8 => Err(Error::WrongLength { expected: 21, actual: value.into() }),
                _ => {
                    let repr = parsed(&bytes).unwrap();
                    assert_ne!(repr, golden_repr(), "byte {position} is not read");
                    assert_eq!(emitted(&repr), bytes);
                    continue;
                }
            };
            assert_eq!(parsed(&bytes), expected);
        }
    }
}

proptest! {
    #[test]
    fn a_repr_survives_the_wire(
        uuid: [u8; 16], major: u16, minor: u16, measured_power_dbm: i8,
    ) {
        let repr = IbeaconRepr { uuid, major, minor, measured_power_dbm };
        prop_assert_eq!(parsed(&emitted(&repr)), Ok(repr));
        prop_assert_eq!(IbeaconRepr::parse_advertisement(&emitted(&repr)), Ok(repr));
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
        let _ = parsed(&bytes);
        let _ = IbeaconRepr::parse_advertisement(&bytes);
        let _ = IbeaconRepr::parse_manufacturer_data(0x004C, &bytes);
    }
}
