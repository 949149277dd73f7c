//! A claim, and what it must pass.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::reproduce::Estimate;

/// One of the five papers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Paper {
    /// Kwak 2018: cards with access points.
    Kwak2018,
    /// Mass-centred 2019: the phone without infrastructure.
    MassCentered,
    /// iBILL 2017: iBeacons in open halls.
    Ibill,
    /// WILA 2016: the sensor at the waist.
    Wila,
    /// Song 2014: few particles at similar intensities.
    Song,
}

impl Paper {
    /// All, in the order in which tables list them.
    pub const ALL: [Self; 5] = [Self::Kwak2018, Self::MassCentered, Self::Ibill, Self::Wila, Self::Song];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kwak2018 => "kwak2018",
            Self::MassCentered => "mass-centered",
            Self::Ibill => "ibill",
            Self::Wila => "wila",
            Self::Song => "song",
        }
    }

    /// What it is about, as a title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Kwak2018 => "Kwak 2018: a card with access points",
            Self::MassCentered => "Mass-centred 2019: a phone without infrastructure",
            Self::Ibill => "iBILL 2017: iBeacons in open halls",
            Self::Wila => "WILA 2016: a sensor at the waist",
            Self::Song => "Song 2014: few particles at similar intensities",
        }
    }
}

impl fmt::Display for Paper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a paper claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// Its name, unique.
    pub id: &'static str,
    /// Where it is from.
    pub paper: Paper,
    /// In words.
    pub text: &'static str,
    /// The unit of its values.
    pub unit: &'static str,
    /// The paper's value, where there is one.
    pub paper_value: Option<f64>,
    /// What it comes down to: it holds when all parts do.
    pub parts: &'static [Part],
}

/// One comparison of a claim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// What is measured; empty where the claim says it.
    pub what: &'static str,
    /// What the measured must pass.
    pub test: Test,
}

/// When a part of a claim holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Test {
    /// The value is not greater.
    AtMost(f64),
    /// The value is not less.
    AtLeast(f64),
    /// The value lies between, ends included.
    Within(f64, f64),
    /// The 95 % interval lies above: for orders, of a paired difference above 0.
    IntervalAbove(f64),
    /// The 95 % interval lies below.
    IntervalBelow(f64),
}

impl Test {
    /// Whether `estimate` passes. A value or an interval that does not exist passes nothing.
    pub fn holds(self, estimate: &Estimate) -> bool {
        match self {
            Self::AtMost(bound) => estimate.value <= bound,
            Self::AtLeast(bound) => estimate.value >= bound,
            Self::Within(low, high) => (low..=high).contains(&estimate.value),
            Self::IntervalAbove(bound) => estimate.low > bound,
            Self::IntervalBelow(bound) => estimate.high < bound,
        }
    }

    /// Whether the interval decides, not the value.
    pub fn needs_interval(self) -> bool {
        matches!(self, Self::IntervalAbove(_) | Self::IntervalBelow(_))
    }
}

impl fmt::Display for Test {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: &f64| format!("{}", (value * 1e4).round() / 1e4);
        match self {
            Self::AtMost(bound) => write!(f, "≤ {}", number(bound)),
            Self::AtLeast(bound) => write!(f, "≥ {}", number(bound)),
            Self::Within(low, high) if low == high => write!(f, "= {}", number(low)),
            Self::Within(low, high) => write!(f, "{} to {}", number(low), number(high)),
            Self::IntervalAbove(bound) => write!(f, "interval above {}", number(bound)),
            Self::IntervalBelow(bound) => write!(f, "interval below {}", number(bound)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_intervals_decide_as_the_test_says() {
        let estimate = Estimate { value: 2.0, low: 0.5, high: 3.5 };
        for (test, holds) in [
            (Test::AtMost(2.0), true),
            (Test::AtMost(1.9), false),
            (Test::AtLeast(2.0), true),
            (Test::AtLeast(2.1), false),
            (Test::Within(1.0, 2.0), true),
            (Test::Within(2.1, 3.0), false),
            (Test::IntervalAbove(0.4), true),
            (Test::IntervalAbove(0.5), false),
            (Test::IntervalBelow(3.6), true),
            (Test::IntervalBelow(3.5), false),
        ] {
            assert_eq!(test.holds(&estimate), holds, "{test}");
            assert!(!test.holds(&Estimate { value: f64::NAN, low: f64::NAN, high: f64::NAN }), "{test}");
        }
        assert_eq!(Test::AtMost(1.62 * 1.15).to_string(), "≤ 1.863");
    }

    #[test]
    fn papers_are_told_as_they_are_asked_for() {
        for paper in Paper::ALL {
            assert_eq!(serde_json::to_value(paper).unwrap(), paper.name());
        }
    }
}
