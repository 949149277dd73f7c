//! `fieldwalk demo` on a small number of walks.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::fs;
use std::path::Path;

use fieldwalk_formats::{open_building, read_plan};
use serde_json::Value;
use synthetic::{fail, folder, succeed, text};

fn rows(out: &Path) -> Vec<Value> {
    let json = succeed(&["demo", "--seed", "2", "--walks", "2", "--json", "--out", text(out)]);
    json.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_demo_maps_the_office_and_scores_every_system_the_same_each_time() {
    let dir = folder("demo_rows");
    let mut first = rows(&dir.join("first"));
    assert_eq!(first.len(), 3);
    let median_m = |system: &str| {
        let row = first.iter().find(|row| row["system"] == system).unwrap();
        assert_eq!(
            (&row["points"], &row["n_walks"], &row["n_without_fix"]),
            (&"truth".into(), &2.into(), &0.into())
        );
        assert!(row["n_points"].as_u64().unwrap() > 2 * 60, "{row}");
        row["median_m"].as_f64().unwrap()
    };
    assert!(median_m("mass-centered").is_finite());
    assert!(median_m("fused") < median_m("dead-reckoning") && median_m("fused") < 1.5, "{first:?}");

    let page = fs::read_to_string(dir.join("first/report.html")).unwrap();
    assert!(page.contains("<title>Fieldwalk demo</title>") && page.contains(r#""label":"held level""#));

    let building = open_building(&dir.join("first/office.map")).unwrap();
    assert_eq!((building.name.as_str(), building.floors.len()), ("office", 1));
    let plan = read_plan(&fs::read(dir.join("first/office.geojson")).unwrap()).unwrap();
    assert_eq!(plan, building.floors[0].plan);

    let mut second = rows(&dir.join("second"));
    for row in first.iter_mut().chain(&mut second) {
        row["step_us_median"] = Value::Null;
    }
    assert_eq!(first, second);
    for file in ["office.geojson", "office.map/building.json"] {
        let bytes = |run: &str| fs::read(dir.join(run).join(file)).unwrap();
        assert!(bytes("first") == bytes("second"), "{file}");
    }
}

#[test]
fn a_demo_prints_a_table_and_where_the_map_is() {
    let out = folder("demo_table");
    let table = succeed(&["demo", "--walks", "1", "--out", text(&out)]);
    for said in
        ["simulated office of 60 × 40 m, seed 1, start known:2;", " fused ", "fieldwalk survey --help"]
    {
        assert!(table.contains(said), "`{said}` is missing: {table}");
    }
    // The command that it proposes works, and finds the walk's start in the recording.
    let command = table.lines().find_map(|line| line.split_once(": fieldwalk ")).unwrap().1;
    let replay = succeed(&command.split_whitespace().collect::<Vec<_>>());
    assert!(replay.contains("start given") && replay.contains("error at "), "{replay}");
    let last = table.lines().last().unwrap();
    assert!(last.starts_with(&format!("The map is in {}", out.join("office.map").display())), "{last}");
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let dir = folder("demo_unwritable");
    let file = dir.join("file");
    fs::write(&file, "in the way").unwrap();
    fail(&["demo", "--out", text(&file)], 1, &["demo_unwritable/file: cannot make the folder"]);
    fail(&["demo", "--out", text(&file.join("below"))], 1, &["file/below: cannot make the folder"]);
    fs::create_dir_all(dir.join("office.geojson")).unwrap();
    fail(&["demo", "--out", text(&dir)], 1, &["office.geojson: cannot write the plan"]);
    fail(&["demo", "--walks", "0"], 2, &["--walks"]);
}
