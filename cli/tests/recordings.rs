//! Recordings of one's own: MCAP in the layout `recordings`.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk_formats::open_recording;
use fieldwalk_formats::recording::{RecordingInfo, RecordingWriter};
use serde_json::Value;
use synthetic::{fail, folder, succeed, text, trace, walk, write_floor};

const PLAN: &str = r#"{"type": "FeatureCollection", "fieldwalk": {"frame": "metres"}, "features": [
{"type": "Feature", "properties": {"kind": "outline"}, "geometry": {"type": "Polygon", "coordinates":
 [[[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]]]}},
{"type": "Feature", "properties": {"kind": "unit"}, "geometry": {"type": "Polygon", "coordinates":
 [[[6, 6], [14, 6], [14, 14], [6, 14], [6, 6]]]}}]}"#;

/// Writes the text log `from` as MCAP, in its own order.
fn to_mcap(from: &Path, to: &Path, floor: &str) {
    let info = RecordingInfo { floor: floor.into(), ..RecordingInfo::default() };
    let mut writer = RecordingWriter::create(to, &info).unwrap();
    for record in open_recording(from).unwrap() {
        writer.write(&record.unwrap()).unwrap();
    }
    writer.finish().unwrap();
}

/// A folder with six walks that survey and two that test.
fn write_recordings(dir: &Path) -> PathBuf {
    let text_floor = write_floor(&dir.join("text"), "F1", 8);
    let floor = dir.join("house");
    for (k, place) in (0..8).map(|k| (k, if k < 6 { "survey" } else { "test" })) {
        fs::create_dir_all(floor.join(place)).unwrap();
        to_mcap(&trace(&text_floor, k), &floor.join(place).join(format!("walk-{k:02}.mcap")), "F1");
    }
    fs::write(floor.join("plan.geojson"), PLAN).unwrap();
    floor
}

fn objects(json: &str) -> Vec<Value> {
    json.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn recordings_are_surveyed_replayed_and_evaluated() {
    let dir = folder("recordings_layout");
    let floor = write_recordings(&dir);
    let map = dir.join("map");
    let report = succeed(&["survey", text(&floor), "--out", text(&map), "--coverage", "--json"]);
    let report = &objects(&report)[0];
    assert_eq!((&report["floor"], &report["n_walks"]), (&"F1".into(), &6.into()));
    assert_eq!(report["refused_walks"].as_array().unwrap().len(), 0);

    let walk = floor.join("test/walk-06.mcap");
    let table = succeed(&["replay", text(&map), text(&walk)]);
    assert!(table.ends_with("recording: nothing lost\n"), "{table}");
    let summary = objects(&succeed(&["replay", text(&map), text(&walk), "--json"])).pop().unwrap();
    assert!(summary["errors"]["median_m"].as_f64().unwrap() < 2.5, "{summary}");

    let rows = objects(&succeed(&["evaluate", text(&floor), "--systems", "fused", "--seeds", "1", "--json"]));
    assert_eq!((&rows[0]["dataset"], &rows[0]["n_walks"]), (&"recordings".into(), &2.into()));
    assert!(rows[0]["median_m"].as_f64().unwrap() < 2.5, "{rows:?}");
    // Which fold is asked for does not matter where the folder says what tests.
    let fold = ["evaluate", text(&floor), "--systems", "fused", "--seeds", "1", "--json", "--fold", "3"];
    assert_eq!(objects(&succeed(&fold))[0]["median_m"], rows[0]["median_m"]);
}

#[test]
fn an_imported_log_gives_the_same_bits_as_the_log() {
    let dir = folder("recordings_import");
    let text_floor = write_floor(&dir, "F1", 6);
    let map = dir.join("map");
    succeed(&["survey", text(&text_floor), "--out", text(&map), "--coverage"]);
    // Out of order, as logs are; with a header, a torn line and a stale WiFi row.
    let original = dir.join("walk.txt");
    let log = walk(0);
    let mut lines: Vec<&str> = log.lines().skip(1).collect();
    for chunk in lines.chunks_mut(40) {
        chunk.reverse();
    }
    let header =
        "#\tFloorName:F1\n#\tstartTime:1574567556121\tBrand:Make\tModel:M 1\n1574567556121\tTYPE_GYRO\n";
    let stale = "\n1574567556121\tTYPE_WIFI\tx\ta8:0c:ca:03:9d:d7\t-49\t2422\t1574567500000\n";
    fs::write(&original, format!("{header}{}{stale}", lines.join("\n"))).unwrap();

    let digest = |path: &Path| {
        succeed(&["replay", text(&map), text(path), "--bits"]).split_once(' ').unwrap().0.to_owned()
    };
    let (out, file) = (dir.join("imported"), dir.join("one.mcap"));
    let report = objects(&succeed(&["import", text(&original), "--out", text(&out), "--json"])).remove(0);
    assert_eq!(report["n_waypoints"], 7);
    assert_eq!((&report["floor"], &report["device"]), (&"F1".into(), &"Make M 1".into()));
    assert_eq!(
        (&report["lines_rejected"]["unknown_type"], &report["n_stale_wifi_rows"]),
        (&1.into(), &1.into())
    );
    let said = succeed(&["import", text(&original), "--out", text(&file), "--zstd", "--floor", "F1"]);
    assert!(said.contains("lines rejected: 1; 1 unknown type; stale WiFi rows left out: 1"), "{said}");

    let imported = out.join("walk.mcap");
    assert_eq!(digest(&original), digest(&imported));
    assert_eq!(digest(&original), digest(&file));
    let size = |path: &Path| fs::metadata(path).unwrap().len();
    assert!(size(&file) < size(&imported));
    let mut recording = open_recording(&imported).unwrap();
    let times: Vec<_> = recording.by_ref().map(|record| record.unwrap().time()).collect();
    assert!(times.is_sorted() && times.len() as u64 == report["n_records"].as_u64().unwrap());
    assert_eq!(recording.info().start_unix_ms, Some(1_574_567_556_121));
    // A recording can be imported too, and says then what it lost itself.
    let again = dir.join("again.mcap");
    assert!(succeed(&["import", text(&imported), "--out", text(&again)]).ends_with("  nothing lost\n"));
    assert_eq!(fs::read(&imported).unwrap(), fs::read(&again).unwrap());
}

#[test]
fn an_import_that_fails_leaves_no_file_and_never_replaces_its_log() {
    let dir = folder("recordings_import_fails");
    let (foreign, good, out) = (dir.join("notes.txt"), dir.join("walk.txt"), dir.join("out"));
    fs::write(&foreign, "notes\n".repeat(1_000)).unwrap();
    fs::write(&good, walk(1)).unwrap();
    let said = ["notes.txt:1: of no known format", "none.txt: cannot open", "2 of 3 logs"];
    let none = dir.join("none.txt");
    fail(&["import", text(&none), text(&foreign), text(&good), "--out", text(&out)], 1, &said);
    let files: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(files, ["walk.mcap"]);
    let imported = out.join("walk.mcap");
    fail(&["import", text(&imported), "--out", text(&out)], 2, &["would replace itself"]);
    fail(&["import", text(&good), text(&imported), "--out", text(&dir.join("o"))], 2, &["would both become"]);
    fail(
        &["import", text(&good), text(&foreign), "--out", text(&dir.join("a.mcap"))],
        2,
        &["names one recording"],
    );
}

#[test]
fn an_empty_folder_of_tests_is_named_and_folds_are_not_advised() {
    let floor = write_recordings(&folder("recordings_no_tests"));
    fs::remove_dir_all(floor.join("test")).unwrap();
    fs::create_dir(floor.join("test")).unwrap();
    let said = ["no test walk with two waypoints in test/ (put walks into its folder test/"];
    fail(&["evaluate", text(&floor), "--seeds", "1", "--systems", "wila"], 1, &said);
}

#[test]
fn floors_by_names_that_are_none_are_to_be_renamed() {
    let dir = folder("recordings_named");
    let house = write_recordings(&dir);
    let floors = ["Erdgeschoss", "Obergeschoss"].map(|name| dir.join("site").join(name));
    for floor in &floors {
        fs::create_dir_all(floor).unwrap();
        fs::copy(house.join("plan.geojson"), floor.join("plan.geojson")).unwrap();
        fs::copy(house.join("survey/walk-01.mcap"), floor.join("walk-01.mcap")).unwrap();
    }
    let map = dir.join("map");
    let said = ["another floor is called F1 as well", "call the folders of one building's floors F1, F2"];
    fail(&["survey", text(&dir.join("site")), "--out", text(&map)], 1, &said);
}

#[test]
fn what_a_recording_lost_is_said() {
    let dir = folder("recordings_losses");
    let floor = write_recordings(&dir);
    let map = dir.join("map");
    let cut = floor.join("survey/walk-01.mcap");
    let bytes = fs::read(&cut).unwrap();
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let elsewhere = floor.join("survey/walk-02.mcap");
    to_mcap(&trace(&dir.join("text/F1"), 2), &elsewhere, "F2");
    fs::write(floor.join("survey/notes.txt"), "nothing\n").unwrap();

    let table = succeed(&["survey", text(&floor), "--out", text(&map), "--coverage"]);
    for said in [
        "F1: 1 recordings cut short",
        "walk-02.mcap: recorded on floor F2, where F1 is surveyed",
        "notes.txt: line 1: of no known format",
    ] {
        assert!(table.contains(said), "`{said}` is missing: {table}");
    }
    let replay = succeed(&["replay", text(&map), text(&cut)]);
    assert!(replay.ends_with("recording: cut short\n"), "{replay}");
    let summary = objects(&succeed(&["replay", text(&map), text(&cut), "--json"])).pop().unwrap();
    assert_eq!(summary["losses"]["was_cut"], true);
    fail(&["replay", text(&map), text(&elsewhere)], 1, &["walk-02.mcap: recorded on floor F2"]);
}

#[test]
fn waypoints_in_degrees_need_a_georeferenced_plan() {
    let dir = folder("recordings_degrees");
    let floor = write_recordings(&dir);
    let map = dir.join("map");
    succeed(&["survey", text(&floor), "--out", text(&map), "--coverage"]);
    // The log of walk 6 as GetSensorData writes it, on a floor at the equator.
    let mut log = String::from("% LogFile created by the GetSensorData App\n");
    for line in walk(6).lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let time = (fields[0].parse::<i64>().unwrap() - 1_574_567_556_121) as f64 * 1e-3;
        log += &match fields[1] {
            "TYPE_ACCELEROMETER" => format!("ACCE;{time:.3};0;{};{};{};3\n", fields[2], fields[3], fields[4]),
            "TYPE_GYROSCOPE" => format!("GYRO;{time:.3};0;{};{};{};3\n", fields[2], fields[3], fields[4]),
            "TYPE_MAGNETIC_FIELD" => {
                format!("MAGN;{time:.3};0;{};{};{};3\n", fields[2], fields[3], fields[4])
            }
            "TYPE_WAYPOINT" => {
                let degrees = |k: usize| fields[k].parse::<f64>().unwrap() * 1e-5;
                format!("POSI;{time:.3};1;{:.9};{:.9};0;0\n", degrees(3), degrees(2))
            }
            _ => continue,
        };
    }
    let walk = dir.join("walk.log");
    fs::write(&walk, log).unwrap();
    let said = ["walk.log: its waypoints are in degrees", "georeference"];
    fail(&["replay", text(&map), text(&walk)], 1, &said);
    let imported = dir.join("walk.mcap");
    fail(
        &["import", text(&walk), "--out", text(&imported)],
        1,
        &["walk.log: its waypoints are in degrees", "--plan"],
    );
    assert!(!imported.exists());

    let georeferenced = PLAN.replacen(
        r#""frame": "metres""#,
        r#""frame": "metres", "georeference": {"origin_latitude_deg": 0, "origin_longitude_deg": 0,
            "latitude_deg_per_m": 1e-5, "longitude_deg_per_m": 1e-5}"#,
        1,
    );
    fs::write(floor.join("plan.geojson"), georeferenced).unwrap();
    succeed(&["survey", text(&floor), "--out", text(&map), "--coverage"]);
    let summary = objects(&succeed(&["replay", text(&map), text(&walk), "--json"])).pop().unwrap();
    assert_eq!(summary["errors"]["n_points"], 6);
    assert!(summary["errors"]["median_m"].as_f64().unwrap() < 2.5, "{summary}");

    let plan = floor.join("plan.geojson");
    succeed(&["import", text(&walk), "--plan", text(&plan), "--out", text(&imported)]);
    let bits = |path: &Path| succeed(&["replay", text(&map), text(path), "--bits"])[..64].to_owned();
    assert_eq!(bits(&walk), bits(&imported));
}
