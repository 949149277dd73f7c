//! The stages of `cargo xtask test`, cheapest complaint first.

use std::time::Instant;

use crate::arguments::Arguments;
use crate::process::{find_program, run as execute, succeeds};
use crate::report::{Outcome, Report, Verdict};
use crate::workspace::Workspace;
use crate::{
    aarch64, android, bindings, disk, firmware, fuzz, install, kotlin, python, swift, tidy, xcframework,
};

/// One kind of check.
#[derive(Debug)]
pub struct Stage {
    pub name: &'static str,
    /// Belongs to `--quick`.
    quick: bool,
    run: fn(&Workspace, &Arguments) -> Outcome,
}

pub const STAGES: &[Stage] = &[
    Stage { name: "install", quick: false, run: |workspace, _| install::run(workspace) },
    Stage { name: "format", quick: true, run: |workspace, _| format(workspace) },
    Stage { name: "tidy", quick: true, run: |workspace, _| tidy::run(workspace) },
    Stage { name: "clippy", quick: true, run: |workspace, _| clippy(workspace) },
    Stage { name: "docs", quick: true, run: |workspace, _| docs(workspace) },
    Stage { name: "deny", quick: false, run: |workspace, _| deny(workspace) },
    Stage { name: "test", quick: true, run: |workspace, _| test(workspace) },
    Stage { name: "bindings", quick: false, run: |workspace, _| bindings::run(workspace) },
    Stage { name: "kotlin", quick: false, run: |workspace, _| kotlin::run(workspace) },
    Stage { name: "swift", quick: false, run: |workspace, _| swift::run(workspace) },
    Stage { name: "python", quick: false, run: |workspace, _| python::run(workspace) },
    Stage { name: "android", quick: false, run: android::run },
    Stage { name: "firmware", quick: false, run: |workspace, _| firmware::run(workspace) },
    Stage {
        name: "fuzz",
        quick: false,
        run: |workspace, arguments| fuzz::run(workspace, arguments.fuzz_seconds),
    },
    Stage { name: "aarch64", quick: false, run: |workspace, _| aarch64::run(workspace) },
];

/// What is no check, and runs only when it is asked for by name.
pub const ON_DEMAND: &[Stage] = &[
    Stage { name: "bench-jvm", quick: false, run: |workspace, _| kotlin::bench(workspace) },
    Stage { name: "xcframework", quick: false, run: |workspace, _| xcframework::run(workspace) },
];

/// Runs the stages asked for; one that fails does not keep the next from running.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Report {
    let mut report = Report::default();
    let is_whole = arguments.only.is_empty() && !arguments.quick;
    if is_whole
        && let Some(free_bytes) = disk::free_bytes(&workspace.target)
        && let Some(warning) = disk::warning(free_bytes, disk::held_bytes(&workspace.target))
    {
        eprintln!("WARNING: {warning}");
    }
    let is_named = |stage: &Stage| arguments.only.iter().any(|name| name == stage.name);
    let checks = STAGES.iter().filter(|stage| arguments.only.is_empty() || is_named(stage));
    for stage in checks.chain(ON_DEMAND.iter().filter(|stage| is_named(stage))) {
        eprintln!("\n== {} ==", stage.name);
        let start = Instant::now();
        let outcome = if arguments.quick && !stage.quick {
            Outcome::skipped("left out by --quick")
        } else {
            (stage.run)(workspace, arguments)
        };
        for reason in &outcome.failures {
            eprintln!("FAILED {}: {reason}", stage.name);
        }
        for reason in &outcome.skipped {
            eprintln!("SKIPPED {}: {reason}", stage.name);
        }
        if outcome.verdict == Verdict::Passed {
            eprintln!("{} passed in {:.1} s", stage.name, start.elapsed().as_secs_f64());
        }
        report.add(stage.name, outcome, start.elapsed());
    }
    if is_whole {
        report.disk = disk::state(&workspace.target);
    }
    report
}

fn format(workspace: &Workspace) -> Outcome {
    if !succeeds(&mut workspace.cargo("fmt --version")) {
        return Outcome::skipped("rustfmt is missing: rustup component add rustfmt");
    }
    let own = execute(&mut workspace.cargo("fmt --all --check"));
    let others = ["fuzz", "firmware/nrf52832", "firmware/qemu"].map(|folder| {
        execute(&mut workspace.cargo(&format!("fmt --manifest-path {folder}/Cargo.toml --check")))
    });
    Outcome::new([own].into_iter().chain(others).filter_map(Result::err).collect(), Vec::new())
}

fn clippy(workspace: &Workspace) -> Outcome {
    if !succeeds(&mut workspace.cargo("clippy --version")) {
        return Outcome::skipped("clippy is missing: rustup component add clippy");
    }
    execute(&mut workspace.cargo("clippy --workspace --all-targets -- -D warnings")).into()
}

fn docs(workspace: &Workspace) -> Outcome {
    let mut doc = workspace.cargo("doc --workspace --no-deps");
    execute(doc.env("RUSTDOCFLAGS", "-D warnings")).into()
}

fn deny(workspace: &Workspace) -> Outcome {
    let Some(cargo_deny) = install::find_cargo_deny(workspace) else {
        return Outcome::skipped(format!("cargo-deny is missing: {}", install::CARGO_DENY_REMEDY));
    };
    let tree = execute(workspace.command(&cargo_deny).args([
        "check",
        "--hide-inclusion-graph",
        "bans",
        "licenses",
        "sources",
    ]));
    let mut failures: Vec<String> = tree.err().into_iter().collect();
    let mut skipped = Vec::new();
    // The advisory database is a git repository of its own; without a network there is nothing to compare with.
    if find_program("git").is_some() && succeeds(workspace.command(&cargo_deny).args(["fetch", "db"])) {
        failures.extend(execute(workspace.command(&cargo_deny).args(["check", "advisories"])).err());
    } else {
        skipped.push(
            "advisories: the RustSec database cannot be fetched; with a network: cargo deny check advisories"
                .into(),
        );
    }
    Outcome::new(failures, skipped)
}

/// Unit, property, replay and documentation tests.
///
/// Tests that miss a recording add a line to the file named by `FIELDWALK_SKIP_LOG`, so that what was left out is
/// seen here too. The generator of bindings is tested by the stage `bindings`, which builds it in a profile of its own.
fn test(workspace: &Workspace) -> Outcome {
    let skip_log = workspace.target.join("skipped-tests.txt");
    let _ = std::fs::remove_file(&skip_log);
    let result = execute(
        workspace
            .cargo("test --workspace --exclude fieldwalk-bindgen --no-fail-fast")
            .env("FIELDWALK_SKIP_LOG", &skip_log),
    );
    let mut skipped: Vec<String> =
        std::fs::read_to_string(&skip_log).unwrap_or_default().lines().map(str::to_owned).collect();
    skipped.sort();
    skipped.dedup();
    Outcome::new(result.err().into_iter().collect(), skipped)
}
