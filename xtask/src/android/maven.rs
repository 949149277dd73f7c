//! The Kotlin side on the JVM: the very sources that Gradle builds, compiled against Robolectric's Android and tested with
//! the engine of this machine; then the AAR.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::abi::ABIS;
use super::cross::LIBRARY;
use crate::bindings;
use crate::kotlin::{has_jdk, is_offline};
use crate::process::{find_program, output_of, run as execute, run_into};
use crate::readme_example;
use crate::report::Outcome;
use crate::workspace::Workspace;

/// What is put before the README's example.
const README_HEAD: &str = "package org.fieldwalk.readme\n\nimport android.app.Activity\n\
                           import kotlinx.coroutines.CoroutineScope\nimport kotlinx.coroutines.launch\n\
                           import org.fieldwalk.*\nimport org.fieldwalk.android.*\n\n";

pub fn run(workspace: &Workspace, folder: &Path) -> Outcome {
    let sources = match bindings::generate(workspace, bindings::KOTLIN) {
        Ok(sources) => sources,
        Err(reason) => return Err(reason).into(),
    };
    if !has_jdk() {
        return Outcome::skipped("a JDK of at least 17 is missing: apt-get install default-jdk-headless");
    }
    let Some(maven) = find_program("mvn") else {
        return Outcome::skipped("Maven is missing: apt-get install maven");
    };
    let made =
        bindings::walk(workspace, bindings::KOTLIN).and_then(|walk| Ok((walk, floor(workspace, folder)?)));
    let (walk, floor) = match made {
        Ok(made) => made,
        Err(reason) => return Err(reason).into(),
    };
    let example = folder.join("readme/Readme.kt");
    if let Err(reason) = readme_example::write(&workspace.root, "kotlin android", README_HEAD, &example) {
        return Err(reason).into();
    }
    let define = |name: &str, path: &Path| format!("-Dfieldwalk.{name}={}", path.display());
    let library = bindings::library(workspace);
    let mut test = workspace.command(maven);
    test.args(["-q", "-B", "-ntp", "-f", "android/pom.xml"])
        .arg(define("target", folder))
        .arg(define("generated", &sources))
        .arg(define("library", library.parent().unwrap_or(folder)))
        .arg(define("walk", &walk))
        .arg(define("floor", &floor))
        .arg("package");
    let log = folder.join("maven.log");
    if let Err(reason) = fs::create_dir_all(folder).map_err(|error| error.to_string()) {
        return Err(reason).into();
    }
    if let Err(reason) = run_into(&mut test, &log) {
        let text = fs::read_to_string(&log).unwrap_or_default();
        if is_offline(&text) {
            return Outcome::skipped(format!(
                "Maven cannot fetch what the Android tests need; with a network: cargo xtask test --only android ({})",
                log.display()
            ));
        }
        eprintln!("{text}");
        return Err(reason).into();
    }
    list(folder).into()
}

/// A simulated floor to survey, its map by the host (`floor.map`), and what the host says of it (`floor.json`).
fn floor(workspace: &Workspace, folder: &Path) -> Result<PathBuf, String> {
    let floor = folder.join("floor");
    let (map, expected) = (folder.join("floor.map"), folder.join("floor.json"));
    for old in [&floor, &map] {
        let _ = fs::remove_dir_all(old); // what another version has simulated
    }
    let mut simulate =
        workspace.cargo("run --quiet --package fieldwalk-cli -- simulate card-office --walks 1 --out");
    execute(simulate.arg(&floor).stdout(Stdio::null()))?;
    let mut survey = workspace.cargo("run --quiet --package fieldwalk-cli -- survey --json");
    let json = output_of(survey.arg(&floor).arg("--out").arg(map))
        .ok_or("`fieldwalk survey` failed on the simulated floor")?;
    fs::write(&expected, json).map_err(|error| format!("{}: {error}", expected.display()))?;
    Ok(floor)
}

/// Shows what is in the AAR, and checks that nothing is missing.
fn list(folder: &Path) -> Result<(), String> {
    let aar: PathBuf = folder.join("fieldwalk.aar");
    let mut jar = Command::new("jar");
    let listing = output_of(jar.arg("--list").arg("--file").arg(&aar))
        .ok_or(format!("{} is no archive", aar.display()))?;
    eprintln!("{}:\n{listing}", aar.display());
    let engines = ABIS.iter().map(|abi| format!("jni/{}/{LIBRARY}", abi.name));
    let engines = engines.filter(|name| folder.join(name).exists());
    let expected = ["AndroidManifest.xml", "classes.jar", "proguard.txt", "R.txt"].map(str::to_owned);
    let missing: Vec<String> = expected
        .into_iter()
        .chain(engines)
        .filter(|name| !listing.lines().any(|line| line == name))
        .collect();
    if missing.is_empty() { Ok(()) } else { Err(format!("the AAR lacks {}", missing.join(", "))) }
}
