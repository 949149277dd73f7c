//! The Kotlin bindings on the JVM: compiled with warnings as errors, compared bit for bit with `fieldwalk replay`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::bindings;
use crate::process::{find_program, run_into};
use crate::report::Outcome;
use crate::workspace::Workspace;

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
            if OFFLINE.iter().any(|sign| text.contains(sign)) {
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

/// Whether there is a compiler for Java; Kotlin's needs the same libraries.
pub fn has_jdk() -> bool {
    find_program("java").is_some() && find_program("javac").is_some()
}

/// The README's example as a source; gives the folder of the simulated walk.
fn prepare(workspace: &Workspace, folder: &Path) -> Result<PathBuf, String> {
    let walk = bindings::walk(workspace)?;
    let example = readme_example(&workspace.root)?;
    let readme = folder.join("readme");
    fs::create_dir_all(&readme)
        .and_then(|()| fs::write(readme.join("Readme.kt"), example))
        .map_err(|error| format!("{}: {error}", folder.display()))?;
    Ok(walk)
}

/// The Kotlin example of README.md as a source.
fn readme_example(root: &Path) -> Result<String, String> {
    let text = fs::read_to_string(root.join("README.md")).map_err(|error| format!("README.md: {error}"))?;
    let example = text.split_once("```kotlin\n").and_then(|(_, rest)| rest.split_once("```"));
    let (example, _) = example.ok_or("README.md has no example in Kotlin")?;
    Ok(format!("{README_HEAD}{example}"))
}
