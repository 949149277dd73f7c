//! Builds the fuzz targets with coverage on the stable toolchain and runs each for a while.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::process::{find_program, output_of, run as execute};
use crate::report::Outcome;
use crate::workspace::Workspace;

/// What `cargo fuzz` passes, without the sanitizers, which need a nightly compiler.
const RUSTFLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Cdebug-assertions";

pub fn run(workspace: &Workspace, seconds: u32) -> Outcome {
    let manifest = workspace.root.join("fuzz/Cargo.toml");
    let targets = match fs::read_to_string(&manifest) {
        Ok(text) => target_names(&text),
        Err(error) => return Err(format!("fuzz/Cargo.toml: {error}")).into(),
    };
    if targets.is_empty() {
        return Err("fuzz/Cargo.toml has no [[bin]]".to_owned()).into();
    }
    if find_program("c++").is_none() {
        return Outcome::skipped("a C++ compiler is missing (libFuzzer): apt-get install g++");
    }
    let build = match build(workspace) {
        Ok(build) => build,
        Err(reason) => return Err(reason).into(),
    };

    // One target a core: libFuzzer's own workers would share a core each anyway.
    let n_workers = std::thread::available_parallelism().map_or(1, usize::from).min(targets.len());
    let (next, failures) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..n_workers {
            scope.spawn(|| {
                while let Some(target) = targets.get(next.fetch_add(1, Ordering::Relaxed)) {
                    match fuzz(workspace, &build, target, seconds) {
                        Ok(summary) => eprintln!("{target}: {summary}"),
                        Err(reason) => {
                            failures.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(reason);
                        }
                    }
                }
            });
        }
    });
    Outcome::new(failures.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()), Vec::new())
}

/// The folder with the built targets.
fn build(workspace: &Workspace) -> Result<PathBuf, String> {
    let version = output_of(workspace.command("rustc").arg("-vV")).ok_or("`rustc -vV` failed")?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc names no host")?;
    let folder = workspace.target.join("fuzz");
    let mut cargo = workspace.cargo("build --release --manifest-path fuzz/Cargo.toml --bins --target");
    // With --target the flags reach the targets but not build scripts and procedural macros.
    execute(cargo.arg(host).arg("--target-dir").arg(&folder).env("RUSTFLAGS", RUSTFLAGS))?;
    Ok(folder.join(host).join("release"))
}

/// Runs one target; its corpus grows under `fuzz/corpus/`, committed seeds are read from `fuzz/seeds/`.
fn fuzz(workspace: &Workspace, build: &Path, target: &str, seconds: u32) -> Result<String, String> {
    let folder = |kind: &str| workspace.root.join("fuzz").join(kind).join(target);
    let (corpus, artifacts, log) =
        (folder("corpus"), folder("artifacts"), build.join(format!("{target}.log")));
    let prepared = fs::create_dir_all(&corpus).and_then(|()| fs::create_dir_all(&artifacts));
    let output = prepared.and_then(|()| File::create(&log)).map_err(|error| format!("{target}: {error}"))?;
    let mut command = workspace.command(build.join(target));
    command
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-artifact_prefix={}/", artifacts.display()))
        .args(["-timeout=20", "-rss_limit_mb=2048", "-print_final_stats=1"])
        .arg(&corpus);
    if folder("seeds").is_dir() {
        command.arg(folder("seeds"));
    }
    let status = command.stdout(std::process::Stdio::null()).stderr(output).status();
    let log_text =
        fs::read(&log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    match status {
        Ok(status) if status.success() => {
            summary(&log_text).ok_or(format!("{target} ran no input: {}", log.display()))
        }
        Ok(status) => {
            let tail: Vec<&str> = log_text.lines().rev().take(40).collect();
            for line in tail.iter().rev() {
                eprintln!("{target}: {line}");
            }
            let input = artifact(&log_text).unwrap_or("no input was written");
            Err(format!("{target}: {status}; input: {input}; log: {}", log.display()))
        }
        Err(error) => Err(format!("{target} did not start: {error}")),
    }
}

/// The names of a manifest's `[[bin]]` tables.
fn target_names(manifest: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut in_bin = false;
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            in_bin = line == "[[bin]]";
        } else if in_bin
            && let Some((key, value)) = line.split_once('=')
            && key.trim() == "name"
        {
            names.push(value.trim().trim_matches('"').to_owned());
        }
    }
    names
}

/// How many inputs ran and how many edges they covered, from libFuzzer's log.
fn summary(log: &str) -> Option<String> {
    let n_inputs: u64 = log
        .lines()
        .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"))
        .and_then(|count| count.trim().parse().ok())
        .filter(|&count| count > 0)?;
    let words: Vec<&str> =
        log.lines().rev().find(|line| line.contains(" cov: "))?.split_whitespace().collect();
    let edges = words.iter().skip_while(|word| **word != "cov:").nth(1)?;
    Some(format!("{n_inputs} inputs, {edges} edges covered"))
}

/// The file with the input that failed, from libFuzzer's log.
fn artifact(log: &str) -> Option<&str> {
    log.lines().find_map(|line| line.split_once("Test unit written to ")).map(|(_, path)| path.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_the_bins_of_the_manifest() {
        let manifest = "[package]\nname = \"fuzz\"\n[[bin]]\nname = \"frame\"\npath = \"a.rs\"\n\
                        [dependencies.x]\nname = \"no\"\n[[bin]]\ntest = false\nname=\"map\"\n";
        assert_eq!(target_names(manifest), ["frame", "map"]);
    }

    #[test]
    fn a_log_is_summed_up() {
        let log = "#2\tINITED cov: 3 ft: 4\n#900\tDONE   cov: 12 ft: 13 corp: 2/3b\n\
                   stat::number_of_executed_units: 900\n";
        assert_eq!(summary(log).as_deref(), Some("900 inputs, 12 edges covered"));
        assert_eq!(summary(&log.replace("900", "0")), None);
        let crash = "x\nartifact_prefix='a/'; Test unit written to a/crash-01\n";
        assert_eq!(artifact(crash), Some("a/crash-01"));
    }
}
