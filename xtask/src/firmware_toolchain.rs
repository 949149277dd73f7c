//! A Rust for the card's Cortex-M4: rustup's target, else a compiler that comes with the sources of `core`.
//!
//! Debian packages such a compiler (`rustc-web` on bookworm) where rustup cannot be reached. It lacks a linker for other
//! machines: rustup's own, or Debian's LLVM.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::install;
use crate::process::{find_program, output_of, run as execute};
use crate::workspace::Workspace;

pub const TARGET: &str = "thumbv7em-none-eabihf";
/// What Debian calls a compiler with its sources, and a linker.
pub const PACKAGES: &[&str] = &["rustc-web", "cargo-web", "rust-web-src", "lld-22"];
const LINKERS: [&str; 4] = ["rust-lld", "ld.lld", "ld.lld-22", "ld.lld-21"];

/// How the card's images are built.
#[derive(Debug)]
pub enum Toolchain {
    /// The compiler in use has the target.
    Installed,
    /// This compiler builds `core` from its sources, with this cargo and this linker.
    FromSources { rustc: PathBuf, cargo: PathBuf, linker: PathBuf },
}

impl Toolchain {
    /// The toolchain of this machine, installed if need be.
    ///
    /// # Errors
    /// A reason when there is none and none can be had, with what would change that.
    pub fn find_or_install(workspace: &Workspace) -> Result<Self, String> {
        if has_target() {
            return Ok(Self::Installed);
        }
        if find_program("rustup").is_some()
            && execute(Command::new("rustup").args(["target", "add", TARGET])).is_ok()
            && has_target()
        {
            return Ok(Self::Installed);
        }
        Self::from_sources(workspace)
            .or_else(|| {
                install::packages(PACKAGES);
                Self::from_sources(workspace)
            })
            .ok_or(format!(
                "Rust for the card is missing: rustup target add {TARGET}; on Debian: apt-get install {}",
                PACKAGES.join(" ")
            ))
    }

    fn from_sources(workspace: &Workspace) -> Option<Self> {
        let in_use = (find_program("rustc")?, find_program("cargo")?);
        let debians = (PathBuf::from("/usr/bin/rustc"), PathBuf::from("/usr/bin/cargo"));
        let (rustc, cargo) = [in_use, debians].into_iter().find(|(rustc, _)| has_sources(rustc))?;
        Some(Self::FromSources { rustc, cargo, linker: find_linker(workspace)? })
    }

    /// Cargo as this toolchain runs it.
    pub fn cargo(&self, workspace: &Workspace) -> Command {
        match self {
            Self::Installed => workspace.cargo(""),
            Self::FromSources { rustc, cargo, linker } => {
                let mut command = workspace.command(cargo);
                command
                    .env("RUSTC", rustc)
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker)
                    // rustup would put its own compiler in their place.
                    .env_remove("RUSTUP_TOOLCHAIN")
                    .env_remove("CARGO");
                command
            }
        }
    }

    /// What `cargo build` needs besides.
    pub fn build_flags(&self) -> &'static [&'static str] {
        match self {
            Self::Installed => &[],
            Self::FromSources { .. } => &["-Zbuild-std=core"],
        }
    }
}

fn has_target() -> bool {
    output_of(Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]))
        .is_some_and(|folder| Path::new(&folder).exists())
}

fn has_sources(rustc: &Path) -> bool {
    output_of(Command::new(rustc).args(["--print", "sysroot"]))
        .is_some_and(|root| Path::new(&root).join("lib/rustlib/src/rust/library/Cargo.lock").exists())
}

/// A linker for ARM: in rustup's own folder, or in `PATH`.
fn find_linker(workspace: &Workspace) -> Option<PathBuf> {
    let mut version = workspace.command("rustc");
    let host =
        output_of(version.arg("-vV"))?.lines().find_map(|line| line.strip_prefix("host: "))?.to_owned();
    let root = output_of(workspace.command("rustc").args(["--print", "sysroot"]))?;
    let own = Path::new(&root).join("lib/rustlib").join(host).join("bin/rust-lld");
    if own.is_file() { Some(own) } else { LINKERS.iter().find_map(|name| find_program(name)) }
}
