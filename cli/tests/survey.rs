//! `fieldwalk survey` on small floors.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::fs;

use serde_json::Value;
use synthetic::{fail, folder, succeed, text, trace, walk, write_floor};

#[test]
fn a_survey_writes_a_map_and_says_what_it_is_worth() {
    let site = folder("survey_writes").join("mall");
    let map = site.join("map");
    write_floor(&site, "F1", 8);
    write_floor(&site, "F2", 4);
    let table = succeed(&["survey", text(&site), "--out", text(&map)]);
    assert!(table.contains("mall: map in ") && table.contains(" F1 ") && table.contains(" F2 "), "{table}");
    assert!(map.join("building.json").is_file() && map.join("F2.safetensors").is_file());

    assert!(site.join("map-F1-survey.svg").is_file() && table.contains("map-F2-survey.svg"), "{table}");

    let pictures = site.join("made for/pictures");
    let json =
        succeed(&["survey", text(&site), "--out", text(&map), "--pictures", text(&pictures), "--json"]);
    let floors: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let [first, second] = &floors[..] else { panic!("{json}") };
    assert_eq!(
        (&first["floor"], &second["ordinal"], &first["n_walks"]),
        (&"F1".into(), &1.into(), &8.into())
    );
    assert_eq!(first["file_bytes"], fs::metadata(map.join("F1.safetensors")).unwrap().len());
    assert_eq!(first["n_transmitters"], 3);
    let picture = fs::read_to_string(first["picture"].as_str().unwrap()).unwrap();
    assert_eq!(first["picture"], text(&pictures.join("map-F1-survey.svg")));
    let document = roxmltree::Document::parse(&picture).unwrap();
    let n_lines = document.descendants().filter(|node| node.attribute("class") == Some("fw-walk")).count();
    assert!(n_lines == 8 && picture.contains("(48 waypoints)"), "{n_lines} lines");
    let number = |key: &str| first[key].as_f64().unwrap();
    // 8 walks of 6 lines of 14 m at 1.8 steps in 1.2 m; 400 m² without the shop's 64 m², all near the loop.
    assert!((number("route_m") - 672.0).abs() < 1e-6, "{first}");
    assert!((900.0..1_100.0).contains(&number("n_steps")), "{first}");
    assert!((300.0..350.0).contains(&number("open_m2")) && number("covered_m2") > 300.0, "{first}");
    let expected = &first["expected_accuracy"];
    assert_eq!(expected["n_points"], 48);
    assert!(expected["median_m"].as_f64().unwrap() < 2.5, "{expected}");
}

#[test]
fn a_fold_leaves_its_test_walks_out() {
    let site = folder("survey_fold");
    let floor = write_floor(&site, "F1", 12);
    let map = site.join("map");
    let json = succeed(&["survey", text(&floor), "--out", text(&map), "--fold", "0", "--coverage", "--json"]);
    let report: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(report["n_walks"], 9);
    assert!(report["expected_accuracy"].is_null());
}

#[test]
fn a_walk_that_cannot_be_used_is_listed_and_the_others_are_mapped() {
    let site = folder("survey_refuses");
    let floor = write_floor(&site, "F1", 6);
    let map = site.join("map");
    fs::write(trace(&floor, 1), b"\x7fELF\x02\x01\x01\0 not a trace").unwrap();
    let without_waypoints: String =
        walk(2).lines().filter(|line| !line.contains("WAYPOINT")).map(|line| format!("{line}\n")).collect();
    fs::write(trace(&floor, 2), without_waypoints).unwrap();
    let standing: String = walk(3)
        .lines()
        .filter(|line| !line.contains("ACCELEROMETER"))
        .map(|line| format!("{line}\n"))
        .collect();
    fs::write(trace(&floor, 3), standing).unwrap();
    // Torn in the middle of a line, with a line of nonsense before that.
    let torn = walk(4).replacen("TYPE_GYROSCOPE\t0\t0", "TYPE_GYROSCOPE\tnan\t0", 1);
    fs::write(trace(&floor, 4), &torn[..torn.len() / 2 + 7]).unwrap();

    let table = succeed(&["survey", text(&floor), "--out", text(&map), "--coverage"]);
    for said in [
        "walk-01.txt: line 1: of no known format",
        "walk-02.txt: 0 waypoints, where two are needed",
        "walk-03.txt: no steps between its waypoints",
        "2 lines not understood, the first: ",
        "walk-04.txt:",
    ] {
        assert!(table.contains(said), "`{said}` is missing: {table}");
    }
    let json = succeed(&["survey", text(&floor), "--out", text(&map), "--coverage", "--json"]);
    let report: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(report["n_walks"], 3);
    assert_eq!(report["refused_walks"].as_array().unwrap().len(), 3);
    assert_eq!(report["n_lines_rejected"], 2);
}

/// `walk` with the first `n` of its waypoints 500 m to the east.
fn moved(walk: &str, n: usize) -> String {
    let mut n_seen = 0;
    let line = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        let [ms, "TYPE_WAYPOINT", x, y] = fields[..] else { return format!("{line}\n") };
        n_seen += 1;
        let x_m: f64 = x.parse().unwrap();
        format!("{ms}\tTYPE_WAYPOINT\t{}\t{y}\n", if n_seen <= n { x_m + 500.0 } else { x_m })
    };
    walk.lines().map(line).collect()
}

#[test]
fn what_lies_beside_the_plan_is_refused_or_counted() {
    let site = folder("survey_off_plan");
    let floor = write_floor(&site, "F1", 4);
    let map = site.join("map");
    fs::write(trace(&floor, 1), moved(&walk(1), 100)).unwrap();
    fs::write(trace(&floor, 2), moved(&walk(2), 2)).unwrap();
    let arguments = ["survey", text(&floor), "--out", text(&map), "--coverage"];
    let table = succeed(&arguments);
    for said in [
        "F1: 2 waypoints beside the plan",
        "walk-01.txt: no waypoint on the plan, the first at 517.0, 3.0, where the plan has 20.0 m x 20.0 m",
    ] {
        assert!(table.contains(said), "`{said}` is missing: {table}");
    }
    let report: Value = serde_json::from_str(&succeed(&[&arguments[..], &["--json"]].concat())).unwrap();
    assert_eq!((&report["n_walks"], &report["n_waypoints_off_plan"]), (&3.into(), &2.into()));
}

#[test]
fn a_survey_without_usable_walks_says_so_and_writes_nothing() {
    let site = folder("survey_empty");
    let map = site.join("map");
    let empty = write_floor(&site, "F1", 0);
    fail(
        &["survey", text(&empty), "--out", text(&map)],
        1,
        &["F1: no walk to survey with", "put recordings"],
    );
    let foreign = write_floor(&site, "F2", 1);
    fs::write(trace(&foreign, 0), "name,value\n1,2\n").unwrap();
    let said = ["F2: none of 1 walks can be used (tap a waypoint", "walk-00.txt: line 1: of no known format"];
    fail(&["survey", text(&foreign), "--out", text(&map)], 1, &said);
    let tested = write_floor(&site, "F3", 1);
    fail(
        &["survey", text(&tested), "--out", text(&map), "--fold", "0"],
        1,
        &["F3: every walk is", "another --fold"],
    );
    assert!(!map.exists());
}

#[test]
fn a_plan_that_cannot_be_read_is_named() {
    let site = folder("survey_plan");
    let (floor, map) = (write_floor(&site, "F1", 2), site.join("map"));
    let arguments = ["survey", text(&floor), "--out", text(&map)];
    fs::write(floor.join("geojson_map.json"), synthetic::plan(&[])).unwrap();
    fail(&arguments, 1, &["survey_plan/F1", "outline"]);
    fs::write(floor.join("geojson_map.json"), "{\"type\": \"Feat").unwrap();
    fail(&arguments, 1, &["survey_plan/F1", "not GeoJSON"]);
    fs::remove_file(floor.join("geojson_map.json")).unwrap();
    fail(&arguments, 1, &["geojson_map.json: cannot read", "check the path"]);
    fail(
        &["survey", text(&site.join("nowhere")), "--out", text(&map)],
        1,
        &["nowhere: cannot open", "check the path"],
    );
    fail(
        &["survey", text(&floor.join("traces")), "--out", text(&map)],
        1,
        &["traces: no floor here", "floor_info.json"],
    );
    assert!(!map.exists());
}

#[test]
fn floors_of_several_buildings_do_not_become_one_by_accident() {
    let dir = folder("survey_buildings");
    let map = dir.join("map");
    let (one, other) = (write_floor(&dir.join("a"), "F1", 1), write_floor(&dir.join("b"), "F1", 1));
    fail(
        &["survey", text(&one), text(&other), "--out", text(&map)],
        1,
        &["called F1 as well", "one building at a time"],
    );
    let other = write_floor(&dir.join("b"), "F2", 1);
    fail(&["survey", text(&one), text(&other), "--out", text(&map)], 2, &["buildings a and b", "--name"]);
    succeed(&["survey", text(&one), text(&other), "--out", text(&map), "--name", "a and b", "--coverage"]);
}

#[test]
fn a_map_that_cannot_be_written_is_named() {
    let site = folder("survey_unwritable");
    let (floor, file) = (write_floor(&site, "F1", 2), site.join("file"));
    fs::write(&file, "in the way").unwrap();
    fail(&["survey", text(&floor), "--out", text(&file)], 1, &["file: cannot make the folder"]);
}
