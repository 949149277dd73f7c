//! Exports of Sensor Logger, by hand-written rows.
#![allow(clippy::unwrap_used, clippy::panic)]

mod text_log;

use std::fs;

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{Reading, TransmitterId};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::ilc::{LineFault, LineRejections};
use fieldwalk_formats::recording::RecordSource;
use fieldwalk_formats::sensor_logger::SensorLoggerReader;
use fieldwalk_formats::{FormatError, Record, open_recording};
use proptest::prelude::*;
use text_log::{radio, read_all, sample_at_ns};

/// When the recordings below began.
const T0: i64 = 1_698_501_144_400_000_000;

const ANDROID: &str = "version,device name,recording epoch time,platform,appVersion,standardisation\n\
                       3,Pixel 8,1698501144400,android,1.40,false\n";

/// A file of vectors: the app writes z before y before x.
fn vectors(rows: &[(i64, [f64; 3])]) -> String {
    let rows = rows.iter().map(|(ns, [x, y, z])| format!("{},0.0,{z},{y},{x}\n", T0 + ns));
    "time,seconds_elapsed,z,y,x\n".to_owned() + &rows.collect::<String>()
}

fn folder(files: &[(&str, &str)]) -> Result<SensorLoggerReader, FormatError> {
    let files = files.iter().map(|(name, text)| (format!("{name}.csv"), text.as_bytes().to_vec()));
    SensorLoggerReader::in_memory(files.collect(), "export")
}

fn json(text: &str) -> Result<SensorLoggerReader, FormatError> {
    SensorLoggerReader::in_memory(vec![("export.json".into(), text.into())], "export.json")
}

fn records(reader: Result<SensorLoggerReader, FormatError>) -> (Vec<Record>, LineRejections) {
    let (records, rejections, error) = read_all(reader.unwrap());
    assert!(error.is_none(), "{error:?}");
    (records, rejections)
}

/// The only specific force of an export.
fn force(reader: Result<SensorLoggerReader, FormatError>) -> [f32; 3] {
    match records(reader).0[..] {
        [Record::Sample(sample)] => match sample.reading {
            Reading::SpecificForce(force) => force,
            other => panic!("{other:?}"),
        },
        ref other => panic!("{other:?}"),
    }
}

fn metadata(platform: &str, version: &str, standardisation: &str) -> String {
    format!("version,platform,appVersion,standardisation\n3,{platform},{version},{standardisation}\n")
}

#[test]
fn a_folder_is_merged_by_time() {
    let (total, gyroscope) = (
        vectors(&[(10, [-0.5, 1.75, 9.75]), (30, [0.0, 0.0, 9.5])]),
        vectors(&[(10, [0.5, 0.25, -0.125]), (20, [0.0, 0.0, 1.0])]),
    );
    let magnetometer = vectors(&[(15, [29.5, 6.25, -30.0]), (16, [0.0, 0.0, 0.0])]);
    let uncalibrated = vectors(&[(15, [129.5, 6.25, -30.0])]);
    let barometer = format!("time,seconds_elapsed,relativeAltitude,pressure\n{},0.1,0,1013.25\n", T0 + 25);
    let bluetooth = format!(
        "time,seconds_elapsed,id,rssi,txPowerLevel,manufacturerData\n\
         {},0.1,DB:08:D3:33:38:EF,-79,,99040512\n\
         {},0.1,DB:08:D3:33:38:EF,-71,,4C0002159195B3ADA9D0450085FF9FB0F65A520100030028C5\n\
         {},0.1,DB:08:D3:33:38:EF,null,,\n",
        T0 + 40,
        T0 + 41,
        T0 + 42
    );
    let wifi = format!(
        "time,seconds_elapsed,ssid,bssid,frequency,level\n{},0.1,\"guests, 2\",a8:0c:ca:03:9d:d7,2412,-49\n",
        T0 + 50
    );
    let annotation = format!(
        "time,seconds_elapsed,text,millisecond_press_duration\n{},1,door,80\n{},1,\"12.5, -40\",80\n\
         {},1,12.5 40,80\n{},1,\"1250000, 40\",80\n",
        T0 + 60,
        T0 + 61,
        T0 + 62,
        T0 + 63
    );
    let reader = folder(&[
        ("Metadata", ANDROID),
        ("TotalAcceleration", &total),
        ("Accelerometer", &vectors(&[(10, [9.0, 9.0, 9.0])])),
        ("Gyroscope", &gyroscope),
        ("Magnetometer", &magnetometer),
        ("MagnetometerUncalibrated", &uncalibrated),
        ("Barometer", &barometer),
        ("bluetooth-DB08D33338EF", &bluetooth),
        ("WiFi", &wifi),
        ("Annotation", &annotation),
        ("Location", "time,seconds_elapsed,altitude\n1,2,3\n"),
    ]);
    let info = reader.as_ref().unwrap().info();
    assert_eq!((info.device.as_str(), info.software.as_str()), ("Pixel 8", "Sensor Logger 1.40"));
    assert_eq!(info.start_unix_ms, Some(1_698_501_144_400));
    let (records, rejections) = records(reader);
    let uuid = [0x91, 0x95, 0xb3, 0xad, 0xa9, 0xd0, 0x45, 0, 0x85, 0xff, 0x9f, 0xb0, 0xf6, 0x5a, 0x52, 1];
    let at = |ns, reading| sample_at_ns(T0 + ns, reading);
    let expected = [
        at(10, Reading::AngularRate([0.5, 0.25, -0.125])),
        at(10, Reading::SpecificForce([-0.5, 1.75, 9.75])),
        at(15, Reading::MagneticField([29.5, 6.25, -30.0])),
        at(20, Reading::AngularRate([0.0, 0.0, 1.0])),
        at(25, Reading::Pressure { pressure_hpa: 1013.25 }),
        at(30, Reading::SpecificForce([0.0, 0.0, 9.5])),
        at(40, radio(TransmitterId::BleAddress([0xdb, 0x08, 0xd3, 0x33, 0x38, 0xef]), -79.0)),
        at(41, radio(TransmitterId::Ibeacon { uuid, major: 3, minor: 40 }, -71.0)),
        at(50, radio(TransmitterId::WifiBssid([0xa8, 0x0c, 0xca, 3, 0x9d, 0xd7]), -49.0)),
        Record::Waypoint { time: Timestamp::from_nanos(T0 + 61), point: Point2::new(12.5, -40.0) },
    ];
    assert_eq!(records, expected);
    // A field of zero and a place out of the world; a sighting without its strength; a place without its comma. That
    // `door` is none is no fault.
    assert_eq!((rejections.total(), rejections.count(LineFault::OutOfRange)), (4, 2));
    assert_eq!((rejections.count(LineFault::FieldCount), rejections.count(LineFault::Number)), (1, 1));
}

#[test]
fn gravity_and_acceleration_have_the_platforms_sign() {
    // The phone lies on a table, screen up, and is pushed to the right with 1 m/s².
    let android = (vectors(&[(0, [1.0, 0.0, 0.0])]), vectors(&[(0, [0.0, 0.0, 9.80665])]));
    let ios = (vectors(&[(0, [-1.0, 0.0, 0.0])]), vectors(&[(0, [0.0, 0.0, -9.80665])]));
    let export = |(user, gravity): &(String, String), metadata: &str| {
        folder(&[("Metadata", metadata), ("Accelerometer", user), ("Gravity", gravity)])
    };
    let expected = [1.0, 0.0, 9.80665];
    assert_eq!(force(export(&android, &metadata("android", "1.40", "false"))), expected);
    assert_eq!(force(export(&android, &metadata("android", "1.20", ""))), expected);
    assert_eq!(force(export(&android, &metadata("ios", "1.40", "true"))), expected);
    assert_eq!(force(export(&ios, &metadata("ios", "1.40", "false"))), expected);
    assert_eq!(force(export(&ios, &metadata("iOS", "1.28", ""))), expected);

    // Without the setting, the raw acceleration of iOS is in g.
    let raw = |scale: f64| vectors(&[(0, [0.0, 0.0, scale])]);
    let uncalibrated = |scale: f64, metadata: &str| {
        force(folder(&[("Metadata", metadata), ("AccelerometerUncalibrated", &raw(scale))]))
    };
    assert_eq!(uncalibrated(-1.0, &metadata("ios", "1.40", "false")), [0.0, 0.0, 9.80665]);
    assert_eq!(uncalibrated(9.5, &metadata("ios", "1.40", "true")), [0.0, 0.0, 9.5]);
    assert_eq!(uncalibrated(9.5, &metadata("android", "1.40", "false")), [0.0, 0.0, 9.5]);
    // Only Android's app logs the total.
    assert_eq!(force(folder(&[("TotalAcceleration", &raw(9.5))])), [0.0, 0.0, 9.5]);
}

#[test]
fn what_cannot_be_known_is_refused() {
    let vectors = vectors(&[(0, [0.0, 0.0, -1.0])]);
    let both = [("Accelerometer", &*vectors), ("Gravity", &*vectors)];
    let with = |metadata: &str| folder(&[&[("Metadata", metadata)][..], &both].concat());
    let said = |reader: Result<SensorLoggerReader, FormatError>| reader.unwrap_err().to_string();
    assert!(said(folder(&both)).contains("recorded on Android or on iOS"));
    for (version, standardisation) in [("1.40", ""), ("", ""), ("1.40", "maybe"), ("new", "")] {
        let said = said(with(&metadata("ios", version, standardisation)));
        assert!(said.starts_with("export: ") && said.contains("Standardise Units & Frames"), "{said}");
    }
    let android = metadata("android", "1.40", "false");
    let alone = folder(&[("Metadata", &android), ("Accelerometer", &vectors)]);
    assert!(said(alone).contains("without gravity only"));
    assert!(said(folder(&[("Metadata", &android)])).contains("none of its sensors"));
    assert!(said(folder(&[])).contains("not an export of Sensor Logger"));
    for text in ["[]", "{}", r#"[{"name": "gyroscope"}]"#, r#"{"payload": [{"sensor": "Gyroscope"}]}"#] {
        assert!(said(json(text)).contains("none of its sensors"), "{text}");
    }
    assert!(said(json("[1, 2]")).contains("byte 1 is between no two objects"));
}

#[test]
fn rows_without_a_partner_and_broken_rows_are_counted() {
    let gravity = vectors(&[(0, [0.0, 0.0, 9.75])]);
    // 20 ms later it still counts, a nanosecond more and it does not; nor did it before.
    let user = vectors(&[(-1, [0.0; 3]), (20_000_000, [0.0, 1.0, 0.0]), (20_000_001, [0.0; 3])]);
    let (read, rejections) =
        records(folder(&[("Metadata", ANDROID), ("Accelerometer", &user), ("Gravity", &gravity)]));
    assert_eq!(read, [sample_at_ns(T0 + 20_000_000, Reading::SpecificForce([0.0, 1.0, 9.75]))]);
    assert_eq!((rejections.total(), rejections.count(LineFault::Unpaired)), (2, 2));

    let uncalibrated = vectors(&[(0, [1.0, 2.0, 3.0])]);
    let (read, rejections) = records(folder(&[("MagnetometerUncalibrated", &uncalibrated)]));
    assert!(read.is_empty() && rejections.first() == Some((2, LineFault::Unpaired)));

    let long = format!("{T0},0,{},0,0", "9".repeat(100_000));
    let hidden = format!("time,id,rssi\n{T0},1B2C3D4E-0000-1111-2222-333344445555,-70\n");
    for (name, row, fault) in [
        ("Gyroscope", format!("{T0},0,0,0"), LineFault::FieldCount),
        ("Gyroscope", format!("{T0},0,0,0,0,0"), LineFault::FieldCount),
        ("Gyroscope", format!("{T0},0,,0,0"), LineFault::FieldCount),
        ("Gyroscope", "1698501144.4,0,0,0,0".into(), LineFault::Time),
        ("Gyroscope", "1698501144400,0,0,0,0".into(), LineFault::Time),
        ("Gyroscope", format!("{T0},0,x,0,0"), LineFault::Number),
        ("Gyroscope", format!("{T0},0,NaN,0,0"), LineFault::NotFinite),
        ("Gyroscope", long, LineFault::TooLong),
        ("Bluetooth", hidden, LineFault::Identity),
    ] {
        let good = vectors(&[(0, [0.0; 3])]);
        let text = if name == "Bluetooth" { row.clone() } else { format!("{good}{row}\n") };
        let (_, rejections) = records(folder(&[(name, &text)]));
        assert_eq!((rejections.total(), rejections.count(fault)), (1, 1), "{row:.80}");
    }
}

/// Three sensors one after the other, as the app writes them; numbers as strings or not.
const JSON: &str = r#"[
  {"sensor": "Gyroscope", "time": "1698501144400000010", "seconds_elapsed": "0.1", "z": "1", "y": "0.5", "x": "0"},
  {"sensor": "Gyroscope", "time": 1698501144400000030, "seconds_elapsed": 0.2, "z": 2, "y": -0.5e0, "x": null},
  {"sensor": "Gyroscope", "time": 1698501144400000030, "z": 2, "y": -0.5e0, "x": 0, "extra": {"a": ["}", "\"{"]}},
  {"sensor": "Location", "time": "1698501144400000020", "latitude": "0.0"},
  {"sensor": "Barometer", "time": "1698501144400000020", "relativeAltitude": "0", "pressure": "1013.25"},
  {"sensor": "Metadata", "version": "3", "platform": "ios", "appVersion": "1.40", "standardisation": "false",
   "device name": "iPhone"},
  {"sensor": "Accelerometer", "time": "1698501144400000025", "x": "0", "y": "0", "z": "0.5"},
  {"sensor": "Gravity", "time": "1698501144400000025", "x": "0", "y": "0", "z": "-9.75"}
]"#;

#[test]
fn json_is_merged_by_time() {
    let reader = json(JSON);
    assert_eq!(reader.as_ref().unwrap().info().device, "iPhone");
    let (records, rejections) = records(reader);
    let at = |ns, reading| sample_at_ns(T0 + ns, reading);
    let expected = [
        at(10, Reading::AngularRate([0.0, 0.5, 1.0])),
        at(20, Reading::Pressure { pressure_hpa: 1013.25 }),
        at(25, Reading::SpecificForce([0.0, 0.0, 9.25])),
        at(30, Reading::AngularRate([0.0, -0.5, 2.0])),
    ];
    assert_eq!(records, expected);
    // The row without its x.
    assert_eq!((rejections.total(), rejections.first()), (1, Some((2, LineFault::FieldCount))));
}

#[test]
fn json_cut_anywhere_gives_what_is_whole_and_says_that_it_was_cut() {
    let metadata = r#"[{"sensor": "Metadata", "platform": "android"},"#;
    let text = metadata.to_owned() + &JSON[1..].replace("\"ios\"", "\"android\"");
    let whole = records(json(&text)).0.len();
    let mut most = 0;
    for end in metadata.len() + 130..text.len() - 2 {
        let Ok(reader) = json(&text[..end]) else {
            // Only the part between `Accelerometer` and `Gravity` has no gravity at all.
            continue;
        };
        let (read, _, error) = read_all(reader);
        assert!(error.is_none() && read.len() <= whole && read.len() >= most, "{end}");
        most = read.len();
        let was_cut = json(&text[..end]).unwrap().losses().was_cut;
        let is_within = text[..end].trim_end().ends_with(['}', ',']);
        assert!(was_cut || is_within, "{end}");
    }
    assert_eq!(most, whole - 1);
}

#[test]
fn json_with_finely_mixed_sensors_comes_in_its_order() {
    let mut text = String::from("[");
    for k in 0..3_000 {
        let sensor = if k % 2 == 0 { "Gyroscope" } else { "Magnetometer" };
        text += &format!(r#"{{"sensor":"{sensor}","time":"{}","x":"1","y":"2","z":"{k}"}},"#, T0 + k);
    }
    let (records, rejections) = records(json(&text));
    assert_eq!((records.len(), rejections.total()), (3_000, 0));
    assert!(records.is_sorted_by_key(Record::time));
}

#[test]
fn exports_are_opened_by_their_content() {
    let dir = std::env::temp_dir().join(format!("fieldwalk-sensor-logger-{}", std::process::id()));
    let export = dir.join("2026-10-03_17-02-05");
    fs::create_dir_all(&export).unwrap();
    assert!(open_recording(&export).err().unwrap().to_string().contains("no export of Sensor Logger"));
    fs::write(export.join("Gyroscope.csv"), vectors(&[(0, [0.5; 3])])).unwrap();
    fs::write(export.join("notes.txt"), "x").unwrap();
    let mut log = open_recording(&export).unwrap();
    assert_eq!(log.by_ref().filter(Result::is_ok).count(), 1);
    assert!(log.losses().is_none());
    let file = dir.join("export.json");
    fs::write(&file, JSON).unwrap();
    assert_eq!(open_recording(&file).unwrap().filter(Result::is_ok).count(), 4);
    fs::write(&file, b"PK\x03\x04").unwrap();
    assert!(open_recording(&file).err().unwrap().to_string().contains("unpack it"));
    fs::remove_dir_all(&dir).unwrap();
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        for name in ["export.json", "Gyroscope.csv", "Metadata.csv"] {
            if let Ok(reader) = SensorLoggerReader::in_memory(vec![(name.into(), bytes.clone())], "export") {
                read_all(reader);
            }
        }
    }

    #[test]
    fn a_damaged_export_gives_no_more_than_the_export(at in 0..JSON.len(), byte: u8) {
        let mut bytes = JSON.as_bytes().to_vec();
        bytes[at] = byte;
        if let Ok(reader) = SensorLoggerReader::in_memory(vec![("export.json".into(), bytes)], "export.json") {
            prop_assert!(read_all(reader).0.len() <= 6);
        }
    }
}
