//! Room on the disk: a run that ends for want of it says so at its beginning and its end, not only in a linker's words.

use std::path::Path;
use std::process::Command;

use crate::process::output_of;

const GIB: u64 = 1 << 30;
/// What all checks write into a build folder that was empty, with some to spare.
const ALL_CHECKS_BYTES: u64 = 9 * GIB;

/// What is free where `folder` is, or will be; `None` where `df` cannot tell.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let existing = folder.ancestors().find(|folder| folder.exists())?;
    free_in(&output_of(Command::new("df").arg("-Pk").arg(existing))?)
}

/// The warning before a run of all checks, where less is free than they write.
pub fn warning(free_bytes: u64, already_there_bytes: u64) -> Option<String> {
    let needed = ALL_CHECKS_BYTES.saturating_sub(already_there_bytes);
    (free_bytes < needed).then(|| {
        format!(
            "{} free where the build folder is; all checks write about {} more",
            shown(free_bytes),
            shown(needed)
        )
    })
}

/// What the build folder holds and what is free beside it.
pub fn state(folder: &Path) -> Option<String> {
    let free = shown(free_bytes(folder)?);
    Some(format!("{} in the build folder, {free} free", shown(held_bytes(folder))))
}

/// What `folder` holds, a file with several names once; nothing where `du` cannot tell.
pub fn held_bytes(folder: &Path) -> u64 {
    let du = output_of(Command::new("du").arg("-sk").arg(folder));
    du.and_then(|du| du.split_whitespace().next()?.parse().ok())
        .map_or(0, |kib: u64| kib.saturating_mul(1024))
}

fn shown(bytes: u64) -> String {
    format!("{:.1} GiB", bytes as f64 / GIB as f64)
}

/// The free bytes in what `df -Pk` prints.
fn free_in(df: &str) -> Option<u64> {
    let free_kib: u64 = df.lines().nth(1)?.split_whitespace().nth(3)?.parse().ok()?;
    free_kib.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn df_is_read() {
        let df = "Filesystem     1024-blocks     Used Available Capacity Mounted on\n\
                  /dev/vda         263174212 37748736  59768832      39% /\n";
        assert_eq!(free_in(df), Some(59_768_832 * 1024));
        assert_eq!(free_in("df: no such folder"), None);
    }

    #[test]
    fn a_warning_counts_what_an_earlier_run_left() {
        assert_eq!(warning(ALL_CHECKS_BYTES, 0), None);
        let warning = |free, held| super::warning(free, held).unwrap_or_default();
        assert!(warning(3 * GIB, 0).starts_with("3.0 GiB free"), "{}", warning(3 * GIB, 0));
        assert_eq!(warning(3 * GIB, ALL_CHECKS_BYTES - GIB), "");
    }

    #[test]
    fn a_folder_holds_what_its_files_do() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let own = folder.join("src/disk.rs").metadata().expect("this file").len();
        assert!(held_bytes(folder) > own, "{}", held_bytes(folder));
        assert_eq!(held_bytes(&folder.join("none")), 0);
    }
}
