//! GetSensorData logs: reading never panics, ends, and gives nothing but finite numbers.
#![no_main]

use fieldwalk_formats::Record;
use fieldwalk_formats::get_sensor_data::GetSensorDataReader;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for record in GetSensorDataReader::new(bytes, "fuzz") {
        match record {
            Ok(Record::Waypoint { point, .. }) => assert!(point.is_finite()),
            Ok(Record::Sample(_)) => {}
            Err(error) => assert!(!error.remedy().is_empty()),
        }
    }
});
