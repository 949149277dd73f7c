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
fn a_text_log_and_the_same_as_mcap_give_the_same_bits() {
    let dir = folder("recordings_bits");
    let text_floor = write_floor(&dir, "F1", 6);
    let map = dir.join("map");
    succeed(&["survey", text(&text_floor), "--out", text(&map), "--coverage"]);
    let (original, copy) = (trace(&text_floor, 0), dir.join("copy.mcap"));
    to_mcap(&original, &copy, "F1");
    let digest = |path: &Path| {
        succeed(&["replay", text(&map), text(path), "--bits"]).split_once(' ').unwrap().0.to_owned()
    };
    assert_eq!(digest(&original), digest(&copy));
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
        "notes.txt: line 1: not an indoor-location-competition trace",
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
    fail(
        &["replay", text(&map), text(&walk)],
        1,
        &["walk.log: its waypoints are in degrees", "georeference"],
    );

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
}
