//! A batch gives back what was put in, and takes any bytes.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::time::Timestamp;
use fieldwalk_batch::layout::{self, HEADER_BYTES, RECORDS};
use fieldwalk_batch::{BatchError, RecordFault, SampleBatch, SampleBatchWriter};
use proptest::prelude::*;

const UPDATE: &str = "FIELDWALK_UPDATE_GOLDEN";

fn batch(samples: &[Sample]) -> Vec<u8> {
    let mut writer = SampleBatchWriter::new();
    for sample in samples {
        assert!(writer.push(sample));
    }
    writer.finish()
}

fn read(bytes: &[u8]) -> Vec<Result<Sample, RecordFault>> {
    SampleBatch::new(bytes).unwrap().samples().collect()
}

fn pressure(ns: i64) -> Sample {
    Sample { time: Timestamp::from_nanos(ns), reading: Reading::Pressure { pressure_hpa: 1_013.25 } }
}

/// The bits of a sample: NaN must cross as well.
fn bits(sample: &Sample) -> String {
    let words = |v: &[f32]| v.iter().map(|x| format!("{:08x}", x.to_bits())).collect::<String>();
    let reading = match &sample.reading {
        Reading::SpecificForce(v) => format!("force {}", words(v)),
        Reading::AngularRate(v) => format!("rate {}", words(v)),
        Reading::MagneticField(v) => format!("field {}", words(v)),
        Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
            format!("uncalibrated {} {}", words(field_ut), words(bias_ut))
        }
        Reading::Pressure { pressure_hpa } => format!("pressure {}", words(&[*pressure_hpa])),
        Reading::Radio(r) => format!("radio {:?} {}", r.transmitter, words(&[r.rssi_dbm])),
        Reading::CardFrame(frame) => format!("card {frame:?}"),
        other => panic!("{other:?}"),
    };
    format!("{} {reading}", sample.time.as_nanos())
}

fn any_f32() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

fn any_vector() -> impl Strategy<Value = [f32; 3]> {
    [any_f32(), any_f32(), any_f32()]
}

fn any_sample() -> impl Strategy<Value = Sample> {
    let transmitter = prop_oneof![
        any::<[u8; 6]>().prop_map(TransmitterId::BleAddress),
        any::<[u8; 6]>().prop_map(TransmitterId::WifiBssid),
        any::<([u8; 16], u16, u16)>().prop_map(|(uuid, major, minor)| TransmitterId::Ibeacon {
            uuid,
            major,
            minor
        }),
    ];
    let reading = prop_oneof![
        any_vector().prop_map(Reading::SpecificForce),
        any_vector().prop_map(Reading::AngularRate),
        any_vector().prop_map(Reading::MagneticField),
        (any_vector(), any_vector())
            .prop_map(|(field_ut, bias_ut)| Reading::UncalibratedMagneticField { field_ut, bias_ut }),
        any_f32().prop_map(|pressure_hpa| Reading::Pressure { pressure_hpa }),
        any::<[u8; 31]>().prop_map(Reading::CardFrame),
        (transmitter, any_f32())
            .prop_map(|(transmitter, rssi_dbm)| Reading::Radio(RadioSighting { transmitter, rssi_dbm })),
    ];
    (any::<i64>(), reading).prop_map(|(ns, reading)| Sample { time: Timestamp::from_nanos(ns), reading })
}

proptest! {
    #[test]
    fn every_sample_survives_to_the_bit(samples in proptest::collection::vec(any_sample(), 0..40)) {
        let back = read(&batch(&samples));
        let bits_back: Vec<String> = back.iter().map(|sample| bits(&sample.unwrap())).collect();
        prop_assert_eq!(bits_back, samples.iter().map(bits).collect::<Vec<_>>());
    }

    #[test]
    fn damage_costs_no_earlier_sample(
        samples in proptest::collection::vec(any_sample(), 1..20), at in 0.0..1.0f64, to in any::<u8>(),
    ) {
        let mut bytes = batch(&samples);
        let at = HEADER_BYTES + (at * (bytes.len() - HEADER_BYTES) as f64) as usize;
        bytes[at] = to;
        let back = read(&bytes);
        // One item a record, and one for what stands after the last where a record has become shorter.
        prop_assert!((samples.len()..=samples.len() + 1).contains(&back.len()));
        let mut end = HEADER_BYTES;
        for (sample, found) in samples.iter().zip(&back) {
            end += batch(&[*sample]).len() - HEADER_BYTES;
            if end > at {
                break;
            }
            prop_assert_eq!(bits(&found.unwrap()), bits(sample));
        }
    }

    #[test]
    fn any_bytes_are_read_to_an_end(bytes in proptest::collection::vec(any::<u8>(), 0..400), header: bool) {
        let mut bytes = bytes;
        if header && bytes.len() >= HEADER_BYTES {
            let n_bytes = bytes.len() as u32;
            bytes[..HEADER_BYTES].copy_from_slice(&batch(&[])[..HEADER_BYTES]);
            bytes[layout::N_RECORDS_AT] = n_bytes.min(20) as u8;
            bytes[layout::N_BYTES_AT..][..4].copy_from_slice(&n_bytes.to_le_bytes());
        }
        if let Ok(batch) = SampleBatch::new(&bytes) {
            let n = batch.samples().count() as u32;
            prop_assert!(n == batch.n_records() || n == batch.n_records() + 1);
        }
    }
}

#[test]
fn the_bytes_are_those_of_the_layout() {
    let time = Timestamp::from_nanos(0x0807_0605_0403_0201);
    let transmitter = TransmitterId::Ibeacon { uuid: *b"0123456789abcdef", major: 0x0a0b, minor: 3 };
    let reading = Reading::Radio(RadioSighting { transmitter, rssi_dbm: -64.0 });
    let bytes = batch(&[Sample { time, reading }]);
    let mut expected = b"FWSB\x01\0\x01\0\0\0\x30\0\0\0".to_vec();
    expected.extend(b"\x07\x22\x01\x02\x03\x04\x05\x06\x07\x08\0\0\x80\xc20123456789abcdef\x0b\x0a\x03\0");
    assert_eq!(bytes, expected);
}

#[test]
fn codes_and_names_are_given_once_and_lengths_fit_a_byte() {
    for (k, record) in RECORDS.iter().enumerate() {
        assert_eq!(usize::from(record.code), k + 1, "{}", record.name);
        assert!(u8::try_from(record.n_bytes()).is_ok(), "{}", record.name);
        assert!(!RECORDS[..k].iter().any(|other| other.name == record.name), "{}", record.name);
    }
}

#[test]
fn a_batch_with_a_wrong_header_is_refused_whole() {
    let good = batch(&[pressure(1), pressure(2)]);
    let refusal = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.clone();
        change(&mut bytes);
        SampleBatch::new(&bytes).err()
    };
    assert_eq!(refusal(&|bytes| bytes.clear()), Some(BatchError::NotABatch));
    assert_eq!(refusal(&|bytes| bytes[0] = b'X'), Some(BatchError::NotABatch));
    assert_eq!(refusal(&|bytes| bytes[4] = 0), Some(BatchError::NotABatch));
    assert_eq!(refusal(&|bytes| bytes[4] = 2), Some(BatchError::NewerVersion { found: 2 }));
    assert_eq!(refusal(&|bytes| bytes[6..10].fill(0xff)), Some(BatchError::NotABatch));
    assert_eq!(refusal(&|bytes| bytes.push(0)), Some(BatchError::Torn));
    for length in layout::MAGIC.len()..good.len() {
        assert_eq!(refusal(&|bytes| bytes.truncate(length)), Some(BatchError::Torn), "{length}");
    }
    assert_eq!(refusal(&|_| {}), None);
}

#[test]
fn a_bad_record_is_a_fault_and_its_neighbours_are_read() {
    let mut bytes = batch(&[pressure(1), pressure(2), pressure(3)]);
    let second = HEADER_BYTES + layout::PRESSURE.n_bytes();
    bytes[second] = 200;
    assert_eq!(read(&bytes), [Ok(pressure(1)), Err(RecordFault::UnknownKind), Ok(pressure(3))]);
    bytes[second] = layout::ANGULAR_RATE.code;
    assert_eq!(read(&bytes), [Ok(pressure(1)), Err(RecordFault::Malformed), Ok(pressure(3))]);
    bytes[second + 1] = 3;
    assert_eq!(
        read(&bytes),
        [Ok(pressure(1)), Err(RecordFault::Malformed), Err(RecordFault::Malformed)],
        "no way past a record whose length is too small"
    );
    let mut bytes = batch(&[pressure(1), pressure(2)]);
    bytes[layout::N_RECORDS_AT] = 1;
    assert_eq!(read(&bytes), [Ok(pressure(1)), Err(RecordFault::Malformed)], "bytes after the last record");
}

#[test]
fn the_document_shows_the_layout() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../BATCH.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (head, _) = text.split_once("\n### ").expect("BATCH.md has the records' tables");
    let whole = format!("{head}\n{}\n", layout::markdown().trim_end());
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        std::fs::write(&path, &whole).unwrap();
        return;
    }
    assert!(
        text == whole,
        "BATCH.md differs: {UPDATE}=1 cargo test -p fieldwalk-batch, then check the result"
    );
}
