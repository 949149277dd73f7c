//! `fieldwalk reproduce` with few seeds.
#![allow(clippy::unwrap_used, clippy::panic)]

mod synthetic;

use std::fs;

use serde_json::Value;
use synthetic::{fail, folder, succeed, text};

/// Two seeds suffice for an interval.
fn rows(arguments: &[&str]) -> Vec<Value> {
    let json = succeed(&[&["reproduce", "--seeds", "2", "--json"], arguments].concat());
    json.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_claim_is_a_row_the_same_each_time() {
    let first = rows(&["mass-centered", "--only", "mc-spectrum,mc-auc-ufh"]);
    let ids: Vec<&Value> = first.iter().map(|row| &row["id"]).collect();
    assert_eq!(ids, ["mc-auc-ufh", "mc-spectrum"]);
    for row in &first {
        let keys: Vec<&str> = row.as_object().unwrap().keys().map(String::as_str).collect();
        for key in [
            "id",
            "paper",
            "claim",
            "unit",
            "paper_value",
            "ours",
            "low",
            "high",
            "holds",
            "cause",
            "seeds",
            "parts",
        ] {
            assert!(keys.contains(&key), "{key} in {row}");
        }
        let number = |key: &str| row[key].as_f64().unwrap();
        assert!(number("low") <= number("ours") && number("ours") <= number("high"), "{row}");
        assert_eq!((&row["paper"], &row["seeds"]), (&"mass-centered".into(), &2.into()));
    }
    assert_eq!(first, rows(&["mass-centered", "--only", "mc-spectrum,mc-auc-ufh"]));
}

#[test]
fn every_claim_of_a_paper_is_a_row() {
    let listed = ["wila-steps", "wila-distance", "wila-turns", "wila-bend"];
    let json = succeed(&["reproduce", "wila", "--seeds", "1", "--json"]);
    let rows: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(rows.iter().map(|row| row["id"].as_str().unwrap()).collect::<Vec<_>>(), listed);
    for row in rows {
        // What fails says why.
        assert_eq!(row["holds"] == true, row["cause"].is_null(), "{row}");
    }
}

#[test]
fn the_page_and_the_table_show_what_was_measured() {
    let dir = folder("reproduce_page");
    let page = dir.join("page.html");
    let arguments =
        ["reproduce", "mass-centered", "--seeds", "2", "--only", "mc-spectrum", "--report", text(&page)];
    let table = succeed(&arguments);
    assert!(table.contains(" mc-spectrum ") && table.contains("1 of 1 claims hold"), "{table}");
    let html = fs::read_to_string(&page).unwrap();
    assert!(html.contains("Energy of the strength along corridors") && html.contains(">mc-spectrum<"));
    let unwritable = dir.join("none").join("page.html");
    // Before it measures: all claims with all their seeds would take the test's time many times over.
    fail(&["reproduce", "all", "--report", text(&unwritable)], 1, &["cannot write the page"]);
}

#[test]
fn a_listed_claim_that_nothing_measures_fails() {
    let dir = folder("reproduce_claims");
    let file = dir.join("claims.json");
    let spectrum =
        ["reproduce", "mass-centered", "--seeds", "2", "--only", "mc-spectrum", "--claims", text(&file)];
    fs::write(&file, r#"[{"id": "mc-spectrum", "paper": "mass-centered", "claim": "…", "test": "…"}]"#)
        .unwrap();
    succeed(&spectrum);
    fs::write(&file, r#"[{"id": "mc-new", "paper": "mass-centered"}]"#).unwrap();
    // Who asks for some claims only is not told of the others.
    succeed(&spectrum);
    fs::write(&file, "{").unwrap();
    fail(&spectrum, 1, &["claims.json", "no list of claims"]);
    fail(&["reproduce", "mass-centered", "--only", "mc-none"], 2, &["mc-none"]);
    let of_other = ["reproduce", "song", "--only", "mc-spectrum", "--strict"];
    fail(&of_other, 2, &["mc-spectrum is a claim of mass-centered"]);
    fail(&["reproduce", "einstein-1905"], 2, &["einstein-1905"]);
}
