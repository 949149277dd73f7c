//! A building as one file: a tar archive of its folder.

use std::collections::BTreeMap;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};

use fieldwalk::map::BuildingMap;
use tar::{Archive, Builder, EntryType, Header};

use super::{MANIFEST_FILE, decode_files, encode_files};
use crate::error::FormatError;

/// The largest archive that is read from disk.
pub(super) const MAX_ARCHIVE_BYTES: u64 = 1 << 30;

const REMEDY: &str = "pack the map's folder again, without compression: tar -cf mall.tar mall.map";

/// `building` as one file; the same map gives the same bytes.
///
/// # Errors
/// When a layer does not fit its grid, and when a number that must be finite is not.
pub fn pack_building(building: &BuildingMap) -> Result<Vec<u8>, FormatError> {
    let mut archive = Builder::new(Vec::new());
    let failed = |error: io::Error| FormatError::malformed(format!("cannot be packed: {error}"), REMEDY);
    encode_files(Path::new(""), building, |path, bytes| {
        let mut header = Header::new_ustar();
        header.set_entry_type(EntryType::Regular);
        header.set_mode(0o644);
        header.set_size(bytes.len() as u64);
        archive.append_data(&mut header, path, bytes).map_err(failed)
    })?;
    archive.into_inner().map_err(failed)
}

/// The building in an archive that [`pack_building`] or `tar` has made of a map's folder; floors come from the lowest
/// to the highest ordinal.
///
/// Files are read where they lie in `bytes`. What is not a plain file, and files that the manifest does not name, are
/// passed over.
///
/// # Errors
/// When `bytes` are no such archive, when it ends early or lacks a file, and as
/// [`open_building`](super::open_building).
pub fn unpack_building(bytes: &[u8]) -> Result<BuildingMap, FormatError> {
    let files = plain_files(bytes).map_err(|error| {
        FormatError::malformed(format!("not a tar archive, or not all of one: {error}"), REMEDY)
    })?;
    let is_manifest = |path: &&PathBuf| path.file_name().is_some_and(|name| name == MANIFEST_FILE);
    let mut manifests = files.keys().filter(is_manifest);
    let (Some(manifest), None) = (manifests.next(), manifests.next()) else {
        let message = format!("an archive without a {MANIFEST_FILE}, or with several");
        return Err(FormatError::malformed(message, REMEDY));
    };
    decode_files(manifest.parent().unwrap_or(Path::new("")), |path, max_bytes| match files.get(path) {
        Some(&file) if file.len() as u64 <= max_bytes => Ok(file),
        Some(_) => {
            let message = format!("larger than {} MB", max_bytes >> 20);
            Err(FormatError::malformed(message, "check that this is a map's file").at_path(path))
        }
        None => Err(FormatError::malformed("is not in the archive", REMEDY).at_path(path)),
    })
}

/// The archive's files by path. A path that comes twice is its last, as tar unpacks it.
fn plain_files(bytes: &[u8]) -> io::Result<BTreeMap<PathBuf, &[u8]>> {
    let mut files = BTreeMap::new();
    let mut archive = Archive::new(Cursor::new(bytes));
    for entry in archive.entries()? {
        let entry = entry?;
        // Sparse files would be longer than what they take in the archive.
        if entry.header().entry_type() != EntryType::Regular {
            continue;
        }
        let start = usize::try_from(entry.raw_file_position()).ok();
        let end = usize::try_from(entry.size()).ok().and_then(|n_bytes| start?.checked_add(n_bytes));
        let content = start.zip(end).and_then(|(start, end)| bytes.get(start..end));
        let content = content.ok_or_else(|| io::Error::from(io::ErrorKind::UnexpectedEof))?;
        let path = entry.path()?;
        files.insert(path.strip_prefix(".").unwrap_or(&path).to_owned(), content);
    }
    Ok(files)
}
