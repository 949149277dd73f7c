//! The Swift package on Linux: compiled with warnings as errors, compared bit for bit with `fieldwalk replay`; the parts
//! for Apple's platforms checked against declarations of what they call.

use std::fs;
use std::path::{Path, PathBuf};

use crate::process::run_into;
use crate::report::Outcome;
use crate::swift_toolchain::Toolchain;
use crate::workspace::Workspace;
use crate::{bindings, readme_example, xcframework};

/// The Swift package.
const PACKAGE: &str = "ios";
/// Where the README's example is put for the tests.
const README_EXAMPLE: &str = "Tests/FieldwalkTests/Generated/Readme.swift";
/// Apple's frameworks that are declared in `Stubs/`, and that the package calls.
const FRAMEWORKS: [&str; 3] = ["CoreMotion", "CoreLocation", "CoreBluetooth"];

pub fn run(workspace: &Workspace) -> Outcome {
    if let Err(reason) = bindings::generate(workspace, bindings::SWIFT) {
        return Err(reason).into();
    }
    if !cfg!(target_os = "linux") {
        return Outcome::skipped(
            "the Swift tests run on Linux; on a Mac: ios/scripts/xcframework.sh, then Xcode",
        );
    }
    let toolchain = match Toolchain::find_or_make() {
        Ok(toolchain) => toolchain,
        Err(reason) => return Outcome::skipped(reason),
    };
    let library = bindings::library(workspace);
    let libraries = library.parent().unwrap_or(&workspace.target).to_owned();
    let folder = workspace.root.join(PACKAGE);
    Outcome::found(Package { workspace, toolchain, folder, libraries }.check())
}

struct Package<'a> {
    workspace: &'a Workspace,
    toolchain: Toolchain,
    folder: PathBuf,
    /// Where the engine's shared library is.
    libraries: PathBuf,
}

impl Package<'_> {
    fn check(&self) -> Result<String, String> {
        let folder = bindings::walk(self.workspace, bindings::SWIFT)?;
        let example = self.folder.join(README_EXAMPLE);
        readme_example::write(&self.workspace.root, "swift", "import Fieldwalk\n\n", &example)?;
        let made = bindings::folder(self.workspace);
        let build = made.join("swift-build");
        let link = format!("-L{}", self.libraries.display());
        let flags = ["--scratch-path", &text(&build), "-Xswiftc", "-warnings-as-errors", "-Xlinker", &link];
        self.run("build", &[["swift", "build", "--build-tests"].as_slice(), &flags].concat())?;
        let walk = format!("FIELDWALK_WALK={}", folder.display());
        self.run("test", &[[walk.as_str(), "swift", "test"].as_slice(), &flags].concat())?;
        self.check_apple_parts(&made.join("swift-stubs"))?;
        xcframework::check_if_there(&self.workspace.root)?;
        bindings::compared_bits(&folder, bindings::SWIFT)
    }

    /// What needs Apple's frameworks is type-checked against declarations of what it calls; the app is parsed.
    fn check_apple_parts(&self, stubs: &Path) -> Result<(), String> {
        fs::create_dir_all(stubs).map_err(|error| format!("{}: {error}", stubs.display()))?;
        let include = text(stubs);
        for framework in FRAMEWORKS {
            let module = text(&stubs.join(format!("{framework}.swiftmodule")));
            let source = format!("Stubs/{framework}.swift");
            let emit =
                ["swiftc", "-emit-module", "-parse-as-library", "-I", &include, "-module-name", framework];
            self.run("stubs", &[emit.as_slice(), &["-emit-module-path", &module, &source]].concat())?;
        }
        let sources = self.sources_under("Sources/Fieldwalk")?;
        let check = [
            "swiftc",
            "-typecheck",
            "-warnings-as-errors",
            "-swift-version",
            "6",
            "-module-name",
            "Fieldwalk",
        ];
        let paths = ["-package-name", "fieldwalk", "-I", &include, "-I", "Sources/FieldwalkFFI"];
        self.run("typecheck", &[&check, paths.as_slice(), &words(&sources)].concat())?;
        let app = self.sources_under("Survey/App")?;
        self.run("parse", &[["swiftc", "-parse"].as_slice(), &words(&app)].concat())
    }

    /// Runs `arguments` in the package; its output is shown when it fails.
    fn run(&self, name: &str, arguments: &[&str]) -> Result<(), String> {
        let log = bindings::folder(self.workspace).join(format!("swift-{name}.log"));
        let mut command = self.toolchain.command(self.workspace, &self.folder, &self.libraries, arguments)?;
        run_into(&mut command, &log).map_err(|_| {
            eprintln!("{}", fs::read_to_string(&log).unwrap_or_default());
            format!("`{}` failed ({})", arguments[..arguments.len().min(3)].join(" "), log.display())
        })
    }

    /// The Swift sources under `folder`, as paths from the package.
    fn sources_under(&self, folder: &str) -> Result<Vec<String>, String> {
        let mut folders = vec![PathBuf::from(folder)];
        let mut sources = Vec::new();
        while let Some(folder) = folders.pop() {
            let entries =
                fs::read_dir(self.folder.join(&folder)).map_err(|error| format!("{folder:?}: {error}"))?;
            for entry in entries.flatten() {
                let path = folder.join(entry.file_name());
                if entry.path().is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|extension| extension == "swift") {
                    sources.push(text(&path));
                }
            }
        }
        sources.sort();
        Ok(sources)
    }
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn words(sources: &[String]) -> Vec<&str> {
    sources.iter().map(String::as_str).collect()
}
