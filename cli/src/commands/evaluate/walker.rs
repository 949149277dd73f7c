//! `fieldwalk evaluate` on recordings of the walker's half: a row a subset, system and metric.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use fieldwalk_formats::FormatError;

use crate::arguments::EvaluateArguments;
use crate::stop::{Stop, note};
use crate::table::{number, table};
use crate::walker_evaluation::{MetricRow, MetricScores, Plot};

/// Scores with `score` and prints its rows.
pub fn run(
    score: impl Fn(&[PathBuf]) -> Result<MetricScores, FormatError>,
    arguments: &EvaluateArguments,
    out: &mut impl Write,
) -> Result<(), Stop> {
    let MetricScores { rows, plots, warnings, errors } = score(&arguments.dirs)?;
    for warning in &warnings {
        note("warning", warning);
    }
    for error in &errors {
        note("error", &error.to_string());
    }
    if let Some(folder) = &arguments.plots {
        write_plots(folder, &plots)?;
    }
    if arguments.json {
        for row in &rows {
            writeln!(out, "{}", serde_json::to_string(row)?)?;
        }
    } else {
        print_table(&rows, out)?;
    }
    if errors.is_empty() { Ok(()) } else { Err(Stop::Incomplete) }
}

fn write_plots(folder: &Path, plots: &[Plot]) -> Result<(), FormatError> {
    fs::create_dir_all(folder).map_err(|error| FormatError::io("make the folder", folder, error))?;
    for plot in plots {
        let path = folder.join(&plot.file_name);
        fs::write(&path, &plot.svg).map_err(|error| FormatError::io("write the picture", &path, error))?;
    }
    Ok(())
}

fn print_table(rows: &[MetricRow], out: &mut impl Write) -> Result<(), Stop> {
    let cells = rows.iter().enumerate().map(|(k, row)| {
        let is_repeated = k > 0 && rows[k - 1].subset == row.subset;
        vec![
            if is_repeated { String::new() } else { row.subset.clone() },
            row.system.clone(),
            row.metric.name().to_owned(),
            number(row.value, 2),
            row.n.to_string(),
        ]
    });
    let table = table(&["subset", "system", "metric", "value", "n"], 3, cells);
    Ok(writeln!(out, "{}", table.trim_fmt())?)
}
