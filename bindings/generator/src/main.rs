//! Generates the foreign side of the bindings from the built library and from the batch's layout.
//!
//! `fieldwalk-bindgen LANGUAGE LIBRARY FOLDER SURFACE`: `LANGUAGE` is `kotlin`, `python` or `swift`, `LIBRARY` the
//! unstripped shared library; generated sources go under `FOLDER`, and the public declarations found there must be those
//! of the file `SURFACE`, those of our own sources beside that file included.
#![forbid(unsafe_code)]

mod kotlin_batch;
mod kotlin_surface;
mod python_batch;
mod python_surface;
mod surface;
mod swift_batch;
mod swift_surface;
mod wording;

use std::error::Error;
use std::process::ExitCode;

use camino::{Utf8Path, Utf8PathBuf};
use uniffi::TargetLanguage;

/// What differs from language to language.
struct Language {
    name: &'static str,
    target: TargetLanguage,
    /// The folder in which sources stand.
    package: &'static str,
    /// The encoder's file and source.
    encoder: (&'static str, fn() -> String),
    declarations: fn(&str) -> Vec<String>,
    /// Where the sources begin that apps see together, from the folder of the generated ones.
    seen_with: &'static str,
    /// The folder of our own sources, from that of the list of declarations, unless they are seen with the generated ones.
    own_sources: Option<&'static str>,
    /// A file that belongs elsewhere: what it is called, and where it belongs, from the folder.
    moved: Option<(&'static str, &'static str)>,
}

const LANGUAGES: &[Language] = &[
    Language {
        name: "kotlin",
        target: TargetLanguage::Kotlin,
        package: "org/fieldwalk",
        encoder: ("SampleBatch.kt", kotlin_batch::source),
        declarations: kotlin_surface::declarations,
        seen_with: "",
        own_sources: Some("src/main/kotlin"),
        moved: None,
    },
    Language {
        name: "python",
        target: TargetLanguage::Python,
        package: "",
        encoder: ("sample_batch.py", python_batch::source),
        declarations: python_surface::declarations,
        seen_with: "",
        own_sources: Some("fieldwalk"),
        moved: None,
    },
    Language {
        name: "swift",
        target: TargetLanguage::Swift,
        package: "",
        encoder: ("SampleBatch.swift", swift_batch::source),
        declarations: swift_surface::declarations,
        seen_with: "..",
        own_sources: None,
        // The header is a module of its own.
        moved: Some(("FieldwalkFFI.h", "../../FieldwalkFFI/FieldwalkFFI.h")),
    },
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [language, library, folder, surface] = arguments.as_slice() else {
        eprintln!("usage: fieldwalk-bindgen LANGUAGE LIBRARY FOLDER SURFACE");
        return ExitCode::from(2);
    };
    let Some(language) = LANGUAGES.iter().find(|known| known.name == language) else {
        eprintln!("error: no bindings for the language `{language}`");
        return ExitCode::from(2);
    };
    let surface = Utf8Path::new(surface);
    let declarations = generate(language, library, folder, surface);
    match declarations.and_then(|declarations| surface::compare(declarations, surface.as_std_path())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the sources anew and gives their public declarations.
fn generate(
    language: &Language,
    library: &str,
    folder: &str,
    surface: &Utf8Path,
) -> Result<Vec<String>, Box<dyn Error>> {
    let folder = Utf8PathBuf::from(folder);
    // A source that is no longer generated must not be compiled.
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    uniffi::generate(uniffi::GenerateOptions {
        languages: vec![language.target.clone()],
        source: library.into(),
        out_dir: folder.clone(),
        ..uniffi::GenerateOptions::default()
    })?;
    let package = folder.join(Utf8Path::new(language.package));
    let (file, encoder) = language.encoder;
    std::fs::write(package.join(file), encoder())?;
    if let Some((file, place)) = language.moved {
        std::fs::rename(folder.join(file), folder.join(place))?;
    }
    let ending = Utf8Path::new(file).extension();
    let mut declarations = Vec::new();
    let own = language.own_sources.map(|own| surface.with_file_name(own));
    let mut folders: Vec<_> = own.into_iter().chain([folder.join(language.seen_with)]).collect();
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir_utf8()? {
            let path = entry?.into_path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension() == ending {
                declarations.extend((language.declarations)(&std::fs::read_to_string(path)?));
            }
        }
    }
    Ok(declarations)
}
