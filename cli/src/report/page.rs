//! A report as one HTML file: style, script and figures stand in it, and it may fetch nothing.

use std::fs;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use fieldwalk_formats::FormatError;
use sha2::{Digest, Sha256};

use crate::report::Report;

const TEMPLATE: &str = include_str!("../../assets/report/page.html");
const STYLE: &str = include_str!("../../assets/report/style.css");
/// In order: each part uses those before it.
const SCRIPT: [&str; 7] = [
    include_str!("../../assets/report/model.js"),
    include_str!("../../assets/report/colours.js"),
    include_str!("../../assets/report/map.js"),
    include_str!("../../assets/report/charts.js"),
    include_str!("../../assets/report/touch.js"),
    include_str!("../../assets/report/controls.js"),
    include_str!("../../assets/report/page.js"),
];

/// What errors say could not be done.
pub const ACTION: &str = "write the report";

/// Writes `report` into `file`, replacing what is there.
///
/// # Errors
/// When the file cannot be written.
pub fn write(report: &Report, file: &Path) -> Result<(), FormatError> {
    let failed = |error| FormatError::io(ACTION, file, error);
    let html = html(report).map_err(|error| failed(error.into()))?;
    fs::write(file, html).map_err(failed)
}

/// The page.
fn html(report: &Report) -> Result<String, serde_json::Error> {
    // A checkout may end its lines as Windows does; a browser undoes that before it compares digests.
    let style = STYLE.replace("\r\n", "\n");
    let script = format!("\"use strict\";\n(() => {{\n{}}})();\n", SCRIPT.join("\n").replace("\r\n", "\n"));
    // Only this script and this style may run: whatever a name smuggles in would have another digest.
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'",
        digest(&script),
        digest(&style)
    );
    let parts = [
        ("POLICY", policy),
        ("TITLE", escape_text(&report.title)),
        ("STYLE", style),
        ("SCRIPT", script),
        ("FIGURES", escape_json(&serde_json::to_string(report)?)),
    ];
    // In one pass: a part may hold what looks like a slot.
    let mut html =
        String::with_capacity(parts.iter().map(|part| part.1.len()).sum::<usize>() + TEMPLATE.len());
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        html.push_str(before);
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        html.extend(parts.iter().filter(|part| part.0 == name).map(|part| part.1.as_str()));
        rest = after;
    }
    html.push_str(rest);
    Ok(html)
}

fn digest(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// JSON that may stand in a `script` element: nothing in it can end the element.
fn escape_json(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

fn escape_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(html: &str) -> serde_json::Value {
        let (_, rest) = html.split_once("id=\"figures\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn no_name_ends_its_element() {
        let evil = "</script><script>alert(1)</script><!-- & \" {{SCRIPT}}";
        let html = html(&Report::new(evil, evil, vec![evil.into()])).unwrap();
        assert!(!html.contains("alert(1)</script>"));
        assert_eq!(html.matches("</script>").count(), TEMPLATE.matches("</script>").count());
        let figures = figures(&html);
        assert_eq!((&figures["title"], &figures["systems"][0]), (&evil.into(), &evil.into()));
        assert!(html.contains("<title>&lt;/script&gt;"));
    }

    #[test]
    fn the_page_asks_for_nothing_outside_itself() {
        let html = html(&Report::new("walks", "", vec![])).unwrap();
        assert!(html.contains("default-src 'none'; script-src 'sha256-"));
        for fetched in
            ["http://", "https://", "@import", "url(", " src=\"", "fetch(", "XMLHttpRequest", "style=\""]
        {
            let allowed = if fetched == "http://" { html.matches("http://www.w3.org/").count() } else { 0 };
            assert_eq!(html.matches(fetched).count(), allowed, "{fetched}");
        }
        assert!(!html.contains("{{"), "a slot is left");
    }
}
