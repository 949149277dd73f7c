//! The library for other languages, the sources generated from it, and the walk that all of them are tested with.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};

use crate::process::{output_of, run as execute};
use crate::report::Outcome;
use crate::workspace::Workspace;

/// A language for which sources are generated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Language {
    name: &'static str,
    /// Its public declarations, no more and no less.
    surface: &'static str,
    /// Where in the repository its sources are made, ignored by git; otherwise they are made in the build folder.
    package: Option<&'static str>,
}

pub const KOTLIN: Language =
    Language { name: "kotlin", surface: "bindings/kotlin/surface.txt", package: None };
pub const PYTHON: Language =
    Language { name: "python", surface: "bindings/python/surface.txt", package: None };
/// A Swift package compiles nothing that lies outside of it.
pub const SWIFT: Language =
    Language { name: "swift", surface: "ios/surface.txt", package: Some("ios/Sources/Fieldwalk/Generated") };

pub fn run(workspace: &Workspace) -> Outcome {
    let tested =
        execute(&mut workspace.cargo("test --quiet --profile generator --package fieldwalk-bindgen"));
    if let Err(reason) = tested {
        return Err(reason).into();
    }
    let mut failures = Vec::new();
    for language in [KOTLIN, SWIFT, PYTHON] {
        match generate(workspace, language) {
            Ok(sources) => eprintln!("{}: {}", language.name, sources.display()),
            Err(reason) => failures.push(reason),
        }
    }
    eprintln!("library: {}", library(workspace).display());
    Outcome::new(failures, Vec::new())
}

/// Where everything that belongs to bindings is made.
pub fn folder(workspace: &Workspace) -> PathBuf {
    workspace.target.join("bindings")
}

/// The built library: unstripped, since it describes itself in its symbols.
pub fn library(workspace: &Workspace) -> PathBuf {
    workspace.target.join("debug").join(library_name())
}

/// The library's file.
pub fn library_name() -> String {
    format!("{DLL_PREFIX}fieldwalk_ffi{DLL_SUFFIX}")
}

/// Builds the library, generates from it, and gives the folder of the sources.
///
/// # Errors
/// When something does not build, or when the public surface has changed.
pub fn generate(workspace: &Workspace, language: Language) -> Result<PathBuf, String> {
    execute(&mut workspace.cargo("build --quiet --package fieldwalk-ffi --lib --features jni"))?;
    let Language { name, surface, package } = language;
    let sources =
        package.map_or_else(|| folder(workspace).join(name), |package| workspace.root.join(package));
    let mut generator = workspace.cargo("run --quiet --profile generator --package fieldwalk-bindgen --");
    generator.arg(name).arg(library(workspace)).arg(&sources).arg(surface);
    execute(&mut generator)?;
    Ok(sources)
}

/// Makes a simulated walk with the digest of its fixes, which the engine computes now, in Rust, by `fieldwalk replay`; gives
/// its folder.
///
/// # Errors
/// When something does not build, run, or get written.
pub fn walk(workspace: &Workspace, language: Language) -> Result<PathBuf, String> {
    let walk = folder(workspace).join("walk");
    // What an earlier run has left says nothing of this one.
    let _ = fs::remove_file(digest_file(&walk, language));
    execute(
        workspace.cargo("run --quiet --package fieldwalk-tests --example walk_for_bindings --").arg(&walk),
    )?;
    let mut replay = workspace.cargo("run --quiet --package fieldwalk-cli -- replay --bits");
    let bits = output_of(replay.arg(walk.join("map")).arg(walk.join("walk.txt")))
        .ok_or("`fieldwalk replay --bits` failed on the simulated walk")?;
    fs::write(walk.join("walk.bits"), bits).map_err(|error| format!("{}: {error}", walk.display()))?;
    Ok(walk)
}

/// Compares the digest of fixes that the tests of `language` have left in the folder of the walk with the engine's, and
/// says it.
///
/// # Errors
/// When they differ, or either is missing.
pub fn compared_bits(walk: &Path, language: Language) -> Result<String, String> {
    let read = |file: PathBuf| {
        let text = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        match text.trim().split_once(' ') {
            Some((digest, rest)) if digest.len() == 64 => Ok((digest.to_owned(), rest.trim().to_owned())),
            _ => Err(format!("{}: no digest", file.display())),
        }
    };
    let (expected, _) = read(walk.join("walk.bits"))?;
    let (found, n_fixes) = read(digest_file(walk, language))?;
    if found == expected {
        Ok(format!("{n_fixes} fixes of one walk, the same bits as in Rust: {found}"))
    } else {
        Err(format!("{n_fixes} fixes of one walk with other bits than in Rust: {found}, not {expected}"))
    }
}

/// Where the tests of `language` leave the digest of the fixes that they saw.
fn digest_file(walk: &Path, language: Language) -> PathBuf {
    walk.join(format!("{}.bits", language.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_digest_is_compared_with_that_of_the_engine() {
        let walk = std::env::temp_dir().join(format!("fieldwalk-bits-{}", std::process::id()));
        fs::create_dir_all(&walk).unwrap();
        let write = |name: &str, digit: &str| fs::write(walk.join(name), digit.repeat(64) + " 91\n").unwrap();
        assert!(compared_bits(&walk, PYTHON).is_err(), "nothing there");
        write("walk.bits", "a");
        assert!(compared_bits(&walk, PYTHON).unwrap_err().contains("python.bits"));
        write("python.bits", "a");
        let same = compared_bits(&walk, PYTHON).unwrap();
        assert!(same.starts_with("91 fixes") && same.ends_with(&"a".repeat(64)), "{same}");
        write("python.bits", "b");
        assert!(compared_bits(&walk, PYTHON).unwrap_err().contains("other bits"));
        fs::remove_dir_all(&walk).unwrap();
    }
}
