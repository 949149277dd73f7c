//! Card frames: parsing never panics, and parse → emit → parse is the identity.
#![no_main]

use fieldwalk_codec::{CARD_COMPANY_ID, CardFrame, CardRepr, Error};
use libfuzzer_sys::fuzz_target;

fn parse(bytes: &[u8]) -> Result<CardRepr, Error> {
    CardRepr::parse(&CardFrame::new_checked(bytes)?)
}

fn check(repr: CardRepr) -> [u8; CardRepr::BUFFER_LEN] {
    let mut bytes = [0; CardRepr::BUFFER_LEN];
    repr.emit(&mut CardFrame::new_unchecked(&mut bytes));
    assert_eq!(parse(&bytes), Ok(repr));

    // Physical units and back: in range at once, and then exact.
    let round = repr.to_physical();
    let requantised = CardRepr::from_physical(repr.header, &round);
    assert_eq!(CardRepr::from_physical(requantised.header, &requantised.to_physical()), requantised);
    bytes
}

fuzz_target!(|bytes: &[u8]| {
    if let Ok(repr) = parse(bytes) {
        assert_eq!(check(repr), bytes[..CardRepr::BUFFER_LEN]);
    }
    if let Ok(repr) = CardRepr::parse_manufacturer_data(CARD_COMPANY_ID, bytes) {
        check(repr);
    }
});
