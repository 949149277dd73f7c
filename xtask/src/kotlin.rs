//! The Kotlin bindings on the JVM: compiled with warnings as errors, compared bit for bit with `fieldwalk replay`; what
//! pushing samples costs there.

use std::fs;
use std::path::{Path, PathBuf};

use crate::process::{find_program, run as execute, run_into};
use crate::report::Outcome;
use crate::workspace::Workspace;
use crate::{bindings, readme_example};

/// How Maven says that it cannot reach a repository; a test that fails says none of these.
const OFFLINE: [&str; 4] = [
    "Could not transfer artifact",
    "has not been downloaded from it before",
    "Unknown host",
    "was not found in",
];

/// What is put round the README's example, which is statements.
const README_HEAD: &str = "package org.fieldwalk.readme\n\nimport org.fieldwalk.*\n\n";

pub fn run(workspace: &Workspace) -> Outcome {
    match maven(workspace, "test", &bindings::library(workspace), &[]) {
        Maven::Ran(walk) => Outcome::found(bindings::compared_bits(&walk, bindings::KOTLIN)),
        Maven::Not(outcome) => outcome,
    }
}

/// Prints the tables of `PushBench.kt`, with the optimised library.
pub fn bench(workspace: &Workspace) -> Outcome {
    if let Err(reason) =
        execute(&mut workspace.cargo("build --quiet --release --package fieldwalk-ffi --lib --features jni"))
    {
        return Err(reason).into();
    }
    let library = workspace.target.join("release").join(bindings::library_name());
    let tables = bindings::folder(workspace).join("push-bench.md");
    let _ = fs::remove_file(&tables);
    let chosen = ["-Dtest=PushBench".to_owned(), format!("-Dfieldwalk.bench={}", tables.display())];
    match maven(workspace, "bench", &library, &chosen) {
        Maven::Ran(_) => {
            let text = fs::read_to_string(&tables).map_err(|error| format!("{}: {error}", tables.display()));
            Outcome::found(text.map(|text| format!("{}:\n{text}", tables.display())))
        }
        Maven::Not(outcome) => outcome,
    }
}

/// What became of a run of Maven.
enum Maven {
    /// All passed; the folder of the simulated walk.
    Ran(PathBuf),
    /// It failed, or could not be made.
    Not(Outcome),
}

/// Compiles the generated and our own sources, and runs what `chosen` names with `library`; all tests by default.
fn maven(workspace: &Workspace, name: &str, library: &Path, chosen: &[String]) -> Maven {
    let failed = |reason: String| Maven::Not(Outcome::new(vec![reason], Vec::new()));
    let sources = match bindings::generate(workspace, bindings::KOTLIN) {
        Ok(sources) => sources,
        Err(reason) => return failed(reason),
    };
    if !has_jdk() {
        let reason = "a JDK of at least 17 is missing: apt-get install default-jdk-headless";
        return Maven::Not(Outcome::skipped(reason));
    }
    let Some(program) = find_program("mvn") else {
        return Maven::Not(Outcome::skipped("Maven is missing: apt-get install maven"));
    };
    let folder = bindings::folder(workspace);
    let walk = match prepare(workspace, &folder) {
        Ok(walk) => walk,
        Err(reason) => return failed(reason),
    };
    let define = |name: &str, path: &Path| format!("-Dfieldwalk.{name}={}", path.display());
    let mut test = workspace.command(program);
    test.args(["-q", "-B", "-ntp", "-f", "bindings/kotlin/pom.xml"])
        .arg(define("target", &folder))
        .arg(define("generated", &sources))
        .arg(define("library", library.parent().unwrap_or(&folder)))
        .arg(define("walk", &walk))
        .args(chosen)
        .arg("test");
    let log = folder.join(format!("maven-{name}.log"));
    let Err(reason) = run_into(&mut test, &log) else { return Maven::Ran(walk) };
    let text = fs::read_to_string(&log).unwrap_or_default();
    if is_offline(&text) {
        return Maven::Not(Outcome::skipped(format!(
            "Maven cannot fetch what the Kotlin tests need; with a network: cargo xtask test --only kotlin ({})",
            log.display()
        )));
    }
    eprintln!("{text}");
    failed(reason)
}

/// Whether Maven's output says that a repository was out of reach.
pub fn is_offline(log: &str) -> bool {
    OFFLINE.iter().any(|sign| log.contains(sign))
}

/// Whether there is a compiler for Java; Kotlin's needs the same libraries.
pub fn has_jdk() -> bool {
    find_program("java").is_some() && find_program("javac").is_some()
}

/// The README's example as a source; gives the folder of the simulated walk.
fn prepare(workspace: &Workspace, folder: &Path) -> Result<PathBuf, String> {
    readme_example::write(&workspace.root, "kotlin", README_HEAD, &folder.join("readme/Readme.kt"))?;
    bindings::walk(workspace, bindings::KOTLIN)
}
