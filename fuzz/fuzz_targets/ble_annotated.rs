//! The annotated BLE collection's files: reading never panics, ends, and gives nothing but finite numbers.
#![no_main]

use fieldwalk_formats::ble_annotated::{SightingReader, read_receivers};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let n_lines = bytes.split(|&byte| byte == b'\n').count();
    let mut n_sightings = 0;
    for sighting in SightingReader::new(bytes, "fuzz") {
        match sighting {
            Ok(sighting) => {
                assert!(sighting.time.as_nanos() >= 0 && sighting.rssi_dbm.is_finite());
                assert!(
                    sighting.truth.is_none_or(|(place, height_m)| place.is_finite() && height_m.is_finite())
                );
            }
            Err(error) => assert!(!error.remedy().is_empty()),
        }
        n_sightings += 1;
    }
    assert!(n_sightings <= n_lines + 1);
    match read_receivers(bytes) {
        Ok(receivers) => assert!(receivers.iter().all(|r| r.position.is_finite() && r.height_m.is_finite())),
        Err(error) => assert!(!error.remedy().is_empty()),
    }
});
