//! MCAP recordings: reading never panics, ends, and what it gives survives being written and read again.
#![no_main]

use fieldwalk_formats::recording::{Record, RecordingInfo, RecordingReader, RecordingWriter};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut reader = RecordingReader::new(bytes, "fuzz");
    let mut records = Vec::new();
    for item in reader.by_ref() {
        match item {
            Ok(record) => records.push(record),
            Err(error) => assert!(!error.remedy().is_empty()),
        }
    }
    let info = reader.info().cloned().unwrap_or_default();
    let (read, read_info) = read(&write(&records, &info));
    // Rust prints floats so that they read back as the same; every NaN is alike.
    assert_eq!(format!("{read:?}"), format!("{records:?}"));
    assert_eq!(read_info, Some(info));
});

fn write(records: &[Record], info: &RecordingInfo) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "memory", info).expect("memory takes every byte");
    for record in records {
        writer.write(record).expect("what was read can be written");
    }
    writer.finish().expect("memory takes every byte");
    file
}

fn read(file: &[u8]) -> (Vec<Record>, Option<RecordingInfo>) {
    let mut reader = RecordingReader::new(file, "memory");
    let records = reader.by_ref().map(|record| record.expect("what was written can be read")).collect();
    assert!(reader.losses().is_none());
    (records, reader.info().cloned())
}
