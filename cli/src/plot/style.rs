//! The palette and the style sheet that all pictures share.

/// Colours of series, in order: Okabe and Ito's, which people with colour blindness tell apart, on white and on black.
pub const SERIES: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// Dashes of series, in order, so that lines differ in print without colour.
pub const DASHES: [&str; 6] = ["none", "7 3", "2 3", "9 3 2 3", "12 4", "5 2"];

/// A series' colour; colours repeat after the sixth.
pub fn colour(series: usize) -> &'static str {
    SERIES[series % SERIES.len()]
}

/// A series' dashes, as `stroke-dasharray`.
pub fn dash(series: usize) -> &'static str {
    DASHES[series % DASHES.len()]
}

/// Text, axes and grid on a light ground.
///
/// Every rule names a class of ours: a page that holds the picture within itself keeps its own style.
pub const SHEET: &str = "\
.fw-title,.fw-label,.fw-small{\
font-family:system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;fill:#24292f}\
.fw-title{font-size:15px;font-weight:600}\
.fw-label{font-size:12px}\
.fw-small{font-size:11px;fill:#57606a}\
.fw-ground{fill:#ffffff}\
.fw-grid{stroke:#d8dee4;stroke-width:1}\
.fw-axis{stroke:#57606a;stroke-width:1.2}\
.fw-line{fill:none;stroke-width:2;stroke-linejoin:round}\
.fw-dot{fill-opacity:.65}\
.fw-bar{fill-opacity:.85}\
.fw-box{fill-opacity:.3}";

/// What a dark ground changes, where the reader prefers that.
pub const DARK: &str = "\
@media (prefers-color-scheme:dark){\
.fw-title,.fw-label{fill:#e6edf3}\
.fw-small{fill:#9ea7b3}\
.fw-ground{fill:#0d1117}\
.fw-grid{stroke:#30363d}\
.fw-axis{stroke:#9ea7b3}}";

/// The sheet of charts, which follow the reader's setting.
pub fn chart_sheet() -> String {
    format!("{SHEET}{DARK}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::floor;

    #[test]
    fn no_rule_reaches_beyond_our_classes() {
        let sheet =
            format!("{}{}", chart_sheet(), floor::SHEET).replace("@media (prefers-color-scheme:dark){", "");
        let rules: Vec<&str> =
            sheet.split('}').filter_map(|rule| rule.split_once('{')).map(|(names, _)| names).collect();
        assert!(rules.len() > 15, "{rules:?}");
        for name in rules.iter().flat_map(|names| names.split(',')) {
            assert!(name.starts_with(".fw-"), "{name} in {sheet}");
        }
    }
}
