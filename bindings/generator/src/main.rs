//! Generates the foreign side of the bindings from the built library and from the batch's layout.
//!
//! `fieldwalk-bindgen LANGUAGE LIBRARY FOLDER SURFACE`: `LANGUAGE` is `kotlin` or `python`, `LIBRARY` the unstripped
//! shared library; generated sources go under `FOLDER`, and the public declarations found there must be those of the
//! file `SURFACE`.
#![forbid(unsafe_code)]

mod kotlin_batch;
mod kotlin_surface;
mod python_batch;
mod python_surface;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use camino::{Utf8Path, Utf8PathBuf};
use uniffi::TargetLanguage;

const UPDATE: &str = "FIELDWALK_UPDATE_GOLDEN";

/// What differs from language to language.
struct Language {
    name: &'static str,
    target: TargetLanguage,
    /// The folder in which sources stand.
    package: &'static str,
    /// The encoder's file and source.
    encoder: (&'static str, fn() -> String),
    declarations: fn(&str) -> Vec<String>,
}

const LANGUAGES: &[Language] = &[
    Language {
        name: "kotlin",
        target: TargetLanguage::Kotlin,
        package: "org/fieldwalk",
        encoder: ("SampleBatch.kt", kotlin_batch::source),
        declarations: kotlin_surface::declarations,
    },
    Language {
        name: "python",
        target: TargetLanguage::Python,
        package: "",
        encoder: ("sample_batch.py", python_batch::source),
        declarations: python_surface::declarations,
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
    let declarations = generate(language, library, folder);
    match declarations.and_then(|declarations| compare(declarations, Path::new(surface))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the sources anew and gives their public declarations.
fn generate(language: &Language, library: &str, folder: &str) -> Result<Vec<String>, Box<dyn Error>> {
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
    let mut declarations = Vec::new();
    for entry in package.read_dir_utf8()? {
        declarations.extend((language.declarations)(&std::fs::read_to_string(entry?.path())?));
    }
    Ok(declarations)
}

/// Compares the public declarations found with those of the file at `path`.
fn compare(mut found: Vec<String>, path: &Path) -> Result<(), Box<dyn Error>> {
    found.sort();
    found.dedup();
    let found = found.join("\n") + "\n";
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        return Ok(std::fs::write(path, found)?);
    }
    let expected = std::fs::read_to_string(path).unwrap_or_default();
    if found == expected {
        return Ok(());
    }
    let lacks = |list: &str, line: &&str| !list.lines().any(|other| other == *line);
    let gone = expected.lines().filter(|line| lacks(&found, line)).map(|line| format!("\n- {line}"));
    let new = found.lines().filter(|line| lacks(&expected, line)).map(|line| format!("\n+ {line}"));
    let changes: String = gone.chain(new).collect();
    let name = path.display();
    Err(format!(
        "the public surface differs from {name}:{changes}\nIf that is meant: {UPDATE}=1 cargo xtask bindings, and say \
         in CHANGELOG.md what breaks"
    )
    .into())
}
