//! `fieldwalk evaluate` on small floors.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::collections::BTreeSet;
use std::fs;

use fieldwalk::system::Recipe;
use serde_json::Value;
use synthetic::{fail, fieldwalk, folder, succeed, text, trace, walk, write_floor};

const KEYS: [&str; 17] = [
    "dataset",
    "floor",
    "system",
    "start",
    "points",
    "n_walks",
    "n_points",
    "n_without_fix",
    "median_m",
    "mean_m",
    "p80_m",
    "p90_m",
    "inside_68",
    "inside_95",
    "radius_68_median_m",
    "step_us_median",
    "seeds",
];

fn rows(arguments: &[&str]) -> Vec<Value> {
    let json = succeed(&[&["evaluate", "--json"][..], arguments].concat());
    json.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// A row without what depends on the clock.
fn timeless(mut row: Value) -> Value {
    row["step_us_median"] = Value::Null;
    row
}

#[test]
fn rows_have_the_agreed_keys_and_come_per_floor_system_and_kind_of_point() {
    let site = folder("evaluate_rows").join("mall");
    write_floor(&site, "F1", 12);
    write_floor(&site, "F2", 8);
    let rows = rows(&[text(&site), "--dataset", "ilc", "--seeds", "1..2"]);
    let agreed: BTreeSet<&str> = KEYS.into();
    for row in &rows {
        let keys: BTreeSet<&str> = row.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, agreed);
        assert_eq!(
            (&row["dataset"], &row["start"], &row["seeds"]),
            (&"ilc".into(), &"known:2".into(), &2.into())
        );
    }
    let names = |key: &str| rows.iter().map(|row| row[key].as_str().unwrap()).collect::<BTreeSet<_>>();
    assert_eq!(names("floor"), BTreeSet::from(["F1", "F2", "all"]));
    assert_eq!(names("system"), BTreeSet::from(Recipe::NAMES));
    assert_eq!(names("points"), BTreeSet::from(["midpoint", "waypoint"]));
    assert_eq!(rows.len(), 3 * Recipe::NAMES.len() * 2);
    // Fold 0 has walks 0, 5 and 11 of F1 and 0 and 5 of F2; each has 6 lines.
    let n = |floor: &str, key: &str| {
        rows.iter().find(|row| row["floor"] == floor).unwrap()[key].as_u64().unwrap()
    };
    assert_eq!((n("F1", "n_walks"), n("F1", "n_points")), (3, 2 * 3 * 6));
    assert_eq!((n("all", "n_walks"), n("all", "n_points")), (5, 2 * 5 * 6));
    let fused = rows.iter().find(|row| row["system"] == "fused" && row["floor"] == "all").unwrap();
    assert!(fused["median_m"].as_f64().unwrap() < 2.5, "{fused}");
    assert!(fused["step_us_median"].as_f64().unwrap() > 0.0, "{fused}");
}

#[test]
fn four_folds_test_every_walk_once() {
    let floor = write_floor(&folder("evaluate_folds"), "F1", 12);
    let n_walks = |arguments: &[&str]| {
        let arguments = [&[text(&floor), "--systems", "dead-reckoning", "--seeds", "1"], arguments].concat();
        rows(&arguments)[0]["n_walks"].as_u64().unwrap()
    };
    assert_eq!(n_walks(&["--folds", "4"]), 12);
    let single: u64 = ["0", "1", "2", "3"].iter().map(|fold| n_walks(&["--fold", fold])).sum();
    assert_eq!(single, 12);
    assert_eq!(n_walks(&["--fold", "0,3"]), 6);
    fail(&["evaluate", text(&floor), "--folds", "4", "--fold", "1"], 2, &["cannot be used with"]);
}

#[test]
fn the_same_seeds_give_the_same_rows_and_a_floor_twice_counts_once() {
    let floor = write_floor(&folder("evaluate_same"), "F1", 8);
    let once = rows(&[text(&floor), "--seeds", "3,1"]);
    let twice = rows(&[text(&floor), text(&floor), "--seeds", "3,1"]);
    assert_eq!(
        once.into_iter().map(timeless).collect::<Vec<_>>(),
        twice.into_iter().map(timeless).collect::<Vec<_>>()
    );
}

#[test]
fn tables_have_a_block_per_kind_of_point() {
    let dir = folder("evaluate_tables");
    let (one, other) = (write_floor(&dir.join("a"), "F1", 8), write_floor(&dir.join("b"), "F1", 8));
    let table = succeed(&["evaluate", text(&one), text(&other), "--systems", "fused", "--seeds", "1"]);
    for said in [
        "start known:2, 1 seed;",
        "\nAt waypoints\n",
        "\nMidway between waypoints\n",
        "a/F1",
        "b/F1",
        " all ",
    ] {
        assert!(table.contains(said), "`{said}` is missing: {table}");
    }
}

#[test]
fn a_cold_start_has_points_without_a_fix_or_larger_errors_and_says_which() {
    let floor = write_floor(&folder("evaluate_cold"), "F1", 8);
    let rows = rows(&[text(&floor), "--start", "cold", "--seeds", "1", "--systems", "fused"]);
    assert!(rows.iter().all(|row| row["start"] == "cold"));
    let n_points = |row: &Value| row["n_points"].as_u64().unwrap() + row["n_without_fix"].as_u64().unwrap();
    assert!(rows.iter().all(|row| n_points(row) == 12), "{rows:?}");
}

#[test]
fn a_recipe_from_a_file_is_one_more_system() {
    let dir = folder("evaluate_recipe");
    let floor = write_floor(&dir, "F1", 8);
    let file = dir.join("mine.json");
    let printed = succeed(&["evaluate", "--print-recipe", "fused"]);
    let arguments = [text(&floor), "--seeds", "1", "--systems", "fused", "--recipe", text(&file)];
    let failing = [&["evaluate"], &arguments[..]].concat();

    fs::write(&file, printed.replace("\"fused\"", "\"mine\"")).unwrap();
    let rows = rows(&arguments);
    let of = |system: &str| -> Vec<Value> {
        let rows = rows.iter().filter(|row| row["system"] == system);
        rows.map(|row| {
            timeless(Value::Object({
                let mut row = row.as_object().unwrap().clone();
                row.remove("system");
                row
            }))
        })
        .collect()
    };
    assert_eq!(of("fused").len(), 4);
    assert_eq!(of("mine"), of("fused"));

    fs::write(&file, &printed).unwrap();
    fail(&failing, 1, &["mine.json: there is another system called `fused`", "change the recipe's `name`"]);
    fs::write(&file, printed.replace("n_particles", "particles")).unwrap();
    fail(&failing, 1, &["mine.json:", "n_particles", "--print-recipe"]);
    fs::remove_file(&file).unwrap();
    fail(&failing, 1, &["mine.json: cannot read the recipe", "check the path"]);
}

#[test]
fn with_plan_names_the_systems_that_it_changes() {
    let floor = write_floor(&folder("evaluate_plan"), "F1", 8);
    let rows = rows(&[text(&floor), "--seeds", "1", "--with-plan"]);
    let systems: BTreeSet<&str> = rows.iter().map(|row| row["system"].as_str().unwrap()).collect();
    let expected = Recipe::NAMES.map(|name| {
        let recipe = Recipe::named(name).unwrap();
        if recipe.clone().with_plan() == recipe { name.to_owned() } else { format!("{name}+plan") }
    });
    assert_eq!(systems, expected.iter().map(String::as_str).collect());
    assert!(systems.is_superset(&BTreeSet::from(["dead-reckoning+plan", "fused", "radar"])));
}

#[test]
fn a_floor_that_fails_does_not_sink_the_others() {
    let site = folder("evaluate_failing");
    write_floor(&site, "F1", 8);
    let broken = write_floor(&site, "F2", 8);
    fs::write(trace(&broken, 3), "not a trace\n").unwrap();
    let arguments = ["evaluate", text(&site), "--seeds", "1", "--systems", "fused", "--json"];
    fail(
        &arguments,
        1,
        &["floor F2: ", "walk-03.txt:1: of no known format", "1 of 2 floors could not be evaluated"],
    );
    let json = String::from_utf8(fieldwalk(&arguments).stdout).unwrap();
    assert_eq!(json.lines().filter(|line| line.contains("\"F1\"")).count(), 2);
    assert!(!json.contains("\"F2\""));
}

#[test]
fn walks_of_another_floor_neither_survey_nor_test() {
    let site = folder("evaluate_other_floor");
    let floor = write_floor(&site, "F1", 8);
    let arguments = ["evaluate", text(&floor), "--seeds", "1", "--systems", "dead-reckoning", "--json"];
    // Walk 1 surveys, walk 5 tests; both floors' frames are one, so nothing else tells.
    fs::remove_file(trace(&floor, 1)).unwrap();
    let without_walk = fieldwalk(&arguments);
    for k in [1, 5] {
        fs::write(trace(&floor, k), format!("#\tFloorName:F3\n{}", walk(k))).unwrap();
    }
    let output = fieldwalk(&arguments);
    let errors = String::from_utf8(output.stderr).unwrap();
    for said in [
        "walk-01.txt: left out, as it was recorded on another floor, F3",
        "walk-05.txt: left out",
        "floor F1: 2 walks of other floors",
    ] {
        assert!(output.status.success() && errors.contains(said), "`{said}` is missing: {errors}");
    }
    let row = |stdout: Vec<u8>| {
        let json = String::from_utf8(stdout).unwrap();
        timeless(serde_json::from_str(json.lines().next().unwrap()).unwrap())
    };
    let (row, without_walk) = (row(output.stdout), row(without_walk.stdout));
    assert_eq!((&row["n_walks"], &without_walk["n_walks"]), (&1.into(), &2.into()));
}

#[test]
fn walks_without_waypoints_and_floors_without_test_walks_are_said() {
    let site = folder("evaluate_nothing");
    let floor = write_floor(&site, "F1", 8);
    let without: String =
        walk(5).lines().filter(|line| !line.contains("WAYPOINT")).map(|line| format!("{line}\n")).collect();
    fs::write(trace(&floor, 5), without).unwrap();
    let output = fieldwalk(&["evaluate", text(&floor), "--seeds", "1", "--systems", "dead-reckoning"]);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && errors.contains("walk-05.txt: no two waypoints"), "{errors}");

    fs::remove_file(trace(&floor, 0)).unwrap();
    fs::remove_file(trace(&floor, 5)).unwrap();
    let arguments = ["evaluate", text(&floor), "--seeds", "1", "--systems", "dead-reckoning"];
    fail(&arguments, 1, &["F1: no test walk with two waypoints in fold 0", "--folds 4"]);
    for k in [1, 2, 3, 4, 6, 7] {
        fs::remove_file(trace(&floor, k)).unwrap();
    }
    fail(&arguments, 1, &["floor F1: ", "no map of the walks outside fold 0"]);
}

#[test]
fn wrong_arguments_exit_with_2() {
    fail(&["evaluate"], 2, &["<DIR>"]);
    fail(&["evaluate", "F1", "--systems", "fusd"], 2, &["fusd", &Recipe::NAMES.join(", ")]);
    fail(&["evaluate", "F1", "--seeds", "5..1"], 2, &["--seeds", "is empty"]);
    fail(&["evaluate", "F1", "--start", "warm"], 2, &["--start", "known:2"]);
    fail(&["evaluate", "F1", "--layout", "uji"], 2, &["--dataset", "ilc"]);
    for (arguments, said) in [
        (&["--lengths", "--report", "r.html"][..], "--report is of use only where whole systems are scored"),
        (&["--dataset", "oxford-steps", "--systems", "fused"], "--systems is of use only"),
        (&["--dataset", "oxford-steps", "--recipe", "mine.json"], "--recipe is of use only"),
        (&["--dataset", "ble-annotated", "--plots", "p"], "--plots is of use only where --dataset oxford"),
        (&["--dataset", "tyrex", "--lengths"], "--lengths is of use only where floors"),
        (&["--table", "t.json"], "--table is of use only where --dataset tyrex"),
    ] {
        fail(&[&["evaluate", "F1"], arguments].concat(), 2, &[said]);
    }
    fail(&["evaluate", "/nonexistent/F1"], 1, &["/nonexistent/F1: cannot open", "check the path"]);
}

#[test]
fn help_has_examples_and_exit_codes() {
    for command in ["survey", "replay", "evaluate"] {
        let help = succeed(&[command, "--help"]);
        assert!(help.contains("Examples:") && help.contains("default"), "{help}");
    }
    assert!(succeed(&["--help"]).contains("Exit codes:"));
}
