//! What the tests of every language's bindings read: a simulated walk with its digest, and the README's examples.

use std::fs;
use std::path::{Path, PathBuf};

use crate::bindings;
use crate::process::{output_of, run as execute};
use crate::workspace::Workspace;

/// Writes the walk and what `fieldwalk replay --bits` says of it; gives the folder.
///
/// # Errors
/// When a program does not build or fails.
pub fn write(workspace: &Workspace) -> Result<PathBuf, String> {
    let walk = bindings::folder(workspace).join("walk");
    execute(
        workspace.cargo("run --quiet --package fieldwalk-tests --example walk_for_bindings --").arg(&walk),
    )?;
    let mut replay = workspace.cargo("run --quiet --package fieldwalk-cli -- replay --bits");
    let bits = output_of(replay.arg(walk.join("map")).arg(walk.join("walk.txt")))
        .ok_or("`fieldwalk replay --bits` failed on the simulated walk")?;
    fs::write(walk.join("walk.bits"), bits).map_err(|error| format!("{}: {error}", walk.display()))?;
    Ok(walk)
}

/// Writes README.md's example in `language` to `file`, behind `head`.
///
/// # Errors
/// When there is none, or the file cannot be written.
pub fn write_readme_example(root: &Path, language: &str, head: &str, file: &Path) -> Result<(), String> {
    let text = fs::read_to_string(root.join("README.md")).map_err(|error| format!("README.md: {error}"))?;
    let example = text.split_once(&format!("```{language}\n")).and_then(|(_, rest)| rest.split_once("```"));
    let (example, _) = example.ok_or(format!("README.md has no example in {language}"))?;
    let folder = file.parent().unwrap_or(root);
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(file, format!("{head}{example}")))
        .map_err(|error| format!("{}: {error}", file.display()))
}
