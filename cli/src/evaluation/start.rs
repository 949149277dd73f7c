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
    /// As [`Start::Known`], and the direction of the first metres ± `off_deg`, uniform and seeded.
    Facing {
        /// How far off, in metres; 0.1 to 1000.
        radius_m: f64,
        /// How far off the direction is, in degrees; 1 to 180.
        off_deg: f64,
    },
    /// Nothing.
    Cold,
}

impl Start {
    /// For people.
    pub fn in_words(self) -> String {
        match self {
            Self::Known { radius_m } => format!("start known to ± {radius_m} m"),
            Self::Facing { radius_m, off_deg } => {
                format!("start known to ± {radius_m} m and ± {off_deg}°")
            }
            Self::Cold => "start unknown".into(),
        }
    }
}

impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Known { radius_m } => write!(f, "known:{radius_m}"),
            Self::Facing { radius_m, off_deg } => write!(f, "known:{radius_m}:{off_deg}"),
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
        let known = || {
            let (radius, angle) = text.strip_prefix("known:")?.split_once(':').map_or_else(
                || text.strip_prefix("known:").map(|radius| (radius, None)),
                |(radius, angle)| Some((radius, Some(angle))),
            )?;
            let radius_m = radius.parse().ok().filter(|m| (0.1..=1_000.0).contains(m))?;
            let Some(angle) = angle else { return Some(Self::Known { radius_m }) };
            let off_deg = angle.parse().ok().filter(|deg| (1.0..=180.0).contains(deg))?;
            Some(Self::Facing { radius_m, off_deg })
        };
        known().ok_or_else(|| {
            "expected `cold`, `known:R` or `known:R:A` with R from 0.1 to 1000 metres and A from 1 to 180 degrees, such as \
             known:2 or known:2:10"
                .into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_reads_as_it_prints() {
        for text in ["cold", "known:2", "known:0.1", "known:12.5", "known:2:10"] {
            assert_eq!(text.parse::<Start>().map(|start| start.to_string()), Ok(text.to_string()));
        }
        for wrong in [
            "",
            "known",
            "known:",
            "known:0",
            "known:-2",
            "known:nan",
            "known:1e9",
            "known:2:",
            "known:2:0",
            "known:2:10:3",
            "warm",
        ] {
            assert!(wrong.parse::<Start>().unwrap_err().contains("known:2"), "{wrong}");
        }
    }
}
