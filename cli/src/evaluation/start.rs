//! What a scored system knows of the start.

use std::fmt;
use std::str::FromStr;

/// What a system is told of the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// The truth ± `radius_m` along each axis, uniform and seeded.
    Known {
        /// How far off, in metres; 0.1 to 1000.
        radius_m: f64,
    },
    /// Nothing.
    Cold,
}

impl Start {
    /// For people.
    pub fn in_words(self) -> String {
        match self {
            Self::Known { radius_m } => format!("start known to ± {radius_m} m"),
            Self::Cold => "start unknown".into(),
        }
    }
}

impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Known { radius_m } => write!(f, "known:{radius_m}"),
            Self::Cold => f.write_str("cold"),
        }
    }
}

impl FromStr for Start {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "cold" {
            return Ok(Self::Cold);
        }
        let radius = text.strip_prefix("known:").and_then(|radius| radius.parse().ok());
        match radius.filter(|radius_m| (0.1..=1_000.0).contains(radius_m)) {
            Some(radius_m) => Ok(Self::Known { radius_m }),
            None => {
                Err("expected `cold` or `known:R` with R from 0.1 to 1000 metres, such as known:2".into())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_reads_as_it_prints() {
        for text in ["cold", "known:2", "known:0.1", "known:12.5"] {
            assert_eq!(text.parse::<Start>().map(|start| start.to_string()), Ok(text.to_string()));
        }
        for wrong in ["", "known", "known:", "known:0", "known:-2", "known:nan", "known:1e9", "warm"] {
            assert!(wrong.parse::<Start>().unwrap_err().contains("known:2"), "{wrong}");
        }
    }
}
