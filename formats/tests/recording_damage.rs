//! Recordings cut, damaged, or not ours.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::{self, Cursor, Read};

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::recording::{Losses, Record, RecordingInfo, RecordingReader, RecordingWriter};
use mcap::records::op;

fn read_all(file: impl Read) -> (Vec<Record>, Losses, Option<FormatError>) {
    let mut reader = RecordingReader::new(file, "walk.mcap");
    let (mut records, mut last_error) = (Vec::new(), None);
    for item in reader.by_ref() {
        match item {
            Ok(record) => records.push(record),
            Err(error) => last_error = Some(error),
        }
    }
    (records, *reader.losses(), last_error)
}

/// Twelve seconds of two sensors.
fn walk() -> Vec<Record> {
    let sample = |ns: i64, reading| Record::Sample(Sample { time: Timestamp::from_nanos(ns), reading });
    (0..600_i64)
        .flat_map(|tick| {
            let value = tick as f32 * 0.37;
            [
                sample(tick * 20_000_000, Reading::SpecificForce([value, -value, 9.81])),
                sample(tick * 20_000_000, Reading::MagneticField([value, 20.0, -40.5])),
            ]
        })
        .collect()
}

fn recording(records: &[Record]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "walk.mcap", &RecordingInfo::default()).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    writer.finish().unwrap();
    file
}

/// Where each chunk begins and ends, and how many messages it holds: by another reader.
fn chunks(file: &[u8]) -> Vec<(usize, usize, usize)> {
    let summary = mcap::Summary::read(file).unwrap().unwrap();
    let chunks = summary.chunk_indexes.iter().map(|index| {
        let start = index.chunk_start_offset as usize;
        let n_messages = summary.stream_chunk(file, index).unwrap().count();
        (start, start + index.chunk_length as usize, n_messages)
    });
    chunks.collect()
}

/// A seeded sequence of numbers.
struct Noise(u64);

impl Noise {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }
}

#[test]
fn a_cut_file_gives_its_whole_chunks() {
    let records = walk();
    let file = recording(&records);
    let chunks = chunks(&file);
    assert_eq!(chunks.iter().map(|chunk| chunk.2).sum::<usize>(), records.len());
    assert!(chunks.len() >= 12);
    let mut noise = Noise(7);
    let random = (0..1_000).map(|_| noise.below(file.len()));
    let edges =
        chunks.iter().flat_map(|&(start, end, _)| [start - 1, start, start + 1, end - 1, end, end + 1]);
    for cut in random.collect::<Vec<_>>().into_iter().chain(edges).chain([0, 1, 7, 8, file.len() - 1]) {
        let n_expected: usize = chunks.iter().filter(|&&(_, end, _)| end <= cut).map(|&(_, _, n)| n).sum();
        let (read, losses, error) = read_all(&file[..cut]);
        assert!(error.is_none(), "cut at {cut}: {error:?}");
        assert_eq!(read, records[..n_expected], "cut at {cut}");
        assert_eq!(losses, Losses { was_cut: true, ..Losses::default() }, "cut at {cut}");
    }
    assert_eq!(read_all(&file[..]).1, Losses::default());
}

#[test]
fn a_damaged_chunk_is_left_out_and_counted() {
    let records = walk();
    let file = recording(&records);
    let chunks = chunks(&file);
    let mut first_record = 0;
    for &(start, end, n_messages) in &chunks {
        // The first chunk declares the channels: even without it the others are read.
        for at in [start + 9 + 24, start + 60, (start + end) / 2, end - 1] {
            let mut damaged = file.clone();
            damaged[at] ^= 0x10;
            let (read, losses, error) = read_all(&damaged[..]);
            assert!(error.is_none());
            assert_eq!(losses, Losses { n_corrupt_chunks: 1, ..Losses::default() }, "byte {at}");
            let kept = [&records[..first_record], &records[first_record + n_messages..]].concat();
            assert_eq!(read, kept, "byte {at}");
        }
        first_record += n_messages;
    }
}

#[test]
fn any_damaged_byte_gives_nothing_that_was_not_written() {
    let records = walk();
    let file = recording(&records);
    let mut noise = Noise(11);
    for _ in 0..2_000 {
        let mut damaged = file.clone();
        let at = noise.below(file.len());
        damaged[at] ^= 1 << noise.below(8);
        let (read, ..) = read_all(&damaged[..]);
        let mut written = records.iter();
        assert!(read.iter().all(|record| written.any(|w| w == record)), "byte {at}");
    }
}

/// An MCAP file of one chunk that `fill` fills.
fn crafted(fill: impl FnOnce(&mut mcap::Writer<Cursor<&mut Vec<u8>>>)) -> Vec<u8> {
    let mut file = Vec::new();
    let options = mcap::WriteOptions::new().compression(None).profile("ros2");
    let mut writer = options.create(Cursor::new(&mut file)).unwrap();
    fill(&mut writer);
    writer.finish().unwrap();
    drop(writer);
    file
}

fn message(writer: &mut mcap::Writer<Cursor<&mut Vec<u8>>>, channel_id: u16, log_time: u64, json: &str) {
    let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time, publish_time: 0 };
    writer.write_to_known_channel(&header, json.as_bytes()).unwrap();
}

#[test]
fn another_programs_file_is_refused() {
    let foreign = crafted(|writer| {
        let schema = writer.add_schema("sensor_msgs/Imu", "ros2msg", b"").unwrap();
        let channel = writer.add_channel(schema, "/specific_force", "cdr", &Default::default()).unwrap();
        message(writer, channel, 1, "{}");
    });
    for file in [foreign, crafted(|_| {})] {
        let (read, _, error) = read_all(&file[..]);
        assert!(read.is_empty());
        let text = error.unwrap().to_string();
        assert!(text.starts_with("walk.mcap: not a recording of Fieldwalk's"), "{text}");
    }
    let (_, _, error) = read_all(&b"PK\x03\x04 and so on"[..]);
    assert_eq!(error.unwrap().message(), "not an MCAP file");
}

#[test]
fn other_channels_are_passed_over_and_bad_messages_counted() {
    let file = crafted(|writer| {
        let schema = writer.add_schema("fieldwalk.Pressure", "jsonschema", b"{}").unwrap();
        let ours = writer.add_channel(schema, "/pressure", "json", &Default::default()).unwrap();
        let other = writer.add_channel(0, "/camera", "json", &Default::default()).unwrap();
        message(writer, ours, 1, r#" {"extra": [1, {"a": null}], "pressure_hpa": 1013} "#);
        message(writer, other, 2, r#"{"pressure_hpa": 1}"#);
        for bad in [
            "",
            "{}",
            "[]",
            "nonsense",
            r#"{"pressure_hpa": null}"#,
            r#"{"pressure_hpa": "1"}"#,
            r#"{"pressure_hpa": 1e39}"#,
            r#"{"pressure_hpa": 1} x"#,
            r#"{"not_finite": {"pressure_hpa": "nan"}}"#,
            r#"{"pressure_hpa": 1, "time_ns": 1e30}"#,
        ] {
            message(writer, ours, 3, bad);
        }
        message(writer, ours, u64::MAX, r#"{"pressure_hpa": 1}"#);
        message(writer, ours, 4, r#"{"pressure_hpa": 1000.5, "time_ns": -3}"#);
    });
    let (read, losses, error) = read_all(&file[..]);
    assert!(error.is_none());
    let pressure = |ns, pressure_hpa| {
        let reading = Reading::Pressure { pressure_hpa };
        Record::Sample(Sample { time: Timestamp::from_nanos(ns), reading })
    };
    assert_eq!(read, [pressure(1, 1_013.0), pressure(-3, 1_000.5)]);
    assert_eq!(losses, Losses { n_malformed: 11, n_foreign_messages: 1, ..Losses::default() });
}

#[test]
fn a_newer_version_is_told() {
    let file = crafted(|writer| {
        let metadata = [("format_version".to_owned(), "2".to_owned())].into();
        writer.write_metadata(&mcap::records::Metadata { name: "fieldwalk".to_owned(), metadata }).unwrap();
    });
    assert!(read_all(&file[..]).2.unwrap().is_newer_version());
}

fn framed(opcode: u8, len: u64, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &len.to_le_bytes(), body].concat()
}

fn chunk(size: u64, compression: &str, records: &[u8]) -> Vec<u8> {
    let body = [
        &[0; 16][..],
        &size.to_le_bytes(),
        &[0; 4],
        &(compression.len() as u32).to_le_bytes(),
        compression.as_bytes(),
        &(records.len() as u64).to_le_bytes(),
        records,
    ]
    .concat();
    framed(op::CHUNK, body.len() as u64, &body)
}

#[test]
fn lengths_that_lie_take_no_memory() {
    let own = recording(&[]);
    let head = &own[..own.len() - chunks_end(&own)];
    let message = framed(op::MESSAGE, 5, &[0; 5]);
    let huge = framed(op::MESSAGE, u64::MAX, &[0; 30]);
    // What follows the head, chunks corrupt, entries malformed, whether an error comes, whether it was cut.
    let cases: &[(Vec<u8>, u64, u64, bool)] = &[
        (framed(op::CHUNK, u64::MAX, b"x"), 0, 0, true),
        (framed(op::ATTACHMENT, u64::MAX, b"x"), 0, 0, false),
        (framed(op::CHUNK, 10_000_000, b"x"), 0, 0, false),
        (framed(op::CHUNK, 1, b"x"), 1, 0, false),
        (chunk(u64::MAX, "", &message), 1, 0, false),
        (chunk(1 << 40, "zstd", &message), 1, 0, false),
        (chunk(3, "snappy", &message), 1, 0, false),
        (chunk(message.len() as u64, "", &message), 0, 1, false),
        (chunk(huge.len() as u64, "", &huge), 0, 1, false),
        (framed(0x7f, 3, b"abc"), 0, 0, false),
    ];
    for (index, (tail, n_corrupt_chunks, n_malformed, is_error)) in cases.iter().enumerate() {
        let file = [head, tail].concat();
        let mut reader = RecordingReader::new(&file[..], "walk.mcap");
        let items: Vec<_> = reader.by_ref().collect();
        assert_eq!(items.iter().any(Result::is_err), *is_error, "case {index}");
        assert!(items.iter().all(Result::is_err), "case {index}");
        let losses = reader.losses();
        assert_eq!(
            (losses.n_corrupt_chunks, losses.n_malformed),
            (*n_corrupt_chunks, *n_malformed),
            "case {index}"
        );
        assert_eq!(losses.was_cut, !is_error, "case {index}");
        assert!(reader.n_buffered_bytes() < 4_096, "case {index}");
    }
}

/// How many bytes of a recording without records lie behind its data: from `DataEnd` on.
fn chunks_end(file: &[u8]) -> usize {
    let mut at = mcap::MAGIC.len();
    while file[at] != op::DATA_END {
        at += 9 + u64::from_le_bytes(file[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    file.len() - at
}

#[test]
fn a_failing_disk_is_an_error() {
    struct Failing;
    impl Read for Failing {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("bad sector"))
        }
    }
    let records = walk();
    let file = recording(&records);
    let (_, end, n_messages) = chunks(&file)[0];
    let (read, losses, error) = read_all((&file[..end]).chain(Failing));
    assert_eq!((read.len(), losses), (n_messages, Losses::default()));
    assert_eq!(error.unwrap().to_string(), "walk.mcap: cannot read the recording: bad sector");
}

#[cfg(feature = "compression")]
#[test]
fn compressed_recordings_are_read_whole_cut_and_damaged() {
    let records = walk();
    let mut file = Vec::new();
    let mut writer =
        RecordingWriter::new_compressed(&mut file, "walk.mcap", &RecordingInfo::default()).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    writer.finish().unwrap();
    assert!(file.len() * 2 < recording(&records).len());
    assert_eq!(read_all(&file[..]).0, records);
    for (start, end, n_messages) in chunks(&file) {
        let (read, losses, error) = read_all(&file[..end]);
        assert!(error.is_none() && losses.was_cut && read == records[..read.len()]);
        let mut damaged = file.clone();
        damaged[(start + end) / 2] ^= 0x10;
        let (read, losses, error) = read_all(&damaged[..]);
        assert!(error.is_none() && losses.n_corrupt_chunks == 1);
        assert_eq!(read.len(), records.len() - n_messages);
    }
    let lz4 = crafted_lz4();
    assert_eq!(read_all(&lz4[..]).0.len(), 1);
}

#[cfg(feature = "compression")]
fn crafted_lz4() -> Vec<u8> {
    let mut file = Vec::new();
    let options = mcap::WriteOptions::new().compression(Some(mcap::Compression::Lz4));
    let mut writer = options.create(Cursor::new(&mut file)).unwrap();
    let schema = writer.add_schema("fieldwalk.Pressure", "jsonschema", b"{}").unwrap();
    let ours = writer.add_channel(schema, "/pressure", "json", &Default::default()).unwrap();
    message(&mut writer, ours, 1, r#"{"pressure_hpa": 1013}"#);
    writer.finish().unwrap();
    drop(writer);
    file
}

#[cfg(not(feature = "compression"))]
#[test]
fn a_build_without_decompressors_says_so() {
    let own = recording(&[]);
    let head = &own[..own.len() - chunks_end(&own)];
    let file = [head, &chunk(3, "zstd", b"abc")].concat();
    let error = read_all(&file[..]).2.unwrap();
    assert!(error.message().starts_with("compressed with zstd"), "{error}");
}
