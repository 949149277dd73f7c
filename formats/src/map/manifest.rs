//! `building.json`: which floors a building has, and in which files.

use std::path::{Component, Path};

use serde::{Deserialize, Serialize};

use super::MAP_VERSION;
use super::metadata::{check_version, malformed_json};
use crate::error::FormatError;

const FORMAT: &str = "fieldwalk-building";

/// Characters of a floor's name that its file's name keeps.
const MAX_NAME_CHARS: usize = 64;

/// The manifest; fields in the order of their names, which is the order on disk.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Manifest {
    pub(super) floors: Vec<FloorEntry>,
    format: String,
    pub(super) name: String,
    version: u64,
}

/// One floor of the manifest.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct FloorEntry {
    /// The file's name in the building's folder.
    pub(super) file: String,
    pub(super) name: String,
    pub(super) ordinal: i32,
    /// SHA-256 of the whole file, as `sha256sum` prints it.
    pub(super) sha256: String,
}

impl Manifest {
    pub(super) fn new(name: &str) -> Self {
        Self { floors: Vec::new(), format: FORMAT.to_owned(), name: name.to_owned(), version: MAP_VERSION }
    }

    /// Reads a manifest; its file names lie in the folder itself.
    pub(super) fn from_json(bytes: &[u8]) -> Result<Self, FormatError> {
        check_version(bytes, FORMAT)?;
        let manifest: Self = serde_json::from_slice(bytes).map_err(|error| malformed_json(FORMAT, &error))?;
        let mut files: Vec<&str> = manifest.floors.iter().map(|entry| entry.file.as_str()).collect();
        files.sort_unstable();
        if files.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(FormatError::malformed("two floors lie in one file", "export the building anew"));
        }
        match manifest.floors.iter().find(|entry| !is_plain_name(&entry.file)) {
            None => Ok(manifest),
            Some(entry) => Err(FormatError::malformed(
                format!("floor {} lies in `{}`, outside the building's folder", entry.name, entry.file),
                "put the floor's file beside the manifest",
            )),
        }
    }

    pub(super) fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// A file name for the floor called `name` that no floor listed so far has, letter case aside.
    pub(super) fn unused_file_name(&self, name: &str) -> String {
        let keep = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let stem: String = name.chars().take(MAX_NAME_CHARS).map(keep).collect();
        let stem = if stem.is_empty() { "floor" } else { &stem };
        let is_used = |file: &String| self.floors.iter().any(|entry| entry.file.eq_ignore_ascii_case(file));
        let mut file = format!("{stem}.safetensors");
        let mut n = 2;
        while is_used(&file) {
            file = format!("{stem}_{n}.safetensors");
            n += 1;
        }
        file
    }
}

/// Whether `file` is a name without any folder, on every platform.
fn is_plain_name(file: &str) -> bool {
    let mut components = Path::new(file).components();
    let is_one = matches!((components.next(), components.next()), (Some(Component::Normal(_)), None));
    is_one && !file.contains(['/', '\\', ':', '\0'])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest_of(files: &[&str]) -> Manifest {
        let mut manifest = Manifest::new("Hall");
        for file in files {
            let (file, name) = ((*file).to_owned(), "F".to_owned());
            manifest.floors.push(FloorEntry { file, name, ordinal: 0, sha256: String::new() });
        }
        manifest
    }

    #[test]
    fn file_names_are_plain_and_differ() {
        assert_eq!(manifest_of(&[]).unused_file_name("F1"), "F1.safetensors");
        assert_eq!(manifest_of(&[]).unused_file_name("../étage 1"), "____tage_1.safetensors");
        assert_eq!(manifest_of(&[]).unused_file_name(""), "floor.safetensors");
        let taken = manifest_of(&["f1.safetensors", "F1_2.safetensors"]);
        assert_eq!(taken.unused_file_name("F1"), "F1_3.safetensors");
    }

    #[test]
    fn a_manifest_cannot_point_out_of_its_folder() {
        for file in ["../x", "/etc/x", "a/b", "a\\b", "C:x", "..", ".", "", "x\0"] {
            let json = manifest_of(&[file]).to_json();
            assert!(Manifest::from_json(json.as_bytes()).is_err(), "{file}");
        }
        assert!(Manifest::from_json(manifest_of(&["a", "b", "a"]).to_json().as_bytes()).is_err());
        let json = manifest_of(&["F1.safetensors"]).to_json();
        assert_eq!(Manifest::from_json(json.as_bytes()).unwrap().to_json(), json);
    }
}
