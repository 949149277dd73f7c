//! `fieldwalk train attitude`, and its table in `fieldwalk evaluate --dataset tyrex`.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use synthetic::{fail, fieldwalk, folder, succeed, text};

const STEPS_PER_S: f64 = 1.8;

/// What a phone feels at 50 Hz that is held level before the chest, its top edge ahead, for `seconds`: time in seconds
/// and specific force in m/s². The body bobs with every step, surges with it, and sways with every other.
fn held_level(seconds: usize, does_walk: bool) -> Vec<(f64, [f64; 3])> {
    let share = if does_walk { 1.0 } else { 0.0 };
    (0..50 * seconds)
        .map(|k| {
            let t = 0.02 * k as f64;
            let step = TAU * STEPS_PER_S * t;
            let force = [0.5 * (0.5 * step).sin(), 0.8 * (step + 0.5 * PI).sin(), 2.0 * step.sin()];
            (t, [share * force[0], share * force[1], 9.81 + share * force[2]])
        })
        .collect()
}

/// The same as a log of GetSensorData.
fn write_log(path: &Path, seconds: usize, does_walk: bool) {
    let mut log = String::from("% LogFile\n");
    for (t, [x, y, z]) in held_level(seconds, does_walk) {
        writeln!(log, "GYRO;{t:.3};{t:.3};0.0;0.0;0.0;3\nACCE;{t:.3};{t:.3};{x:.4};{y:.4};{z:.4};3").unwrap();
    }
    fs::write(path, log).unwrap();
}

/// The benchmark's folder with one trial of texting.
fn write_benchmark(dir: &Path) -> PathBuf {
    let root = dir.join("benchmark");
    let trial = root.join("android/Ada_Phone_NoDist_Texting");
    fs::create_dir_all(&trial).unwrap();
    fs::create_dir_all(root.join("qualisys")).unwrap();
    let (mut forces, mut rates, mut fields) = (String::new(), String::new(), String::new());
    for (t, [x, y, z]) in held_level(60, true) {
        writeln!(forces, "{t:.3} {x:.4} {y:.4} {z:.4}").unwrap();
        writeln!(rates, "{t:.3} 0.0 0.0 0.0 0.0 0.0 0.0").unwrap();
        writeln!(fields, "{t:.3} 0.0 20.0 -40.0 0.0 0.0 0.0").unwrap();
    }
    for (name, log) in [("accelerometer", forces), ("gyroscope", rates), ("magnetometer", fields)] {
        fs::write(trial.join(format!("{name}.txt")), log).unwrap();
    }
    fs::write(trial.join("timeAlignment.txt"), "0.0\n").unwrap();
    // The reader's fuzzing begins with a capture of two frames, which is enough to be read.
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds/tyrex_capture/two_frames");
    fs::copy(seed, root.join("qualisys/Ada_Phone_NoDist_Texting.mat")).unwrap();
    root
}

/// The four columns of a table, each eight likelihoods.
fn columns(table: &str) -> Vec<Vec<f64>> {
    let table: Value = serde_json::from_str(table).unwrap();
    let rows = table["likelihood"].as_array().unwrap();
    assert_eq!((rows.len(), table["prior"].as_array().unwrap().len()), (8, 4));
    (0..4).map(|column| rows.iter().map(|row| row[column].as_f64().unwrap()).collect()).collect()
}

#[test]
fn a_walk_becomes_a_table_of_distributions() {
    let dir = folder("train_walk");
    let (long, short) = (dir.join("long.txt"), dir.join("short.txt"));
    write_log(&long, 180, true);
    write_log(&short, 20, true);
    let output = fieldwalk(&["train", "attitude", text(&long), text(&short)]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("strides") && !said.contains("rough"), "{said}");
    let printed = String::from_utf8(output.stdout).unwrap();
    let columns = columns(&printed);
    for column in &columns {
        assert!(
            (column.iter().sum::<f64>() - 1.0).abs() < 1e-4 && column.iter().all(|&p| p >= 0.0),
            "{column:?}"
        );
    }
    // A walk of one kind has its strides in few rows, and another way to point has them in others.
    let likeliest = |column: &[f64]| (0..8).max_by(|&a, &b| column[a].total_cmp(&column[b])).unwrap();
    assert!(columns[0][likeliest(&columns[0])] > 0.5, "{columns:?}");
    assert_ne!(likeliest(&columns[0]), likeliest(&columns[1]), "{columns:?}");

    let file = dir.join("table.json");
    assert_eq!(succeed(&["train", "attitude", text(&long), text(&short), "--out", text(&file)]), "");
    assert_eq!(fs::read_to_string(&file).unwrap(), printed);

    let output = fieldwalk(&["train", "attitude", text(&short)]);
    assert!(String::from_utf8(output.stderr).unwrap().contains("make a rough table: walk 200 or more"));
}

#[test]
fn who_stands_trains_nothing() {
    let dir = folder("train_nothing");
    let still = dir.join("still.txt");
    write_log(&still, 60, false);
    fail(&["train", "attitude", text(&still)], 1, &["no stride in these recordings", "held level"]);
    fail(
        &["train", "attitude", text(&dir.join("none.txt"))],
        1,
        &["none.txt: cannot open", "check the path"],
    );
    fail(&["train", "attitude", text(&dir)], 1, &["no trial of the attitude benchmark"]);
}

#[test]
fn a_table_from_a_file_is_one_more_system() {
    let dir = folder("train_table");
    let root = write_benchmark(&dir);
    let file = dir.join("table.json");
    succeed(&["train", "attitude", text(&root), "--out", text(&file)]);
    let evaluate = ["evaluate", "--dataset", "tyrex", text(&root), "--json"];
    let systems = |arguments: &[&str]| -> Vec<String> {
        let json = succeed(arguments);
        let row = |line: &str| serde_json::from_str::<Value>(line).unwrap();
        json.lines().map(|line| row(line)["system"].as_str().unwrap().to_owned()).collect()
    };
    let with_table = [&evaluate[..], &["--table", text(&file)]].concat();
    assert!(!systems(&evaluate).contains(&"file".to_owned()));
    assert!(systems(&with_table).contains(&"file".to_owned()));

    let table = fs::read_to_string(&file).unwrap();
    for (damaged, said) in [
        ("{}".to_owned(), "not a table of events"),
        (table.replacen("0.7", "0.9", 1), "no distribution"),
        (" ".repeat(70_000), "larger than any table"),
    ] {
        fs::write(&file, damaged).unwrap();
        fail(&with_table, 1, &["table.json: ", said, "write one with `fieldwalk train attitude`"]);
    }
    fs::remove_file(&file).unwrap();
    fail(&with_table, 1, &["table.json: cannot open the table"]);
}

#[test]
fn a_folder_may_be_an_export_of_sensor_logger() {
    let dir = folder("train_export");
    let export = dir.join("2026-10-03_17-02-05");
    fs::create_dir_all(&export).unwrap();
    fs::write(
        export.join("Metadata.csv"),
        "version,device name,recording epoch time,platform,standardisation\n3,Pixel 8,1698501144400,android,false\n",
    )
    .unwrap();
    let mut rows = String::from("time,seconds_elapsed,z,y,x\n");
    for (t, [x, y, z]) in held_level(60, true) {
        writeln!(rows, "{},{t:.3},{z:.4},{y:.4},{x:.4}", 1_698_501_144_400_000_000 + (1e9 * t) as i64)
            .unwrap();
    }
    fs::write(export.join("TotalAcceleration.csv"), &rows).unwrap();
    let rates = rows.lines().map(|row| match row.split(',').collect::<Vec<_>>()[..] {
        [time, seconds, ..] if time != "time" => format!("{time},{seconds},0,0,0\n"),
        _ => format!("{row}\n"),
    });
    fs::write(export.join("Gyroscope.csv"), rates.collect::<String>()).unwrap();
    let table: Value = serde_json::from_str(&succeed(&["train", "attitude", text(&export)])).unwrap();
    assert_eq!(table["likelihood"].as_array().unwrap().len(), 8);
}
