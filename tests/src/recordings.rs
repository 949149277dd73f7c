//! Recordings by others, found through the environment and unpacked once.
//!
//! `FIELDWALK_DATA` names the folder that holds them, absolute or from the workspace's root; without it the tests that
//! need a recording are skipped, and say so on standard error. With `FIELDWALK_REQUIRE_DATA=1` a missing recording is a
//! failure.
//!
//! Archives are unpacked into `fieldwalk-data` in Cargo's build folder, never into the source tree.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::UNIX_EPOCH;

use crate::skipped;

/// The folder of one floor of the shopping mall of indoor-location-competition-20, for instance `"F1"`: it holds
/// `floor_info.json`, `geojson_map.json` and `traces/*.txt`.
///
/// Read from `$FIELDWALK_DATA/ilc/site1-F1.tar.xz`, or from the folder `$FIELDWALK_DATA/ilc/site1/F1` where there is no
/// archive. `None` when there is neither; the test then returns early.
///
/// # Panics
/// When there is neither and `FIELDWALK_REQUIRE_DATA=1`, and when the archive cannot be unpacked.
pub fn ilc_floor(floor: &str) -> Option<PathBuf> {
    let wanted = format!("ilc floor {floor}");
    let sought = format!("neither ilc/site1-{floor}.tar.xz nor ilc/site1/{floor}");
    find(&wanted, &sought, |recordings, cache| find_ilc_floor(recordings, cache, floor))
}

/// The folder of the attitude benchmark of Inria Tyrex: it holds `android/`, `ios/` and `qualisys/`.
///
/// Read from `$FIELDWALK_DATA/tyrex-attitude.tar.xz`, or from the folder `$FIELDWALK_DATA/tyrex-attitude` where there
/// is no archive. `None` when there is neither; the test then returns early.
///
/// # Panics
/// When there is neither and `FIELDWALK_REQUIRE_DATA=1`, and when the archive cannot be unpacked.
pub fn tyrex_attitude() -> Option<PathBuf> {
    find("tyrex-attitude", "neither tyrex-attitude.tar.xz nor tyrex-attitude", |recordings, cache| {
        find_archive(recordings, cache, "tyrex-attitude")
    })
}

/// The folder of the collection `name`: of the archive `$FIELDWALK_DATA/NAME.tar.xz`, or else the folder
/// `$FIELDWALK_DATA/NAME`. `None` when there is neither.
///
/// # Panics
/// When there is neither and `FIELDWALK_REQUIRE_DATA=1`, and when the archive cannot be unpacked.
pub fn collection(name: &str) -> Option<PathBuf> {
    let sought = format!("neither {name}.tar.xz nor {name}");
    find(name, &sought, |recordings, cache| find_archive(recordings, cache, name))
}

fn find(
    wanted: &str,
    sought: &str,
    search: impl FnOnce(&Path, &Path) -> io::Result<Option<PathBuf>>,
) -> Option<PathBuf> {
    let Some(recordings) = std::env::var_os("FIELDWALK_DATA") else {
        return missing(wanted, "FIELDWALK_DATA is not set; set it to the folder that holds the recordings");
    };
    let recordings = workspace().join(recordings);
    match search(&recordings, &cache_folder()) {
        Ok(Some(folder)) => Some(folder),
        Ok(None) => missing(wanted, &format!("{} has {sought}", recordings.display())),
        Err(error) => fail(wanted, &error.to_string()),
    }
}

/// The folder `name` of the archive `name.tar.xz`, or else beside the archives.
fn find_archive(recordings: &Path, cache: &Path, name: &str) -> io::Result<Option<PathBuf>> {
    let archive = recordings.join(format!("{name}.tar.xz"));
    let is_archived = archive.is_file();
    let folder = if is_archived { unpacked(&archive, cache)?.join(name) } else { recordings.join(name) };
    match folder.is_dir() {
        true => Ok(Some(folder)),
        false if is_archived => Err(io::Error::other(format!("{} holds no {name}", archive.display()))),
        false => Ok(None),
    }
}

fn find_ilc_floor(recordings: &Path, cache: &Path, floor: &str) -> io::Result<Option<PathBuf>> {
    let ilc = recordings.join("ilc");
    let archive = ilc.join(format!("site1-{floor}.tar.xz"));
    let is_archived = archive.is_file();
    let folder = if is_archived { unpacked(&archive, &cache.join("ilc"))? } else { ilc };
    let folder = folder.join("site1").join(floor);
    match folder.is_dir() {
        true => Ok(Some(folder)),
        false if is_archived => {
            Err(io::Error::other(format!("{} holds no site1/{floor}", archive.display())))
        }
        false => Ok(None),
    }
}

/// Cargo's build folder, as far as a test can know it.
fn cache_folder() -> PathBuf {
    let build = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    workspace().join(build).join("fieldwalk-data")
}

fn workspace() -> &'static Path {
    let own_crate = Path::new(env!("CARGO_MANIFEST_DIR"));
    own_crate.parent().unwrap_or(own_crate)
}

/// The folder in `cache` with the archive's content, unpacked now if it is not there or if the archive has changed.
///
/// Tests run in many processes: a lock lets one unpack while the others wait. A stop halfway leaves a folder under
/// another name, which the next attempt clears away.
fn unpacked(archive: &Path, cache: &Path) -> io::Result<PathBuf> {
    let file_name = archive.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let name = file_name.split(".tar").next().unwrap_or(&file_name);
    let folder = cache.join(name);
    let stamp_file = folder.join(".unpacked-from");
    let stamp = stamp(archive)?;

    fs::create_dir_all(cache)?;
    let lock = File::create(cache.join(format!("{name}.lock")))?;
    lock.lock()?;
    if fs::read_to_string(&stamp_file).is_ok_and(|found| found == stamp) {
        return Ok(folder);
    }
    let unfinished = cache.join(format!("{name}.unfinished"));
    for stale in [&folder, &unfinished] {
        if stale.exists() {
            fs::remove_dir_all(stale)?;
        }
    }
    fs::create_dir(&unfinished)?;
    untar(archive, &unfinished)?;
    fs::write(unfinished.join(".unpacked-from"), &stamp)?;
    fs::rename(&unfinished, &folder)?;
    Ok(folder)
}

/// Changes when the archive does.
fn stamp(archive: &Path) -> io::Result<String> {
    let metadata = fs::metadata(archive)?;
    let modified = metadata.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
    Ok(format!("{} bytes, modified at {} ns\n", metadata.len(), modified.as_nanos()))
}

fn untar(archive: &Path, folder: &Path) -> io::Result<()> {
    let output =
        Command::new("tar").arg("-xf").arg(archive).arg("-C").arg(folder).output().map_err(|error| {
            io::Error::new(
                error.kind(),
                format!("tar did not start ({error}); on Debian: apt-get install tar xz-utils"),
            )
        })?;
    if output.status.success() {
        return Ok(());
    }
    let why = String::from_utf8_lossy(&output.stderr);
    Err(io::Error::other(format!(
        "{} cannot be unpacked: {}; fetch it again, or install xz (on Debian: apt-get install xz-utils)",
        archive.display(),
        why.trim()
    )))
}

/// Says that a recording is missing; fails when that was ruled out.
fn missing(wanted: &str, reason: &str) -> Option<PathBuf> {
    if std::env::var("FIELDWALK_REQUIRE_DATA").is_ok_and(|value| value == "1") {
        fail(wanted, reason);
    }
    skipped::say(wanted, reason);
    None
}

#[expect(clippy::panic, reason = "only tests call this module, and a test fails by panicking")]
fn fail(wanted: &str, reason: &str) -> ! {
    panic!("{wanted}: {reason}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An empty folder, removed when the test ends.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(test: &str) -> Self {
            let folder =
                std::env::temp_dir().join(format!("fieldwalk-recordings-{}-{test}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        /// An archive, uncompressed, in which floor F1 has one file.
        fn archive(&self, text: &str) -> PathBuf {
            let (content, archive) = (self.0.join("content"), self.0.join("ilc/site1-F1.tar.xz"));
            fs::create_dir_all(content.join("site1/F1")).unwrap();
            fs::create_dir_all(self.0.join("ilc")).unwrap();
            fs::write(content.join("site1/F1/floor_info.json"), text).unwrap();
            let mut tar = Command::new("tar");
            let status = tar.arg("-cf").arg(&archive).arg("-C").arg(&content).arg("site1").status();
            assert!(status.unwrap().success());
            archive
        }

        fn floor_info(&self) -> String {
            let folder = find_ilc_floor(&self.0, &self.0.join("cache"), "F1").unwrap().unwrap();
            fs::read_to_string(folder.join("floor_info.json")).unwrap()
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn an_archive_is_unpacked_once_and_again_when_it_changes() {
        let scratch = Scratch::new("once");
        scratch.archive("first");
        assert_eq!(scratch.floor_info(), "first");
        let unpacked = scratch.0.join("cache/ilc/site1-F1/site1/F1/floor_info.json");
        fs::write(&unpacked, "kept").unwrap();
        assert_eq!(scratch.floor_info(), "kept");
        scratch.archive(&"second".repeat(2000));
        assert!(scratch.floor_info().starts_with("second"));
    }

    #[test]
    fn a_half_unpacked_folder_is_not_believed() {
        let scratch = Scratch::new("half");
        scratch.archive("whole");
        for name in ["site1-F1", "site1-F1.unfinished"] {
            let half = scratch.0.join("cache/ilc").join(name).join("site1/F1");
            fs::create_dir_all(&half).unwrap();
            fs::write(half.join("floor_info.json"), "ha").unwrap();
        }
        assert_eq!(scratch.floor_info(), "whole");
    }

    #[test]
    fn a_torn_archive_is_an_error_with_a_remedy() {
        let scratch = Scratch::new("torn");
        let archive = scratch.archive(&"whole".repeat(1000));
        let bytes = fs::read(&archive).unwrap();
        // two folders' headers, the file's header, and the start of its content
        fs::write(&archive, &bytes[..3 * 512 + 700]).unwrap();
        let error = find_ilc_floor(&scratch.0, &scratch.0.join("cache"), "F1").unwrap_err().to_string();
        assert!(error.contains("site1-F1.tar.xz") && error.contains("fetch it again"), "{error}");
        assert!(!scratch.0.join("cache/ilc/site1-F1").exists());
    }

    #[test]
    fn a_folder_beside_the_archives_serves_too() {
        let scratch = Scratch::new("folder");
        assert_eq!(find_ilc_floor(&scratch.0, &scratch.0.join("cache"), "F1").unwrap(), None);
        fs::create_dir_all(scratch.0.join("ilc/site1/F1")).unwrap();
        let found = find_ilc_floor(&scratch.0, &scratch.0.join("cache"), "F1").unwrap();
        assert_eq!(found, Some(scratch.0.join("ilc/site1/F1")));
    }
}
