//! `fieldwalk evaluate` on an emitter among receivers.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use synthetic::{fail, fieldwalk, folder, succeed, text};

const RECEIVERS: [(f64, f64); 6] = [(1.0, 1.0), (9.0, 1.0), (5.0, 4.0), (1.0, 9.0), (9.0, 9.0), (5.0, 6.5)];

/// A packet a half second at −60 − 20·log10(d) dBm, in turns 4 dB more and less: whole dBm as receivers tell them.
fn rssi_dbm(receiver: usize, (x_m, y_m): (f64, f64), packet: usize) -> f64 {
    let (dx, dy) = (x_m - RECEIVERS[receiver].0, y_m - RECEIVERS[receiver].1);
    // The sequence of signs repeats after 7 and 5: no two receivers fade alike.
    let fading_db = if (packet * 3 + receiver) % 7 < 3 + (packet + receiver) % 2 { 4.0 } else { -4.0 };
    (-60.0 - 10.0 * (dx * dx + dy * dy).max(1.0).log10() + fading_db).round()
}

fn line(packet: usize, receiver: usize, place: (f64, f64)) -> String {
    let time_s = 1e9 + 0.5 * packet as f64;
    format!("{time_s:.2},0000000000{receiver:02},e78f135624ce,{}", rssi_dbm(receiver, place, packet))
}

/// A room of 10 × 10 m with sixteen fixed points, and a track across it.
fn write_collection(dir: &Path) {
    let (cnf, set, trk) = (dir.join("cnf"), dir.join("hst/set_1"), dir.join("trk"));
    [&cnf, &set, &trk].iter().for_each(|dir| fs::create_dir_all(dir).unwrap());
    let devices: Vec<String> = RECEIVERS
        .iter()
        .enumerate()
        .map(|(k, (x_m, y_m))| format!(r#""0000000000{k:02}": [[{x_m}, {y_m}, 2.0], 0, "sensor{k}"]"#))
        .collect();
    fs::write(cnf.join("room.dev"), format!("Dongles:{{{}}}\n", devices.join(", "))).unwrap();
    fs::write(cnf.join("room.par"), r#"{"limits": [0, 0, 10, 10]}"#).unwrap();
    for point in 0..16 {
        let place = (0.7 + 2.8 * f64::from(point % 4), 0.6 + 2.9 * f64::from(point / 4));
        for receiver in 0..RECEIVERS.len() {
            let lines: String = (0..60).map(|packet| line(packet, receiver, place) + "\n").collect();
            let name = format!("sensor{receiver}_{:.2}_{:.2}_1.85.mbd", place.0, place.1);
            fs::write(set.join(name), lines).unwrap();
        }
    }
    let mut track = String::new();
    for packet in 0..80 {
        let place = (1.0 + 0.1 * packet as f64, 5.0);
        for receiver in 0..RECEIVERS.len() {
            let line = line(packet, receiver, place);
            writeln!(track, "{line},{},{},1.8,0,0,0,0,0,0,0,0,0", place.0, place.1).unwrap();
        }
    }
    fs::write(trk.join("across_all_sensors.mbd"), track).unwrap();
}

#[test]
fn ranges_places_and_matches_are_scored_a_row_a_subset_system_and_metric() {
    let dir = folder("evaluate_radio_rows");
    write_collection(&dir);
    let json = succeed(&["evaluate", "--dataset", "ble-annotated", "--json", text(&dir)]);
    let rows: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let agreed = BTreeSet::from(["dataset", "subset", "system", "metric", "value", "n"]);
    for row in &rows {
        assert_eq!(row.as_object().unwrap().keys().map(String::as_str).collect::<BTreeSet<_>>(), agreed);
        assert_eq!(row["dataset"], "ble-annotated");
    }
    let row = |subset: &str, system: &str, metric: &str| {
        let is_it = |row: &&Value| {
            (&row["subset"], &row["system"], &row["metric"])
                == (&subset.into(), &system.into(), &metric.into())
        };
        let row = rows.iter().find(is_it).unwrap_or_else(|| panic!("{subset} {system} {metric}"));
        (row["value"].as_f64().unwrap(), row["n"].as_u64().unwrap())
    };
    // 29 whole rounds at each of 16 points, of which 25 end a window of five; 6 receivers a round.
    assert_eq!(row("fixed", "raw_range_1s", "range_bias_m").1, 29 * 16 * 6);
    assert_eq!(row("fixed", "trilateration_5s", "place_error_median_m").1, 25 * 16);
    assert_eq!(row("tracks", "radar", "place_error_median_m").1, 39);
    for subset in ["fixed", "fixed_near", "tracks", "tracks_near"] {
        let raw_m = row(subset, "raw_range_1s", "range_bias_m").0;
        let unbiased_m = row(subset, "unbiased_range_1s", "range_bias_m").0;
        assert!(unbiased_m.abs() < 0.5 * raw_m, "{subset}: {raw_m} {unbiased_m}");
        let placed = row(subset, "trilateration_1s", "placed_percent").0;
        let robust_m = row(subset, "trilateration_5s", "place_error_median_m").0;
        assert!(placed == 100.0 && robust_m < 1.0, "{subset}: {placed} {robust_m}");
        assert!(row(subset, "ble_filter", "truth_near_match_percent").0 > 90.0, "{subset}");
    }
    let shown = succeed(&["evaluate", "--dataset", "ble-annotated", text(&dir)]);
    assert!(shown.contains("tracks_near") && shown.contains("trilateration_printed_5s"), "{shown}");
}

#[test]
fn bad_lines_are_told_and_a_folder_of_something_else_fails() {
    let dir = folder("evaluate_radio_damage");
    write_collection(&dir);
    let track = dir.join("trk/across_all_sensors.mbd");
    let mut lines = fs::read_to_string(&track).unwrap();
    lines.push_str("torn,line\n1000000003.5,ffffffffffff,e78f135624ce,-70,1,1,1,0,0,0,0,0,0,0,0,0\n");
    fs::write(&track, &lines).unwrap();
    let output = fieldwalk(&["evaluate", "--dataset", "ble-annotated", "--json", text(&dir)]);
    let warnings = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{warnings}");
    assert!(warnings.contains("across: 1 lines are not of the format"), "{warnings}");
    assert!(warnings.contains("across: 1 lines tell no place or no known receiver"), "{warnings}");

    fs::write(&track, "no line\n").unwrap();
    let output = fieldwalk(&["evaluate", "--dataset", "ble-annotated", "--json", text(&dir)]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stderr).unwrap().contains("across_all_sensors.mbd:1: not an .mbd file"));
    assert!(String::from_utf8(output.stdout).unwrap().contains("fixed_near"), "the others are scored");

    let empty = folder("evaluate_radio_empty");
    fail(&["evaluate", "--dataset", "ble-annotated", text(&empty)], 1, &["cnf"]);
}
