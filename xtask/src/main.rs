//! `cargo xtask …`: the checks of this workspace, the same for people and for continuous integration.

mod aarch64;
mod android;
mod arguments;
mod bindings;
mod disk;
mod elf;
mod firmware;
mod firmware_toolchain;
mod fuzz;
mod install;
mod kotlin;
mod process;
mod python;
mod readme_example;
mod report;
mod stages;
mod swift;
mod swift_toolchain;
mod tidy;
mod workspace;
mod xcframework;

use std::process::ExitCode;

use arguments::{Arguments, USAGE};
use workspace::Workspace;

fn main() -> ExitCode {
    let arguments = match Arguments::parse(std::env::args().skip(1)) {
        Ok(Some(arguments)) => arguments,
        Ok(None) => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(message) => {
            eprintln!("error: {message}\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    let workspace = Workspace::open();
    let report = stages::run(&workspace, &arguments);
    // Figures have standard output to themselves.
    if arguments.json {
        eprint!("\n{report}")
    } else {
        print!("\n{report}")
    }
    if arguments.only == ["firmware"] {
        print!("{}", firmware::result(&workspace).unwrap_or_default());
    }
    if report.n_failed() > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
