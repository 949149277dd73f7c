//! Tests that are left out say so.

use std::fs::File;
use std::io::{self, Write};

/// Says on standard error, past the test runner's capture, that tests of `wanted` are left out because of `reason`.
pub fn say(wanted: &str, reason: &str) {
    let line = format!("tests of {wanted}: {reason}\n");
    let _ = io::stderr().write_all(format!("SKIPPED {line}").as_bytes());
    // `cargo xtask test` repeats these lines at its end.
    if let Some(log) = std::env::var_os("FIELDWALK_SKIP_LOG") {
        let file = File::options().create(true).append(true).open(log);
        let _ = file.and_then(|mut file| file.write_all(line.as_bytes()));
    }
}
