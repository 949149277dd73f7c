//! `fieldwalk simulate`, and what its recordings are good for.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk_formats::recording::{Record, open_recording};
use serde_json::Value;
use synthetic::{fail, folder, succeed, text};

/// All files below `dir`, with their bytes.
fn files(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(
                files(&path)
                    .into_iter()
                    .map(|(file, bytes)| (Path::new(path.file_name().unwrap()).join(file), bytes)),
            );
        } else {
            found.insert(path.file_name().unwrap().into(), fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn a_simulated_office_is_surveyed_and_walked() {
    let dir = folder("simulate_office");
    let (office, map) = (dir.join("office"), dir.join("map"));
    let said = succeed(&["simulate", "office", "--out", text(&office), "--walks", "2", "--seed", "3"]);
    assert!(said.contains("10 walks to survey and 2 to test with"), "{said}");
    succeed(&["survey", text(&office), "--out", text(&map), "--coverage"]);
    let walk = office.join("test/test-02.mcap");
    let json = succeed(&["replay", text(&map), text(&walk), "--json"]);
    let objects: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let summary = objects.last().unwrap();
    assert!(summary["errors"]["median_m"].as_f64().unwrap() < 1.5, "{summary}");

    // The truth beside it says where the fixes should be, at every one of them.
    let truth = fs::read_to_string(office.join("test/test-02.truth.csv")).unwrap();
    let mut lines = truth.lines();
    assert_eq!(lines.next(), Some("time_ns,x_m,y_m,heading_rad,floor"));
    let truth: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
    let began = open_recording(&walk).unwrap().next().unwrap().unwrap().time();
    let mut errors_m: Vec<f64> = objects
        .iter()
        .filter(|object| object["record"] == "fix")
        .map(|fix| {
            let number = |key: &str| fix[key].as_f64().unwrap();
            let time_ns = began.as_nanos() as f64 + 1e9 * number("time_s");
            let at = truth.partition_point(|point| point[0] < time_ns).min(truth.len() - 1);
            (number("x_m") - truth[at][1]).hypot(number("y_m") - truth[at][2])
        })
        .collect();
    errors_m.sort_by(f64::total_cmp);
    assert!(errors_m.len() > 100 && errors_m[errors_m.len() / 2] < 1.5, "{errors_m:?}");
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let dir = folder("simulate_bytes");
    let simulate = |name: &str, arguments: &[&str]| {
        let out = dir.join(name);
        succeed(
            &[&["simulate", "office", "--walks", "1", "--length", "20", "--out", text(&out)], arguments]
                .concat(),
        );
        files(&out)
    };
    let first = simulate("first", &[]);
    assert_eq!(first.len(), 1 + 2 * (10 + 1));
    assert!(first.contains_key(Path::new("survey/survey-10.truth.csv")));
    assert!(first == simulate("first", &["--seed", "1"]), "written again");
    let walk = Path::new("test/test-01.mcap");
    let pocket = simulate("pocket", &["--carry", "pocket"]);
    assert!(first[walk] != pocket[walk]);
    let survey = Path::new("survey/survey-01.mcap");
    assert!(first[survey] == pocket[survey], "the survey is held level");
    assert!(first[survey] != simulate("other", &["--seed", "2"])[survey]);
    // The recording has its walk's waypoints, among records in order of time.
    let records: Vec<Record> =
        open_recording(&dir.join("first").join(walk)).unwrap().collect::<Result<_, _>>().unwrap();
    assert!(records.is_sorted_by_key(Record::time));
    assert!(records.iter().filter(|record| matches!(record, Record::Waypoint { .. })).count() > 2);
}

/// Runs a command line that the program proposed, with `more` arguments, as a shell would.
#[cfg(unix)]
fn proposed(line: &str, more: &str) -> String {
    let program = env!("CARGO_BIN_EXE_fieldwalk");
    let line = format!("{} {more}", line.trim().replacen("fieldwalk", program, 1));
    let output = std::process::Command::new("sh").args(["-c", &line]).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[cfg(unix)]
#[test]
fn what_is_proposed_next_works_for_floors_cards_and_folders_with_spaces() {
    let dir = folder("simulate_next");
    for (scenario, more) in
        [("two-floors", &["--walks", "2"][..]), ("card-office", &["--walks", "1", "--card"])]
    {
        let out = dir.join(format!("a {scenario}"));
        let arguments = ["simulate", scenario, "--out", text(&out), "--length", "20", "--seed", "2"];
        let said = succeed(&[&arguments[..], more].concat());
        let [_, survey, replay] = said.lines().collect::<Vec<_>>()[..] else { panic!("{said}") };
        proposed(survey, "--coverage");
        let table = proposed(replay, "");
        let is_positioned = |line: &str| {
            let median_m = line.split_once("median ").and_then(|(_, rest)| rest.split_once(" m"));
            median_m.is_some_and(|(median_m, _)| median_m.parse::<f64>().unwrap() < 4.0)
        };
        assert!(table.contains("start given") && table.lines().any(is_positioned), "{table}");
    }
    // What a phone's system makes of a card's frames is nothing, and it says so.
    let (map, walk) = (dir.join("a card-office.map"), dir.join("a card-office/test/test-01.mcap"));
    let output = synthetic::fieldwalk(&["replay", text(&map), text(&walk)]);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && errors.contains("give --system card"), "{errors}");
    // Without walks there is nothing to replay.
    let out = dir.join("none");
    let said = succeed(&["simulate", "office", "--out", text(&out), "--walks", "0"]);
    assert!(said.contains("fieldwalk survey") && !said.contains("replay"), "{said}");
}

#[test]
fn two_floors_are_two_folders_and_the_test_walks_climb() {
    let dir = folder("simulate_floors");
    let site = dir.join("site");
    succeed(&["simulate", "two-floors", "--out", text(&site), "--walks", "1", "--length", "40"]);
    let json = succeed(&["survey", text(&site), "--out", text(&dir.join("map")), "--coverage", "--json"]);
    let floors: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(floors.iter().map(|floor| &floor["floor"]).collect::<Vec<_>>(), ["F1", "F2"]);
    assert!(floors.iter().all(|floor| floor["refused_walks"].as_array().unwrap().is_empty()), "{json}");
    let truth = fs::read_to_string(site.join("test/test-01.truth.csv")).unwrap();
    for floor in [",0", ",1"] {
        assert!(truth.lines().any(|line| line.ends_with(floor)), "{floor}");
    }
}

#[test]
fn scenarios_are_listed_and_foreign_files_are_not_mixed_in() {
    let list = succeed(&["simulate", "--list"]);
    assert!(list.starts_with("office ") && list.contains("two-floors"), "{list}");
    let dir = folder("simulate_foreign");
    fail(&["simulate", "castle", "--out", text(&dir)], 2, &["castle", "office"]);
    fail(&["simulate"], 2, &["SCENARIO"]);
    fail(&["simulate", "office", "--out", text(&dir), "--carry", "hat"], 2, &["level, upright"]);
    fs::create_dir_all(dir.join("test")).unwrap();
    fs::write(dir.join("test/test-09.mcap"), "of another run").unwrap();
    let said = ["test-09.mcap: a file of something else", "another --out"];
    fail(&["simulate", "office", "--out", text(&dir), "--walks", "8"], 1, &said);
}
