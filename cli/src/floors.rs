//! Which floors some folders hold, what to call them, and their plans and walks.

mod folder;

use std::path::{Path, PathBuf};
use std::{fs, io};

use fieldwalk_formats::FormatError;

pub use folder::Floor;

/// How the folders of floors are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// The layout of indoor-location-competition-20.
    Ilc,
    /// The layout for recordings of one's own: `plan.geojson`, and logs beside it or in `survey/` and `test/`.
    Recordings,
    /// The layout of UJIIndoorLoc-Mag: survey walks in `lines/`, others beside it.
    UjiMag,
}

/// The file that makes a folder a floor's in the layout for recordings.
pub const PLAN_FILE: &str = "plan.geojson";

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
pub fn find_floors(dirs: &[PathBuf], layout: Layout) -> Result<Vec<FoundFloor>, FormatError> {
    let mut found: Vec<(PathBuf, PathBuf)> = Vec::new();
    for dir in dirs {
        for floor in floors_in(dir, layout)? {
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

fn floors_in(dir: &Path, layout: Layout) -> Result<Vec<PathBuf>, FormatError> {
    let mut below = folders_in(dir).map_err(|error| FormatError::io("open the folder", dir, error))?;
    below.retain(|path| layout.is_floor(path));
    below.sort();
    // A site's folder may lie about marks of its own: floors below it go first.
    match (below.is_empty(), layout.is_floor(dir)) {
        (false, _) => Ok(below),
        (true, true) => Ok(vec![dir.into()]),
        (true, false) => Err(FormatError::malformed("no floor here", layout.remedy()).at_path(dir)),
    }
}

fn folders_in(dir: &Path) -> io::Result<Vec<PathBuf>> {
    let paths: Vec<PathBuf> = fs::read_dir(dir)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    Ok(paths.into_iter().filter(|path| path.is_dir()).collect())
}

impl Layout {
    /// Its name, in arguments and in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ilc => "ilc",
            Self::Recordings => "recordings",
            Self::UjiMag => "uji-mag",
        }
    }

    /// The layout of `dirs`, by what lies in them or in the folders below.
    pub fn of(dirs: &[PathBuf]) -> Self {
        let holds = |layout: Self, dir: &PathBuf| {
            layout.is_floor(dir)
                || folders_in(dir).is_ok_and(|below| below.iter().any(|dir| layout.is_floor(dir)))
        };
        let is_layout = |layout: &Self| dirs.iter().any(|dir| holds(*layout, dir));
        [Self::Recordings, Self::UjiMag].into_iter().find(is_layout).unwrap_or(Self::Ilc)
    }

    fn is_floor(self, dir: &Path) -> bool {
        self.marks().iter().any(|mark| dir.join(mark).exists())
    }

    /// Any of these makes a folder a floor's; what then is missing is for the reader to say.
    fn marks(self) -> &'static [&'static str] {
        match self {
            Self::Ilc => &["floor_info.json", "geojson_map.json", "path_data_files", "traces"],
            Self::Recordings => &[PLAN_FILE],
            Self::UjiMag => &["lines"],
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Ilc => {
                "give a floor's folder, with floor_info.json, geojson_map.json and traces/ or path_data_files/, or one \
                 with plan.geojson and recordings, or a folder of such folders"
            }
            Self::Recordings => {
                "give a floor's folder, with plan.geojson and recordings, or a folder of such folders"
            }
            Self::UjiMag => "give the unpacked folder of UJIIndoorLoc-Mag, with lines/ and curves/",
        }
    }
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
