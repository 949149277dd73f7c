//! `fieldwalk reproduce`: the papers' claims measured and judged.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use fieldwalk_formats::FormatError;
use serde::Deserialize;

use crate::arguments::{PaperChoice, ReproduceArguments};
use crate::probe;
use crate::reproduce::{Outcome, Paper, Run, claims::CLAIMS, page, reproduce};
use crate::stop::{Stop, note};
use crate::table::{number, table};

/// A larger list of claims is none, in bytes.
const MAX_CLAIMS_BYTES: u64 = 1_000_000;

/// A claim in a file of claims; whatever else it says of a claim is for people.
#[derive(Debug, Deserialize)]
struct ListedClaim {
    id: String,
    paper: Option<String>,
}

/// Measures the claims of the papers asked for and prints a row for each.
pub fn run(arguments: &ReproduceArguments, out: &mut impl Write) -> Result<(), Stop> {
    let papers = papers(arguments.paper);
    if let Some(unknown) = arguments.only.iter().find(|id| CLAIMS.iter().all(|claim| claim.id != **id)) {
        return Err(Stop::Usage(format!("no claim is called `{unknown}`: see the ids that --json prints")));
    }
    let of_other = CLAIMS
        .iter()
        .find(|claim| !papers.contains(&claim.paper) && arguments.only.iter().any(|id| claim.id == *id));
    if let Some(claim) = of_other {
        let paper = claim.paper;
        return Err(Stop::Usage(format!(
            "{} is a claim of {paper}: ask for it with `fieldwalk reproduce {paper} --only {}`",
            claim.id, claim.id
        )));
    }
    // First, for a list that cannot be read or a page that cannot be written should not cost minutes.
    let listed = arguments.claims.as_deref().map(read_claims).transpose()?.unwrap_or_default();
    if let Some(file) = &arguments.report {
        probe::writable("write the page", file)?;
    }
    let began = Instant::now();
    let reproduction =
        reproduce(&papers, &arguments.only, &arguments.seeds.map_or_else(Run::complete, Run::with_seeds));
    let seconds = began.elapsed().as_secs_f64();
    let outcomes = &reproduction.outcomes;
    if arguments.json {
        for outcome in outcomes {
            writeln!(out, "{}", serde_json::to_string(outcome)?)?;
        }
    } else {
        print_table(outcomes, out)?;
    }
    let n_holding = outcomes.iter().filter(|outcome| outcome.holds).count();
    let n_failed = outcomes.len() - n_holding;
    let counted = format!("{n_holding} of {} claims hold; measured in {seconds:.0} s", outcomes.len());
    if !arguments.json {
        writeln!(out, "\n{counted}")?;
    }
    if let Some(file) = &arguments.report {
        page::write(&reproduction, &about(arguments), file)?;
        note("note", &format!("{} shows the claims and their plots: open it in a browser", file.display()));
    }
    let missing = missing(&listed, &papers, outcomes, arguments.only.is_empty());
    if !missing.is_empty() {
        return Err(Stop::Failed(format!("nothing measures these claims: {}", missing.join(", "))));
    }
    if arguments.strict && n_failed > 0 {
        note("error", &counted);
        return Err(Stop::Incomplete);
    }
    Ok(())
}

fn papers(choice: PaperChoice) -> Vec<Paper> {
    match choice {
        PaperChoice::Kwak2018 => vec![Paper::Kwak2018],
        PaperChoice::MassCentered => vec![Paper::MassCentered],
        PaperChoice::Ibill => vec![Paper::Ibill],
        PaperChoice::Wila => vec![Paper::Wila],
        PaperChoice::Song => vec![Paper::Song],
        PaperChoice::All => Paper::ALL.to_vec(),
    }
}

fn about(arguments: &ReproduceArguments) -> String {
    let seeds = match arguments.seeds {
        Some(n) => format!("At most {n} seeds each."),
        None => String::new(),
    };
    format!("Made by fieldwalk {}. {seeds}", env!("CARGO_PKG_VERSION"))
}

fn read_claims(path: &Path) -> Result<Vec<ListedClaim>, FormatError> {
    let failed = |error| FormatError::io("read the claims", path, error);
    let length = fs::metadata(path).map_err(failed)?.len();
    let remedy = "give a JSON array of objects, each with an `id` and a `paper`";
    if length > MAX_CLAIMS_BYTES {
        return Err(FormatError::malformed("more than a list of claims holds", remedy).at_path(path));
    }
    let text = fs::read_to_string(path).map_err(failed)?;
    serde_json::from_str(&text)
        .map_err(|error| FormatError::malformed(format!("no list of claims: {error}"), remedy).at_path(path))
}

/// The listed claims of `papers` for which nothing was measured; a claim that names no known paper is of all.
fn missing<'a>(
    listed: &'a [ListedClaim],
    papers: &[Paper],
    outcomes: &[Outcome],
    is_complete: bool,
) -> Vec<&'a str> {
    let is_of_other =
        |name: &str| Paper::ALL.iter().any(|paper| paper.name() == name && !papers.contains(paper));
    let is_asked = |claim: &&ListedClaim| {
        !claim.paper.as_deref().is_some_and(is_of_other)
            && (is_complete || outcomes.iter().any(|outcome| outcome.id == claim.id))
    };
    let is_measured = |id: &str| outcomes.iter().any(|outcome| outcome.id == id && outcome.is_measured());
    listed.iter().filter(is_asked).map(|claim| claim.id.as_str()).filter(|id| !is_measured(id)).collect()
}

fn print_table(outcomes: &[Outcome], out: &mut impl Write) -> Result<(), Stop> {
    let header = ["claim", "part", "test", "paper", "ours", "95 % interval", "seeds", "holds"];
    let mut rows: Vec<Vec<String>> = Vec::new();
    for outcome in outcomes {
        let paper_value = outcome.paper_value.map_or(String::new(), |value| number(value, 2));
        let verdict = |holds: bool| if holds { "yes" } else { "FAILED" }.to_owned();
        if outcome.parts.is_empty() {
            let blank = String::new;
            rows.push(vec![
                outcome.id.into(),
                blank(),
                blank(),
                paper_value,
                number(f64::NAN, 2),
                blank(),
                outcome.seeds.to_string(),
                verdict(false),
            ]);
            continue;
        }
        for (k, part) in outcome.parts.iter().enumerate() {
            rows.push(vec![
                if k == 0 { outcome.id.into() } else { String::new() },
                part.what.into(),
                part.test.clone(),
                if k == 0 { paper_value.clone() } else { String::new() },
                number(part.ours, 2),
                page::interval(part.low, part.high),
                outcome.seeds.to_string(),
                verdict(part.holds),
            ]);
        }
    }
    writeln!(out, "{}", table(&header, 3, rows).trim_fmt())?;
    let failed: Vec<&Outcome> = outcomes.iter().filter(|outcome| !outcome.holds).collect();
    if !failed.is_empty() {
        writeln!(out, "\nFailed, with the likely cause:")?;
    }
    for outcome in failed {
        let cause = outcome.cause.as_deref().unwrap_or("not known");
        writeln!(out, "  {} ({}): {cause}", outcome.id, outcome.claim)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn listed_claims_of_the_papers_asked_for_must_be_measured() {
        let listed: Vec<ListedClaim> = serde_json::from_str(
            r#"[{"id": "song-nn", "paper": "song", "test": "x"}, {"id": "mc-80", "paper": "mass-centered"}, {"id": "new"}]"#,
        )
        .unwrap();
        let song = |is_complete| missing(&listed, &[Paper::Song], &[], is_complete);
        assert_eq!(song(true), ["song-nn", "new"]);
        assert!(song(false).is_empty());
        assert_eq!(missing(&listed, &Paper::ALL, &[], true), ["song-nn", "mc-80", "new"]);
    }
}
