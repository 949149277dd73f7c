//! UJIIndoorLoc-Mag, by hand-written walks.
#![allow(clippy::unwrap_used, clippy::panic)]

mod text_log;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::Georeference;
use fieldwalk::geometry::Point2;
use fieldwalk::sensor::Reading;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::ilc::{LineFault, LineRejections};
use fieldwalk_formats::uji_mag::{MAX_ROWS, UjiMagCollection, UjiMagReader, UjiMagWalk};
use fieldwalk_formats::{FormatError, Record, open_recording};
use proptest::prelude::*;
use text_log::{read_all, sample};

/// The phone flat, then its top edge up by 30 degrees; what was left over in the first row is of another walk.
const WALK: &str = "\
1000 9 9 9 5 5 5 170 0 0
1100 1 20 -40 0.5 0 0 0 0 0
1200 1 20 -40 0.25 0 -1 0 0 0
1300 2 20 -41 0 0 1 0 -30 0
1400 2 20 -41 0 0 0.5 0 -30 0
<2>
39.9938 -0.0738 39.99389 -0.0738 0 2
39.99389 -0.0738 39.99389 -0.0739 3 4
";

fn read(bytes: &[u8]) -> (Vec<Record>, LineRejections, Option<FormatError>) {
    read_all(UjiMagReader::new(bytes, "walk.txt"))
}

fn waypoints(records: &[Record]) -> Vec<(Timestamp, Point2)> {
    let of = |record: &Record| match record {
        Record::Waypoint { time, point } => Some((*time, *point)),
        Record::Sample(_) => None,
    };
    records.iter().filter_map(of).collect()
}

fn error(text: &str) -> FormatError {
    UjiMagWalk::read(text.as_bytes(), Path::new("walk.txt")).unwrap_err()
}

#[test]
fn gravity_stands_where_the_orientation_says_up() {
    let (records, rejections, failed) = read(WALK.as_bytes());
    assert!(failed.is_none() && rejections.total() == 0, "{rejections}");
    let forces: Vec<(i64, [f32; 3])> = records
        .iter()
        .filter_map(|record| match record {
            Record::Sample(sample) => match sample.reading {
                Reading::SpecificForce(force) => Some((sample.time.as_nanos() / 1_000_000, force)),
                _ => None,
            },
            Record::Waypoint { .. } => None,
        })
        .collect();
    // 9.80665·(cos 15°, sin 15°) halfway through the turn, then (cos 30°, sin 30°): up is on z and on y.
    let expected = [
        (1_100, [0.5, 0.0, 9.80665]),
        (1_200, [0.25, 0.0, 9.80665 - 1.0]),
        (1_300, [0.0, 4.903325, 8.492808 + 1.0]),
        (1_400, [0.0, 4.903325, 8.492808 + 0.5]),
    ];
    // From the first orientation at 1.1 s to the next at 1.3 s the device turns evenly.
    let halfway = [0.25, 9.80665 * 0.258_819_04, 9.80665 * 0.965_925_8 - 1.0];
    for (k, (force, expected)) in forces.iter().zip(expected).enumerate() {
        let expected_force = if k == 1 { halfway } else { expected.1 };
        assert_eq!(force.0, expected.0);
        assert!(
            (0..3).all(|c| (force.1[c] - expected_force[c]).abs() < 1e-4),
            "{force:?} {expected_force:?}"
        );
    }
    assert_eq!(forces.len(), 4);
}

#[test]
fn turning_is_what_lies_between_orientations_and_only_fresh_fields_count() {
    let (records, _, _) = read(WALK.as_bytes());
    let samples: Vec<_> = records.into_iter().filter(|record| matches!(record, Record::Sample(_))).collect();
    let fields = [
        sample(1_100, Reading::MagneticField([1.0, 20.0, -40.0])),
        sample(1_300, Reading::MagneticField([2.0, 20.0, -41.0])),
    ];
    assert!(fields.iter().all(|field| samples.contains(field)));
    let n_fields = samples.iter().filter(|record| {
        matches!(record, Record::Sample(sample) if matches!(sample.reading, Reading::MagneticField(_)))
    });
    assert_eq!(n_fields.count(), 2);
    let turned: Vec<f32> = samples
        .iter()
        .filter_map(|record| match record {
            Record::Sample(sample) => match sample.reading {
                Reading::AngularRate([x, y, z]) => {
                    assert!(y.abs() < 1e-6 && z.abs() < 1e-6);
                    Some(x.to_degrees())
                }
                _ => None,
            },
            Record::Waypoint { .. } => None,
        })
        .collect();
    // The top edge rises by 30 degrees in 0.2 s.
    assert!(turned.iter().zip([0.0, 150.0, 150.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-2), "{turned:?}");
    assert_eq!(turned.len(), 4);
}

#[test]
fn segments_become_waypoints_and_a_corner_is_one() {
    let (records, _, _) = read(WALK.as_bytes());
    let waypoints = waypoints(&records);
    let times: Vec<i64> = waypoints.iter().map(|(time, _)| time.as_nanos() / 1_000_000).collect();
    assert_eq!(times, [1_000, 1_250, 1_400]);
    // 9e-5 degrees of latitude are 10 m; 1e-4 of longitude at 40 degrees 8.54 m.
    let [(_, start), (_, corner), (_, end)] = waypoints[..] else { panic!("{waypoints:?}") };
    assert_eq!(start, Point2::default());
    assert!(corner.x_m.abs() < 1e-6 && (corner.y_m - 9.99).abs() < 0.01, "{corner:?}");
    assert!((end.x_m + 8.54).abs() < 0.01 && (end.y_m - corner.y_m).abs() < 1e-6, "{end:?}");
    // Two places that are apart are two waypoints.
    let apart = WALK.replace("39.99389 -0.0738 39.99389 -0.0739", "39.99380 -0.0738 39.99389 -0.0739");
    assert_eq!(self::waypoints(&read(apart.as_bytes()).0).len(), 4);
}

#[test]
fn a_georeference_puts_waypoints_on_the_floor() {
    let georeference = Georeference {
        origin_latitude_deg: 39.9937,
        origin_longitude_deg: -0.0740,
        latitude_deg_per_m: 1e-5,
        longitude_deg_per_m: 2e-5,
    };
    let mut reader = UjiMagReader::new(WALK.as_bytes(), "walk.txt").with_georeference(georeference);
    assert!(reader.is_in_floor_frame());
    let records: Vec<Record> = reader.by_ref().collect::<Result<_, _>>().unwrap();
    let start = waypoints(&records)[0].1;
    assert!((start.x_m - 10.0).abs() < 1e-6 && (start.y_m - 10.0).abs() < 1e-6, "{start:?}");
}

#[test]
fn sensors_that_never_change_are_no_motion() {
    let stuck: String = WALK
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            [time, x, y, z, .., azimuth, pitch, roll] if line.len() < 40 => {
                format!("{time} {x} {y} {z} 0.5 0.5 0.5 {azimuth} {pitch} {roll}\n")
            }
            _ => format!("{line}\n"),
        })
        .collect();
    let walk = UjiMagWalk::read(stuck.as_bytes(), Path::new("walk.txt")).unwrap();
    assert!(walk.is_motion_stuck());
    let records = walk.records(Georeference {
        latitude_deg_per_m: 1e-5,
        longitude_deg_per_m: 1e-5,
        ..Georeference::default()
    });
    assert_eq!(records.len(), 2 + 3, "{records:?}");
    assert!(!UjiMagWalk::read(WALK.as_bytes(), Path::new("walk.txt")).unwrap().is_motion_stuck());
}

#[test]
fn bad_rows_are_counted_and_keep_their_number() {
    let text = WALK
        .replace("1200 1 20 -40 0.25 0 -1 0 0 0", "1200 1 20 NaN 0.25 0 -1 0 0 0")
        .replace("<2>", "14\n1350 2 20 -41 0 0 1 0 -30 0\n1500 2 20 -41 0 0 1e9 0 -30 0\n49<2>");
    let (records, rejections, failed) = read(text.as_bytes());
    assert!(failed.is_none(), "{failed:?}");
    let n = |fault| rejections.count(fault);
    assert_eq!((n(LineFault::NotFinite), n(LineFault::FieldCount), n(LineFault::Time)), (1, 2, 1));
    assert_eq!((n(LineFault::OutOfRange), rejections.total()), (1, 5));
    // Row 2 was lost: the first segment ends with row 1, the second still begins with row 3.
    let times: Vec<i64> = waypoints(&records).iter().map(|(time, _)| time.as_nanos() / 1_000_000).collect();
    assert_eq!(times, [1_000, 1_200, 1_400]);
}

#[test]
fn the_last_row_may_be_one_beyond() {
    let text = WALK.replace(" 3 4\n", " 3 5");
    assert!(read(text.as_bytes()).2.is_none());
    assert!(error(&WALK.replace(" 3 4\n", " 3 6")).to_string().contains("rows 3 to 6, of 5"));
}

#[test]
fn what_is_no_walk_is_refused_with_line_and_remedy() {
    for (text, line, said) in [
        ("", 1, "ends before its segments"),
        ("hello\nworld\n", 1, "malformed time"),
        (&WALK[..60], 3, "ends before its segments"),
        (&WALK.replace("<2>", "<0>"), 6, "announces no segments"),
        (&WALK.replace("<2>", "<x>"), 6, "announces no segments"),
        (&WALK.replace("<2>", "<1>"), 8, "1 segments announced"),
        (&WALK.replace("<2>", "<3>"), 8, "3 segments announced"),
        (&WALK.replace("39.9938 ", "99.9938 "), 7, "out of range"),
        (&WALK.replace(" 0 2\n", " 2 0\n"), 7, "out of range"),
        (&WALK.replace(" 0 2\n", " 0\n"), 7, "wrong number of fields"),
        (&WALK.replace(" 3 4\n", " 1 4\n"), 8, "before the last one ends"),
    ] {
        let error = error(text);
        assert!(error.to_string().contains(said), "{text}: {error}");
        assert_eq!((error.line(), error.path()), (Some(line), Some(Path::new("walk.txt"))), "{text}");
        assert!(!error.remedy().is_empty());
    }
    let mut endless = String::new();
    for k in 0..=MAX_ROWS {
        writeln!(endless, "{} 0 20 -40 0 0 0 0 0 0", 1_000 + 100 * k).unwrap();
    }
    assert!(error(&endless).to_string().contains("more than 36000 rows"));
}

fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&dir);
    for below in ["lines/c1", "curves/c1", "tests"] {
        fs::create_dir_all(dir.join(below)).unwrap();
    }
    dir
}

#[test]
fn a_collection_has_a_frame_round_all_its_walks() {
    let dir = folder("uji_collection");
    fs::write(dir.join("readme.txt"), "no walk").unwrap();
    fs::write(dir.join("lines/c1/l1n_01.txt"), WALK).unwrap();
    fs::write(dir.join("curves/c1/c1n2n_01.txt"), WALK).unwrap();
    fs::write(dir.join("tests/t1.txt"), WALK).unwrap();
    let collection = UjiMagCollection::open(&dir).unwrap();
    assert_eq!(collection.lines, [dir.join("lines/c1/l1n_01.txt")]);
    assert_eq!(collection.walks, [dir.join("curves/c1/c1n2n_01.txt"), dir.join("tests/t1.txt")]);
    // 8.54 m east to west, 9.99 m south to north, and 5 m all round.
    let plan = &collection.plan;
    assert!((plan.width_m - 18.54).abs() < 0.01 && (plan.height_m - 19.99).abs() < 0.01, "{plan:?}");
    let mut nodes = collection.nodes.clone();
    nodes.sort_by(|a, b| (a.x_m, a.y_m).partial_cmp(&(b.x_m, b.y_m)).unwrap());
    assert_eq!(nodes.len(), 3);
    let near = |node: Point2, x_m, y_m| node.distance_m(Point2::new(x_m, y_m)) < 0.01;
    assert!(
        near(nodes[0], 5.0, 14.99) && near(nodes[1], 13.54, 5.0) && near(nodes[2], 13.54, 14.99),
        "{nodes:?}"
    );
    // Any reader of logs knows the format.
    let mut log = open_recording(&collection.walks[1]).unwrap();
    assert_eq!(log.by_ref().count(), 4 + 4 + 2 + 3);
    assert!(!log.is_in_floor_frame());

    fs::write(dir.join("tests/t2.txt"), "torn").unwrap();
    assert_eq!(UjiMagCollection::open(&dir).unwrap_err().path(), Some(dir.join("tests/t2.txt").as_path()));
    fs::remove_dir_all(dir.join("lines")).unwrap();
    assert!(UjiMagCollection::open(&dir).unwrap_err().to_string().contains("no file `*.txt`"));
    assert!(UjiMagCollection::open(&dir.join("nowhere")).unwrap_err().is_not_found());
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&bytes);
    }

    #[test]
    fn any_damage_is_read_or_refused(at in 0..WALK.len(), byte in any::<u8>()) {
        let mut bytes = WALK.as_bytes().to_vec();
        bytes[at] = byte;
        let (records, _, failed) = read(&bytes);
        prop_assert!(failed.is_some() || waypoints(&records).len() >= 2);
        prop_assert!(records.windows(2).all(|pair| pair[0].time() <= pair[1].time()));
    }
}
