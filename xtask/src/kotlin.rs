//! The Kotlin bindings on the JVM: compiled with warnings as errors, compared bit for bit with `fieldwalk replay`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::process::{find_program, run_into};
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
const README_HEAD: &str = "import org.fieldwalk.*\n\n@Suppress(\"unused\")\n";

pub fn run(workspace: &Workspace) -> Outcome {
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
    let folder = bindings::folder(workspace);
    let walk = match prepare(workspace, &folder) {
        Ok(walk) => walk,
        Err(reason) => return Err(reason).into(),
    };
    let define = |name: &str, path: &Path| format!("-Dfieldwalk.{name}={}", path.display());
    let library = bindings::library(workspace);
    let mut test = workspace.command(maven);
    test.args(["-q", "-B", "-ntp", "-f", "bindings/kotlin/pom.xml"])
        .arg(define("target", &folder))
        .arg(define("generated", &sources))
        .arg(define("library", library.parent().unwrap_or(&folder)))
        .arg(define("walk", &walk))
        .arg("test");
    let log = folder.join("maven.log");
    match run_into(&mut test, &log) {
        Ok(()) => Ok(()).into(),
        Err(reason) => {
            let text = fs::read_to_string(&log).unwrap_or_default();
            if is_offline(&text) {
                return Outcome::skipped(format!(
                    "Maven cannot fetch what the Kotlin tests need; with a network: cargo xtask test --only kotlin ({})",
                    log.display()
                ));
            }
            eprintln!("{text}");
            Err(reason).into()
        }
    }
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
    bindings::walk(workspace)
}
