//! Which floors some folders hold, and what to call them.

use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk_formats::FormatError;

/// Any of these makes a folder a floor's; what then is missing is for the reader to say.
const FLOOR_MARKS: [&str; 4] = ["floor_info.json", "geojson_map.json", "path_data_files", "traces"];

/// A floor's folder and what to call it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundFloor {
    /// The folder.
    pub dir: PathBuf,
    /// Its name; with those of the folders above where floors of the same name are found.
    pub label: String,
}

/// The floors in `dirs`, each a floor's folder or a folder of such folders; a floor named twice counts once.
///
/// # Errors
/// When a folder cannot be read or holds no floor.
pub fn find_floors(dirs: &[PathBuf]) -> Result<Vec<FoundFloor>, FormatError> {
    let mut found: Vec<(PathBuf, PathBuf)> = Vec::new();
    for dir in dirs {
        for floor in floors_in(dir)? {
            let absolute =
                floor.canonicalize().map_err(|error| FormatError::io("open the floor", &floor, error))?;
            if found.iter().all(|(known, _)| *known != absolute) {
                found.push((absolute, floor));
            }
        }
    }
    let absolutes: Vec<PathBuf> = found.iter().map(|(absolute, _)| absolute.clone()).collect();
    let floors =
        found.into_iter().map(|(absolute, dir)| FoundFloor { dir, label: label(&absolute, &absolutes) });
    Ok(floors.collect())
}

fn floors_in(dir: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let entries = || fs::read_dir(dir)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>();
    let mut below = entries().map_err(|error| FormatError::io("open the folder", dir, error))?;
    below.retain(|path| path.is_dir() && is_floor(path));
    below.sort();
    // A site's folder may lie about marks of its own: floors below it go first.
    match (below.is_empty(), is_floor(dir)) {
        (false, _) => Ok(below),
        (true, true) => Ok(vec![dir.into()]),
        (true, false) => Err(FormatError::malformed(
            "no floor here",
            "give a floor's folder, with floor_info.json, geojson_map.json and traces/ or path_data_files/, or a folder of such folders",
        )
        .at_path(dir)),
    }
}

fn is_floor(dir: &Path) -> bool {
    FLOOR_MARKS.iter().any(|mark| dir.join(mark).exists())
}

/// As many of the last folders of `path` as set it apart from all others of the same name.
fn label(path: &Path, all: &[PathBuf]) -> String {
    let n_folders = path.components().count();
    let tail = |path: &Path, n: usize| -> PathBuf {
        path.components().skip(path.components().count().saturating_sub(n)).collect()
    };
    let is_unique = |n: &usize| all.iter().filter(|other| tail(other, *n) == tail(path, *n)).count() <= 1;
    let n = (1..n_folders).find(is_unique).unwrap_or(n_folders);
    tail(path, n).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_of_one_name_are_told_apart_by_the_folders_above() {
        let all = ["/d/site1/F1", "/d/site2/F1", "/d/site1/F2", "/e/site1/F1"].map(PathBuf::from);
        let labels: Vec<String> = all.iter().map(|path| label(path, &all)).collect();
        assert_eq!(labels, ["d/site1/F1", "site2/F1", "F2", "e/site1/F1"]);
    }
}
