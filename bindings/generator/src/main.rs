//! Generates the foreign side of the bindings from the built library and from the batch's layout.
//!
//! `LIBRARY` is the unstripped shared library. What an app can call must be what the language's surface file lists.
#![forbid(unsafe_code)]

mod kotlin_batch;
mod kotlin_surface;
mod surface;
mod swift_batch;
mod swift_surface;
mod wording;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use camino::{Utf8Path, Utf8PathBuf};
use uniffi::TargetLanguage;

const USAGE: &str = "\
usage: fieldwalk-bindgen kotlin LIBRARY FOLDER SURFACE   sources go under FOLDER
       fieldwalk-bindgen swift LIBRARY PACKAGE SURFACE   sources and the C header go into the Swift package";

/// Where in the Swift package its own and the generated sources are.
const SWIFT_SOURCES: &str = "Sources/Fieldwalk";
const SWIFT_GENERATED: &str = "Sources/Fieldwalk/Generated";
const SWIFT_HEADER: &str = "Sources/FieldwalkFFI/FieldwalkFFI.h";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["kotlin", library, folder, surface] => kotlin(library, Utf8Path::new(folder), Path::new(surface)),
        ["swift", library, package, surface] => swift(library, Utf8Path::new(package), Path::new(surface)),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn kotlin(library: &str, folder: &Utf8Path, surface: &Path) -> Result<(), Box<dyn Error>> {
    generate(TargetLanguage::Kotlin, library, folder)?;
    let package = folder.join("org/fieldwalk");
    std::fs::write(package.join("SampleBatch.kt"), kotlin_batch::source())?;
    let sources = sources_under(&package)?;
    surface::compare(
        sources.iter().flat_map(|source| kotlin_surface::declarations(source)).collect(),
        surface,
    )
}

fn swift(library: &str, package: &Utf8Path, surface: &Path) -> Result<(), Box<dyn Error>> {
    let folder = package.join(SWIFT_GENERATED);
    generate(TargetLanguage::Swift, library, &folder)?;
    // The header is a module of its own.
    std::fs::rename(folder.join("FieldwalkFFI.h"), package.join(SWIFT_HEADER))?;
    std::fs::write(folder.join("SampleBatch.swift"), swift_batch::source())?;
    let sources = sources_under(&package.join(SWIFT_SOURCES))?;
    surface::compare(sources.iter().flat_map(|source| swift_surface::declarations(source)).collect(), surface)
}

/// Writes what UniFFI generates, into an emptied folder: a source that is no longer generated must not be compiled.
fn generate(language: TargetLanguage, library: &str, folder: &Utf8Path) -> Result<(), Box<dyn Error>> {
    if folder.exists() {
        std::fs::remove_dir_all(folder)?;
    }
    uniffi::generate(uniffi::GenerateOptions {
        languages: vec![language],
        source: library.into(),
        out_dir: folder.to_owned(),
        ..uniffi::GenerateOptions::default()
    })?;
    Ok(())
}

/// The texts of all Kotlin or Swift sources under `folder`.
fn sources_under(folder: &Utf8Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut folders: Vec<Utf8PathBuf> = vec![folder.to_owned()];
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir_utf8()? {
            let path = entry?.into_path();
            if path.is_dir() {
                folders.push(path);
            } else if matches!(path.extension(), Some("kt" | "swift")) {
                sources.push(std::fs::read_to_string(path)?);
            }
        }
    }
    Ok(sources)
}
