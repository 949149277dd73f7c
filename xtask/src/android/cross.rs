//! The engine built for phones: with the NDK through cargo-ndk where both are, else with clang, Rust's sources and
//! stand-ins for the libraries that a phone has.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::abi::{API, Abi, IMPORTS};
use crate::process::{find_program, output_of, run as execute, succeeds};
use crate::workspace::Workspace;

pub const REMEDY: &str = "with an NDK: cargo install cargo-ndk, and set ANDROID_NDK_HOME; on Debian: \
                          apt-get install clang-22 lld-22 llvm-22 rustc-web cargo-web rust-web-src";
/// The library's file, and the name that it has for the loader.
pub const LIBRARY: &str = "libfieldwalk_ffi.so";
const PACKAGE: [&str; 9] = [
    "--package",
    "fieldwalk-ffi",
    "--lib",
    "--features",
    "jni",
    "--profile",
    "phone",
    "--crate-type",
    "cdylib",
];
/// Debian's compiler for targets that rustup is not there to fetch.
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";

/// What there is to build with.
#[derive(Debug)]
pub enum Toolchain {
    Ndk,
    Clang(Clang),
}

/// Tools of LLVM, and a Rust that has its own sources.
#[derive(Debug)]
pub struct Clang {
    clang: &'static str,
    llvm_ifs: &'static str,
    llvm_ar: &'static str,
    llvm_strip: &'static str,
    /// With the sources of std beside it.
    rustc: PathBuf,
    cargo: PathBuf,
}

impl Toolchain {
    /// What is installed; `None` when neither way is open.
    pub fn find() -> Option<Self> {
        if std::env::var_os("ANDROID_NDK_HOME").is_some() && find_program("cargo-ndk").is_some() {
            return Some(Self::Ndk);
        }
        let first = |names: [&'static str; 2]| names.into_iter().find(|name| find_program(name).is_some());
        first(["ld.lld-22", "ld.lld"])?;
        let (rustc, cargo) = find_rust_with_sources()?;
        Some(Self::Clang(Clang {
            clang: first(["clang-22", "clang"])?,
            llvm_ifs: first(["llvm-ifs-22", "llvm-ifs"])?,
            llvm_ar: first(["llvm-ar-22", "llvm-ar"])?,
            llvm_strip: first(["llvm-strip-22", "llvm-strip"])?,
            rustc,
            cargo,
        }))
    }

    /// Builds the library for `abi` and gives the stripped file, in `folder`, under the ABI's name.
    ///
    /// # Errors
    /// When it does not build, or calls what Android does not have.
    pub fn build(&self, workspace: &Workspace, abi: &Abi, folder: &Path) -> Result<PathBuf, String> {
        let out = folder.join("jni").join(abi.name);
        fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
        let stripped = out.join(LIBRARY);
        let unstripped = workspace.target.join(abi.rust_target).join("phone").join(LIBRARY);
        match self {
            Self::Ndk => {
                let mut build = workspace.cargo("ndk --platform");
                build.arg(API.to_string()).args(["--target", abi.name, "rustc"]).args(PACKAGE);
                // The linker strips: the NDK's own tool for it lies where its host's name says.
                build.env("CARGO_PROFILE_PHONE_STRIP", "symbols");
                build.env("RUSTFLAGS", format!("-Clink-arg=-Wl,-soname,{LIBRARY} {ALIGNED}"));
                execute(&mut build)?;
                fs::copy(&unstripped, &stripped)
                    .map_err(|error| format!("{}: {error}", unstripped.display()))?;
            }
            Self::Clang(clang) => {
                clang.build(workspace, abi, &folder.join("stubs").join(abi.name))?;
                let mut strip = workspace.command(clang.llvm_strip);
                execute(strip.arg("--strip-all").arg("-o").arg(&stripped).arg(&unstripped))?;
            }
        }
        Ok(stripped)
    }
}

/// Pages of 16 KB.
const ALIGNED: &str = "-Clink-arg=-Wl,-z,max-page-size=16384";

/// What a backtrace asks for where there is no unwinder: it is at its end (5), and no register can be read (1).
const NO_UNWINDER: &str = "\
int _Unwind_Backtrace(void *trace, void *argument) { (void)trace; (void)argument; return 5; }
int _Unwind_VRS_Get(void *context, int kind, unsigned number, int representation, void *value) {
    (void)context; (void)kind; (void)number; (void)representation; (void)value;
    return 1;
}
";

impl Clang {
    fn build(&self, workspace: &Workspace, abi: &Abi, stubs: &Path) -> Result<(), String> {
        self.write_stubs(workspace, abi, stubs)?;
        let mut build = workspace.command(&self.cargo);
        let panic = if abi.unwinds { "panic_unwind" } else { "panic_abort" };
        build
            .arg("rustc")
            .env("RUSTC", &self.rustc)
            .args(PACKAGE)
            .args(["--quiet", "--target", abi.rust_target])
            .arg(format!("-Zbuild-std=std,{panic}"))
            // Without names of functions in backtraces, which a stripped library has not anyway.
            .arg("-Zbuild-std-features=panic-unwind,optimize_for_size")
            .env("RUSTC_BOOTSTRAP", "1");
        if abi.unwinds {
            build.args(["--features", "unwinder"]);
        } else {
            build.env("CARGO_PROFILE_PHONE_PANIC", "abort");
        }
        let target = abi.rust_target.to_uppercase().replace('-', "_");
        build
            .env(format!("CARGO_TARGET_{target}_LINKER"), self.clang)
            .env(format!("CARGO_TARGET_{target}_RUSTFLAGS"), self.flags(abi, stubs));
        execute(&mut build)
    }

    fn flags(&self, abi: &Abi, stubs: &Path) -> String {
        let linker = [
            format!("--target={}", abi.clang_target),
            "-fuse-ld=lld".into(),
            "-nostartfiles".into(),
            format!("-L{}", stubs.display()),
            format!("-Wl,-soname,{LIBRARY}"),
            "-Wl,-z,defs".into(),
            // Equal functions once, and relocations packed as Android reads them since 6.
            "-Wl,--icf=all".into(),
            "-Wl,--pack-dyn-relocs=android".into(),
        ];
        let linker = linker.map(|argument| format!("-Clink-arg={argument}"));
        format!("{} {ALIGNED}", linker.join(" "))
    }

    /// Libraries with names and no code: what the linker needs to know of a phone's.
    fn write_stubs(&self, workspace: &Workspace, abi: &Abi, folder: &Path) -> Result<(), String> {
        let failed = |error| format!("{}: {error}", folder.display());
        fs::create_dir_all(folder).map_err(failed)?;
        let none = ("log", "");
        for (library, symbols) in IMPORTS.into_iter().chain([none]) {
            let text = folder.join(format!("lib{library}.ifs"));
            fs::write(&text, stub(library, symbols, abi)).map_err(failed)?;
            let stub = folder.join(format!("lib{library}.so"));
            let mut make = workspace.command(self.llvm_ifs);
            make.args(["--input-format=IFS", "--write-if-changed"]);
            execute(make.arg(format!("--output-elf={}", stub.display())).arg(text))?;
        }
        // Rust asks for it by name. On 64 bit what it should hold comes from the feature `unwinder`.
        let mut archive = workspace.command(self.llvm_ar);
        archive.arg("rc").arg(folder.join("libunwind.a"));
        if !abi.unwinds {
            let (source, object) = (folder.join("unwind.c"), folder.join("unwind.o"));
            fs::write(&source, NO_UNWINDER).map_err(failed)?;
            let mut compile = workspace.command(self.clang);
            compile.arg(format!("--target={}", abi.clang_target)).args(["-Os", "-fPIC", "-c"]);
            execute(compile.arg(source).arg("-o").arg(&object))?;
            archive.arg(object);
        }
        execute(&mut archive)
    }
}

fn stub(library: &str, symbols: &str, abi: &Abi) -> String {
    let Abi { stub_arch, bits, .. } = abi;
    let mut symbols: String =
        symbols.split_whitespace().map(|name| format!("  - {{ Name: {name}, Type: Func }}\n")).collect();
    if symbols.is_empty() {
        symbols = "  []\n".into();
    }
    format!(
        "--- !ifs-v1\nIfsVersion: 3.0\nSoName: lib{library}.so\n\
         Target: {{ ObjectFormat: ELF, Arch: {stub_arch}, Endianness: little, BitWidth: {bits} }}\n\
         Symbols:\n{symbols}...\n"
    )
}

/// A rustc that has the sources of std, and its cargo: the one in use, or Debian's.
fn find_rust_with_sources() -> Option<(PathBuf, PathBuf)> {
    let in_use = (PathBuf::from("rustc"), std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()).into());
    [in_use, (DEBIAN_RUSTC.into(), DEBIAN_CARGO.into())].into_iter().find(|(rustc, cargo)| {
        output_of(Command::new(rustc).args(["--print", "sysroot"]))
            .is_some_and(|root| Path::new(&root).join("lib/rustlib/src/rust/library/Cargo.lock").exists())
            && succeeds(Command::new(cargo).arg("--version"))
    })
}
