//! What a log held and was not handed out.

use std::fmt;

/// What a log held, or should have held, and did not give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Whether the file ends before its end: its writer died, or the file was cut short.
    pub was_cut: bool,
    /// Chunks left out because they have changed since they were written.
    pub n_corrupt_chunks: u64,
    /// Messages or lines left out because they are not of their kind's form.
    pub n_malformed: u64,
    /// Messages of other programs' channels.
    pub n_foreign_messages: u64,
}

impl Losses {
    /// Whether everything was handed out; messages of other programs do not count.
    pub fn is_none(&self) -> bool {
        !self.was_cut && self.n_corrupt_chunks == 0 && self.n_malformed == 0
    }
}

impl fmt::Display for Losses {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        let mut say = |text: fmt::Arguments<'_>| {
            write!(f, "{separator}{text}")?;
            separator = ", ";
            Ok(())
        };
        if self.was_cut {
            say(format_args!("cut short"))?;
        }
        for (n, what) in [
            (self.n_corrupt_chunks, "damaged chunks"),
            (self.n_malformed, "malformed entries"),
            (self.n_foreign_messages, "messages of other programs"),
        ] {
            if n > 0 {
                say(format_args!("{n} {what}"))?;
            }
        }
        if separator.is_empty() { f.write_str("nothing lost") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::Losses;

    #[test]
    fn losses_are_said_in_one_line() {
        assert_eq!(Losses::default().to_string(), "nothing lost");
        let losses = Losses { was_cut: true, n_malformed: 2, ..Losses::default() };
        assert_eq!(losses.to_string(), "cut short, 2 malformed entries");
        assert!(!losses.is_none());
        assert!(Losses { n_foreign_messages: 1, ..Losses::default() }.is_none());
    }
}
