//! The page: one HTML file with every claim and the pictures, which fetches nothing and runs nothing.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use fieldwalk_formats::FormatError;

use crate::reproduce::{Outcome, Paper, PartOutcome, Reproduction};
use crate::table::number;

const TEMPLATE: &str = include_str!("../../assets/reproduce/page.html");
const STYLE: &str = include_str!("../../assets/reproduce/style.css");

/// Writes `reproduction` into `file`, replacing what is there; `about` says how it was made.
///
/// # Errors
/// When the file cannot be written.
pub fn write(reproduction: &Reproduction, about: &str, file: &Path) -> Result<(), FormatError> {
    fs::write(file, html(reproduction, about)).map_err(|error| FormatError::io("write the page", file, error))
}

/// The page.
fn html(reproduction: &Reproduction, about: &str) -> String {
    let mut body = String::new();
    for (paper, pictures) in &reproduction.pictures {
        let outcomes: Vec<&Outcome> =
            reproduction.outcomes.iter().filter(|outcome| outcome.paper == *paper).collect();
        section(&mut body, *paper, &outcomes);
        body.push_str("<div class=\"pictures\">\n");
        for picture in pictures {
            let caption = escape(&picture.caption);
            let _ = writeln!(body, "<figure>\n{}<figcaption>{caption}</figcaption>\n</figure>", picture.svg);
        }
        body.push_str("</div>\n</section>\n");
    }
    let holding = reproduction.outcomes.iter().filter(|outcome| outcome.holds).count();
    let summary = format!("{holding} of {} claims hold. {}", reproduction.outcomes.len(), escape(about));
    // One after the other: none of the parts before the last holds a slot.
    TEMPLATE.replace("{{STYLE}}", STYLE).replace("{{SUMMARY}}", &summary).replace("{{BODY}}", &body)
}

fn section(body: &mut String, paper: Paper, outcomes: &[&Outcome]) {
    let _ = writeln!(body, "<section id=\"{paper}\">\n<h2>{}</h2>", escape(paper.title()));
    body.push_str(
        "<table>\n<tr><th>claim</th><th class=\"number\">paper</th><th class=\"number\">ours</th>\
         <th class=\"number\">95 % interval</th><th>unit</th><th>test</th><th>holds</th></tr>\n",
    );
    for outcome in outcomes {
        for (k, part) in outcome.parts.iter().enumerate() {
            let what = if k == 0 { told(outcome, part) } else { escape(part.what) };
            row(body, outcome, &what, Some(part), k == 0);
        }
        if outcome.parts.is_empty() {
            row(body, outcome, &told_alone(outcome), None, true);
        }
        if let Some(cause) = &outcome.cause {
            let _ = writeln!(body, "<tr class=\"cause\"><td colspan=\"7\">{}</td></tr>", escape(cause));
        }
    }
    body.push_str("</table>\n");
}

fn told_alone(outcome: &Outcome) -> String {
    format!("<span class=\"id\">{}</span> {}", outcome.id, escape(outcome.claim))
}

fn told(outcome: &Outcome, part: &PartOutcome) -> String {
    let what = if part.what.is_empty() { String::new() } else { format!("<br>{}", escape(part.what)) };
    format!("{}{what}", told_alone(outcome))
}

fn row(body: &mut String, outcome: &Outcome, what: &str, part: Option<&PartOutcome>, is_first: bool) {
    let nothing = PartOutcome {
        what: "",
        test: String::new(),
        ours: f64::NAN,
        low: f64::NAN,
        high: f64::NAN,
        holds: false,
    };
    let part = part.unwrap_or(&nothing);
    let verdict = if part.holds { "yes" } else { "no" };
    let paper_value = match outcome.paper_value {
        Some(value) if is_first => number(value, 2),
        _ => String::new(),
    };
    let _ = writeln!(
        body,
        "<tr class=\"{verdict}{}\"><td>{what}</td><td class=\"number\">{paper_value}</td>\
         <td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td><td>{}</td><td>{verdict}</td></tr>",
        if is_first { " first" } else { "" },
        number(part.ours, 2),
        interval(part.low, part.high),
        escape(if is_first { outcome.unit } else { "" }),
        escape(&part.test),
    );
}

/// An interval for people; empty where it says no more than the value.
pub fn interval(low: f64, high: f64) -> String {
    if low == high || low.is_nan() {
        String::new()
    } else {
        format!("{} to {}", number(low, 2), number(high, 2))
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::{Claim, Estimate, Finding, Picture, Test, claims::CLAIMS};

    #[test]
    fn the_page_shows_every_claim_and_asks_for_nothing_outside_itself() {
        let evil = "<script>alert(1)</script>";
        let of = |claim: &Claim| {
            let estimates = vec![Estimate { value: -9.0, low: -10.0, high: -8.0 }; claim.parts.len()];
            Outcome::of(claim, Some(&Finding::new(claim.id, 3, estimates).because(evil)))
        };
        let outcomes: Vec<Outcome> = CLAIMS.iter().map(of).collect();
        let pictures =
            Paper::ALL.map(|paper| (paper, vec![Picture::of(evil, "<svg></svg>")])).into_iter().collect();
        let html = html(&Reproduction { outcomes, pictures }, evil);
        for claim in CLAIMS {
            assert!(html.contains(&format!(">{}<", claim.id)), "{}", claim.id);
        }
        assert!(!html.contains("<script") && !html.contains("{{"), "a slot or a script");
        assert_eq!(html.matches("<figure>").count(), 5);
        assert!(html.contains("-10.00 to -8.00") && html.contains(&escape(&Test::AtLeast(15.0).to_string())));
        for fetched in ["http://", "https://", "@import", "url(", " src=\""] {
            assert!(!html.contains(fetched), "{fetched}");
        }
    }
}
