//! Why a command ends early, and the exit code that says so.

use std::io;
use std::process::ExitCode;

use clap::CommandFactory;
use clap::error::ErrorKind;
use fieldwalk_formats::FormatError;

use crate::arguments::Arguments;

/// Why a command ends before its end.
#[derive(Debug)]
pub enum Stop {
    /// A file, or what it holds, is not as it should be.
    Failed(String),
    /// Some inputs failed, the rest is done; all of it has been reported.
    Incomplete,
    /// The arguments ask for something that there is not.
    Usage(String),
    /// Whoever read standard output has gone, such as `head`.
    PipeClosed,
}

impl Stop {
    /// Says on standard error what happened, and gives the exit code.
    pub fn report(self) -> ExitCode {
        match self {
            Self::Failed(message) => {
                note("error", &message);
                ExitCode::FAILURE
            }
            Self::Incomplete => ExitCode::FAILURE,
            Self::Usage(message) => {
                // As clap reports the mistakes that it finds by itself.
                let error = Arguments::command().error(ErrorKind::ValueValidation, message);
                let _ = error.print();
                ExitCode::from(2)
            }
            Self::PipeClosed => ExitCode::SUCCESS,
        }
    }
}

impl From<FormatError> for Stop {
    fn from(error: FormatError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Only standard output is written without a [`FormatError`].
impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self::PipeClosed;
        }
        Self::Failed(format!("standard output: cannot write: {error} (check where it is redirected to)"))
    }
}

impl From<serde_json::Error> for Stop {
    fn from(error: serde_json::Error) -> Self {
        io::Error::from(error).into()
    }
}

/// Writes a line to standard error; that this may fail is nobody's business.
pub fn note(kind: &str, message: &str) {
    use io::Write as _;
    let _ = writeln!(io::stderr().lock(), "{kind}: {message}");
}
