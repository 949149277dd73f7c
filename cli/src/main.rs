//! The `fieldwalk` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    fieldwalk_cli::run()
}
