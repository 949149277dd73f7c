//! The collection's recordings, and what their names say.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::geometry::Point2;

use super::MAX_PLACE_M;
use crate::error::FormatError;

/// What the file of a whole track ends in.
const TRACK: &str = "_all_sensors.mbd";
const REMEDY: &str =
    "give the unpacked folder of the position-annotated BLE collection, with cnf/, hst/ and trk/";

/// A place where the emitter stood, and the files of the receivers that heard it.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedPoint {
    /// The set that it belongs to: its folder's name, such as `set_1`.
    pub set: String,
    /// The emitter's place.
    pub place: Point2,
    /// The emitter's height, in metres.
    pub height_m: f64,
    /// A file a receiver, in order of the names.
    pub files: Vec<PathBuf>,
}

/// A recording of the emitter under way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Track {
    /// Its name, such as `straight_01`.
    pub name: String,
    /// Its file, with the sightings of all receivers.
    pub file: PathBuf,
}

/// The fixed points of the collection in `dir`, in order of set and place.
///
/// # Errors
/// When a folder cannot be listed, a file's name tells no place, or there is no point.
pub fn find_points(dir: &Path) -> Result<Vec<FixedPoint>, FormatError> {
    let hst = dir.join("hst");
    // By the place as it is spelt: the same spelling in every receiver's name.
    let mut points: BTreeMap<(String, String), FixedPoint> = BTreeMap::new();
    for folder in listed(&hst)?.into_iter().filter(|path| path.is_dir()) {
        let set = name_of(&folder);
        for file in listed(&folder)?.into_iter().filter(|path| has_ending(path)) {
            let name = name_of(&file);
            let (spelt, [x_m, y_m, height_m]) = place_of(&name).ok_or_else(|| {
                let message = "the name tells no place: it is not `receiver_x_y_z.mbd`";
                FormatError::malformed(message, REMEDY).at_path(&file)
            })?;
            let point =
                FixedPoint { set: set.clone(), place: Point2::new(x_m, y_m), height_m, files: Vec::new() };
            points.entry((set.clone(), spelt.to_owned())).or_insert(point).files.push(file);
        }
    }
    if points.is_empty() {
        return Err(FormatError::malformed("no fixed point here", REMEDY).at_path(hst));
    }
    let mut points: Vec<FixedPoint> = points.into_values().collect();
    points.sort_by(|a, b| {
        let by_place = a.place.x_m.total_cmp(&b.place.x_m).then(a.place.y_m.total_cmp(&b.place.y_m));
        a.set.cmp(&b.set).then(by_place)
    });
    Ok(points)
}

/// The tracks of the collection in `dir`, in order of their names; none when it has no folder `trk`.
///
/// # Errors
/// When the folder cannot be listed.
pub fn find_tracks(dir: &Path) -> Result<Vec<Track>, FormatError> {
    let trk = dir.join("trk");
    if !trk.is_dir() {
        return Ok(Vec::new());
    }
    let track = |file: PathBuf| {
        let name = name_of(&file).strip_suffix(TRACK)?.to_owned();
        Some(Track { name, file })
    };
    Ok(listed(&trk)?.into_iter().filter_map(track).collect())
}

/// The entries of a folder, in order of their names.
fn listed(dir: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let failed = |error| FormatError::io("list the folder", dir, error);
    let entries = fs::read_dir(dir).map_err(failed)?;
    let mut paths = entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<Vec<_>, _>>()?;
    paths.sort();
    Ok(paths)
}

fn has_ending(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "mbd")
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The place in `receiver_x_y_z.mbd`, as spelt and as numbers.
fn place_of(name: &str) -> Option<(&str, [f64; 3])> {
    let (_receiver, spelt) = name.strip_suffix(".mbd")?.split_once('_')?;
    let numbers = spelt.split('_').map(|number| number.parse().ok()).collect::<Option<Vec<f64>>>()?;
    let place: [f64; 3] = numbers.try_into().ok()?;
    // Written so that NaN fails.
    place.iter().all(|m| m.abs() <= MAX_PLACE_M).then_some((spelt, place))
}
