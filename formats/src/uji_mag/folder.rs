//! The collection's folder: which walks survey, which test, and the frame that they share.

use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;

use super::UjiMagWalk;
use crate::error::FormatError;
use crate::geojson_plan::georeference_at;
use crate::text_lines::MAX_LINE_BYTES;

/// The walks of the collection, and the ground that they cover.
#[derive(Clone, Debug, PartialEq)]
pub struct UjiMagCollection {
    /// The walks along one corridor, in the folder `lines`: they survey. Sorted by path.
    pub lines: Vec<PathBuf>,
    /// Those in all other folders. Sorted by path.
    pub walks: Vec<PathBuf>,
    /// The frame: metres east and north, with a margin of 5 m round all walks. The collection has no plan: nothing is
    /// drawn, and the extent is all ground.
    pub plan: FloorPlan,
    /// Where segments begin or end, in that frame: ends of corridors and places where they meet.
    pub nodes: Vec<Point2>,
}

/// The folder of the walks that survey.
const LINES_DIR: &str = "lines";
/// Deeper folders are not searched.
const MAX_DEPTH: usize = 4;
/// Ground round the outermost nodes, in metres.
const MARGIN_M: f64 = 5.0;
/// Nodes nearer than this, in metres, are one.
const SAME_NODE_M: f64 = 0.3;

impl UjiMagCollection {
    /// Finds the walks, `*.txt` in the folders below `dir`, and reads where they go.
    ///
    /// # Errors
    /// When a folder cannot be listed, a walk cannot be read, or there is no line.
    pub fn open(dir: &Path) -> Result<Self, FormatError> {
        let (mut lines, mut walks) = (Vec::new(), Vec::new());
        for below in folders_in(dir)? {
            let found = if is_of_lines(&below) { &mut lines } else { &mut walks };
            search(&below, MAX_DEPTH, found)?;
        }
        if lines.is_empty() {
            let message = format!("no file `*.txt` in a folder `{LINES_DIR}`");
            let remedy = "give the unpacked folder of UJIIndoorLoc-Mag, with lines/ and curves/";
            return Err(FormatError::malformed(message, remedy).at_path(dir));
        }
        lines.sort();
        walks.sort();
        let (plan, nodes) = ground(&places_deg(lines.iter().chain(&walks))?);
        Ok(Self { lines, walks, plan, nodes })
    }
}

fn is_of_lines(dir: &Path) -> bool {
    dir.file_name().is_some_and(|name| name == LINES_DIR)
}

fn search(dir: &Path, depth: usize, found: &mut Vec<PathBuf>) -> Result<(), FormatError> {
    for path in paths_in(dir)? {
        if path.is_dir() && depth > 0 {
            search(&path, depth - 1, found)?;
        } else if path.extension().is_some_and(|extension| extension == "txt") && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

fn folders_in(dir: &Path) -> Result<Vec<PathBuf>, FormatError> {
    Ok(paths_in(dir)?.into_iter().filter(|path| path.is_dir()).collect())
}

fn paths_in(dir: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let list = || fs::read_dir(dir)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>();
    list().map_err(|error| FormatError::io("list the folder", dir, error))
}

/// Latitude and longitude of all ends of segments, each once.
fn places_deg<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> Result<Vec<[f64; 2]>, FormatError> {
    let mut places_deg = Vec::new();
    for path in paths {
        let file = File::open(path).map_err(|error| FormatError::io("open the walk", path, error))?;
        let walk = UjiMagWalk::read(BufReader::with_capacity(MAX_LINE_BYTES, file), path)?;
        for place_deg in walk.segments().iter().flat_map(|segment| [segment.start_deg, segment.end_deg]) {
            if !places_deg.contains(&place_deg) {
                places_deg.push(place_deg);
            }
        }
    }
    Ok(places_deg)
}

/// The smallest frame that holds all places with a margin, and the places in it.
fn ground(places_deg: &[[f64; 2]]) -> (FloorPlan, Vec<Point2>) {
    let lowest = |axis: usize| places_deg.iter().map(|place| place[axis]).fold(f64::INFINITY, f64::min);
    let corner = georeference_at([lowest(0), lowest(1)]);
    let (latitude_deg, longitude_deg) = corner.latitude_longitude_deg(Point2::new(-MARGIN_M, -MARGIN_M));
    let mut georeference = corner;
    (georeference.origin_latitude_deg, georeference.origin_longitude_deg) = (latitude_deg, longitude_deg);
    let mut nodes: Vec<Point2> = Vec::new();
    let (mut width_m, mut height_m) = (0.0f64, 0.0f64);
    for &[latitude_deg, longitude_deg] in places_deg {
        let node = georeference.point(latitude_deg, longitude_deg);
        (width_m, height_m) = (width_m.max(node.x_m + MARGIN_M), height_m.max(node.y_m + MARGIN_M));
        if nodes.iter().all(|known| known.distance_m(node) >= SAME_NODE_M) {
            nodes.push(node);
        }
    }
    let plan = FloorPlan { width_m, height_m, georeference: Some(georeference), ..FloorPlan::default() };
    (plan, nodes)
}
