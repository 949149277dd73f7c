//! Where things are.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The repository's root and the build folder.
#[derive(Debug)]
pub struct Workspace {
    pub root: PathBuf,
    pub target: PathBuf,
}

impl Workspace {
    /// The workspace that this program was built from.
    pub fn open() -> Self {
        let own_crate = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = own_crate.parent().unwrap_or(own_crate).to_owned();
        let target = root.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()));
        Self { root, target }
    }

    /// `program` with the root as its working folder.
    pub fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root).env("CARGO_TARGET_DIR", &self.target);
        command
    }

    /// Cargo with these arguments, split at spaces.
    pub fn cargo(&self, arguments: &str) -> Command {
        let mut command = self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.args(arguments.split_whitespace());
        command
    }

    /// Where tools that only the checks need are installed.
    pub fn tools(&self) -> PathBuf {
        self.target.join("tools")
    }
}
