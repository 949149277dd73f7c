//! iBeacon advertisements: parsing never panics, and parse → emit → parse is the identity.
#![no_main]

use fieldwalk_codec::{Error, IbeaconFrame, IbeaconRepr};
use libfuzzer_sys::fuzz_target;

fn parse(bytes: &[u8]) -> Result<IbeaconRepr, Error> {
    IbeaconRepr::parse(&IbeaconFrame::new_checked(bytes)?)
}

fuzz_target!(|bytes: &[u8]| {
    for repr in [parse(bytes), IbeaconRepr::parse_advertisement(bytes)].into_iter().flatten() {
        let mut emitted = [0; IbeaconRepr::BUFFER_LEN];
        repr.emit(&mut IbeaconFrame::new_unchecked(&mut emitted));
        assert_eq!(parse(&emitted), Ok(repr));
        assert_eq!(IbeaconRepr::parse_advertisement(&emitted), Ok(repr));
    }
});
