//! Files read whole and written whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::path::Path;
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use sha2::{Digest as _, Sha256};

use crate::error::FormatError;

/// A manifest of the largest building is far smaller.
pub(super) const MAX_MANIFEST_BYTES: u64 = 16 << 20;

/// A floor of 1 km² at half a metre is a quarter of this.
pub(super) const MAX_FLOOR_BYTES: u64 = 256 << 20;

/// The content of `path`, which may have `max_bytes` at most.
pub(super) fn read(path: &Path, max_bytes: u64) -> Result<Vec<u8>, FormatError> {
    let fail = |error| FormatError::io("read the map", path, error);
    let file = File::open(path).map_err(fail)?;
    let n_bytes = file.metadata().map_err(fail)?.len();
    let mut bytes = Vec::with_capacity(n_bytes.min(max_bytes) as usize + 1);
    file.take(max_bytes + 1).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > max_bytes {
        let message = format!("larger than {} MB", max_bytes >> 20);
        return Err(FormatError::malformed(message, "check that this is a map's file").at_path(path));
    }
    Ok(bytes)
}

/// Makes the folder `dir` and those above it, where they do not exist.
pub(super) fn create_folder(dir: &Path) -> Result<(), FormatError> {
    fs::create_dir_all(dir).map_err(|error| FormatError::io("make the folder", dir, error))
}

/// Writes `bytes` to a new file beside `path`, then renames it to `path`.
pub(super) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FormatError> {
    static SERIAL: AtomicU64 = AtomicU64::new(0);
    let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
    let unfinished = path.with_extension(format!("{}-{serial}.unfinished", process::id()));
    let written = write_new(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, path));
    written.map_err(|error| {
        // The first error is the one to tell; the unfinished file may not even exist.
        let _ = fs::remove_file(&unfinished);
        FormatError::io("write the map", path, error)
    })
}

/// The SHA-256 of the parts, one after the other, as 64 lower-case hexadecimal digits.
pub(super) fn sha256_hex(parts: &[&[u8]]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        hasher.update(part);
    }
    let hex_digit = |nibble: u8| char::from(if nibble < 10 { b'0' + nibble } else { b'a' - 10 + nibble });
    hasher.finalize().iter().flat_map(|byte| [hex_digit(byte >> 4), hex_digit(byte & 15)]).collect()
}

fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}
