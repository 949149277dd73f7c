//! Walks of UJIIndoorLoc-Mag: reading never panics, ends, and gives nothing but finite numbers in order of time.
#![no_main]

use fieldwalk::sensor::Reading;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::Record;
use fieldwalk_formats::uji_mag::{MAX_ROWS, MAX_SEGMENTS, UjiMagReader};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (mut last, mut n_records) = (Timestamp::MIN, 0);
    for record in UjiMagReader::new(bytes, "fuzz") {
        match record {
            Ok(record) => {
                assert!(record.time() >= last);
                last = record.time();
                match record {
                    Record::Waypoint { point, .. } => assert!(point.is_finite()),
                    Record::Sample(sample) => match sample.reading {
                        Reading::SpecificForce(v) | Reading::AngularRate(v) | Reading::MagneticField(v) => {
                            assert!(v.iter().all(|c| c.is_finite()));
                        }
                        other => panic!("{other:?}"),
                    },
                }
            }
            Err(error) => assert!(!error.remedy().is_empty()),
        }
        n_records += 1;
    }
    assert!(n_records <= 3 * MAX_ROWS + 2 * MAX_SEGMENTS);
});
