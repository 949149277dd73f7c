//! What the stages found, as a table and one plain last line.

use std::fmt;
use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    Passed,
    Failed,
    Skipped,
}

/// What one stage did: its verdict, why it failed, everything that it left out, and what it found.
#[derive(Debug)]
pub struct Outcome {
    pub verdict: Verdict,
    pub failures: Vec<String>,
    pub skipped: Vec<String>,
    /// Findings to show.
    pub notes: Vec<String>,
}

impl Outcome {
    /// Failed if anything failed; otherwise passed, even if parts were left out.
    pub fn new(failures: Vec<String>, skipped: Vec<String>) -> Self {
        let verdict = if failures.is_empty() { Verdict::Passed } else { Verdict::Failed };
        Self { verdict, failures, skipped, notes: Vec::new() }
    }

    /// What was found, or why it failed.
    pub fn found(result: Result<String, String>) -> Self {
        match result {
            Ok(note) => Self { notes: vec![note], ..Self::new(Vec::new(), Vec::new()) },
            Err(reason) => Self::new(vec![reason], Vec::new()),
        }
    }

    /// The whole stage was left out.
    pub fn skipped(reason: impl Into<String>) -> Self {
        let (failures, skipped) = (Vec::new(), vec![reason.into()]);
        Self { verdict: Verdict::Skipped, failures, skipped, notes: Vec::new() }
    }
}

impl From<Result<(), String>> for Outcome {
    fn from(result: Result<(), String>) -> Self {
        Self::new(result.err().into_iter().collect(), Vec::new())
    }
}

/// The outcomes of a run, in order.
#[derive(Debug, Default)]
pub struct Report {
    lines: Vec<(&'static str, Outcome, Duration)>,
    /// What was written and what is free.
    pub disk: Option<String>,
}

impl Report {
    pub fn add(&mut self, stage: &'static str, outcome: Outcome, time: Duration) {
        self.lines.push((stage, outcome, time));
    }

    pub fn n_failed(&self) -> usize {
        self.count(Verdict::Failed)
    }

    fn count(&self, verdict: Verdict) -> usize {
        self.lines.iter().filter(|(_, outcome, _)| outcome.verdict == verdict).count()
    }

    /// Stages left out and parts left out of stages that ran.
    fn n_skipped(&self) -> usize {
        self.lines.iter().map(|(_, outcome, _)| outcome.skipped.len()).sum()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "stage     result   seconds")?;
        for (stage, outcome, time) in &self.lines {
            let result = match outcome.verdict {
                Verdict::Passed => "passed",
                Verdict::Failed => "FAILED",
                Verdict::Skipped => "SKIPPED",
            };
            writeln!(f, "{stage:<9} {result:<8} {:>7.1}", time.as_secs_f64())?;
            for note in &outcome.notes {
                writeln!(f, "          {note}")?;
            }
            for reason in &outcome.failures {
                writeln!(f, "          failed: {reason}")?;
            }
            for reason in &outcome.skipped {
                writeln!(f, "          skipped: {reason}")?;
            }
        }
        let seconds: f64 = self.lines.iter().map(|(_, _, time)| time.as_secs_f64()).sum();
        writeln!(f, "total              {seconds:>7.1}")?;
        if let Some(disk) = &self.disk {
            writeln!(f, "disk      {disk}")?;
        }
        writeln!(
            f,
            "{} passed, {} failed, {} skipped",
            self.count(Verdict::Passed),
            self.n_failed(),
            self.n_skipped()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_counts_failures_and_everything_left_out() {
        let mut report = Report::default();
        report.add("format", Outcome::new(vec![], vec![]), Duration::from_secs(1));
        report.add("python", Outcome::found(Ok("the same bits".to_owned())), Duration::from_secs(1));
        report.add("deny", Outcome::new(vec![], vec!["advisories".into()]), Duration::from_secs(2));
        report.add("docs", Outcome::new(vec!["broken link".into()], vec![]), Duration::from_secs(3));
        report.add("aarch64", Outcome::skipped("no qemu"), Duration::ZERO);
        report.disk = Some("9.0 GiB in the build folder, 3.0 GiB free".into());
        let text = report.to_string();
        assert!(text.contains("\ndisk      9.0 GiB in"), "{text}");
        assert_eq!(text.lines().last(), Some("3 passed, 1 failed, 2 skipped"));
        assert!(text.contains("\n          the same bits\n"), "{text}");
        assert!(text.contains("failed: broken link") && text.contains("skipped: no qemu"), "{text}");
    }
}
