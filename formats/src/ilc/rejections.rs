//! Which lines of a trace were not understood, and why.

use std::fmt;

/// What is wrong with a line of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum LineFault {
    /// The line has too few or too many fields for its type: torn in writing, as a rule.
    FieldCount,
    /// The time is not as the format writes it.
    Time,
    /// A field that should be a number is not.
    Number,
    /// A number is NaN or infinite.
    NotFinite,
    /// A number is outside what it can be.
    OutOfRange,
    /// Neither a hardware address nor an iBeacon identity could be read.
    Identity,
    /// The line is not UTF-8.
    NotUtf8,
    /// The line is longer than any line of the format.
    TooLong,
    /// The line's type is unknown.
    UnknownType,
    /// A reading that means something only together with another, which is not there.
    Unpaired,
}

/// Counts of the lines that gave no record although they should have.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineRejections {
    counts: [u64; LineFault::ALL.len()],
    first: Option<(u64, LineFault)>,
    /// WiFi rows left out because the access point had last been heard long before the scan was reported.
    pub n_stale_wifi: u64,
}

impl LineFault {
    /// Every fault, in the order of the enumeration.
    pub const ALL: [Self; 10] = [
        Self::FieldCount,
        Self::Time,
        Self::Number,
        Self::NotFinite,
        Self::OutOfRange,
        Self::Identity,
        Self::NotUtf8,
        Self::TooLong,
        Self::UnknownType,
        Self::Unpaired,
    ];
}

impl LineRejections {
    /// Number of lines rejected for `fault`.
    pub fn count(&self, fault: LineFault) -> u64 {
        self.counts[fault as usize]
    }

    /// Number of lines rejected for any fault; stale WiFi rows are well formed and not among them.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The first rejected line, counted from 1, and what was wrong with it.
    pub fn first(&self) -> Option<(u64, LineFault)> {
        self.first
    }

    pub(crate) fn add(&mut self, line: u64, fault: LineFault) {
        self.counts[fault as usize] += 1;
        self.first.get_or_insert((line, fault));
    }
}

impl fmt::Display for LineFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FieldCount => "wrong number of fields",
            Self::Time => "malformed time",
            Self::Number => "not a number",
            Self::NotFinite => "number is not finite",
            Self::OutOfRange => "number out of range",
            Self::Identity => "no transmitter identity",
            Self::NotUtf8 => "not UTF-8",
            Self::TooLong => "line too long",
            Self::UnknownType => "unknown type",
            Self::Unpaired => "reading without its partner",
        })
    }
}

impl fmt::Display for LineRejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((line, fault)) = self.first else { return f.write_str("no line rejected") };
        write!(f, "{} rejected, first line {line}: {fault}", self.total())
    }
}
