//! The Python bindings: the wheel built, installed into an environment of its own, and compared bit for bit with
//! `fieldwalk replay`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::bindings;
use crate::process::{run as execute, succeeds};
use crate::report::Outcome;
use crate::workspace::Workspace;

/// True for a Python of at least 3.9 that can make environments with pip.
const IS_FIT: &str = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 9))";

pub fn run(workspace: &Workspace) -> Outcome {
    let sources = match bindings::generate(workspace, bindings::PYTHON) {
        Ok(sources) => sources,
        Err(reason) => return Err(reason).into(),
    };
    let Some(python) = find_python() else {
        return Outcome::skipped("Python of at least 3.9 with venv is missing: apt-get install python3-venv");
    };
    let folder = bindings::folder(workspace);
    let environment = match environment(workspace, python, &folder) {
        Ok(environment) => environment,
        Err(Unmade::Offline) => {
            return Outcome::skipped(
                "pip cannot fetch numpy; with a network: cargo xtask test --only python",
            );
        }
        Err(Unmade::Failed(reason)) => return Err(reason).into(),
    };
    Outcome::found(test(workspace, &environment, &sources, &folder))
}

/// The Python that this stage can use.
pub fn find_python() -> Option<&'static str> {
    ["python3", "python"].into_iter().find(|name| succeeds(Command::new(name).args(["-c", IS_FIT])))
}

enum Unmade {
    Offline,
    Failed(String),
}

/// The Python of an environment with numpy, kept from run to run.
fn environment(workspace: &Workspace, python: &str, folder: &Path) -> Result<PathBuf, Unmade> {
    let environment = folder.join("python-environment");
    let own = environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if !succeeds(workspace.command(&own).args(["-c", "import pip"])) {
        let mut make = workspace.command(python);
        execute(make.args(["-m", "venv", "--clear"]).arg(&environment)).map_err(Unmade::Failed)?;
    }
    if !succeeds(workspace.command(&own).args(["-c", "import numpy"])) {
        let mut fetch = pip(workspace, &own);
        execute(fetch.args(["install", "--only-binary", ":all:", "numpy"])).map_err(|_| Unmade::Offline)?;
    }
    Ok(own)
}

fn test(workspace: &Workspace, python: &Path, sources: &Path, folder: &Path) -> Result<String, String> {
    let walk = bindings::walk(workspace, bindings::PYTHON)?;
    let mut install = pip(workspace, python);
    install
        .args(["install", "--no-index", "--no-deps", "--no-build-isolation", "--force-reinstall"])
        .arg("bindings/python")
        .env("FIELDWALK_LIBRARY", bindings::library(workspace))
        .env("FIELDWALK_GENERATED", sources);
    execute(&mut install)?;
    let mut tests = workspace.command(python);
    tests
        .args(["-B", "-W", "error", "-m", "unittest", "discover", "-s"])
        .arg(workspace.root.join("bindings/python/tests"))
        .current_dir(folder)
        .env("FIELDWALK_WALK", &walk)
        .env("PYTHONDONTWRITEBYTECODE", "1");
    execute(&mut tests)?;
    bindings::compared_bits(&walk, bindings::PYTHON)
}

/// pip in the environment of `python`, quiet and leaving nothing beside the sources.
fn pip(workspace: &Workspace, python: &Path) -> Command {
    let mut command = workspace.command(python);
    command
        .args(["-B", "-m", "pip", "--quiet", "--disable-pip-version-check"])
        .env("PYTHONDONTWRITEBYTECODE", "1");
    command
}
