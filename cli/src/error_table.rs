//! The error table for people.

use comfy_table::Table;

use crate::evaluation::Row;
use crate::table::{number, table};

/// A line a row; a floor's name stands on its first line.
pub fn error_table(rows: &[&Row]) -> Table {
    let header = [
        "floor",
        "system",
        "walks",
        "points",
        "no fix",
        "median",
        "mean",
        "p80",
        "p90",
        "in 68 %",
        "in 95 %",
        "radius 68",
        "µs/step",
    ];
    let cells = rows.iter().enumerate().map(|(k, row)| {
        let is_repeated = k > 0 && rows[k - 1].floor == row.floor;
        vec![
            if is_repeated { String::new() } else { row.floor.clone() },
            row.system.clone(),
            row.n_walks.to_string(),
            row.n_points.to_string(),
            row.n_without_fix.to_string(),
            number(row.median_m, 2),
            number(row.mean_m, 2),
            number(row.p80_m, 2),
            number(row.p90_m, 2),
            number(100.0 * row.inside_68, 0),
            number(100.0 * row.inside_95, 0),
            number(row.radius_68_median_m, 2),
            number(row.step_us_median, 0),
        ]
    });
    table(&header, 2, cells)
}
