//! The walk over advertising structures: whole, padded and hostile payloads.

use fieldwalk_codec::{AdStructure, AdStructures, Error, ad_type};
use proptest::prelude::*;

#[test]
fn structures_come_in_order() {
    let payload = [0x02, 0x01, 0x06, 0x01, 0x0A, 0x04, 0xFF, 0x4C, 0x00, 0x02];
    let structures: Vec<_> = AdStructures::new(&payload).map(Result::unwrap).collect();
    assert_eq!(
        structures,
        [
            AdStructure { ad_type: ad_type::FLAGS, payload: &[0x06] },
            AdStructure { ad_type: 0x0A, payload: &[] },
            AdStructure { ad_type: ad_type::MANUFACTURER_DATA, payload: &[0x4C, 0x00, 0x02] },
        ]
    );
    assert_eq!(structures[0].manufacturer_data(), None);
    assert_eq!(structures[2].manufacturer_data(), Some((0x004C, &[0x02][..])));
}

#[test]
fn manufacturer_data_needs_a_whole_company_identifier() {
    for payload in [&[][..], &[0x4C]] {
        assert_eq!(AdStructure { ad_type: ad_type::MANUFACTURER_DATA, payload }.manufacturer_data(), None);
    }
}

#[test]
fn a_zero_length_ends_the_payload() {
    let mut structures = AdStructures::new(&[0x02, 0x01, 0x06, 0x00, 0x02, 0x01, 0x06]);
    assert!(structures.next().is_some());
    assert_eq!(structures.next(), None);
    assert_eq!(structures.next(), None);
    assert_eq!(AdStructures::new(&[]).next(), None);
}

#[test]
fn an_overrun_is_told_once() {
    let mut structures = AdStructures::new(&[0x02, 0x01, 0x06, 0xFF, 0xFF, 0x4C]);
    assert!(matches!(structures.next(), Some(Ok(_))));
    assert_eq!(structures.next(), Some(Err(Error::Overrun { length: 255, remaining: 2 })));
    assert_eq!(structures.next(), None);
    let mut lone_length = AdStructures::new(&[0x01]);
    assert_eq!(lone_length.next(), Some(Err(Error::Overrun { length: 1, remaining: 0 })));
    assert_eq!(lone_length.next(), None);
}

#[test]
fn errors_say_what_was_found() {
    let error = Error::Overrun { length: 255, remaining: 2 };
    assert_eq!(error.to_string(), "a structure of 255 bytes with 2 bytes left");
    assert_eq!(Error::ForeignCompany(0x4C).to_string(), "manufacturer data of company 0x004c");
}

proptest! {
    #[test]
    fn any_payload_is_walked_within_bounds(payload in prop::collection::vec(0..8_u8, 0..300)) {
        let mut walked = 0;
        let mut count = 0;
        for structure in AdStructures::new(&payload) {
            count += 1;
            if let Ok(structure) = structure {
                walked += 2 + structure.payload.len();
            }
        }
        prop_assert!(walked <= payload.len());
        prop_assert!(count <= payload.len().div_ceil(2));
    }
}
