//! Progress on standard error, drawn only where that is a terminal.

use std::borrow::Cow;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `n` units of `what`.
pub fn bar(what: impl Into<Cow<'static, str>>, n: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}, {elapsed}, {eta} left");
    // indicatif draws on standard error, and hides a bar where that is no terminal.
    ProgressBar::new(n as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(what)
}
