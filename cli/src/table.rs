//! Tables for people.

use comfy_table::{CellAlignment, LineStyle, Table, TableStyle};

/// One line, below the header.
const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// A table with `header`; the first `n_labels` columns are text, the others numbers.
pub fn table(header: &[&str], n_labels: usize, rows: impl IntoIterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table.load_style(STYLE).set_header(header.to_vec()).add_rows(rows);
    for column in table.column_iter_mut().skip(n_labels) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// A number with `decimals` digits; a dash where there is none.
pub fn number(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "–".into() }
}
