//! `fieldwalk report`, and the report of an evaluation, on small floors.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::fs;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use synthetic::{fail, folder, succeed, text, trace, walk, write_floor};

/// Those that are played.
const SYSTEMS: [&str; 3] = ["dead-reckoning", "mass-centered", "fused"];

/// A map of F1 that has not seen the walks of fold 0, and F1's folder.
fn surveyed(name: &str) -> (PathBuf, PathBuf) {
    let site = folder(name);
    let (floor, map) = (write_floor(&site, "F1", 8), site.join("map"));
    succeed(&["survey", text(&site), "--out", text(&map), "--fold", "0", "--coverage"]);
    (map, floor)
}

/// What the page in `file` knows.
fn figures(file: &Path) -> Value {
    let html = fs::read_to_string(file).unwrap();
    let (_, rest) = html.split_once("id=\"figures\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// A packed array of four-byte numbers.
fn unpacked(packed: &Value) -> Vec<i32> {
    let bytes = STANDARD.decode(packed.as_str().unwrap()).unwrap();
    bytes.chunks_exact(4).map(|four| i32::from_le_bytes(four.try_into().unwrap())).collect()
}

#[test]
fn a_report_plays_the_fixes_that_a_replay_prints() {
    let (map, floor) = surveyed("report_fixes");
    let (walks, out) = ([trace(&floor, 0), trace(&floor, 5)], floor.join("walks.html"));
    let said = succeed(&[
        "report",
        text(&map),
        text(&walks[0]),
        text(&walks[1]),
        "--out",
        text(&out),
        "--title",
        "<b>&",
        "--systems",
        &SYSTEMS.join(","),
    ]);
    assert_eq!(said, format!("{} plays 2 walks: open it in a browser\n", out.display()));
    let figures = figures(&out);
    assert_eq!((&figures["title"], &figures["n_walks"]), (&"<b>&".into(), &2.into()));
    assert_eq!(figures["systems"], serde_json::json!(SYSTEMS));
    assert_eq!(
        (figures["rows"].as_array().unwrap().len(), figures["curves"].as_array().unwrap().len()),
        (2 * SYSTEMS.len(), SYSTEMS.len())
    );
    let fused = SYSTEMS.iter().position(|&name| name == "fused").unwrap();
    let mean_m = |k: usize| figures["walks"][k]["errors"][fused]["mean_m"].as_f64().unwrap();
    assert!(mean_m(0) >= mean_m(1), "the worst comes first");

    let played = figures["walks"].as_array().unwrap().iter().find(|walk| walk["name"] == "walk-00").unwrap();
    let track = &played["tracks"][fused];
    let (times, places) = (unpacked(&track["time"]), unpacked(&track["place"]));
    assert!(times.is_sorted() && places.len() == 2 * times.len());
    let json = succeed(&["replay", text(&map), text(&walks[0]), "--floor", "F1", "--json"]);
    let (mut n_fixes, mut errors_cm) = (0, Vec::new());
    for line in json.lines() {
        let object: Value = serde_json::from_str(line).unwrap();
        let number = |key: &str| object[key].as_f64().unwrap();
        if object["record"] == "fix" {
            let k = times.binary_search(&((1e3 * number("time_s")).round() as i32)).unwrap();
            let cm = [100.0 * number("x_m"), 100.0 * number("y_m")].map(|cm| cm.round() as i32);
            assert_eq!(places[2 * k..2 * k + 2], cm);
            n_fixes += 1;
        }
        if object["record"] == "waypoint" {
            errors_cm.push((100.0 * number("error_m")).round() as u16);
        }
    }
    assert!(n_fixes > 100, "{n_fixes} fixes");
    let scored = STANDARD.decode(track["scored_error"].as_str().unwrap()).unwrap();
    let scored: Vec<u16> = scored.chunks_exact(2).map(|two| u16::from_le_bytes([two[0], two[1]])).collect();
    assert_eq!(scored, errors_cm[1..], "all waypoints but the first");
    assert_eq!(played["truth"]["kind"], "waypoints");
    assert_eq!(played["bands"][0]["spans"][0]["label"], "started");
}

#[test]
fn a_walk_whose_truth_nobody_knows_is_played_without_errors() {
    let (map, floor) = surveyed("report_truthless");
    let unmarked: Vec<String> =
        walk(0).lines().filter(|line| !line.contains("TYPE_WAYPOINT")).map(String::from).collect();
    let log = floor.join("unmarked.txt");
    fs::write(&log, unmarked.join("\n")).unwrap();
    let out = floor.join("unmarked.html");
    for start in ["cold", "waypoint", "3,3"] {
        succeed(&[
            "report",
            text(&map),
            text(&log),
            "--start",
            start,
            "--systems",
            "fused",
            "--out",
            text(&out),
        ]);
        let figures = figures(&out);
        let played = &figures["walks"][0];
        assert_eq!((&played["truth"]["kind"], &played["errors"][0]), (&"none".into(), &Value::Null));
        assert!(unpacked(&played["tracks"][0]["time"]).len() > 100);
        assert_eq!((&figures["rows"], &figures["curves"]), (&serde_json::json!([]), &serde_json::json!([])));
    }
}

#[test]
fn a_truth_beside_the_recording_is_scored_once_a_second() {
    let (map, floor) = surveyed("report_truth");
    let (log, out) = (trace(&floor, 0), floor.join("truth.html"));
    let began_ms = 1_574_567_556_121_i64;
    let lines: String =
        (0..=200).map(|k| format!("{},3,3,0,0\n", (began_ms + 100 * k) * 1_000_000)).collect();
    let truth = log.with_extension("truth.csv");
    fs::write(&truth, format!("time_ns,x_m,y_m,heading_rad,floor\n{lines}")).unwrap();
    let arguments = ["report", text(&map), text(&log), "--systems", "fused", "--out", text(&out)];
    succeed(&arguments);
    let figures = figures(&out);
    assert_eq!(figures["walks"][0]["truth"]["kind"], "continuous");
    let rows = figures["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &rows[0]["points"], &rows[0]["n_points"]), (1, &"truth".into(), &16.into()));
    fs::write(&truth, "time_ns,x_m,y_m,heading_rad,floor\n5,3,3,0,0\n4,3,3,0,0\n").unwrap();
    fail(&arguments, 1, &["walk-00.truth.csv:3: not a later time"]);
}

#[test]
fn an_evaluation_leaves_a_report_of_its_worst_walks() {
    let site = folder("report_evaluation");
    write_floor(&site, "F1", 12);
    write_floor(&site, "F2", 6);
    let out = site.join("report.html");
    let options = ["--systems", "dead-reckoning,fused", "--seeds", "1..2", "--json", "--walks", "2"];
    let rows = succeed(&[&["evaluate", text(&site), "--report", text(&out)][..], &options].concat());
    let figures = figures(&out);
    assert_eq!(figures["walks"].as_array().unwrap().len(), 2);
    let all: Vec<Value> = rows.lines().map(|row| serde_json::from_str(row).unwrap()).collect();
    assert_eq!(figures["rows"], Value::Array(all), "the table is the evaluation's");
    let mean_m = |k: usize| figures["walks"][k]["errors"][1]["mean_m"].as_f64().unwrap();
    assert!(mean_m(0) >= mean_m(1));
    let curve = &figures["curves"][1];
    let pooled = figures["rows"].as_array().unwrap().iter().find(|row| {
        (&row["floor"], &row["system"], &row["points"])
            == (&"all".into(), &"fused".into(), &"waypoint".into())
    });
    let median_cm = (100.0 * pooled.unwrap()["median_m"].as_f64().unwrap()).round() as i64;
    assert_eq!(
        (curve["quantiles_cm"][100].as_i64(), &curve["n_points"]),
        (Some(median_cm), &pooled.unwrap()["n_points"])
    );
}

#[test]
fn what_cannot_be_reported_is_named() {
    let (map, floor) = surveyed("report_refused");
    let (log, empty, out) = (trace(&floor, 0), floor.join("empty.txt"), floor.join("report.html"));
    fs::write(&empty, "").unwrap();
    fail(&["report", text(&map), text(&empty), "--out", text(&out)], 1, &["empty.txt: an empty file"]);
    assert!(!out.exists());
    fail(
        &["report", text(&map), text(&empty), text(&log), "--out", text(&out)],
        1,
        &["empty.txt: an empty file"],
    );
    assert_eq!(figures(&out)["walks"].as_array().unwrap().len(), 1);
    fail(
        &["report", text(&map), text(&log), "--start", "900,3"],
        1,
        &["the start, 900.0, 3.0, is not on the plan"],
    );
    let other = floor.join("other.txt");
    fs::write(&other, format!("#\tFloorName:F7\n{}", walk(0))).unwrap();
    fail(&["report", text(&map), text(&other)], 1, &["recorded on floor F7, but the map is of F1"]);
    fs::create_dir(floor.join("folder")).unwrap();
    let folder = floor.join("folder");
    fail(
        &["report", text(&map), text(&log), "--out", text(&folder)],
        1,
        &["folder: cannot write the report"],
    );
    // Before any walk is scored: the floor's bad walk is not even read.
    let site = floor.parent().unwrap();
    fs::write(trace(&floor, 3), "not a trace\n").unwrap();
    let output = synthetic::fieldwalk(&["evaluate", text(site), "--report", text(&folder)]);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.contains("folder: cannot write the report") && !errors.contains("walk-03"), "{errors}");
    fail(&["evaluate", "F1", "--walks", "3"], 2, &["--report"]);
}
