//! A Swift of at least 6: the one installed, or Debian's in a root folder of its own.
//!
//! Debian packages Swift since trixie. Where there is none and we are root on any Debian, trixie is unpacked into a
//! cache folder (2.6 GB, about three minutes), once. Commands run there in a mount namespace of their own, so that no
//! mount outlives them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::{find_program, output_of, run as execute, succeeds};
use crate::workspace::Workspace;

/// Another place for the root folder than the cache.
const ROOT_VARIABLE: &str = "FIELDWALK_SWIFT_ROOT";
const RELEASE: &str = "trixie";
const PACKAGES: [&str; 7] =
    ["swiftlang", "libswiftlang", "swiftlang-dev", "libc6-dev", "gcc", "g++", "binutils"];
/// Used when apt does not tell where this machine's packages come from.
const MIRROR: &str = "http://deb.debian.org/debian";
/// Documentation is not unpacked, and no file flushed: a folder half made is thrown away anyhow.
const DPKG_OPTIONS: &str = "force-unsafe-io\npath-exclude=/usr/share/doc/*\npath-exclude=/usr/share/man/*\n\
                            path-exclude=/usr/share/locale/*\n";

/// Runs in the namespace: makes the folders visible under the root, and what a program expects of a system.
const ENTER: &str = r#"set -e
root=$1; folders=$2; here=$3; libraries=$4; shift 4
IFS=:
for folder in $folders; do
    mkdir -p "$root$folder"
    mount --bind "$folder" "$root$folder"
done
for folder in proc dev sys; do mount --rbind "/$folder" "$root/$folder"; done
exec chroot "$root" env -i HOME=/root LANG=C.UTF-8 PATH=/usr/libexec/swift/bin:/usr/bin:/bin \
    LD_LIBRARY_PATH="/usr/libexec/swift/lib/swift/linux:/usr/lib/swift/linux:$libraries" \
    sh -ec 'cd "$1"; shift; exec env "$@"' sh "$here" "$@"
"#;

/// Where Swift is.
#[derive(Debug)]
pub enum Toolchain {
    /// In `PATH`.
    Installed,
    /// In this root folder.
    Root(PathBuf),
}

impl Toolchain {
    /// The Swift of this machine, made if need be.
    ///
    /// # Errors
    /// A reason when there is none and none can be made, with what would change that.
    pub fn find_or_make() -> Result<Self, String> {
        if has_swift() {
            return Ok(Self::Installed);
        }
        let root = root_folder().ok_or("Swift is missing, and neither HOME nor XDG_CACHE_HOME is set")?;
        if !is_root() || find_program("apt-get").is_none() || find_program("unshare").is_none() {
            return Err(
                "Swift 6 is missing: https://www.swift.org/install; as root on Debian it is fetched".into()
            );
        }
        // A container may forbid it.
        if !succeeds(Command::new("unshare").args(["--mount", "true"])) {
            return Err(
                "Swift 6 is missing, and this machine allows no mount namespace to run Debian's in".into()
            );
        }
        if !root.exists() {
            make(&root).map_err(|reason| format!("Swift 6 is missing and cannot be fetched: {reason}"))?;
        }
        Ok(Self::Root(root))
    }

    /// `arguments` (variables, a program, what it is given) in the folder `here` of the workspace; `libraries` is where
    /// it finds shared libraries.
    ///
    /// # Errors
    /// When the script that enters the root folder cannot be written.
    pub fn command(
        &self,
        workspace: &Workspace,
        here: &Path,
        libraries: &Path,
        arguments: &[&str],
    ) -> Result<Command, String> {
        match self {
            Self::Installed => {
                let mut command = workspace.command("env");
                command.args(arguments).current_dir(here).env("LD_LIBRARY_PATH", libraries);
                Ok(command)
            }
            Self::Root(root) => {
                let script = workspace.tools().join("enter-swift-root.sh");
                fs::create_dir_all(workspace.tools())
                    .and_then(|()| fs::write(&script, ENTER))
                    .map_err(|error| format!("{}: {error}", script.display()))?;
                let folders = format!("{}:{}", workspace.root.display(), workspace.target.display());
                let mut command = workspace.command("unshare");
                command.args(["--mount", "sh"]).arg(script).arg(root).arg(folders).arg(here).arg(libraries);
                command.args(arguments);
                Ok(command)
            }
        }
    }
}

/// Whether `swift` is in `PATH`, is Apple's language and new enough.
fn has_swift() -> bool {
    let version = output_of(Command::new("swift").arg("--version")).unwrap_or_default();
    let number =
        version.split_once("Swift version ").and_then(|(_, rest)| rest.split('.').next()?.parse().ok());
    number.is_some_and(|major: u32| major >= 6)
}

/// Whether the toolchain would have to be fetched with debootstrap.
pub fn needs_debootstrap() -> bool {
    cfg!(target_os = "linux") && !has_swift() && root_folder().is_some_and(|root| !root.exists())
}

fn root_folder() -> Option<PathBuf> {
    if let Some(root) = std::env::var_os(ROOT_VARIABLE) {
        return Some(root.into());
    }
    let cache = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let cache = cache.or_else(|| Some(Path::new(&std::env::var_os("HOME")?).join(".cache")))?;
    Some(cache.join("fieldwalk").join(format!("swift-{RELEASE}")))
}

fn is_root() -> bool {
    output_of(Command::new("id").arg("-u")).as_deref() == Some("0")
}

/// Unpacks Debian with Swift into `root`, which appears when it is whole.
fn make(root: &Path) -> Result<(), String> {
    if find_program("debootstrap").is_none() {
        return Err("debootstrap is missing: apt-get install debootstrap".into());
    }
    let partial = root.with_extension(format!("partial-{}", std::process::id()));
    let made = fill(&partial).and_then(|()| match fs::rename(&partial, root) {
        // Another run was faster.
        Err(_) if root.exists() => Ok(()),
        renamed => renamed.map_err(|error| format!("{}: {error}", root.display())),
    });
    let _ = fs::remove_dir_all(&partial);
    made
}

fn fill(folder: &Path) -> Result<(), String> {
    let options = folder.join("etc/dpkg/dpkg.cfg.d/fieldwalk");
    let parent = options.parent().unwrap_or(folder);
    fs::create_dir_all(parent)
        .and_then(|()| fs::write(&options, DPKG_OPTIONS))
        .map_err(|error| format!("{}: {error}", options.display()))?;
    let mut debootstrap = Command::new("debootstrap");
    debootstrap.args(["--variant=minbase", "--include=ca-certificates", RELEASE]).arg(folder).arg(mirror());
    execute(&mut debootstrap)?;
    let mut install = Command::new("chroot");
    install.arg(folder).args(["apt-get", "install", "-q", "-y", "--no-install-recommends"]).args(PACKAGES);
    execute(install.env("DEBIAN_FRONTEND", "noninteractive").env("LC_ALL", "C"))?;
    execute(Command::new("chroot").arg(folder).args(["apt-get", "clean"]))
}

/// Where this machine's own packages come from.
fn mirror() -> String {
    let mut targets = Command::new("apt-get");
    targets.args(["indextargets", "--format", "$(LABEL) $(REPO_URI)", "Created-By: Packages"]);
    let targets = output_of(&mut targets).unwrap_or_default();
    let own = targets.lines().find_map(|line| line.strip_prefix("Debian ")).map(str::trim);
    own.filter(|uri| uri.starts_with("http")).unwrap_or(MIRROR).to_owned()
}
