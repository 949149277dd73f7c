//! Recordings: what is written is read.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::io::{self, Write};
use std::time::{SystemTime, UNIX_EPOCH};

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::recording::{Record, RecordingInfo, RecordingReader, RecordingWriter, open_recording};
use fieldwalk_formats::{FormatError, recording::Losses};
use proptest::prelude::*;

fn info() -> RecordingInfo {
    RecordingInfo {
        device: "Phöne 8".to_owned(),
        software: "test 1.2".to_owned(),
        floor: "F1".to_owned(),
        start_unix_ms: Some(1_700_000_000_123),
    }
}

fn write_all(records: &[Record]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "walk.mcap", &info()).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    assert_eq!(writer.n_written(), records.len() as u64);
    writer.finish().unwrap();
    file
}

fn read_all(file: &[u8]) -> (Vec<Record>, Losses, Option<FormatError>) {
    let mut reader = RecordingReader::new(file, "walk.mcap");
    let (mut records, mut last_error) = (Vec::new(), None);
    for item in reader.by_ref() {
        assert!(last_error.is_none(), "an error is the last item");
        match item {
            Ok(record) => records.push(record),
            Err(error) => last_error = Some(error),
        }
    }
    (records, *reader.losses(), last_error)
}

/// Every bit of the records but a NaN's payload: Rust prints floats so that they read back as the same.
fn bits(records: &[Record]) -> Vec<String> {
    records.iter().map(|record| format!("{record:?}")).collect()
}

fn sample(ns: i64, reading: Reading) -> Record {
    Record::Sample(Sample { time: Timestamp::from_nanos(ns), reading })
}

fn any_f32() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => any::<u32>().prop_map(f32::from_bits),
        4 => -100.0_f32..100.0,
        1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY), Just(-0.0), Just(16_777_216.0)],
    ]
}

fn any_reading() -> impl Strategy<Value = Reading> {
    let vector = || [any_f32(), any_f32(), any_f32()];
    let transmitter = prop_oneof![
        any::<[u8; 6]>().prop_map(TransmitterId::BleAddress),
        any::<[u8; 6]>().prop_map(TransmitterId::WifiBssid),
        any::<([u8; 16], u16, u16)>().prop_map(|(uuid, major, minor)| TransmitterId::Ibeacon {
            uuid,
            major,
            minor
        }),
    ];
    prop_oneof![
        vector().prop_map(Reading::SpecificForce),
        vector().prop_map(Reading::AngularRate),
        vector().prop_map(Reading::MagneticField),
        (vector(), vector())
            .prop_map(|(field_ut, bias_ut)| Reading::UncalibratedMagneticField { field_ut, bias_ut }),
        (transmitter, any_f32())
            .prop_map(|(transmitter, rssi_dbm)| Reading::Radio(RadioSighting { transmitter, rssi_dbm })),
        any_f32().prop_map(|pressure_hpa| Reading::Pressure { pressure_hpa }),
        any::<[u8; 31]>().prop_map(Reading::CardFrame),
    ]
}

fn any_record() -> impl Strategy<Value = Record> {
    let time_ns = prop_oneof![
        8 => 0_i64..20_000_000_000,
        1 => any::<i64>(),
        1 => prop_oneof![Just(i64::MIN), Just(i64::MAX), Just(-1), Just(0)],
    ];
    let coordinate = || prop_oneof![any::<u64>().prop_map(f64::from_bits), -1e3..1e3];
    let reading = prop_oneof![
        6 => any_reading().prop_map(Some),
        1 => Just(None),
    ];
    (time_ns, reading, coordinate(), coordinate()).prop_map(|(ns, reading, x, y)| match reading {
        Some(reading) => sample(ns, reading),
        None => Record::Waypoint { time: Timestamp::from_nanos(ns), point: Point2::new(x, y) },
    })
}

proptest! {
    #[test]
    fn every_record_survives(records in proptest::collection::vec(any_record(), 0..200)) {
        let (read, losses, error) = read_all(&write_all(&records));
        prop_assert!(error.is_none() && losses == Losses::default());
        prop_assert_eq!(bits(&read), bits(&records));
    }

    #[test]
    fn any_bytes_are_read_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read_all(&bytes);
        read_all(&[mcap::MAGIC, &bytes].concat());
    }
}

#[test]
fn a_dropped_writer_leaves_a_whole_file() {
    let records = [sample(5, Reading::Pressure { pressure_hpa: 1_000.1 })];
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "walk.mcap", &info()).unwrap();
    writer.write(&records[0]).unwrap();
    drop(writer);
    let (read, losses, error) = read_all(&file);
    assert!(error.is_none() && losses.is_none());
    assert_eq!(read, records);
}

#[test]
fn a_recording_says_where_it_comes_from() {
    let file = write_all(&[sample(5, Reading::SpecificForce([0.0; 3]))]);
    let mut reader = RecordingReader::new(&file[..], "walk.mcap");
    assert_eq!(reader.info(), None, "nothing has been read");
    assert!(reader.next().unwrap().is_ok());
    assert_eq!(reader.info(), Some(&info()));
    assert!(reader.next().is_none() && !reader.was_cut());

    let mut file = Vec::new();
    RecordingWriter::new(&mut file, "walk.mcap", &RecordingInfo::default()).unwrap().finish().unwrap();
    let mut reader = RecordingReader::new(&file[..], "walk.mcap");
    assert!(reader.next().is_none());
    assert_eq!(reader.info(), Some(&RecordingInfo::default()), "nothing recorded is a recording");
}

#[test]
fn the_json_is_what_the_documentation_says() {
    let not_a_number = Reading::Radio(RadioSighting {
        transmitter: TransmitterId::BleAddress([1, 2, 3, 4, 5, 255]),
        rssi_dbm: f32::NAN,
    });
    let records = [
        sample(7, Reading::SpecificForce([0.1, -0.2, 9.81])),
        sample(-7, not_a_number),
        sample(8, Reading::MagneticField([f32::INFINITY, 20.0, f32::NEG_INFINITY])),
        Record::Waypoint { time: Timestamp::from_nanos(9), point: Point2::new(0.1, 1e300) },
        sample(10, Reading::CardFrame(core::array::from_fn(|k| 0xF0 + k as u8 % 16))),
    ];
    let file = write_all(&records);
    let messages: Vec<_> = mcap::MessageStream::new(&file).unwrap().map(Result::unwrap).collect();
    let texts: Vec<_> =
        messages.iter().map(|m| (m.log_time, std::str::from_utf8(&m.data).unwrap())).collect();
    assert_eq!(
        texts,
        [
            (7, r#"{"x_m_s2":0.1,"y_m_s2":-0.2,"z_m_s2":9.81}"#),
            (0, r#"{"transmitter":"ble:01:02:03:04:05:ff","not_finite":{"rssi_dbm":"NaN"},"time_ns":-7}"#),
            (8, r#"{"y_ut":20.0,"not_finite":{"x_ut":"Infinity","z_ut":"-Infinity"}}"#),
            (9, r#"{"x_m":0.1,"y_m":1e+300}"#),
            (10, r#"{"frame":"f0f1f2f3f4f5f6f7f8f9fafbfcfdfefff0f1f2f3f4f5f6f7f8f9fafbfcfdfe"}"#),
        ]
    );
    let summary = mcap::Summary::read(&file).unwrap().unwrap();
    let mut topics: Vec<_> = summary.channels.values().map(|channel| channel.topic.as_str()).collect();
    topics.sort_unstable();
    assert_eq!(topics, ["/card_frame", "/magnetic_field", "/radio", "/specific_force", "/waypoint"]);
    assert!(summary.schemas.values().all(|schema| schema.encoding == "jsonschema"));
}

#[test]
fn chunks_span_a_second_at_most_and_late_records_close_few() {
    let reading = Reading::Pressure { pressure_hpa: 1_000.0 };
    let ms = |ms: i64| sample(ms * 1_000_000, reading);
    let chunks = |records: &[Record]| {
        let file = write_all(records);
        let summary = mcap::Summary::read(&file).unwrap().unwrap();
        let spans =
            summary.chunk_indexes.iter().map(|chunk| chunk.message_end_time - chunk.message_start_time);
        spans.collect::<Vec<_>>()
    };
    let steady: Vec<_> = (0..500).map(|k| ms(k * 10)).collect();
    let spans = chunks(&steady);
    assert_eq!(spans.len(), 5);
    assert!(spans.iter().all(|&span| span < 1_000_000_000));

    // One sensor is two seconds late: its records start no chunk each.
    let late: Vec<_> = (300..800).flat_map(|k| [ms(k * 10), ms(k * 10 - 2_000)]).collect();
    assert!(chunks(&late).len() < 30);

    // The clock jumps back, or one stamp is far off: no chunk grows without end.
    let jump: Vec<_> = std::iter::once(ms(1 << 40)).chain((0..2_000).map(|k| ms(k * 10))).collect();
    assert!((20..30).contains(&chunks(&jump).len()));
}

/// Counts bytes, and those between two flushes.
#[derive(Default)]
struct Counting {
    n_bytes: u64,
    n_unflushed: u64,
    most_unflushed: u64,
    n_flushes: u64,
}

impl Write for &mut Counting {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.n_bytes += bytes.len() as u64;
        self.n_unflushed += bytes.len() as u64;
        self.most_unflushed = self.most_unflushed.max(self.n_unflushed);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        (self.n_unflushed, self.n_flushes) = (0, self.n_flushes + 1);
        Ok(())
    }
}

#[test]
fn an_hour_is_written_through_a_small_buffer() {
    let mut sink = Counting::default();
    let mut writer = RecordingWriter::new(&mut sink, "walk.mcap", &info()).unwrap();
    let mut most_buffered = 0;
    for tick in 0..3_600 * 200_i64 {
        let (ns, value) = (tick * 5_000_000, tick as f32 * 0.001);
        for reading in [
            Reading::SpecificForce([value; 3]),
            Reading::AngularRate([value; 3]),
            Reading::MagneticField([value; 3]),
            Reading::UncalibratedMagneticField { field_ut: [value; 3], bias_ut: [value; 3] },
        ] {
            writer.write(&sample(ns, reading)).unwrap();
            most_buffered = most_buffered.max(writer.n_buffered_bytes());
        }
    }
    writer.finish().unwrap();
    assert!(most_buffered < 300 * 1024, "{most_buffered} bytes");
    assert!(sink.n_flushes >= 3_600 && sink.most_unflushed < 2 * 1024 * 1024);
    assert!(sink.n_bytes < 500_000_000, "{} bytes", sink.n_bytes);
}

#[test]
fn reading_holds_one_chunk() {
    let records: Vec<_> = (0..200_000)
        .map(|tick| sample(tick * 5_000_000, Reading::SpecificForce([tick as f32 * 0.01; 3])))
        .collect();
    let file = write_all(&records);
    let mut reader = RecordingReader::new(&file[..], "walk.mcap");
    let mut n_read = 0;
    while let Some(record) = reader.next() {
        assert_eq!(record.unwrap(), records[n_read]);
        assert!(reader.n_buffered_bytes() < 256 * 1024);
        n_read += 1;
    }
    assert_eq!(n_read, records.len());
}

#[test]
fn a_full_disk_is_an_error_each_time() {
    struct Full(usize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let error = RecordingWriter::new(Full(20), "walk.mcap", &info()).unwrap_err();
    assert!(error.is_io() && error.to_string().starts_with("walk.mcap: cannot write"), "{error}");
    let mut writer = RecordingWriter::new(Full(1_000), "walk.mcap", &info()).unwrap();
    let record = sample(0, Reading::SpecificForce([1.0; 3]));
    (0..100).for_each(|_| writer.write(&record).unwrap());
    assert_eq!(writer.flush().unwrap_err().remedy(), "free some space and try again");
    assert!(writer.write(&record).is_err() && writer.finish().is_err());
}

#[test]
fn a_log_is_opened_by_its_content() {
    let nanos = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos();
    let dir = std::env::temp_dir().join(format!("fieldwalk-open-{}-{nanos}", std::process::id()));
    fs::create_dir_all(&dir).unwrap();
    let path = |name: &str, content: &[u8]| {
        let path = dir.join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let records = [sample(5, Reading::SpecificForce([1.0; 3])), sample(6, Reading::AngularRate([2.0; 3]))];
    let file = write_all(&records);
    let mut log = open_recording(&path("no.txt", &file)).unwrap();
    assert_eq!(log.by_ref().collect::<Result<Vec<_>, _>>().unwrap(), records);
    assert_eq!((log.floor_name(), log.losses()), (Some("F1"), Losses::default()));

    let mut log = open_recording(&path("walk.mcap", include_bytes!("fixtures/walk.txt"))).unwrap();
    assert_eq!(log.by_ref().filter(Result::is_ok).count(), 10);
    assert_eq!(log.floor_name(), Some("F1"));

    let mut cut = open_recording(&path("cut", &file[..5])).unwrap();
    assert!(cut.next().is_none() && cut.losses().was_cut);
    assert!(open_recording(&path("empty", b"")).is_err_and(|error| error.message() == "an empty file"));
    assert!(open_recording(&dir.join("none")).is_err_and(|error| error.is_not_found()));
    let foreign = open_recording(&path("foreign", b"PNG")).unwrap().next().unwrap().unwrap_err();
    assert_eq!(foreign.path(), Some(dir.join("foreign").as_path()));
    fs::remove_dir_all(&dir).unwrap();
}
