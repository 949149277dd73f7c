//! Writes what the bindings of every language are tested with into the folder given: a simulated building's map, one
//! walk there, and the same samples in two shapes.
//!
//! | file | content |
//! |---|---|
//! | `map/` | the map, of one floor |
//! | `plan.geojson` | its plan |
//! | `walk.txt` | the walk as a log that `fieldwalk replay` reads |
//! | `walk.samples` | its records in order of time, for encoders: a record a line, fields separated by spaces |
//! | `card.samples` | the frames of a card that the walker would have worn: the phone's samples read as a card's |
//! | `walk.batch` | its samples in one batch, by the encoder for Rust |
//! | `kinds.samples`, `kinds.batch` | a few samples of every kind, whole range of numbers |
//!
//! A line of a `.samples` file is the time in nanoseconds, the record's name in `bindings/BATCH.md` and its fields:
//! f32 as the eight hexadecimal digits of their bits, bytes in hexadecimal digits, the rest in decimal. The name
//! `waypoint` has two f64 (sixteen digits each): the walker stood there.
#![allow(clippy::expect_used, clippy::panic, reason = "a test's fixture fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::card::CardEmulator;
use fieldwalk::geometry::Point2;
use fieldwalk::map::BuildingMap;
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::survey::{SurveyParams, SurveyWalk, build_floor};
use fieldwalk::time::Timestamp;
use fieldwalk_batch::SampleBatchWriter;
use fieldwalk_formats::ilc::TraceReader;
use fieldwalk_formats::recording::Record;
use fieldwalk_formats::write_building;
use fieldwalk_sim::building::{Aisle, GridBuilding};
use fieldwalk_sim::magnetic_field::SteelParams;
use fieldwalk_sim::scenario::{Recorded, Scenario};

const SEED: u64 = 11;
/// Added to the simulator's times: logs count milliseconds since 1970.
const EPOCH_MS: i64 = 1_700_000_000_000;

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).expect("usage: walk_for_bindings FOLDER"));
    fs::create_dir_all(&folder).expect("the folder can be made");
    let write = |name: &str, content: &[u8]| {
        fs::write(folder.join(name), content).unwrap_or_else(|error| panic!("{name}: {error}"));
    };
    let scenario = Scenario::of_building(office().build(), &SteelParams::default(), SEED);
    let plan = &scenario.building.plan;
    write("plan.geojson", fieldwalk_formats::write_plan(plan).as_bytes());
    let walks: Vec<SurveyWalk> =
        scenario.survey_walks().iter().map(|walk| scenario.simulate(walk).survey_walk()).collect();
    let floor = build_floor("F1", 0, plan, &walks, &SurveyParams::default()).expect("the survey gives a map");
    write_building(&folder.join("map"), &BuildingMap { name: "office".into(), floors: vec![floor] })
        .expect("the map can be written");

    let walk = &scenario.test_walks(1, 60.0)[0];
    let recorded = scenario.simulate(walk);
    write("walk.txt", log_of(&recorded).as_bytes());
    let records = read_log(&folder.join("walk.txt"));
    write("walk.samples", lines(&records).as_bytes());
    write("walk.batch", &batch(&records));

    write("card.samples", lines(&card_frames(&records)).as_bytes());

    let kinds = samples_of_every_kind();
    write("kinds.samples", lines(&kinds).as_bytes());
    write("kinds.batch", &batch(&kinds));
}

/// A small building: a ring of corridors.
fn office() -> GridBuilding {
    let aisle = |centre_m| Aisle { centre_m, width_m: 1.6 };
    GridBuilding {
        width_m: 26.0,
        height_m: 20.0,
        columns: vec![aisle(5.0), aisle(21.0)],
        rows: vec![aisle(5.0), aisle(15.0)],
        halls: Vec::new(),
        lifts: Vec::new(),
        ..GridBuilding::office()
    }
}

fn log_ms(time: Timestamp) -> i64 {
    EPOCH_MS + time.as_nanos() / 1_000_000
}

/// The walk as a log, a waypoint after the samples of its instant; a replay holds back a bounded number of records, so
/// they stand in order of time.
fn log_of(walk: &Recorded) -> String {
    let mut log = String::from("#\tstartTime:1700000000000\n");
    let mut waypoints = walk.waypoints.iter().peekable();
    let mut push_waypoints_before = |log: &mut String, ms: i64| {
        while let Some(waypoint) = waypoints.next_if(|waypoint| log_ms(waypoint.time) < ms) {
            let Point2 { x_m, y_m } = waypoint.point;
            writeln!(log, "{}\tTYPE_WAYPOINT\t{x_m}\t{y_m}", log_ms(waypoint.time)).expect("memory");
        }
    };
    for sample in &walk.samples {
        push_waypoints_before(&mut log, log_ms(sample.time));
        push_log_line(&mut log, sample);
    }
    push_waypoints_before(&mut log, i64::MAX);
    log
}

fn push_log_line(log: &mut String, sample: &Sample) {
    let ms = log_ms(sample.time);
    let vector = |[x, y, z]: [f32; 3]| format!("{x}\t{y}\t{z}");
    let hex = |address: [u8; 6]| address.map(|byte| format!("{byte:02x}")).join(":");
    let line = match sample.reading {
        Reading::SpecificForce(force) => format!("ACCELEROMETER\t{}\t3", vector(force)),
        Reading::AngularRate(rate) => format!("GYROSCOPE\t{}\t3", vector(rate)),
        Reading::MagneticField(field) => format!("MAGNETIC_FIELD\t{}\t3", vector(field)),
        Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
            format!("MAGNETIC_FIELD_UNCALIBRATED\t{}\t{}\t3", vector(field_ut), vector(bias_ut))
        }
        Reading::Pressure { pressure_hpa } => format!("PRESSURE\t{pressure_hpa}\t3"),
        Reading::Radio(RadioSighting { transmitter, rssi_dbm }) => match transmitter {
            TransmitterId::WifiBssid(bssid) => format!("WIFI\t-\t{}\t{rssi_dbm}\t2412\t{ms}", hex(bssid)),
            TransmitterId::BleAddress(address) => {
                format!("BEACON\t-\t-\t-\t-59\t{rssi_dbm}\t1\t{}\t{ms}", hex(address))
            }
            TransmitterId::Ibeacon { uuid, major, minor } => {
                let uuid: String = uuid.iter().map(|byte| format!("{byte:02x}")).collect();
                format!("BEACON\t{uuid}\t{major}\t{minor}\t-59\t{rssi_dbm}\t1\t-\t{ms}")
            }
            other => panic!("{other:?} in a log"),
        },
        other => panic!("{other:?} in a log"),
    };
    writeln!(log, "{ms}\tTYPE_{line}").expect("memory takes every line");
}

/// The log's records in the order in which a replay takes them.
fn read_log(path: &Path) -> Vec<Record> {
    let mut reader = TraceReader::open(path).expect("the log can be read");
    let mut records: Vec<Record> = reader.by_ref().map(|record| record.expect("a record")).collect();
    assert_eq!(reader.rejections().total(), 0, "every line written is read");
    records.sort_by_key(|record| (record.time(), matches!(record, Record::Waypoint { .. })));
    records
}

fn card_frames(records: &[Record]) -> Vec<Record> {
    let mut card = CardEmulator::default();
    let frame_of = |record: &Record| {
        let Record::Sample(sample) = record else { return None };
        let frame = card.push(sample)?;
        Some(Record::Sample(Sample { time: sample.time, reading: Reading::CardFrame(frame) }))
    };
    records.iter().filter_map(frame_of).collect()
}

fn samples_of_every_kind() -> Vec<Record> {
    let uuid = *b"\x00\x7f\x80\xffabcdefghijkl";
    let radio = |transmitter| Reading::Radio(RadioSighting { transmitter, rssi_dbm: -63.5 });
    let readings = [
        Reading::SpecificForce([0.0, -0.0, 9.806_65]),
        Reading::AngularRate([f32::MIN_POSITIVE, -1e-45, f32::MAX]),
        Reading::MagneticField([f32::INFINITY, f32::NEG_INFINITY, f32::NAN]),
        Reading::UncalibratedMagneticField { field_ut: [1.0, 2.0, 3.0], bias_ut: [-4.0, -5.0, -6.0] },
        Reading::Pressure { pressure_hpa: 1_013.25 },
        radio(TransmitterId::BleAddress([0xff, 0x80, 0x7f, 1, 2, 0])),
        radio(TransmitterId::Ibeacon { uuid, major: u16::MAX, minor: 0x8001 }),
        radio(TransmitterId::WifiBssid([0, 1, 2, 3, 4, 255])),
        Reading::CardFrame(core::array::from_fn(|k| 0xf0 + k as u8 % 16)),
    ];
    let times_ns = [i64::MIN, -1, 0, 1, 1_234_567_890_123_456_789, i64::MAX - 1, i64::MAX, 42, 43];
    let samples = times_ns.into_iter().zip(readings);
    samples.map(|(ns, reading)| Record::Sample(Sample { time: Timestamp::from_nanos(ns), reading })).collect()
}

fn batch(records: &[Record]) -> Vec<u8> {
    let mut writer = SampleBatchWriter::new();
    for record in records {
        if let Record::Sample(sample) = record {
            assert!(writer.push(sample), "{sample:?}");
        }
    }
    writer.finish()
}

fn lines(records: &[Record]) -> String {
    records.iter().map(|record| format!("{} {}\n", record.time().as_nanos(), fields(record))).collect()
}

fn fields(record: &Record) -> String {
    let bits = |numbers: &[f32]| {
        numbers.iter().map(|number| format!(" {:08x}", number.to_bits())).collect::<String>()
    };
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let sample = match record {
        Record::Sample(sample) => sample,
        Record::Waypoint { point, .. } => {
            return format!("waypoint {:016x} {:016x}", point.x_m.to_bits(), point.y_m.to_bits());
        }
    };
    match &sample.reading {
        Reading::SpecificForce(force) => format!("specific_force{}", bits(force)),
        Reading::AngularRate(rate) => format!("angular_rate{}", bits(rate)),
        Reading::MagneticField(field) => format!("magnetic_field{}", bits(field)),
        Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
            format!("uncalibrated_magnetic_field{}{}", bits(field_ut), bits(bias_ut))
        }
        Reading::Pressure { pressure_hpa } => format!("pressure{}", bits(&[*pressure_hpa])),
        Reading::Radio(RadioSighting { transmitter, rssi_dbm }) => {
            let rssi = bits(&[*rssi_dbm]);
            match transmitter {
                TransmitterId::BleAddress(address) => format!("ble_sighting{rssi} {}", hex(address)),
                TransmitterId::Ibeacon { uuid, major, minor } => {
                    format!("ibeacon_sighting{rssi} {} {major} {minor}", hex(uuid))
                }
                TransmitterId::WifiBssid(bssid) => format!("wifi_sighting{rssi} {}", hex(bssid)),
                other => panic!("{other:?} has no name"),
            }
        }
        Reading::CardFrame(frame) => format!("card_frame {}", hex(frame)),
        other => panic!("{other:?} has no name"),
    }
}
