//! The host's command line: walks become maps, recordings become fixes and error tables; a demo needs neither.
//!
//! Results go to standard output, as tables for people or as one JSON object a line; everything else goes to standard
//! error. [`evaluation`] scores systems without any of that.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod arguments;
mod bits;
pub mod card_walks;
mod commands;
pub mod energy;
mod error_table;
pub mod evaluation;
pub mod floors;
pub mod plot;
mod probe;
mod progress;
mod quoted;
pub mod report;
pub mod reproduce;
mod simulated;
mod stop;
mod table;
pub mod walker_evaluation;
pub mod walks;

use std::ffi::OsString;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command, TrainArguments, TrainedPart};
use stop::Stop;

/// Runs the command that the process's arguments ask for.
pub fn run() -> ExitCode {
    run_from(std::env::args_os())
}

/// Runs the command that `arguments` ask for, the first of which is the program's name.
///
/// Wrong arguments end the process, as [`run`] does.
pub fn run_from<T: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = T>) -> ExitCode {
    let arguments = Arguments::parse_from(arguments);
    let mut out = BufWriter::new(io::stdout().lock());
    let outcome = match &arguments.command {
        Command::Demo(arguments) => commands::demo::run(arguments, &mut out),
        Command::Survey(arguments) => commands::survey::run(arguments, &mut out),
        Command::Replay(arguments) => commands::replay::run(arguments, &mut out),
        Command::Evaluate(arguments) => commands::evaluate::run(arguments, &mut out),
        Command::Report(arguments) => commands::report::run(arguments, &mut out),
        Command::Reproduce(arguments) => commands::reproduce::run(arguments, &mut out),
        Command::Train(TrainArguments { part: TrainedPart::Attitude(arguments) }) => {
            commands::train::attitude(arguments, &mut out)
        }
        Command::Import(arguments) => commands::import::run(arguments, &mut out),
        Command::Simulate(arguments) => commands::simulate::run(arguments, &mut out),
        Command::Energy(arguments) => commands::energy::run(arguments, &mut out),
        Command::CardWalks(arguments) => commands::card_walks::run(arguments, &mut out),
    };
    // What was written before a failure is shown before it is explained.
    let flushed = out.flush().map_err(Stop::from);
    match outcome.and(flushed) {
        Ok(()) => ExitCode::SUCCESS,
        Err(stop) => stop.report(),
    }
}
