//! One floor's folder: its plan and the list of its walks.

use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::FloorPlan;

use crate::error::FormatError;
use crate::geojson_plan::read_ilc_plan;

/// A floor of the indoor-location-competition-20 collection.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// The building: the name of the folder that holds the floor's.
    pub site: String,
    /// The floor: the name of its folder, such as `F1`.
    pub name: String,
    /// The outline and the shops.
    pub plan: FloorPlan,
    /// The walks' files, sorted by name; read one with [`TraceReader`](super::TraceReader).
    pub traces: Vec<PathBuf>,
}

impl Floor {
    /// Opens the floor's folder `dir`; walks lie in `path_data_files` or `traces` below it.
    ///
    /// # Errors
    /// When `floor_info.json` or `geojson_map.json` is missing or malformed, or when there is no folder of walks.
    pub fn open(dir: &Path) -> Result<Self, FormatError> {
        let absolute = dir.canonicalize().map_err(|error| FormatError::io("open the floor", dir, error))?;
        let name_of = |path: Option<&Path>| {
            path.and_then(Path::file_name)
                .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        let (info_path, plan_path) = (dir.join("floor_info.json"), dir.join("geojson_map.json"));
        let read =
            |path: &Path| fs::read(path).map_err(|error| FormatError::io("read the plan", path, error));
        let plan = read_ilc_plan(&read(&info_path)?, &read(&plan_path)?).map_err(|error| {
            let path = error.path().map_or_else(|| dir.to_owned(), |file| dir.join(file));
            error.at_path(path)
        })?;
        Ok(Self {
            site: name_of(absolute.parent()),
            name: name_of(Some(&absolute)),
            plan,
            traces: list_traces(dir)?,
        })
    }
}

/// The floor's number by its name: `F1`, `1F`, `L1` and `G` are the ground floor, 0; `B1` is -1.
///
/// A bare number counts from the ground floor, 1. A name that says nothing gives 0. Where a building has both `G` and
/// `F1`, names alone cannot tell them apart.
pub fn floor_ordinal(name: &str) -> i32 {
    let name = name.trim().to_ascii_uppercase();
    let digits: String =
        name.chars().skip_while(|c| !c.is_ascii_digit()).take_while(char::is_ascii_digit).collect();
    let number = (!digits.is_empty()).then(|| digits.parse::<i32>().unwrap_or(i32::MAX));
    let is_below = name.starts_with(['B', '-']) || name.starts_with("LG");
    match number {
        Some(number) if is_below || name.starts_with('P') => -number,
        Some(number) => (number - 1).max(0),
        None if is_below => -1,
        None => 0,
    }
}

/// Whether `name` is a floor's and no building's: a few letters and a number, such as `F1`, `2F` or `Level 3`, or `G`,
/// `GF`, `B`, `LG`, `UG`.
pub fn is_floor_name(name: &str) -> bool {
    let name = name.trim().to_ascii_uppercase();
    let (letters, number) = name.split_at(name.find(|c: char| c.is_ascii_digit()).unwrap_or(name.len()));
    let is_number =
        |text: &str| !text.is_empty() && text.len() < 4 && text.bytes().all(|c| c.is_ascii_digit());
    let letters = letters.trim_end_matches([' ', '_', '-']);
    match letters {
        _ if number.is_empty() => matches!(letters, "G" | "GF" | "B" | "LG" | "UG"),
        "" => is_number(number.strip_suffix('F').unwrap_or(number)),
        "F" | "L" | "B" | "P" | "LG" | "UG" | "FLOOR" | "LEVEL" => is_number(number),
        _ => false,
    }
}

fn list_traces(dir: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let mut folder = dir.join("path_data_files");
    if !folder.is_dir() {
        folder = dir.join("traces");
    }
    let fail = |error| FormatError::io("list the walks", &folder, error);
    let mut traces = Vec::new();
    for entry in fs::read_dir(&folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.extension().is_some_and(|extension| extension == "txt") {
            traces.push(path);
        }
    }
    traces.sort();
    Ok(traces)
}

#[cfg(test)]
mod tests {
    use super::{floor_ordinal, is_floor_name};

    #[test]
    fn a_building_is_not_called_as_a_floor() {
        for name in ["F1", "f12", "1F", "3", "-1", "B2", "LG1", "Level 3", "floor_2", "G", "LG"] {
            assert!(is_floor_name(name), "{name}");
        }
        for name in ["", "office", "office2", "F", "2026-10-03", "F1 old", "Mall", "FL1", "F1000"] {
            assert!(!is_floor_name(name), "{name}");
        }
    }

    #[test]
    fn floors_are_numbered_by_their_names() {
        let cases = [
            ("F1", 0),
            ("F2", 1),
            ("1F", 0),
            ("12F", 11),
            ("L2", 1),
            ("G", 0),
            ("GF", 0),
            ("B1", -1),
            ("b2", -2),
            ("B", -1),
            ("LG", -1),
            ("LG2", -2),
            ("P1", -1),
            ("-3", -3),
            ("0", 0),
            ("4", 3),
            ("Level 3", 2),
            ("", 0),
            ("roof", 0),
            ("penthouse", 0),
            ("F99999999999", i32::MAX - 1),
        ];
        for (name, ordinal) in cases {
            assert_eq!(floor_ordinal(name), ordinal, "{name}");
        }
    }
}
