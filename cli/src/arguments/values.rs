//! Arguments with a syntax of their own.

use std::str::FromStr;

use fieldwalk::geometry::Point2;

use crate::floors::Layout;

/// More seeds than this are a slip of the finger.
const MAX_SEEDS: u64 = 1_000;

/// Random seeds, in the order given, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seeds(pub Vec<u64>);

impl FromStr for Seeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected seeds such as `1..5` (1 and 5 included), `7` or `1,4,9..12`";
        let number =
            |text: &str| text.trim().parse::<u64>().map_err(|_| format!("`{text}` is no seed: {expected}"));
        let mut seeds = Vec::new();
        for part in text.split(',') {
            let (first, last) = match part.split_once("..") {
                Some((first, last)) => (number(first)?, number(last)?),
                None => (number(part)?, number(part)?),
            };
            if first > last {
                return Err(format!("`{part}` is empty: {expected}"));
            }
            if last - first >= MAX_SEEDS - seeds.len() as u64 {
                return Err(format!("more than {MAX_SEEDS} seeds: give fewer"));
            }
            seeds.extend(first..=last);
        }
        let mut sorted = seeds.clone();
        sorted.sort_unstable();
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("seed {} is given twice: each would count double", pair[0])),
            None => Ok(Self(seeds)),
        }
    }
}

impl FromStr for Layout {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        [Self::Ilc, Self::Recordings, Self::UjiMag]
            .into_iter()
            .find(|layout| layout.name() == text)
            .ok_or_else(|| "expected `recordings`, `ilc` or `uji-mag`".into())
    }
}

/// What a replayed system is told of the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReplayStart {
    /// The recording's first waypoint.
    Waypoint,
    /// Nothing.
    Cold,
    /// A place in the floor frame.
    At(Point2),
}

impl FromStr for ReplayStart {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "waypoint" => return Ok(Self::Waypoint),
            "cold" => return Ok(Self::Cold),
            _ => {}
        }
        let point = text.split_once(',').and_then(|(x, y)| {
            Some(Point2::new(x.trim().parse().ok()?, y.trim().parse().ok()?))
                .filter(|point| point.is_finite())
        });
        point
            .map(Self::At)
            .ok_or_else(|| "expected `waypoint`, `cold`, or a place in metres such as `12.5,40`".into())
    }
}

/// A radius in metres, as a position hint takes it.
pub fn radius_m(text: &str) -> Result<f64, String> {
    let radius = text.parse().ok().filter(|radius_m| (0.1..=1_000.0).contains(radius_m));
    radius.ok_or_else(|| "expected metres from 0.1 to 1000".into())
}

/// A share in percent.
pub fn percent(text: &str) -> Result<f64, String> {
    let percent = text.parse().ok().filter(|percent| (0.0..=100.0).contains(percent));
    percent.ok_or_else(|| "expected percent from 0 to 100".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_inclusive_ranges_and_lists() {
        let seeds = |text: &str| text.parse::<Seeds>().map(|seeds| seeds.0);
        assert_eq!(seeds("1..5").unwrap(), [1, 2, 3, 4, 5]);
        assert_eq!(seeds("7").unwrap(), [7]);
        assert_eq!(seeds("3..3,1, 9..10").unwrap(), [3, 1, 9, 10]);
        assert_eq!(seeds(&format!("{0}..{0}", u64::MAX)).unwrap(), [u64::MAX]);
        assert_eq!(seeds("1..1000").unwrap().len(), 1_000);
        for (wrong, why) in [
            ("", "no seed"),
            ("1..", "no seed"),
            ("..5", "no seed"),
            ("a", "no seed"),
            ("-1", "no seed"),
            ("1,,2", "no seed"),
            ("5..1", "empty"),
            ("1..3,2", "twice"),
            ("1..1001", "1000"),
            ("0..18446744073709551615", "1000"),
            ("1..999,2000..2002", "1000"),
        ] {
            let message = seeds(wrong).unwrap_err();
            assert!(message.contains(why), "{wrong}: {message}");
        }
    }

    #[test]
    fn a_replay_starts_at_a_waypoint_a_place_or_nowhere() {
        let start = |text: &str| text.parse::<ReplayStart>();
        assert_eq!(start("waypoint"), Ok(ReplayStart::Waypoint));
        assert_eq!(start("cold"), Ok(ReplayStart::Cold));
        assert_eq!(start("-1.5,40"), Ok(ReplayStart::At(Point2::new(-1.5, 40.0))));
        for wrong in ["", "12", "1,", "1,2,3", "nan,1", "inf,0", "warm"] {
            assert!(start(wrong).unwrap_err().contains("12.5,40"), "{wrong}");
        }
    }

    #[test]
    fn a_radius_is_what_a_hint_takes() {
        assert_eq!(radius_m("0.1"), Ok(0.1));
        assert!(["0", "-1", "1001", "nan", ""].iter().all(|text| radius_m(text).is_err()));
    }
}
