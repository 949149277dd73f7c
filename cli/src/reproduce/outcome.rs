//! A claim as it was found: one row of the table.

use serde::Serialize;

use crate::reproduce::{Claim, Estimate, Finding, Paper, Part};

/// A claim with what was measured and whether it holds. Numbers that do not exist are NaN, in JSON null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The claim's id.
    pub id: &'static str,
    /// Where it is from.
    pub paper: Paper,
    /// In words.
    pub claim: &'static str,
    /// The unit of the values.
    pub unit: &'static str,
    /// The paper's value.
    pub paper_value: Option<f64>,
    /// Ours: of the first part that fails, else of the first.
    pub ours: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether every part passes its test.
    pub holds: bool,
    /// Where it fails, why, as far as is known.
    pub cause: Option<String>,
    /// Number of seeds behind it.
    pub seeds: usize,
    /// All of the claim's parts; empty when nothing was measured.
    pub parts: Vec<PartOutcome>,
}

/// A part of a claim with what was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartOutcome {
    /// What it is about; empty where the claim says it.
    pub what: &'static str,
    /// What it must pass, in words.
    pub test: String,
    /// Ours.
    pub ours: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it passes.
    pub holds: bool,
}

impl Outcome {
    /// `claim` judged by `finding`; nothing measured is nothing shown.
    pub fn of(claim: &Claim, finding: Option<&Finding>) -> Self {
        let estimates = finding.map_or(&[][..], |finding| &finding.estimates);
        let parts: Vec<PartOutcome> = claim
            .parts
            .iter()
            .zip(estimates)
            .map(|(part, estimate)| PartOutcome::of(part, estimate))
            .collect();
        let holds =
            !parts.is_empty() && parts.len() == claim.parts.len() && parts.iter().all(|part| part.holds);
        let shown = parts.iter().find(|part| !part.holds).or(parts.first());
        let needs_interval = claim.parts.iter().any(|part| part.test.needs_interval());
        let cause = match finding {
            None => Some("nothing measures it yet".to_owned()),
            Some(_) if parts.len() != claim.parts.len() => Some("not every part was measured".to_owned()),
            Some(finding) if needs_interval && finding.n_seeds < 2 => {
                Some("one seed gives no interval: ask for more".to_owned())
            }
            Some(finding) if finding.likely_cause.is_empty() => Some("not known".to_owned()),
            Some(finding) => Some(finding.likely_cause.clone()),
        };
        Self {
            id: claim.id,
            paper: claim.paper,
            claim: claim.text,
            unit: claim.unit,
            paper_value: claim.paper_value,
            ours: shown.map_or(f64::NAN, |part| part.ours),
            low: shown.map_or(f64::NAN, |part| part.low),
            high: shown.map_or(f64::NAN, |part| part.high),
            holds,
            cause: cause.filter(|_| !holds),
            seeds: finding.map_or(0, |finding| finding.n_seeds),
            parts,
        }
    }

    /// Whether something was measured for it.
    pub fn is_measured(&self) -> bool {
        !self.parts.is_empty()
    }
}

impl PartOutcome {
    fn of(part: &Part, estimate: &Estimate) -> Self {
        let Estimate { value, low, high } = *estimate;
        Self {
            what: part.what,
            test: part.test.to_string(),
            ours: value,
            low,
            high,
            holds: part.test.holds(estimate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::Test;

    const CLAIM: Claim = Claim {
        id: "a-b",
        paper: Paper::Song,
        text: "b between a and 2",
        unit: "m",
        paper_value: None,
        parts: &[
            Part { what: "b", test: Test::AtMost(2.0) },
            Part { what: "b − a", test: Test::IntervalAbove(0.0) },
        ],
    };

    fn finding(estimates: &[[f64; 3]]) -> Finding {
        let estimates: Vec<Estimate> =
            estimates.iter().map(|&[value, low, high]| Estimate { value, low, high }).collect();
        Finding::new("a-b", 5, estimates).because("chance")
    }

    #[test]
    fn a_claim_holds_when_all_its_parts_do_and_shows_the_part_that_fails() {
        let held = Outcome::of(&CLAIM, Some(&finding(&[[1.5, 1.4, 1.6], [0.3, 0.1, 0.5]])));
        assert!(held.holds && held.cause.is_none() && (held.ours, held.seeds) == (1.5, 5), "{held:?}");
        let failed = Outcome::of(&CLAIM, Some(&finding(&[[1.5, 1.4, 1.6], [0.3, -0.1, 0.5]])));
        assert!(
            !failed.holds && failed.ours == 0.3 && failed.cause.as_deref() == Some("chance"),
            "{failed:?}"
        );
        assert_eq!(failed.parts.iter().map(|part| part.holds).collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn what_was_not_measured_does_not_hold() {
        let missing = Outcome::of(&CLAIM, None);
        assert!(!missing.holds && !missing.is_measured() && missing.cause.is_some());
        assert!(serde_json::to_value(&missing).unwrap()["ours"].is_null());
        let half = Outcome::of(&CLAIM, Some(&finding(&[[1.5, 1.4, 1.6]])));
        assert!(!half.holds && half.cause.unwrap().contains("part"));
    }
}
