//! The library for other languages and the sources generated from it.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

use crate::process::run as execute;
use crate::report::Outcome;
use crate::workspace::Workspace;

/// The public declarations that the generated Kotlin must have, no more and no less.
const KOTLIN_SURFACE: &str = "bindings/kotlin/surface.txt";

/// The same of the Swift package, the generated and its own.
const SWIFT_SURFACE: &str = "ios/surface.txt";
/// The Swift package; what is generated goes into it, and git ignores it there.
pub const SWIFT_PACKAGE: &str = "ios";

/// Generated Kotlin and the library that all languages call.
#[derive(Debug)]
pub struct Generated {
    pub kotlin: PathBuf,
    pub library: PathBuf,
}

pub fn run(workspace: &Workspace) -> Outcome {
    let tested =
        execute(&mut workspace.cargo("test --quiet --profile generator --package fieldwalk-bindgen"));
    let generated = tested.and_then(|()| generate(workspace));
    if let Ok(Generated { kotlin, library }) = &generated {
        let swift = workspace.root.join(SWIFT_PACKAGE);
        eprintln!("Kotlin: {}\nSwift: {}\nlibrary: {}", kotlin.display(), swift.display(), library.display());
    }
    generated.map(|_| ()).into()
}

/// Where everything that belongs to bindings is made.
pub fn folder(workspace: &Workspace) -> PathBuf {
    workspace.target.join("bindings")
}

/// Builds the library, unstripped since it describes itself in its symbols, and generates from it.
///
/// # Errors
/// When something does not build, or when the public surface has changed.
pub fn generate(workspace: &Workspace) -> Result<Generated, String> {
    execute(&mut workspace.cargo("build --quiet --package fieldwalk-ffi --lib"))?;
    let library = workspace.target.join("debug").join(format!("{DLL_PREFIX}fieldwalk_ffi{DLL_SUFFIX}"));
    let kotlin = folder(workspace).join("kotlin");
    let generator = || workspace.cargo("run --quiet --profile generator --package fieldwalk-bindgen --");
    execute(generator().arg("kotlin").arg(&library).arg(&kotlin).arg(KOTLIN_SURFACE))?;
    execute(generator().arg("swift").arg(&library).arg(SWIFT_PACKAGE).arg(SWIFT_SURFACE))?;
    Ok(Generated { kotlin, library })
}
