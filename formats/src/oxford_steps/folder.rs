//! The folders of the collection's walks, and what their names say.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::FormatError;

/// One walk's folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFolder {
    /// The folder's name, such as `Samsung_Carmelo_Hard_NeckPouch_1`.
    pub name: String,
    /// The folder.
    pub dir: PathBuf,
    /// How the phone was carried.
    pub placement: Placement,
}

/// How the phone was carried, by the folder's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Placement {
    /// Held in front of the body.
    InHand,
    /// In a front pocket of the trousers.
    FrontPocket,
    /// In a back pocket of the trousers.
    BackPocket,
    /// On the upper arm.
    ArmBand,
    /// In a pouch hung from the neck.
    NeckPouch,
    /// In a purse or bag.
    Purse,
    /// In the hand of an arm that swings.
    SwingingArm,
    /// The name does not say.
    Unstated,
}

/// Deeper folders are not searched.
const MAX_DEPTH: usize = 4;

impl RunFolder {
    /// The accelerometer's file, which some walks of the collection do not have.
    pub fn accelerometer(&self) -> PathBuf {
        self.dir.join("accelerometer.csv")
    }

    /// The foot switches' file.
    pub fn contacts(&self) -> PathBuf {
        self.dir.join(CONTACTS)
    }
}

const CONTACTS: &str = "stepcounter.csv";

/// The walks in `dir` and the folders below it, sorted by name; `dir` may be a walk's folder itself.
///
/// # Errors
/// When a folder cannot be listed, and when there is no walk.
pub fn find_runs(dir: &Path) -> Result<Vec<RunFolder>, FormatError> {
    let mut runs = Vec::new();
    search(dir, MAX_DEPTH, &mut runs)?;
    if runs.is_empty() {
        let remedy = "give the unpacked folder of the Oxford step-counting collection";
        let message = format!("no folder here holds a {CONTACTS}");
        return Err(FormatError::malformed(message, remedy).at_path(dir));
    }
    runs.sort_by(|a, b| (&a.name, &a.dir).cmp(&(&b.name, &b.dir)));
    Ok(runs)
}

fn search(dir: &Path, depth: usize, runs: &mut Vec<RunFolder>) -> Result<(), FormatError> {
    if dir.join(CONTACTS).is_file() {
        // `.` and `..` have no name of their own.
        let named = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
        let name = named.file_name().unwrap_or_default().to_string_lossy().into_owned();
        runs.push(RunFolder { placement: Placement::of_run(&name), name, dir: dir.to_owned() });
        return Ok(());
    }
    if depth == 0 {
        return Ok(());
    }
    let failed = |error| FormatError::io("list the folder", dir, error);
    for entry in fs::read_dir(dir).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            search(&path, depth - 1, runs)?;
        }
    }
    Ok(())
}

impl Placement {
    /// Every placement, in the order in which tables list them.
    pub const ALL: [Self; 8] = [
        Self::InHand,
        Self::FrontPocket,
        Self::BackPocket,
        Self::ArmBand,
        Self::NeckPouch,
        Self::Purse,
        Self::SwingingArm,
        Self::Unstated,
    ];

    /// The placement that a walk's folder `name` states, in whatever case it is written.
    pub fn of_run(name: &str) -> Self {
        let is_named = |part: &str, placement: &Self| {
            *placement != Self::Unstated && part.eq_ignore_ascii_case(&placement.name().replace('_', ""))
        };
        let of_part = |part| Self::ALL.into_iter().find(|placement| is_named(part, placement));
        name.split('_').find_map(of_part).unwrap_or(Self::Unstated)
    }

    /// The name in rows, such as `in_hand`.
    pub fn name(self) -> &'static str {
        match self {
            Self::InHand => "in_hand",
            Self::FrontPocket => "front_pocket",
            Self::BackPocket => "back_pocket",
            Self::ArmBand => "arm_band",
            Self::NeckPouch => "neck_pouch",
            Self::Purse => "purse",
            Self::SwingingArm => "swinging_arm",
            Self::Unstated => "unstated",
        }
    }
}

impl fmt::Display for Placement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
