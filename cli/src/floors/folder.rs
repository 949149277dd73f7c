//! One floor's folder: its plan and the list of its walks.

use std::path::{Path, PathBuf};
use std::{fs, io};

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk_formats::ilc::{self, is_floor_name};
use fieldwalk_formats::uji_mag::UjiMagCollection;
use fieldwalk_formats::{FormatError, read_plan};

use super::{Layout, PLAN_FILE};

/// A floor to survey, with its walks.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// The building's name.
    pub site: String,
    /// The floor's name, such as `F1`.
    pub name: String,
    /// Its plan.
    pub plan: FloorPlan,
    /// The logs of its walks, in order of their names; without those of `test_traces`.
    pub traces: Vec<PathBuf>,
    /// The logs of the walks set aside to test with, where the folder tells them apart.
    pub test_traces: Option<Vec<PathBuf>>,
    /// Where corridors end or meet, where walks are to be scored at cut-offs away from there.
    pub nodes: Option<Vec<Point2>>,
}

/// The folder of the walks to map; where there is none, logs lie beside the plan.
const SURVEY_DIR: &str = "survey";
/// The folder of the walks to test with.
const TEST_DIR: &str = "test";
/// What a floor is called whose folder is called after the building.
const ONLY_FLOOR: &str = "F1";
/// By this file, a folder is an export of the app Sensor Logger.
const EXPORT_MARK: &str = "Metadata.csv";

impl Floor {
    /// Opens the floor's folder `dir`.
    ///
    /// # Errors
    /// When the plan is missing or malformed, or the walks cannot be listed.
    pub fn open(dir: &Path, layout: Layout) -> Result<Self, FormatError> {
        match layout {
            Layout::Ilc => {
                let ilc::Floor { site, name, plan, traces } = ilc::Floor::open(dir)?;
                Ok(Self { site, name, plan, traces, test_traces: None, nodes: None })
            }
            Layout::Recordings => Self::open_recordings(dir),
            Layout::UjiMag => Self::open_uji_mag(dir),
        }
    }

    fn open_recordings(dir: &Path) -> Result<Self, FormatError> {
        let (site, name) = names(dir)?;
        let plan_file = dir.join(PLAN_FILE);
        let plan =
            fs::read(&plan_file).map_err(|error| FormatError::io("read the plan", &plan_file, error))?;
        let plan = read_plan(&plan).map_err(|error| error.at_path(&plan_file))?;
        let (survey, test) = (dir.join(SURVEY_DIR), dir.join(TEST_DIR));
        let traces = logs_in(if survey.is_dir() { &survey } else { dir })?;
        let test_traces = if test.is_dir() { Some(logs_in(&test)?) } else { None };
        Ok(Self { site, name, plan, traces, test_traces, nodes: None })
    }

    fn open_uji_mag(dir: &Path) -> Result<Self, FormatError> {
        let (site, name) = names(dir)?;
        let UjiMagCollection { lines, walks, plan, nodes } = UjiMagCollection::open(dir)?;
        Ok(Self { site, name, plan, traces: lines, test_traces: Some(walks), nodes: Some(nodes) })
    }
}

/// The building's and the floor's name, by the folder `dir` and the one above it.
fn names(dir: &Path) -> Result<(String, String), FormatError> {
    let absolute = dir.canonicalize().map_err(|error| FormatError::io("open the floor", dir, error))?;
    let name_of = |path: Option<&Path>| {
        path.and_then(Path::file_name).map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    };
    let (own, above) = (name_of(Some(&absolute)), name_of(absolute.parent()));
    Ok(if is_floor_name(&own) { (above, own) } else { (own, ONLY_FLOOR.to_owned()) })
}

/// The logs in `dir`, sorted by name: `*.mcap`, `*.txt`, `*.json`, and folders of Sensor Logger.
fn logs_in(dir: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let list = || fs::read_dir(dir)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    let mut logs = list().map_err(|error| FormatError::io("list the walks", dir, error))?;
    logs.retain(|path| {
        let is_log = |extension: &std::ffi::OsStr| {
            ["mcap", "txt", "json"].iter().any(|known| extension.eq_ignore_ascii_case(known))
        };
        if path.is_dir() { path.join(EXPORT_MARK).is_file() } else { path.extension().is_some_and(is_log) }
    });
    logs.sort();
    Ok(logs)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = r#"{"type": "FeatureCollection", "fieldwalk": {"frame": "metres"}, "features": [{"type":
        "Feature", "properties": {"kind": "outline"}, "geometry": {"type": "Polygon", "coordinates":
        [[[0, 0], [40, 0], [40, 25], [0, 25], [0, 0]]]}}]}"#;

    fn write_floor(name: &str, files: &[&str]) -> PathBuf {
        let building = std::env::temp_dir().join(format!("fieldwalk-floors-{}", std::process::id()));
        let dir = building.join(name);
        for file in files.iter().chain(&[PLAN_FILE]) {
            let path = dir.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, PLAN).unwrap();
        }
        dir
    }

    #[test]
    fn a_folder_says_which_walks_map_and_which_test() {
        let dir =
            write_floor("office", &["survey/b.mcap", "survey/a.txt", "test/c.MCAP", "test/c.truth.csv"]);
        let floor = Floor::open(&dir, Layout::Recordings).unwrap();
        assert_eq!((floor.site.as_str(), floor.name.as_str(), floor.plan.width_m), ("office", "F1", 40.0));
        assert_eq!(floor.traces, [dir.join("survey/a.txt"), dir.join("survey/b.mcap")]);
        assert_eq!(floor.test_traces, Some(vec![dir.join("test/c.MCAP")]));
        fs::remove_dir_all(dir).unwrap();
    }

    #[test]
    fn logs_may_lie_beside_the_plan_and_a_floor_is_called_by_its_folder() {
        let dir = write_floor("B2", &["x.json", "night/Metadata.csv", "other/notes.txt", "readme.md"]);
        let floor = Floor::open(&dir, Layout::Recordings).unwrap();
        assert_eq!(floor.name, "B2");
        assert_eq!(floor.traces, [dir.join("night"), dir.join("x.json")]);
        assert_eq!(floor.test_traces, None);
        fs::write(dir.join(PLAN_FILE), "{").unwrap();
        let error = Floor::open(&dir, Layout::Recordings).unwrap_err();
        assert_eq!(error.path(), Some(dir.join(PLAN_FILE).as_path()));
        fs::remove_dir_all(dir).unwrap();
    }
}
