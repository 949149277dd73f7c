//! Installs what the other stages need: on Debian from its packages, elsewhere what rustup and cargo can.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::aarch64::{self, TARGET};
use crate::android;
use crate::process::{find_program, run as execute, succeeds};
use crate::report::Outcome;
use crate::swift_toolchain;
use crate::workspace::Workspace;
use crate::{kotlin, python};

const CARGO_DENY_VERSION: &str = "0.20.2";
pub const CARGO_DENY_REMEDY: &str = "cargo install --locked cargo-deny";

/// Something that a stage calls and that Debian packages.
struct Tool {
    name: &'static str,
    purpose: &'static str,
    is_present: fn() -> bool,
    packages: &'static [&'static str],
}

const TOOLS: &[Tool] = &[
    Tool {
        name: "a C++ compiler",
        purpose: "libFuzzer, stage fuzz",
        is_present: || find_program("c++").is_some(),
        packages: &["g++"],
    },
    Tool {
        name: "qemu-aarch64",
        purpose: "stage aarch64",
        is_present: || aarch64::find_qemu().is_some(),
        packages: &["qemu-user"],
    },
    Tool {
        name: "a linker and C library for arm64",
        purpose: "stage aarch64",
        is_present: || find_program(aarch64::LINKER).is_some() && Path::new(aarch64::SYSROOT).exists(),
        packages: &["gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross"],
    },
    Tool {
        name: "tar and xz",
        purpose: "unpacking recordings, stage test",
        is_present: || find_program("tar").is_some() && find_program("xz").is_some(),
        packages: &["tar", "xz-utils"],
    },
    Tool {
        name: "chromium",
        purpose: "the report in a browser, stage test",
        is_present: || find_program("chromium").is_some(),
        packages: &["chromium"],
    },
    Tool {
        name: "a JDK",
        purpose: "stages kotlin and android",
        is_present: kotlin::has_jdk,
        packages: &["default-jdk-headless"],
    },
    Tool {
        name: "Maven",
        purpose: "stages kotlin and android",
        is_present: || find_program("mvn").is_some(),
        packages: &["maven"],
    },
    Tool {
        name: "an NDK, or LLVM and Rust's sources",
        purpose: "the engine for phones, stage android",
        is_present: || android::Toolchain::find().is_some(),
        packages: &["clang-22", "lld-22", "llvm-22", "rustc-web", "cargo-web", "rust-web-src"],
    },
    Tool {
        name: "debootstrap",
        purpose: "Debian's Swift, stage swift",
        is_present: || find_program("debootstrap").is_some() || !swift_toolchain::needs_debootstrap(),
        packages: &["debootstrap"],
    },
    Tool {
        name: "python3 with venv",
        purpose: "stage python",
        is_present: || python::find_python().is_some(),
        packages: &["python3", "python3-venv"],
    },
];

pub fn run(workspace: &Workspace) -> Outcome {
    let mut skipped = Vec::new();
    install_packages(&mut skipped);
    install_rust_parts(workspace, &mut skipped);
    if find_cargo_deny(workspace).is_none()
        && let Err(reason) = install_cargo_deny(workspace)
    {
        skipped.push(format!("{reason}; by hand: {CARGO_DENY_REMEDY}"));
    }
    Outcome::new(Vec::new(), skipped)
}

/// The cargo-deny that the checks installed, or the user's own.
pub fn find_cargo_deny(workspace: &Workspace) -> Option<PathBuf> {
    let own = workspace.tools().join("bin").join(format!("cargo-deny{}", std::env::consts::EXE_SUFFIX));
    if own.is_file() { Some(own) } else { find_program("cargo-deny") }
}

fn install_packages(skipped: &mut Vec<String>) {
    let missing = || TOOLS.iter().filter(|tool| !(tool.is_present)());
    let packages: Vec<&str> = missing().flat_map(|tool| tool.packages).copied().collect();
    if !packages.is_empty() && find_program("apt-get").is_some() {
        let install = [&["install", "-y", "--no-install-recommends"], packages.as_slice()].concat();
        // A fresh container has no package lists; a desk machine has, and is spared the wait.
        if apt_get(&install).is_err() && apt_get(&["update"]).is_ok() {
            let _ = apt_get(&install); // what is still missing is listed below
        }
    }
    skipped.extend(missing().map(|tool| {
        let packages = tool.packages.join(" ");
        format!("{} ({}); on Debian: apt-get install {packages}", tool.name, tool.purpose)
    }));
}

fn apt_get(arguments: &[&str]) -> Result<(), String> {
    let is_root = || crate::process::output_of(Command::new("id").arg("-u")).as_deref() == Some("0");
    let mut command = if is_root() {
        Command::new("apt-get")
    } else if succeeds(Command::new("sudo").args(["-n", "true"])) {
        let mut sudo = Command::new("sudo");
        sudo.args(["-n", "apt-get"]);
        sudo
    } else {
        return Err("apt-get needs root".into());
    };
    execute(
        command
            .args(["-q", "-o", "Dpkg::Use-Pty=0"])
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive"),
    )
}

fn install_rust_parts(workspace: &Workspace, skipped: &mut Vec<String>) {
    let parts: [(&str, [&str; 3], bool); 3] = [
        ("rustfmt", ["component", "add", "rustfmt"], succeeds(&mut workspace.cargo("fmt --version"))),
        ("clippy", ["component", "add", "clippy"], succeeds(&mut workspace.cargo("clippy --version"))),
        ("Rust for arm64", ["target", "add", TARGET], aarch64::has_rust_target()),
    ];
    for (name, arguments, is_present) in parts {
        if !is_present && execute(Command::new("rustup").args(arguments)).is_err() {
            skipped.push(format!("{name}; by hand: rustup {}", arguments.join(" ")));
        }
    }
}

/// Unoptimised: cargo-deny then builds in a third of the time, and checks our tree in about a second all the same.
fn install_cargo_deny(workspace: &Workspace) -> Result<(), String> {
    let mut install = workspace.cargo("install --locked --quiet cargo-deny --version");
    install
        .arg(CARGO_DENY_VERSION)
        .arg("--root")
        .arg(workspace.tools())
        .env_remove("CARGO_TARGET_DIR") // a temporary folder, removed at the end
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0")
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "256");
    execute(&mut install)
}
