//! Maps on disk: a building is a folder with a manifest and one safetensors file per floor.
//!
//! `building.json` names the floors, their files and the files' SHA-256. A floor's file holds every layer as an F16
//! tensor `[ny, nx]` under the layer's name, the routes, the radio table and the fingerprints as tensors, and the rest as
//! sorted JSON under the one metadata key `fieldwalk`. The same map gives the same bytes. Any safetensors reader opens a
//! floor.
//!
//! As one file, a building is a tar archive of that folder, uncompressed: `tar -cf mall.tar mall.map`. Nothing in it
//! can grow while it is read, and any tar opens it.

mod archive;
mod check;
mod disk;
mod floor_file;
mod manifest;
mod metadata;
mod tensors;

use std::path::Path;

use fieldwalk::map::{BuildingMap, FloorMap};

use crate::error::FormatError;
use floor_file::FloorFile;
use manifest::{FloorEntry, Manifest};

pub use archive::{pack_building, unpack_building};
pub use floor_file::encode_floor;

/// The manifest's name in a building's folder.
pub const MANIFEST_FILE: &str = "building.json";

/// The version of the map format that this build writes, and the newest that it reads.
///
/// A new tensor is no new version: builds that do not know it pass over it, and where it is missing nothing was surveyed.
pub const MAP_VERSION: u64 = 1;

/// Writes `building` into the folder `dir`, which is made if need be; floors are ordered by ordinal.
///
/// Each file appears whole or not at all, the manifest last. Files of floors that the building no longer has stay.
///
/// # Errors
/// When a layer does not fit its grid, when a number that must be finite is not, and when writing fails.
pub fn write_building(dir: &Path, building: &BuildingMap) -> Result<(), FormatError> {
    disk::create_folder(dir)?;
    encode_files(dir, building, disk::write_atomically)
}

/// Opens the building in the folder at `path`, or in the archive there; floors come from the lowest to the highest
/// ordinal.
///
/// # Errors
/// When a file is missing, malformed, of a newer version, or not the one that the manifest was written with.
pub fn open_building(path: &Path) -> Result<BuildingMap, FormatError> {
    if path.is_file() {
        let bytes = disk::read(path, archive::MAX_ARCHIVE_BYTES)?;
        return unpack_building(&bytes).map_err(|error| match error.path() {
            Some(inside) => {
                let inside = path.join(inside);
                error.at_path(inside)
            }
            None => error.at_path(path),
        });
    }
    decode_files(path, disk::read)
}

/// Gives `write` the path in `dir` and the content of every file of `building`, floors by ordinal, the manifest last.
fn encode_files(
    dir: &Path,
    building: &BuildingMap,
    mut write: impl FnMut(&Path, &[u8]) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let mut floors: Vec<&FloorMap> = building.floors.iter().collect();
    floors.sort_by_key(|floor| floor.ordinal);
    let mut manifest = Manifest::new(&building.name);
    for floor in floors {
        let file = manifest.unused_file_name(&floor.name);
        let path = dir.join(&file);
        let bytes = encode_floor(floor).map_err(|error| error.at_path(&path))?;
        write(&path, &bytes)?;
        let sha256 = disk::sha256_hex(&[&bytes]);
        manifest.floors.push(FloorEntry { file, name: floor.name.clone(), ordinal: floor.ordinal, sha256 });
    }
    write(&dir.join(MANIFEST_FILE), manifest.to_json().as_bytes())
}

/// The building whose files in `dir` are what `read` gives for a path and the most bytes that it may have.
fn decode_files<B: AsRef<[u8]>>(
    dir: &Path,
    read: impl Fn(&Path, u64) -> Result<B, FormatError>,
) -> Result<BuildingMap, FormatError> {
    let path = dir.join(MANIFEST_FILE);
    let bytes = read(&path, disk::MAX_MANIFEST_BYTES)?;
    let manifest = Manifest::from_json(bytes.as_ref()).map_err(|error| error.at_path(&path))?;
    let mut floors = Vec::with_capacity(manifest.floors.len());
    for entry in &manifest.floors {
        let path = dir.join(&entry.file);
        let bytes = read(&path, disk::MAX_FLOOR_BYTES)?;
        floors.push(open_floor(entry, bytes.as_ref()).map_err(|error| error.at_path(&path))?);
    }
    floors.sort_by_key(|floor| floor.ordinal);
    Ok(BuildingMap { name: manifest.name, floors })
}

/// Reads a floor's file from `bytes`.
///
/// # Errors
/// When `bytes` are not a floor map, are of a newer version, or have changed since they were written.
pub fn decode_floor(bytes: &[u8]) -> Result<FloorMap, FormatError> {
    let file = FloorFile::parse(bytes)?;
    file.check_digest()?;
    file.to_map()
}

/// The floor of one entry of the manifest; the manifest's digest makes the file's own superfluous.
fn open_floor(entry: &FloorEntry, bytes: &[u8]) -> Result<FloorMap, FormatError> {
    let file = FloorFile::parse(bytes)?;
    if !cfg!(fuzzing) && disk::sha256_hex(&[bytes]) != entry.sha256 {
        return Err(FormatError::corrupt(
            "the file is not the one that the manifest was written with",
            "copy the building's folder again, or export it anew",
        ));
    }
    let floor = file.to_map()?;
    if floor.name != entry.name || floor.ordinal != entry.ordinal {
        return Err(FormatError::malformed(
            format!("holds floor {} ({}), not {} ({})", floor.name, floor.ordinal, entry.name, entry.ordinal),
            "export the building anew",
        ));
    }
    Ok(floor)
}
