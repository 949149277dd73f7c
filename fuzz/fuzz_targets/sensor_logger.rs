//! Exports of Sensor Logger: reading never panics, ends, and gives nothing but finite places.
//!
//! What begins with `@` is a folder: files, each after a line `@NAME`. All else is JSON.
#![no_main]

use fieldwalk_formats::Record;
use fieldwalk_formats::sensor_logger::SensorLoggerReader;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match SensorLoggerReader::in_memory(files(bytes), "fuzz") {
        Err(error) => assert!(!error.remedy().is_empty()),
        Ok(reader) => {
            for record in reader {
                match record {
                    Ok(Record::Waypoint { point, .. }) => assert!(point.is_finite()),
                    Ok(Record::Sample(_)) => {}
                    Err(error) => panic!("memory can be read: {error}"),
                }
            }
        }
    }
});

fn files(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    if bytes.first() != Some(&b'@') {
        return vec![("export.json".into(), bytes.to_vec())];
    }
    let file = |text: &[u8]| {
        let end = text.iter().position(|&byte| byte == b'\n').unwrap_or(text.len());
        let (name, rows) = text.split_at(end);
        (String::from_utf8_lossy(name).into_owned(), rows.get(1..).unwrap_or_default().to_vec())
    };
    bytes[1..].split(|&byte| byte == b'@').map(file).collect()
}
