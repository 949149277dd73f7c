//! The bytes of an export, from any place of any of its files.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::FormatError;

/// What a lane holds of its file.
const BUFFER_BYTES: usize = 8 * 1024;

/// The files of an export.
pub(super) trait Files: fmt::Debug + Send + Sync {
    fn len(&self) -> usize;

    /// The name of a file, without its folder.
    fn name(&self, file: usize) -> String;

    /// What stands for the file in errors.
    fn path(&self, file: usize) -> PathBuf;

    /// Reads from `position` on; 0 at the end.
    fn read_at(&self, file: usize, position: u64, buffer: &mut [u8]) -> io::Result<usize>;
}

/// Files on disk, opened anew for every buffer: an export may have more of them than a process may open.
#[derive(Debug)]
pub(super) struct Disk(Vec<PathBuf>);

impl Disk {
    /// The CSV files of the folder `path`, sorted by name, or the file `path`; and whether it is a folder.
    pub(super) fn open(path: &Path) -> Result<(Self, bool), FormatError> {
        let failed = |error| FormatError::io("open the export", path, error);
        if !fs::metadata(path).map_err(failed)?.is_dir() {
            return Ok((Self(vec![path.to_owned()]), false));
        }
        let mut paths = Vec::new();
        for entry in fs::read_dir(path).map_err(failed)? {
            let file = entry.map_err(failed)?.path();
            if file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
                && file.is_file()
            {
                paths.push(file);
            }
        }
        paths.sort();
        Ok((Self(paths), true))
    }
}

impl Files for Disk {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn name(&self, file: usize) -> String {
        let name = self.0.get(file).and_then(|path| path.file_name());
        name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    fn path(&self, file: usize) -> PathBuf {
        self.0.get(file).cloned().unwrap_or_default()
    }

    fn read_at(&self, file: usize, position: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let Some(path) = self.0.get(file) else { return Ok(0) };
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start(position))?;
        file.read(buffer)
    }
}

/// Files in memory, with their names.
#[derive(Debug)]
pub(super) struct Memory(pub(super) Vec<(String, Vec<u8>)>);

impl Files for Memory {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn name(&self, file: usize) -> String {
        self.0.get(file).map_or_else(String::new, |(name, _)| name.clone())
    }

    fn path(&self, file: usize) -> PathBuf {
        self.name(file).into()
    }

    fn read_at(&self, file: usize, position: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = self.0.get(file).map_or(&[][..], |(_, bytes)| bytes);
        let mut rest = bytes.get(usize::try_from(position).unwrap_or(usize::MAX)..).unwrap_or_default();
        rest.read(buffer)
    }
}

/// One file read onwards from a place.
#[derive(Debug)]
pub(super) struct Onwards {
    files: Arc<dyn Files>,
    file: usize,
    position: u64,
}

impl Onwards {
    pub(super) fn from(files: &Arc<dyn Files>, file: usize, position: u64) -> BufReader<Self> {
        BufReader::with_capacity(BUFFER_BYTES, Self { files: Arc::clone(files), file, position })
    }
}

impl Read for Onwards {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.files.read_at(self.file, self.position, buffer)?;
        self.position += n as u64;
        Ok(n)
    }
}
