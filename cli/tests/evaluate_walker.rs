//! `fieldwalk evaluate` on recordings of the walker's half.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use synthetic::{fail, fieldwalk, folder, succeed, text, write_floor};

/// A walk of two steps a second at 100 Hz, with foot switches read at 10 Hz.
fn write_run(dir: &Path, name: &str, seconds: usize) {
    let (mut samples, mut switches) = (String::new(), String::new());
    for k in 0..100 * seconds {
        let t = 0.01 * k as f64;
        writeln!(samples, "{},3,0.1,4.0,{}", 10_000_000 * k, 9.0 + 3.0 * (TAU * 2.0 * t).sin()).unwrap();
    }
    for k in 0..10 * seconds {
        writeln!(switches, "{},{},{}", 100_000_000 * k, u8::from(k % 10 < 6), u8::from((k + 5) % 10 < 6))
            .unwrap();
    }
    let run = dir.join(name);
    fs::create_dir_all(&run).unwrap();
    fs::write(run.join("accelerometer.csv"), samples).unwrap();
    fs::write(run.join("stepcounter.csv"), switches).unwrap();
}

#[test]
fn step_detectors_are_scored_a_row_a_placement_system_and_metric() {
    let dir = folder("evaluate_walker_rows");
    write_run(&dir, "Phone_A_Hard_InHand_1", 60);
    write_run(&dir, "Phone_A_Hard_InHand_2", 40);
    write_run(&dir, "Phone_A_Hard_Backpocket_1", 60);
    let json = succeed(&["evaluate", "--dataset", "oxford-steps", "--json", text(&dir)]);
    let rows: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let agreed = BTreeSet::from(["dataset", "subset", "system", "metric", "value", "n"]);
    for row in &rows {
        assert_eq!(row.as_object().unwrap().keys().map(String::as_str).collect::<BTreeSet<_>>(), agreed);
        assert_eq!(row["dataset"], "oxford-steps");
    }
    let row = |subset: &str, metric: &str| {
        let is_it = |row: &&Value| {
            (&row["subset"], &row["metric"], &row["system"])
                == (&subset.into(), &metric.into(), &"phone".into())
        };
        rows.iter().find(is_it).unwrap_or_else(|| panic!("{subset} {metric}"))
    };
    for (subset, n) in [("in_hand", 2), ("back_pocket", 1), ("all", 3)] {
        let abs = row(subset, "count_error_abs_percent");
        // The first and the last contact of a recording may be cut off.
        assert!(abs["n"] == n && abs["value"].as_f64().unwrap() < 3.0, "{abs}");
    }
    assert_eq!(rows.last().unwrap()["subset"], "all");
    let shown = succeed(&["evaluate", "--dataset", "oxford-steps", text(&dir)]);
    assert!(shown.contains("back_pocket") && shown.contains("count_error_signed_percent"), "{shown}");
}

#[test]
fn a_walk_without_truth_is_left_out_and_a_torn_one_fails() {
    let dir = folder("evaluate_walker_damage");
    write_run(&dir, "Phone_A_Hard_Purse_1", 30);
    write_run(&dir, "_Patient_1", 30);
    let switches = dir.join("_Patient_1/stepcounter.csv");
    fs::write(&switches, "0,1,1\n100000000,1,1\n").unwrap();
    let output = fieldwalk(&["evaluate", "--dataset", "oxford-steps", "--json", text(&dir)]);
    let warnings = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && warnings.contains("_Patient_1: its foot switches"), "{warnings}");
    assert!(!String::from_utf8(output.stdout).unwrap().contains("unstated"));

    fs::write(&switches, "no row\n").unwrap();
    let output = fieldwalk(&["evaluate", "--dataset", "oxford-steps", "--json", text(&dir)]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stdout).unwrap().contains("purse"), "the others are scored");
    assert!(String::from_utf8(output.stderr).unwrap().contains("stepcounter.csv:1"));

    let empty = folder("evaluate_walker_empty");
    fail(
        &["evaluate", "--dataset", "oxford-steps", text(&empty)],
        1,
        &["no folder here holds a stepcounter.csv"],
    );
}

#[test]
fn miscounted_walks_are_drawn() {
    let dir = folder("evaluate_walker_plots");
    write_run(&dir, "Phone_A_Hard_InHand_1", 60);
    write_run(&dir, "Phone_A_Hard_InHand_2", 60);
    // The switches of the second walk fail halfway.
    let switches = dir.join("Phone_A_Hard_InHand_2/stepcounter.csv");
    let rows = fs::read_to_string(&switches).unwrap();
    let half: String = rows.lines().take(300).map(|row| format!("{row}\n")).collect();
    fs::write(&switches, half).unwrap();
    let plots = dir.join("plots");
    succeed(&["evaluate", "--dataset", "oxford-steps", text(&dir), "--plots", text(&plots)]);
    let drawn: Vec<_> = fs::read_dir(&plots).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(drawn, ["Phone_A_Hard_InHand_2.svg"]);
    let picture = fs::read_to_string(plots.join("Phone_A_Hard_InHand_2.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("contacts (+"), "{picture:.300}");
    // A minute in strips of 20 s, each with its curve, and a tick for every contact and step.
    assert_eq!(picture.matches("<polyline").count(), 3);
    assert!(picture.matches("<line x1").count() > 150);
}

#[test]
fn step_lengths_are_scored_between_waypoints() {
    let floor = write_floor(&folder("evaluate_walker_lengths"), "F1", 6);
    let json = succeed(&["evaluate", "--dataset", "ilc", "--lengths", "--json", text(&floor)]);
    let rows: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let systems: Vec<&str> = rows.iter().map(|row| row["system"].as_str().unwrap()).collect();
    assert_eq!(systems, ["static", "fitted", "learnt", "static", "fitted", "learnt"]);
    for row in &rows {
        assert_eq!(row["metric"], "segment_length_error_percent");
        assert!(row["n"].as_u64().unwrap() >= 6 && row["value"].as_f64().unwrap() < 40.0, "{row}");
    }
    let value = |k: usize| rows[k]["value"].as_f64().unwrap();
    // All walk alike there: what is learnt on the first segment holds for the next.
    assert!(value(5) < value(4) && rows[5]["subset"] == "all", "{} {}", value(5), value(4));
}
