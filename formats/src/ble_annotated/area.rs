//! `cnf/`: where the receivers hang and how large the room is.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use fieldwalk::geometry::Point2;
use serde::Deserialize;

use super::MAX_PLACE_M;
use crate::comma_rows::address;
use crate::error::FormatError;

/// The collection's own files have two thousand bytes.
const MAX_BYTES: u64 = 1 << 20;
/// What the line with the receivers begins with.
const RECEIVERS: &str = "Dongles:";

const DEVICES_REMEDY: &str = "give a .dev file of the collection, with a line such as `Dongles:{\"b827eb4521b4\": [[7.00, 7.09, 1.22], 0, \"a\"]}`";
const LIMITS_REMEDY: &str = "give a .par file of the collection, with `\"limits\": [0, 0, 20.66, 17.64]` for the room's corners in metres";

/// A receiver at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Receiver {
    /// Its hardware address.
    pub address: [u8; 6],
    /// Its name in the collection, such as `sensor10`.
    pub alias: String,
    /// Where it hangs.
    pub position: Point2,
    /// How high, in metres.
    pub height_m: f64,
}

/// The room.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// The receivers, in order of their names.
    pub receivers: Vec<Receiver>,
    /// The corner with the least coordinates.
    pub low: Point2,
    /// The corner with the greatest coordinates.
    pub high: Point2,
}

/// Reads the room of the collection in `dir`: the `.dev` and the `.par` file in `cnf/`.
///
/// # Errors
/// When a file is missing, too long, or not of the format.
pub fn open_area(dir: &Path) -> Result<Area, FormatError> {
    let (devices, limits) = (only_file(dir, "dev", DEVICES_REMEDY)?, only_file(dir, "par", LIMITS_REMEDY)?);
    let receivers = read_receivers(&read(&devices)?).map_err(|error| error.at_path(&devices))?;
    let (low, high) = read_limits(&read(&limits)?).map_err(|error| error.at_path(&limits))?;
    Ok(Area { receivers, low, high })
}

/// Reads the receivers of a `.dev` file.
///
/// # Errors
/// When there is no line with receivers, or it is not one of the format.
pub fn read_receivers(bytes: &[u8]) -> Result<Vec<Receiver>, FormatError> {
    let malformed = |message: String| FormatError::malformed(message, DEVICES_REMEDY);
    let text = str::from_utf8(bytes).map_err(|_| malformed("not UTF-8".to_owned()))?;
    let found =
        text.lines().zip(1..).find_map(|(line, number)| Some((line.strip_prefix(RECEIVERS)?, number)));
    let (table, number) = found.ok_or_else(|| malformed(format!("no line begins with {RECEIVERS}")))?;
    let table: BTreeMap<String, (Vec<f64>, i64, String)> =
        serde_json::from_str(table).map_err(|error| malformed(error.to_string()).at_line(number))?;
    let receiver = |(name, (place, _colour, alias)): (String, (Vec<f64>, i64, String))| {
        let address = address(&name)
            .ok_or_else(|| malformed(format!("`{name}` is no hardware address")).at_line(number))?;
        let &[x_m, y_m, height_m] = place.as_slice() else {
            return Err(malformed(format!("{alias} stands at {place:?}")).at_line(number));
        };
        // Written so that NaN fails.
        if !place.iter().all(|m| m.abs() <= MAX_PLACE_M) {
            return Err(
                malformed(format!("{alias} stands at {place:?}, beyond {MAX_PLACE_M} m")).at_line(number)
            );
        }
        Ok(Receiver { address, alias, position: Point2::new(x_m, y_m), height_m })
    };
    let mut receivers = table.into_iter().map(receiver).collect::<Result<Vec<_>, _>>()?;
    if receivers.is_empty() {
        return Err(malformed("no receiver".to_owned()).at_line(number));
    }
    receivers.sort_by(|a, b| (&a.alias, a.address).cmp(&(&b.alias, b.address)));
    Ok(receivers)
}

fn read_limits(bytes: &[u8]) -> Result<(Point2, Point2), FormatError> {
    #[derive(Deserialize)]
    struct Parameters {
        limits: [f64; 4],
    }
    let malformed = |message: String| FormatError::malformed(message, LIMITS_REMEDY);
    let parameters: Parameters =
        serde_json::from_slice(bytes).map_err(|error| malformed(error.to_string()))?;
    let [x0_m, y0_m, x1_m, y1_m] = parameters.limits;
    let is_room = x0_m < x1_m && y0_m < y1_m && parameters.limits.iter().all(|m| m.abs() <= MAX_PLACE_M);
    if !is_room {
        return Err(malformed(format!("{:?} are no corners of a room", parameters.limits)));
    }
    Ok((Point2::new(x0_m, y0_m), Point2::new(x1_m, y1_m)))
}

/// The first file of `dir/cnf` with the ending `ending`.
fn only_file(dir: &Path, ending: &str, remedy: &'static str) -> Result<PathBuf, FormatError> {
    let cnf = dir.join("cnf");
    let failed = |error| FormatError::io("list the folder", &cnf, error);
    let mut found = None;
    for entry in fs::read_dir(&cnf).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|extension| extension == ending) {
            found = Some(found.map_or(path.clone(), |first: PathBuf| first.min(path)));
        }
    }
    found.ok_or_else(|| FormatError::malformed(format!("no .{ending} file here"), remedy).at_path(cnf))
}

fn read(path: &Path) -> Result<Vec<u8>, FormatError> {
    let failed = |error| FormatError::io("read the file", path, error);
    let file = fs::File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(
            FormatError::malformed("the file is longer than a megabyte", DEVICES_REMEDY).at_path(path)
        );
    }
    Ok(bytes)
}
