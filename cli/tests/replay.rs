//! `fieldwalk replay` on a small floor.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use synthetic::{fail, folder, succeed, text, trace, walk, write_floor};

/// A map of F1 and F2 that has not seen walk 0, and F1's folder.
fn surveyed(name: &str) -> (PathBuf, PathBuf) {
    let site = folder(name);
    let (floor, map) = (write_floor(&site, "F1", 8), site.join("map"));
    write_floor(&site, "F2", 4);
    succeed(&["survey", text(&site), "--out", text(&map), "--fold", "0", "--coverage"]);
    (map, floor)
}

fn objects(json: &str) -> Vec<Value> {
    json.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_replay_gives_fixes_errors_and_a_summary() {
    let (map, floor) = surveyed("replay_fixes");
    let walk = trace(&floor, 0);
    let lines = succeed(&["replay", text(&map), text(&walk), "--floor", "F1"]);
    assert!(lines.contains("first waypoint, error") && lines.contains("fixes in "), "{lines}");

    let objects = objects(&succeed(&["replay", text(&map), text(&walk), "--floor", "F1", "--json"]));
    let of_kind = |kind: &str| objects.iter().filter(|object| object["record"] == kind).collect::<Vec<_>>();
    let (fixes, waypoints, summary) = (of_kind("fix"), of_kind("waypoint"), of_kind("summary"));
    assert_eq!((waypoints.len(), summary.len()), (7, 1));
    assert!(fixes.len() > 100, "{} fixes", fixes.len());
    assert_eq!(summary[0]["n_fixes"], fixes.len());
    assert_eq!(summary[0]["errors"]["n_points"], 6);
    assert!(summary[0]["errors"]["median_m"].as_f64().unwrap() < 2.5, "{}", summary[0]);
    assert!(waypoints.iter().all(|waypoint| waypoint["error_m"].is_f64()));
    let times: Vec<f64> = fixes.iter().map(|fix| fix["time_s"].as_f64().unwrap()).collect();
    assert!(times.is_sorted() && times[0] > 0.5, "{times:?}");
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    let (map, floor) = surveyed("replay_bits");
    let walk = trace(&floor, 0);
    let bits =
        |seed: &str| succeed(&["replay", text(&map), text(&walk), "--floor", "F1", "--bits", "--seed", seed]);
    let first = bits("1");
    assert_eq!(first, bits("1"));
    assert_ne!(first, bits("2"));
    let (digest, file) = first.trim_end().split_once("  ").unwrap();
    assert_eq!((digest.len(), file), (64, text(&walk)));
    let json = succeed(&["replay", text(&map), text(&walk), "--floor", "F1", "--bits", "--json"]);
    assert_eq!(objects(&json)[0]["bits_sha256"], digest);
}

#[test]
fn the_order_of_a_log_does_not_matter() {
    let (map, floor) = surveyed("replay_order");
    let shuffled = floor.join("shuffled.txt");
    let log = walk(0);
    let mut lines: Vec<&str> = log.lines().skip(1).collect();
    for chunk in lines.chunks_mut(40) {
        chunk.reverse();
    }
    fs::write(&shuffled, lines.join("\n")).unwrap();
    let digest = |path: &Path| {
        let line = succeed(&["replay", text(&map), text(path), "--floor", "F1", "--bits"]);
        line.split_once(' ').unwrap().0.to_owned()
    };
    assert_eq!(digest(&trace(&floor, 0)), digest(&shuffled));
}

#[test]
fn what_is_rejected_is_counted_by_cause() {
    let (map, floor) = surveyed("replay_rejections");
    let damaged = floor.join("damaged.txt");
    let mut lines: Vec<String> = walk(0).lines().map(String::from).collect();
    let accelerometer: Vec<usize> =
        (0..lines.len()).filter(|&k| lines[k].contains("ACCELEROMETER")).collect();
    lines[accelerometer[10]] = lines[accelerometer[10]].replace("0.01", "NaN");
    lines[accelerometer[20]] = lines[accelerometer[20]].replace("0.01", "99999");
    lines[accelerometer[30]] = lines[accelerometer[29]].clone();
    lines[accelerometer[40]].insert(0, '9');
    lines.push("1574567556121\tTYPE_ACCEL".into());
    fs::write(&damaged, lines.join("\r\n")).unwrap();
    let objects = objects(&succeed(&["replay", text(&map), text(&damaged), "--floor", "F1", "--json"]));
    let summary = objects.last().unwrap();
    assert_eq!(summary["samples_rejected"]["implausible"], 1);
    assert_eq!(summary["samples_rejected"]["duplicate"], 1);
    assert_eq!(summary["lines_rejected"]["number_is_not_finite"], 1);
    assert_eq!(summary["lines_rejected"]["malformed_time"], 1);
    assert_eq!(summary["lines_rejected"]["unknown_type"], 1);
    assert!(summary["errors"]["median_m"].as_f64().unwrap() < 3.0, "{summary}");
}

#[test]
fn a_start_is_a_waypoint_a_place_or_unknown() {
    let (map, floor) = surveyed("replay_start");
    let walk = trace(&floor, 0);
    let first = |start: &str| {
        let arguments = ["replay", text(&map), text(&walk), "--floor", "F1", "--json", "--start", start];
        objects(&succeed(&arguments)).into_iter().find(|object| object["record"] == "waypoint").unwrap()
    };
    assert!(first("waypoint")["error_m"].as_f64().unwrap() < 1.0);
    assert!(first("17,17")["error_m"].as_f64().unwrap() > 15.0);
    assert!(first("cold")["error_m"].is_null());
    let arguments = ["replay", text(&map), text(&walk), "--floor", "F1", "--start"];
    fail(
        &[&arguments[..], &["100,-50"]].concat(),
        1,
        &["walk-00.txt: the start, 100.0, -50.0, is not on", "--floor"],
    );
    fail(&[&arguments[..], &["there"]].concat(), 2, &["--start", "12.5,40"]);
}

#[test]
fn the_floor_must_be_one_of_the_map() {
    let (map, floor) = surveyed("replay_floor");
    let walk = trace(&floor, 0);
    let arguments = ["replay", text(&map), text(&walk)];
    fail(&arguments, 1, &["map: the building has several floors", "--floor one of: F1, F2"]);
    fail(&[&arguments[..], &["--floor", "F9"]].concat(), 1, &["no floor is called F9", "F1, F2"]);
}

#[test]
fn a_recording_of_another_floor_is_refused() {
    let (map, floor) = surveyed("replay_other_floor");
    let walk = trace(&floor, 0);
    let named = |name: &str| {
        let header = format!("#\tSiteID:1\tSiteName:Mall\tFloorId:2\tFloorName:{name}\n");
        let path = floor.join(format!("on-{name}.txt"));
        fs::write(&path, header + &fs::read_to_string(&walk).unwrap()).unwrap();
        path
    };
    fail(
        &["replay", text(&map), text(&named("F2")), "--floor", "F1"],
        1,
        &["on-F2.txt: recorded on floor F2, but the map is of F1", "--floor"],
    );
    succeed(&["replay", text(&map), text(&named("F1")), "--floor", "F1"]);
}

#[test]
fn a_damaged_map_is_refused() {
    let (map, floor) = surveyed("replay_map");
    let walk = trace(&floor, 0);
    let arguments = ["replay", text(&map), text(&walk), "--floor", "F1"];
    let (file, manifest) = (map.join("F1.safetensors"), map.join("building.json"));
    let mut bytes = fs::read(&file).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(&file, &bytes).unwrap();
    fail(&arguments, 1, &["F1.safetensors: the file is not the one", "copy the building's folder again"]);
    fs::write(&file, &bytes[..100]).unwrap();
    fail(&arguments, 1, &["F1.safetensors: "]);
    fs::remove_file(&file).unwrap();
    fail(&arguments, 1, &["F1.safetensors: cannot read the map", "check the path"]);
    let newer = fs::read_to_string(&manifest).unwrap().replace("\"version\": 1", "\"version\": 99");
    fs::write(&manifest, newer).unwrap();
    fail(&arguments, 1, &["building.json: written in format version 99", "update Fieldwalk"]);
    fs::write(&manifest, "[]").unwrap();
    fail(&arguments, 1, &["building.json: "]);
    fail(
        &["replay", text(&floor), text(&walk)],
        1,
        &["building.json: cannot read the map", "check the path"],
    );
}

#[test]
fn a_foreign_recording_fails_and_the_others_are_replayed() {
    let (map, floor) = surveyed("replay_foreign");
    let (walk, foreign, missing) = (trace(&floor, 0), floor.join("notes.txt"), floor.join("missing.txt"));
    fs::write(&foreign, "notes\n".repeat(1_000)).unwrap();
    let arguments =
        ["replay", text(&map), text(&foreign), text(&missing), text(&walk), "--floor", "F1", "--bits"];
    let said = [
        "notes.txt:1: of no known format",
        "missing.txt: cannot open the recording",
        "check the path",
        "2 of 3 recordings",
    ];
    fail(&arguments, 1, &said);
    let output = synthetic::fieldwalk(&arguments);
    assert!(String::from_utf8(output.stdout).unwrap().trim_end().ends_with("walk-00.txt"));
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let (map, floor) = surveyed("replay_pipe");
    let walk = trace(&floor, 0);
    // More output than a pipe holds.
    let mut arguments = vec!["replay", text(&map), "--floor", "F1", "--json"];
    arguments.extend([text(&walk); 8]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_fieldwalk"));
    let mut child = command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
