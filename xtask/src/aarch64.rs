//! The same bits on arm64: the golden digests and the codec's tests, built for arm64 and run under qemu.

use std::path::Path;
use std::process::Command;

use crate::process::{find_program, output_of, run as execute};
use crate::report::Outcome;
use crate::workspace::Workspace;

pub const TARGET: &str = "aarch64-unknown-linux-gnu";
pub const LINKER: &str = "aarch64-linux-gnu-gcc";
/// Where Debian puts arm64's C library.
pub const SYSROOT: &str = "/usr/aarch64-linux-gnu";

/// Each passes on arm64 only if its bits equal those committed, which the stage `test` compares on this machine.
const TESTS: [&str; 3] = [
    "test --package fieldwalk-tests --test same_bits",
    "test --package fieldwalk-codec --lib --tests",
    "test --package fieldwalk-card --tests",
];

pub fn run(workspace: &Workspace) -> Outcome {
    if cfg!(all(target_arch = "aarch64", target_os = "linux")) {
        return Outcome::skipped("this machine is arm64: stage test has run the same tests");
    }
    let Some(qemu) = find_qemu() else {
        return Outcome::skipped("qemu-aarch64 is missing: apt-get install qemu-user");
    };
    if find_program(LINKER).is_none() || !Path::new(SYSROOT).exists() {
        let packages = "gcc-aarch64-linux-gnu libc6-dev-arm64-cross";
        return Outcome::skipped(format!("{LINKER} or {SYSROOT} is missing: apt-get install {packages}"));
    }
    if !has_rust_target() {
        return Outcome::skipped(format!("Rust for arm64 is missing: rustup target add {TARGET}"));
    }
    let failures = TESTS.iter().filter_map(|test| {
        let mut test = workspace.cargo(test);
        test.args(["--target", TARGET])
            .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", LINKER)
            .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER", format!("{qemu} -L {SYSROOT}"));
        execute(&mut test).err()
    });
    Outcome::new(failures.collect(), Vec::new())
}

pub fn find_qemu() -> Option<&'static str> {
    ["qemu-aarch64", "qemu-aarch64-static"].into_iter().find(|name| find_program(name).is_some())
}

pub fn has_rust_target() -> bool {
    output_of(Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]))
        .is_some_and(|folder| Path::new(&folder).exists())
}
