//! A building in one file: no bytes make the reader panic, and what it reads is packed and read again.
//!
//! Under `cfg(fuzzing)` the reader leaves digests unchecked; no mutation would get past them.
#![no_main]

use fieldwalk_formats::{pack_building, unpack_building};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(building) = unpack_building(bytes) else { return };
    let Ok(packed) = pack_building(&building) else { return };
    let again = unpack_building(&packed).expect("what was packed can be read");
    assert_eq!(pack_building(&again).expect("and packed again"), packed);
});
