//! `fieldwalk evaluate --dataset uji-mag` on a small laboratory.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use synthetic::{fail, fieldwalk, folder, succeed, text};

/// The ends of two corridors and where they meet, in metres east and north of the first.
const NODES: [[f64; 2]; 3] = [[0.0, 0.0], [14.0, 0.0], [14.0, 12.0]];
const RATE_HZ: f64 = 10.0;
const SPEED_M_S: f64 = 1.1;
const STEPS_PER_S: f64 = 1.7;

/// A walk past `nodes`, as the collection writes it: by a phone held flat, its top edge ahead.
fn walk(nodes: &[usize]) -> String {
    let (mut rows, mut segments, mut n_rows) = (String::new(), String::new(), 0);
    // What an earlier walk left behind.
    writeln!(rows, "1000 40 40 40 3 3 3 170 40 40").unwrap();
    for pair in nodes.windows(2) {
        let (from, to) = (NODES[pair[0]], NODES[pair[1]]);
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let azimuth = dx.atan2(dy);
        let n = (dx.hypot(dy) / SPEED_M_S * RATE_HZ) as usize;
        let (sin, cos) = azimuth.sin_cos();
        for k in 0..n {
            let share = k as f64 / n as f64;
            let (x, y) = (from[0] + share * dx, from[1] + share * dy);
            let time_s = 0.1 * (n_rows + k + 1) as f64;
            let bob = 1.5 * (TAU * STEPS_PER_S * time_s).sin();
            // A field that the corridors' steel bends, seen by the phone.
            let (east, north) = (8.0 * (0.9 * x + 0.4 * y).sin(), 22.0 + 8.0 * (0.7 * x - 0.8 * y).sin());
            let (right, ahead) = (east * cos - north * sin, east * sin + north * cos);
            let up = -35.0 + 6.0 * (0.5 * x + 0.9 * y).cos();
            let wobble = 0.02 * (3.0 * time_s).sin();
            writeln!(
                rows,
                "{} {right:.4} {ahead:.4} {up:.4} {wobble:.4} 0.1 {bob:.4} {:.4} 0.5 {wobble:.4}",
                1_000 + 100 * (n_rows + k + 1),
                azimuth.to_degrees() + wobble
            )
            .unwrap();
        }
        let place = |[x, y]: [f64; 2]| format!("{:.9} {:.9}", 39.99 + y / 111_035.0, -0.07 + x / 85_400.0);
        let first = if n_rows == 0 { 0 } else { n_rows + 1 };
        n_rows += n;
        writeln!(segments, "{} {} {first} {n_rows}", place(from), place(to)).unwrap();
    }
    format!("{rows}<{}>\n{segments}", nodes.len() - 1)
}

fn write_laboratory(name: &str) -> PathBuf {
    let dir = folder(name);
    let write = |file: &str, text: &str| {
        let path = dir.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    for k in 1..=2 {
        write(&format!("lines/c1/l1n_0{k}.txt"), &walk(&[0, 1]));
        write(&format!("lines/c1/l1r_0{k}.txt"), &walk(&[1, 0]));
        write(&format!("lines/c2/l2n_0{k}.txt"), &walk(&[1, 2]));
        write(&format!("lines/c2/l2r_0{k}.txt"), &walk(&[2, 1]));
    }
    write("curves/c1/c1n2n_01.txt", &walk(&[0, 1, 2]));
    write("curves/c1/c2r1r_01.txt", &walk(&[2, 1, 0]));
    write("tests/t01.txt", &walk(&[0, 1, 0]));
    dir
}

fn rows(dir: &Path, arguments: &[&str]) -> Vec<Value> {
    let asked = ["evaluate", "--dataset", "uji-mag", text(dir), "--json"];
    let json = succeed(&[&asked, arguments].concat());
    json.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn walks_are_scored_at_cut_offs_on_the_map_of_the_lines() {
    let dir = write_laboratory("uji_mag_cut_offs");
    let rows = rows(&dir, &["--seeds", "1..2"]);
    let cut_offs: Vec<&Value> =
        rows.iter().filter(|row| row["points"] == "cut_off" && row["floor"] == "all").collect();
    assert!(cut_offs.len() >= 3, "a row a system: {rows:?}");
    for row in &cut_offs {
        // Five moments of three walks with two seeds.
        assert_eq!((&row["dataset"], &row["n_walks"]), (&"uji-mag".into(), &3.into()));
        assert_eq!((&row["n_points"], &row["n_without_fix"]), (&30.into(), &0.into()));
    }
    let fused = cut_offs.iter().find(|row| row["system"] == "fused").unwrap();
    assert!(fused["mean_m"].as_f64().unwrap() < 2.0, "{fused}");
    let of_kind = |kind: &str| rows.iter().filter(|row| row["points"] == kind).count();
    assert_eq!((of_kind("waypoint"), of_kind("midpoint")), (2 * cut_offs.len(), 2 * cut_offs.len()));
}

#[test]
fn the_layout_is_seen_and_its_table_shown() {
    let dir = write_laboratory("uji_mag_table");
    let shown = succeed(&["evaluate", text(&dir), "--systems", "fused", "--seeds", "1", "--start", "cold"]);
    assert!(shown.contains("uji-mag, start cold") && shown.contains("\nAt cut-offs\n"), "{shown}");
    let map = dir.join("lab.map");
    let surveyed = succeed(&["survey", text(&dir), "--layout", "uji-mag", "--coverage", "--out", text(&map)]);
    assert!(surveyed.contains("F1"), "{surveyed}");
    let replayed = succeed(&["replay", text(&map), text(&dir.join("tests/t01.txt")), "--json"]);
    assert!(replayed.contains("\"latitude_longitude_deg\":[39.99"), "{replayed:.400}");
}

#[test]
fn a_torn_walk_fails_and_a_folder_without_lines_is_no_laboratory() {
    let dir = write_laboratory("uji_mag_torn");
    let torn = dir.join("curves/c1/c1n2n_01.txt");
    let whole = fs::read_to_string(&torn).unwrap();
    fs::write(&torn, &whole[..whole.find('<').unwrap()]).unwrap();
    fail(&["evaluate", text(&dir)], 1, &["c1n2n_01.txt:", "ends before its segments", "give a file of UJI"]);
    fs::remove_dir_all(dir.join("lines")).unwrap();
    let asked = ["evaluate", "--dataset", "uji-mag", text(&dir)];
    fail(&asked, 1, &["no floor here", "lines/ and curves/"]);
}

#[test]
fn a_walk_whose_sensors_stood_still_is_scored_where_it_began() {
    let dir = write_laboratory("uji_mag_stuck");
    let path = dir.join("tests/t01.txt");
    let stuck: String = fs::read_to_string(&path)
        .unwrap()
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            [time, x, y, z, _, _, _, _, _, _] => format!("{time} {x} {y} {z} 0.1 0.1 0.1 90 0 0\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    fs::write(&path, stuck).unwrap();
    let output = fieldwalk(&["evaluate", text(&dir), "--systems", "fused", "--seeds", "1", "--json"]);
    assert!(output.status.success());
    let json = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let cut_off = rows.iter().find(|row| row["points"] == "cut_off").unwrap();
    assert_eq!((&cut_off["n_points"], &cut_off["n_walks"]), (&15.into(), &3.into()));
}
