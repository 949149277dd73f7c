//! GeoJSON plans: reading never panics, and what reads can be written and read again.
#![no_main]

use fieldwalk_formats::{read_plan, write_plan};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(plan) = read_plan(bytes) {
        let written = write_plan(&plan);
        let again = read_plan(written.as_bytes());
        assert!(again.is_ok(), "{again:?} of {written}");
    }
});
