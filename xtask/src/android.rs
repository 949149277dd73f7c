//! The library for Android: the engine cross-built and examined; the Kotlin side compiled and tested on the JVM against
//! Robolectric's Android, and all of it put together as an AAR.

mod abi;
mod cross;
mod maven;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::arguments::Arguments;
use crate::elf::SharedLibrary;
use crate::report::Outcome;
use crate::workspace::Workspace;
use abi::{ABIS, Abi};
pub use cross::Toolchain;
use cross::{LIBRARY, REMEDY};

/// Pages of the newest phones.
const PAGE_BYTES: u64 = 0x4000;
/// What an app pays for on nearly every phone, at most.
const MAX_ARM64_BYTES: u64 = 1_500_000;
/// What exported names begin with: functions that Kotlin calls, and descriptions of them.
const EXPORTS: [&str; 4] =
    ["uniffi_fieldwalk_ffi_", "ffi_fieldwalk_ffi_", "UNIFFI_META_", "Java_org_fieldwalk_"];
/// The function that the sensors' loop calls; without it Kotlin takes the way that makes garbage.
const SENSOR_LOOP: &str = "Java_org_fieldwalk_SensorLoop_pushOverJni";
/// And the unwinder's own, which the crate exports; a library finds its own before those of others.
const UNWINDER: &str = "_Unwind_";

pub fn run(workspace: &Workspace, arguments: &Arguments) -> Outcome {
    let folder = workspace.target.join("android");
    let mut skipped = Vec::new();
    match Toolchain::find() {
        None => skipped.push(format!("the engine for phones is not built: {REMEDY}")),
        Some(toolchain) => {
            let built: Result<Vec<Built>, String> =
                ABIS.iter().map(|abi| build(workspace, &toolchain, abi, &folder)).collect();
            match built {
                Ok(built) if arguments.json => built.iter().for_each(|one| println!("{}", one.json())),
                Ok(built) => eprint!("{}", table(&built)),
                Err(reason) => return Err(reason).into(),
            }
        }
    }
    // Who asks for figures gets figures.
    if arguments.json {
        return Outcome::new(Vec::new(), skipped);
    }
    let mut outcome = maven::run(workspace, &folder);
    outcome.skipped.append(&mut skipped);
    outcome
}

/// A library that passed.
struct Built {
    abi: &'static str,
    bytes: u64,
    library: SharedLibrary,
}

impl Built {
    fn json(&self) -> String {
        let needed: Vec<String> = self.library.needed.iter().map(|name| format!("\"{name}\"")).collect();
        format!(
            "{{\"abi\": \"{}\", \"bytes_stripped\": {}, \"load_align\": {}, \"needed\": [{}], \"soname\": \"{}\"}}",
            self.abi,
            self.bytes,
            self.library.load_align,
            needed.join(", "),
            self.library.soname.as_deref().unwrap_or_default(),
        )
    }
}

fn build(
    workspace: &Workspace,
    toolchain: &Toolchain,
    abi: &'static Abi,
    folder: &Path,
) -> Result<Built, String> {
    let file: PathBuf = toolchain.build(workspace, abi, folder)?;
    let bytes = fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let library = SharedLibrary::read(&bytes).map_err(|reason| format!("{}: {reason}", file.display()))?;
    let faults = faults(abi, bytes.len() as u64, &library);
    if !faults.is_empty() {
        return Err(format!("{}: {}", abi.name, faults.join("; ")));
    }
    Ok(Built { abi: abi.name, bytes: bytes.len() as u64, library })
}

/// Why a phone would refuse the library, or an app not want it.
fn faults(abi: &Abi, bytes: u64, library: &SharedLibrary) -> Vec<String> {
    let mut faults = Vec::new();
    if library.load_align < PAGE_BYTES {
        faults.push(format!("segments are aligned to {:#x}, phones have pages of 16 KB", library.load_align));
    }
    if library.soname.as_deref() != Some(LIBRARY) {
        faults.push(format!("its SONAME is {:?}", library.soname));
    }
    let foreign: Vec<&String> = library.needed.iter().filter(|name| !is_of_android(name)).collect();
    if !foreign.is_empty() {
        faults.push(format!("it needs {foreign:?}"));
    }
    if library.has_text_relocations {
        faults.push("it has text relocations".into());
    }
    let is_ours = |name: &String| EXPORTS.iter().any(|head| name.starts_with(head));
    if let Some(other) = library.exports.iter().find(|name| !is_ours(name) && !name.starts_with(UNWINDER)) {
        faults.push(format!("it exports {other}"));
    }
    if !library.exports.iter().any(is_ours) {
        faults.push("it exports nothing that Kotlin calls".into());
    }
    if !library.exports.iter().any(|name| name == SENSOR_LOOP) {
        faults.push(format!("it does not export {SENSOR_LOOP}"));
    }
    if abi.name == "arm64-v8a" && bytes > MAX_ARM64_BYTES {
        faults.push(format!("{bytes} bytes are more than {MAX_ARM64_BYTES}"));
    }
    faults
}

fn is_of_android(name: &str) -> bool {
    ["libc.so", "libdl.so", "libm.so", "liblog.so"].contains(&name)
}

fn table(built: &[Built]) -> String {
    let mut table = String::from("\nABI           stripped bytes  alignment  needs\n");
    for Built { abi, bytes, library } in built {
        let _ = writeln!(
            table,
            "{abi:<13} {bytes:>14}  {:#9x}  {}",
            library.load_align,
            library.needed.join(" ")
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library() -> SharedLibrary {
        SharedLibrary {
            load_align: PAGE_BYTES,
            soname: Some(LIBRARY.into()),
            needed: vec!["libc.so".into()],
            has_text_relocations: false,
            exports: vec!["uniffi_fieldwalk_ffi_fn_func_version".into(), SENSOR_LOOP.into()],
            imports: Vec::new(),
        }
    }

    #[test]
    fn a_library_that_phones_load_has_no_fault() {
        assert_eq!(faults(&ABIS[0], MAX_ARM64_BYTES, &library()), [""; 0]);
    }

    #[test]
    fn every_fault_is_named() {
        let bad = SharedLibrary {
            load_align: 0x1000,
            soname: None,
            needed: vec!["libgcc_s.so.1".into()],
            has_text_relocations: true,
            exports: vec!["rust_eh_personality".into()],
            imports: Vec::new(),
        };
        let faults = faults(&ABIS[0], MAX_ARM64_BYTES + 1, &bad).join("\n");
        for word in [
            "0x1000",
            "SONAME",
            "libgcc_s",
            "text relocations",
            "personality",
            "Kotlin",
            "pushOverJni",
            "1500001",
        ] {
            assert!(faults.contains(word), "{word}: {faults}");
        }
    }

    #[test]
    fn figures_are_json() {
        let built = Built { abi: "x86_64", bytes: 7, library: library() };
        let expected = "{\"abi\": \"x86_64\", \"bytes_stripped\": 7, \"load_align\": 16384, \
                        \"needed\": [\"libc.so\"], \"soname\": \"libfieldwalk_ffi.so\"}";
        assert_eq!(built.json(), expected);
    }
}
