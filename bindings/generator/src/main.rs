//! Generates the foreign side of the bindings from the built library and from the batch's layout.
//!
//! `fieldwalk-bindgen LIBRARY FOLDER SURFACE`: `LIBRARY` is the unstripped shared library, generated sources go under
//! `FOLDER`, and the public declarations found there must be those of the file `SURFACE`.
#![forbid(unsafe_code)]

mod kotlin_batch;
mod kotlin_surface;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use camino::Utf8PathBuf;

const UPDATE: &str = "FIELDWALK_UPDATE_GOLDEN";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [library, folder, surface] = arguments.as_slice() else {
        eprintln!("usage: fieldwalk-bindgen LIBRARY FOLDER SURFACE");
        return ExitCode::from(2);
    };
    match generate(library, folder).and_then(|sources| compare(&sources, Path::new(surface))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the Kotlin sources anew and gives their texts.
fn generate(library: &str, folder: &str) -> Result<Vec<String>, Box<dyn Error>> {
    let folder = Utf8PathBuf::from(folder);
    // A source that is no longer generated must not be compiled.
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    uniffi::generate(uniffi::GenerateOptions {
        languages: vec![uniffi::TargetLanguage::Kotlin],
        source: library.into(),
        out_dir: folder.clone(),
        ..uniffi::GenerateOptions::default()
    })?;
    let package = folder.join("org/fieldwalk");
    std::fs::write(package.join("SampleBatch.kt"), kotlin_batch::source())?;
    let mut sources = Vec::new();
    for entry in package.read_dir_utf8()? {
        sources.push(std::fs::read_to_string(entry?.path())?);
    }
    Ok(sources)
}

/// Compares the public declarations of `sources` with those of the file at `path`.
fn compare(sources: &[String], path: &Path) -> Result<(), Box<dyn Error>> {
    let mut found: Vec<String> =
        sources.iter().flat_map(|source| kotlin_surface::declarations(source)).collect();
    found.sort();
    found.dedup();
    let found = found.join("\n") + "\n";
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        return Ok(std::fs::write(path, found)?);
    }
    let expected = std::fs::read_to_string(path)?;
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
