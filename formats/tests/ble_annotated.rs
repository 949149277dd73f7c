//! The position-annotated BLE collection's files: what is read, what is refused.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::PathBuf;

use fieldwalk::geometry::Point2;
use fieldwalk_formats::ble_annotated::{SightingReader, find_points, find_tracks, open_area, read_receivers};
use fieldwalk_formats::ilc::LineFault;

const DEVICES: &str = r#"Dongles:{"b827eb4521b4": [[7.00, 7.09, 1.22], 16711680, "sensor10"], "000000000101": [[7.18, 0.68, 2.30], 3, "sensor09"] }
Beacons:{"e78f135624ce": [[], 1328790, "beacon1"] }
"#;
const LIMITS: &str =
    r#"{"origin": [22, 9], "limits": [0.0, 0.0, 20.66, 17.64], "direction": [1,0,1,1], "parity": 0.03}"#;

fn empty_folder(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("fieldwalk-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&dir).unwrap();
    dir
}

#[test]
fn a_fixed_points_line_and_a_tracks_line_are_read() {
    let text = "1568979940.637430906,b827eb4521b4,e78f135624ce,-73\r\n\
                1581249601.41,000000000202,e78f135624ce,-77.5,18.031,8.465,1.816,0.062,-0.0,-0.998,0.998,0.017,0.062,0.017,-1.0,0.002\n";
    let read: Vec<_> = SightingReader::new(text.as_bytes(), "a").collect::<Result<_, _>>().unwrap();
    assert_eq!(read[0].time.as_nanos(), 1_568_979_940_637_430_906);
    assert_eq!(read[0].receiver, [0xb8, 0x27, 0xeb, 0x45, 0x21, 0xb4]);
    assert_eq!(read[0].emitter, [0xe7, 0x8f, 0x13, 0x56, 0x24, 0xce]);
    assert_eq!((read[0].rssi_dbm, read[0].truth), (-73.0, None));
    assert_eq!(read[1].time.as_nanos(), 1_581_249_601_410_000_000);
    assert_eq!((read[1].rssi_dbm, read[1].truth), (-77.5, Some((Point2::new(18.031, 8.465), 1.816))));
}

#[test]
fn bad_lines_are_counted_and_the_rest_kept() {
    let good = "1.5,b827eb4521b4,e78f135624ce,-73";
    let bad = [
        ("1.5,b827eb4521b4,e78f135624ce", LineFault::FieldCount),
        ("1.5,b827eb4521b4,e78f135624ce,-73,1,2,3", LineFault::FieldCount),
        ("1.5,b827eb4521b4,e78f135624ce,-73,1,2,3,0,0,0,0,0,0,0,0,0,0", LineFault::FieldCount),
        ("-1.5,b827eb4521b4,e78f135624ce,-73", LineFault::Time),
        ("1e9,b827eb4521b4,e78f135624ce,-73", LineFault::Time),
        (".5,b827eb4521b4,e78f135624ce,-73", LineFault::Time),
        ("9223372036854775807,b827eb4521b4,e78f135624ce,-73", LineFault::Time),
        ("1.5,b827eb4521b,e78f135624ce,-73", LineFault::Identity),
        ("1.5,+827eb4521b4,e78f135624ce,-73", LineFault::Identity),
        ("1.5,b827eb4521b4,e78f135624ce,loud", LineFault::Number),
        ("1.5,b827eb4521b4,e78f135624ce,nan", LineFault::NotFinite),
        ("1.5,b827eb4521b4,e78f135624ce,-200", LineFault::OutOfRange),
        ("1.5,b827eb4521b4,e78f135624ce,-73,1e9,2,3,0,0,0,0,0,0,0,0,0", LineFault::OutOfRange),
    ];
    for (line, fault) in bad {
        let text = format!("{good}\n{line}\n{good}\n");
        let mut reader = SightingReader::new(text.as_bytes(), "a");
        assert_eq!(reader.by_ref().filter(Result::is_ok).count(), 2, "{line}");
        assert_eq!(reader.rejections().first(), Some((2, fault)), "{line}");
    }
}

#[test]
fn another_file_is_refused_by_name() {
    let error = SightingReader::new(&b"time,who\n1,2\n"[..], "b.mbd").next().unwrap().unwrap_err();
    assert!(error.to_string().starts_with("b.mbd:1: not an .mbd file"), "{error}");
    assert!(SightingReader::new(&b""[..], "b.mbd").next().unwrap().is_err());
}

#[test]
fn the_room_is_read_from_its_two_files() {
    let dir = empty_folder("ble-room");
    assert!(open_area(&dir).unwrap_err().is_io());
    fs::create_dir_all(dir.join("cnf")).unwrap();
    let error = open_area(&dir).unwrap_err();
    assert!(error.to_string().contains("no .dev file"), "{error}");
    fs::write(dir.join("cnf/room.dev"), DEVICES).unwrap();
    fs::write(dir.join("cnf/room.par"), LIMITS).unwrap();
    let area = open_area(&dir).unwrap();
    assert_eq!((area.low, area.high), (Point2::new(0.0, 0.0), Point2::new(20.66, 17.64)));
    let aliases: Vec<_> = area.receivers.iter().map(|receiver| receiver.alias.as_str()).collect();
    assert_eq!(aliases, ["sensor09", "sensor10"]);
    let last = &area.receivers[1];
    assert_eq!((last.position, last.height_m), (Point2::new(7.0, 7.09), 1.22));
    for limits in
        ["{}", r#"{"limits": [0, 0, 0, 1]}"#, r#"{"limits": [0, 0, 1e300, 1]}"#, "[", r#"{"limits": [1]}"#]
    {
        fs::write(dir.join("cnf/room.par"), limits).unwrap();
        let error = open_area(&dir).unwrap_err();
        assert!(error.to_string().contains("room.par") && !error.remedy().is_empty(), "{limits}: {error}");
    }
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn receivers_that_are_none_are_refused() {
    for text in [
        "",
        "Beacons:{}",
        "Dongles:{}",
        "Dongles:[",
        "Dongles:{\"b827eb4521b4\": [[1, 2], 0, \"a\"]}",
        "Dongles:{\"b827eb4521b4\": [[1, 2, 1e9], 0, \"a\"]}",
        "Dongles:{\"zz27eb4521b4\": [[1, 2, 3], 0, \"a\"]}",
    ] {
        assert!(!read_receivers(text.as_bytes()).unwrap_err().remedy().is_empty(), "{text}");
    }
    assert!(read_receivers(b"\xff").is_err());
    assert_eq!(read_receivers(b"x\nDongles:{\"b827eb4521b4\": [[1, 2, 3], 0, \"a\"]}\r\n").unwrap().len(), 1);
}

#[test]
fn points_and_tracks_are_found_by_their_names() {
    let dir = empty_folder("ble-files");
    assert!(find_points(&dir).unwrap_err().is_io());
    assert_eq!(find_tracks(&dir).unwrap(), []);
    let set = dir.join("hst/set_1");
    fs::create_dir_all(&set).unwrap();
    assert!(find_points(&dir).unwrap_err().to_string().contains("no fixed point"));
    for name in ["a_2.50_1.00_1.85.mbd", "b_2.50_1.00_1.85.mbd", "a_0.50_3.00_1.9.mbd", "all.hst"] {
        fs::write(set.join(name), "").unwrap();
    }
    fs::write(dir.join("hst/README.md"), "").unwrap();
    let points = find_points(&dir).unwrap();
    let found: Vec<_> = points.iter().map(|p| (p.place, p.height_m, p.files.len())).collect();
    assert_eq!(found, [(Point2::new(0.5, 3.0), 1.9, 1), (Point2::new(2.5, 1.0), 1.85, 2)]);
    assert_eq!(points[0].set, "set_1");

    fs::create_dir_all(dir.join("trk/way")).unwrap();
    fs::write(dir.join("trk/way_all_sensors.mbd"), "").unwrap();
    fs::write(dir.join("trk/README.md"), "").unwrap();
    let tracks = find_tracks(&dir).unwrap();
    assert_eq!(tracks.iter().map(|track| track.name.as_str()).collect::<Vec<_>>(), ["way"]);

    fs::write(set.join("a_nan_1.00_1.85.mbd"), "").unwrap();
    let error = find_points(&dir).unwrap_err();
    assert!(error.to_string().contains("tells no place"), "{error}");
    fs::remove_dir_all(&dir).unwrap();
}
