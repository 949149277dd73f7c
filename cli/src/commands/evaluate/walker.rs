//! `fieldwalk evaluate` on recordings of the walker's half: a row a subset, system and metric.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use fieldwalk_formats::FormatError;

use crate::arguments::EvaluateArguments;
use crate::floors::Layout;
use crate::stop::{Stop, note};
use crate::table::{number, table};
use crate::walker_evaluation::oxford_steps::{self, CountedRun};
use crate::walker_evaluation::segments;
use crate::walker_evaluation::step_strips::step_strips;
use crate::walker_evaluation::{MetricRow, MetricScores, Plot};

/// Scores step detectors, and pictures the walks that they miscounted if asked to.
pub fn run_oxford_steps(arguments: &EvaluateArguments, out: &mut impl Write) -> Result<(), Stop> {
    let score = |dirs: &[PathBuf]| {
        let counted = oxford_steps::count(dirs)?;
        let plots = match &arguments.plots {
            Some(_) => pictures(&counted.runs, arguments.plot_errors_over)?,
            None => Vec::new(),
        };
        Ok(MetricScores { plots, ..counted.into_scores() })
    };
    run(score, arguments, out)
}

/// Scores step lengths between waypoints.
pub fn run_segments(arguments: &EvaluateArguments, layout: Layout, out: &mut impl Write) -> Result<(), Stop> {
    run(|dirs| segments::score(dirs, layout), arguments, out)
}

fn pictures(runs: &[CountedRun], least_percent: f64) -> Result<Vec<Plot>, FormatError> {
    let miscounted = runs.iter().filter(|run| run.signed_error_percent(0).abs() > least_percent);
    miscounted
        .map(|run| Ok(Plot { file_name: format!("{}.svg", run.run.name), svg: step_strips(run)? }))
        .collect()
}

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
