//! Map files: decoding never panics, and what decodes survives encode → decode.
//!
//! Under `cfg(fuzzing)` the reader leaves the digest unchecked; no mutation would get past it.
#![no_main]

use fieldwalk_formats::{decode_floor, encode_floor};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(map) = decode_floor(bytes)
        && let Ok(encoded) = encode_floor(&map)
    {
        // NaN marks unknown nodes, so maps are compared by their bytes.
        let again = decode_floor(&encoded).and_then(|map| encode_floor(&map));
        assert_eq!(again.ok(), Some(encoded));
    }
});
