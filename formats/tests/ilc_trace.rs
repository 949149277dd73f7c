//! Traces of the public collection, by hand-written lines.

mod text_log;

use std::fs;
use std::io::{self, BufReader, Read};

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{Reading, TransmitterId};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::ilc::{Floor, LineFault, LineRejections, TraceReader};
use fieldwalk_formats::{FormatError, Record};
use proptest::prelude::*;
use text_log::{radio, read_all, sample};

const WALK: &str = include_str!("fixtures/walk.txt");

fn read(bytes: &[u8]) -> (Vec<Record>, LineRejections, Option<FormatError>) {
    read_all(TraceReader::new(bytes, "walk.txt"))
}

#[test]
fn every_kind_of_line_gives_its_record() {
    let (records, rejections, error) = read(WALK.as_bytes());
    assert!(error.is_none());
    let uuid = [0x91, 0x95, 0xb3, 0xad, 0xa9, 0xd0, 0x45, 0, 0x85, 0xff, 0x9f, 0xb0, 0xf6, 0x5a, 0x52, 1];
    let expected = [
        Record::Waypoint { time: Timestamp::from_millis(1_600_000_000_003), point: Point2::new(81.25, 93.5) },
        sample(1_600_000_000_141, Reading::SpecificForce([-0.5, 1.75, 9.75])),
        sample(1_600_000_000_141, Reading::MagneticField([29.5, 6.25, -30.0])),
        sample(1_600_000_000_141, Reading::AngularRate([-0.375, -0.125, 0.0625])),
        sample(
            1_600_000_000_141,
            Reading::UncalibratedMagneticField {
                field_ut: [-18.0, -75.0, -322.5],
                bias_ut: [-47.5, -81.25, -292.5],
            },
        ),
        sample(1_600_000_000_160, Reading::Pressure { pressure_hpa: 1013.25 }),
        sample(1_600_000_001_000, radio(TransmitterId::WifiBssid([0xa8, 0x0c, 0xca, 3, 0x9d, 0xd7]), -49.0)),
        sample(
            1_600_000_001_200,
            radio(TransmitterId::BleAddress([0xe0, 0x78, 0xa3, 0x3d, 0xb5, 0xd6]), -93.0),
        ),
        sample(1_600_000_001_300, radio(TransmitterId::Ibeacon { uuid, major: 3, minor: 40 }, -71.0)),
        Record::Waypoint { time: Timestamp::from_millis(1_600_000_002_000), point: Point2::new(75.0, 94.75) },
    ];
    assert_eq!(records, expected);
    assert_eq!((rejections.total(), rejections.n_stale_wifi), (0, 1));
}

#[test]
fn the_header_names_the_floor() {
    let mut reader = TraceReader::new(WALK.as_bytes(), "walk.txt");
    assert_eq!(reader.floor_name(), None, "nothing has been read");
    assert!(reader.next().unwrap().is_ok());
    assert_eq!(reader.floor_name(), Some("F1"));
    let info = reader.info();
    assert_eq!((info.device.as_str(), info.start_unix_ms), ("X Y", Some(1_600_000_000_000)));

    let waypoint = "1600000000003\tTYPE_WAYPOINT\t1\t2\n";
    for (header, name) in [
        ("", None),
        ("#\tFloorName:\n", None),
        ("#\tstartTime:1600000000000\n#\tSiteName:FloorName:F9\tFloorName:B 1 \r\n", Some("B 1")),
        ("#\tFloorName:F2\n#\tFloorName:F3\n", Some("F2")),
    ] {
        let text = format!("{header}{waypoint}");
        let mut reader = TraceReader::new(text.as_bytes(), "walk.txt");
        assert!(reader.next().unwrap().is_ok());
        assert_eq!(reader.floor_name(), name, "{header}");
    }
}

#[test]
fn broken_lines_are_counted_by_cause() {
    let good = "1600000000003\tTYPE_WAYPOINT\t1\t2";
    let cases: &[(&[u8], LineFault)] = &[
        (b"1600000000141\tTYPE_ACCELEROMETER\t-0.5\t1.75", LineFault::FieldCount),
        (b"1600000000141\tTYPE_ACCELEROMETER\t-0.5\t1.75\t9.75", LineFault::FieldCount),
        (b"1600000000141\tTYPE_ACCELEROMETER\t-0.5\t1.75\t9.75\t2\t2", LineFault::FieldCount),
        (b"1600000000141", LineFault::FieldCount),
        (b"000000141\tTYPE_WAYPOINT\t1\t2", LineFault::Time),
        (b"", LineFault::Time),
        (b"1600000000141\tTYPE_GYROSCOPE\t0\tx\t0\t3", LineFault::Number),
        (b"1600000000141\tTYPE_GYROSCOPE\t0\tNaN\t0\t3", LineFault::NotFinite),
        (b"1600000000141\tTYPE_GYROSCOPE\t0\t-inf\t0\t3", LineFault::NotFinite),
        (b"1600000000141\tTYPE_GYROSCOPE\t0\t1e39\t0\t3", LineFault::NotFinite),
        (b"1600000000141\tTYPE_WIFI\tx\ta8:0c\t-49\t2422\t1600000000141", LineFault::Identity),
        (
            b"1600000000141\tTYPE_WIFI\t\xff\xfe\ta8:0c:ca:03:9d:d7\t-49\t2422\t1600000000141",
            LineFault::NotUtf8,
        ),
        (b"1600000000141\tTYPE_SMELL\t1", LineFault::UnknownType),
        (b"1600000000141\tWAYPOINT\t1\t2", LineFault::UnknownType),
    ];
    for (line, fault) in cases {
        let text = [good.as_bytes(), line, good.as_bytes()].join(&b'\n');
        let (records, rejections, error) = read(&text);
        if line.is_empty() {
            assert_eq!(rejections.total(), 0, "an empty line is nothing");
            continue;
        }
        assert!(error.is_none() && records.len() == 2);
        assert_eq!(rejections.first(), Some((2, *fault)), "{}", String::from_utf8_lossy(line));
        assert_eq!((rejections.total(), rejections.count(*fault)), (1, 1));
    }
}

#[test]
fn records_glued_onto_one_line_come_apart() {
    let glued = "1600000000003\tTYPE_WAYPOINT\t81.25\t93.51600000000141\tTYPE_GYROSCOPE\t1\t2\t3\t\
                 31600000000142\tTYPE_ROTATION_VECTOR\t1\t2\t3\t31600000000143\tTYPE_WAYPOINT\t5\t6\r\n";
    let (records, rejections, _) = read(glued.as_bytes());
    let waypoint = |ms, x, y| Record::Waypoint { time: Timestamp::from_millis(ms), point: Point2::new(x, y) };
    assert_eq!(
        records,
        [
            waypoint(1_600_000_000_003, 81.25, 93.5),
            sample(1_600_000_000_141, Reading::AngularRate([1.0, 2.0, 3.0])),
            waypoint(1_600_000_000_143, 5.0, 6.0),
        ]
    );
    assert_eq!(rejections.total(), 0);

    // Torn before it was glued: the first record is lost, the second is not.
    let torn = "1600000000003\tTYPE_GYROSCOPE\t81.25\t93.1600000000141\tTYPE_WAYPOINT\t1\t2";
    let (records, rejections, _) = read(torn.as_bytes());
    assert_eq!(records, [waypoint(1_600_000_000_141, 1.0, 2.0)]);
    assert_eq!(rejections.first(), Some((1, LineFault::FieldCount)));

    // Torn so that the count of fields fits: what should be the accuracy is the next record's type.
    let torn = "1600000000003\tTYPE_GYROSCOPE\t1\t2\t31600000000141\tTYPE_ROTATION_VECTOR";
    let (records, rejections, _) = read(torn.as_bytes());
    assert_eq!((records.len(), rejections.first()), (0, Some((1, LineFault::FieldCount))));

    // A network may call itself what it likes.
    let (records, _, _) =
        read(b"1600000000141\tTYPE_WIFI\tTYPE_WIFI\ta8:0c:ca:03:9d:d7\t-49\t2422\t1600000000141");
    assert_eq!(records.len(), 1);
}

#[test]
fn what_is_no_trace_is_refused_with_file_and_line() {
    let foreign = "time,x,y\n1,2,3\n".repeat(10_000);
    let cases =
        [("", 1), ("#\tstartTime:1600000000000\n", 1), ("\n\n", 2), (&foreign, 1), ("#\n{\"a\": 1}", 2)];
    for (text, line) in cases {
        let (records, _, error) = read(text.as_bytes());
        let error = error.expect("an error");
        assert!(records.is_empty() && !error.is_io());
        let expected = format!("walk.txt:{line}: not an indoor-location-competition trace");
        assert!(error.to_string().starts_with(&expected), "{error}");
    }
    let late = format!("{}1600000000003\tTYPE_WAYPOINT\t1\t2\n", "x\n".repeat(200));
    assert!(read(late.as_bytes()).2.is_some());
    let in_time = format!("{}1600000000003\tTYPE_WAYPOINT\t1\t2\n", "x\n".repeat(199));
    assert!(read(in_time.as_bytes()).2.is_none());
}

#[test]
fn a_line_without_end_fills_no_memory() {
    let good = "1600000000003\tTYPE_WAYPOINT\t1\t2\n";
    let text = format!("{good}{}\n{good}{}", "9".repeat(3_000_000), "\t".repeat(500_000));
    let (records, rejections, error) = read(text.as_bytes());
    assert!(error.is_none());
    assert_eq!((records.len(), rejections.count(LineFault::TooLong)), (2, 2));
    assert_eq!(rejections.first(), Some((2, LineFault::TooLong)));
}

#[test]
fn a_failing_disk_is_an_error() {
    struct Failing;
    impl Read for Failing {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("bad sector"))
        }
    }
    let good = &b"1600000000003\tTYPE_WAYPOINT\t1\t2\n"[..];
    let mut reader = TraceReader::new(BufReader::new(good.chain(Failing)), "walk.txt");
    assert!(reader.next().unwrap().is_ok());
    let error = reader.next().unwrap().unwrap_err();
    assert!(error.is_io());
    assert_eq!(error.to_string(), "walk.txt:2: cannot read the trace: bad sector");
    assert!(reader.next().is_none());
}

#[test]
fn a_floor_lists_its_walks_in_order() {
    let dir = std::env::temp_dir().join(format!("fieldwalk-ilc-{}", std::process::id()));
    let floor_dir = dir.join("mall").join("F2");
    fs::create_dir_all(floor_dir.join("path_data_files")).unwrap();
    fs::write(floor_dir.join("floor_info.json"), include_str!("fixtures/floor_info.json")).unwrap();
    assert!(Floor::open(&floor_dir).unwrap_err().is_not_found());
    fs::write(floor_dir.join("geojson_map.json"), include_str!("fixtures/geojson_map.json")).unwrap();
    for name in ["b.txt", "a.txt", "notes.md"] {
        fs::write(floor_dir.join("path_data_files").join(name), WALK).unwrap();
    }
    let floor = Floor::open(&floor_dir).unwrap();
    assert_eq!((floor.site.as_str(), floor.name.as_str()), ("mall", "F2"));
    let names: Vec<_> = floor.traces.iter().map(|path| path.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["a.txt", "b.txt"]);
    assert_eq!(TraceReader::open(&floor.traces[0]).unwrap().filter(Result::is_ok).count(), 10);
    assert!(TraceReader::open(&floor_dir.join("none.txt")).unwrap_err().is_not_found());

    // A bad plan is reported with the path of the file that is wrong.
    for (file, bad) in [
        ("geojson_map.json", "[]"),
        ("geojson_map.json", r#"{"type": "FeatureCollection", "features": []}"#),
        ("floor_info.json", "{"),
        ("floor_info.json", r#"{"map_info": {"width": -1.0, "height": 50.0}}"#),
    ] {
        let path = floor_dir.join(file);
        let good = fs::read(&path).unwrap();
        fs::write(&path, bad).unwrap();
        assert_eq!(Floor::open(&floor_dir).unwrap_err().path(), Some(path.as_path()), "{bad}");
        fs::write(&path, good).unwrap();
    }
    fs::remove_dir_all(&dir).unwrap();
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read(&bytes);
    }

    #[test]
    fn near_misses_are_read_without_panic(
        pieces in proptest::collection::vec(
            prop_oneof![
                Just("\t"), Just("\n"), Just("1600000000141"), Just("TYPE_"), Just("TYPE_WIFI"), Just("#"),
                Just("TYPE_BEACON"), Just("TYPE_WAYPOINT"), Just("-1.5"), Just("a8:0c:ca:03:9d:d7"), Just("\r"),
                Just("9195B3AD-A9D0-4500-85FF-9FB0F65A5201"), Just("é"), Just("nan"), Just("1600000000141\tTYPE_"),
            ],
            0..60,
        ),
    ) {
        read(pieces.concat().as_bytes());
    }

    #[test]
    fn a_damaged_walk_gives_no_more_than_the_walk(at in 0..WALK.len(), byte: u8) {
        let mut bytes = WALK.as_bytes().to_vec();
        bytes[at] = byte;
        let (records, _, _) = read(&bytes);
        prop_assert!(records.len() <= 11, "ten records and one stale row");
    }
}
