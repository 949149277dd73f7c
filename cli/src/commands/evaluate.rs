//! `fieldwalk evaluate`: systems compared on recordings with known places.

mod options;
mod played;
mod recipe_file;
mod table_file;
mod walker;

use std::io::Write;

use fieldwalk::survey::SurveyParams;
use fieldwalk::system::Recipe;
use fieldwalk_formats::FormatError;
use rayon::prelude::*;

use crate::arguments::{Dataset, EvaluateArguments};
use crate::error_table::error_table;
use crate::evaluation::{Evaluation, FloorScores, PointKind, Row};
use crate::floors::{Floor, FoundFloor, Layout, find_floors};
use crate::report::page;
use crate::stop::{Stop, note};
use crate::walker_evaluation;
use crate::{probe, progress};

/// The name under which all floors are pooled.
const ALL: &str = "all";

/// Scores what the data set is for and prints the rows.
pub fn run(arguments: &EvaluateArguments, out: &mut impl Write) -> Result<(), Stop> {
    options::check(arguments)?;
    match arguments.dataset {
        None if arguments.lengths => walker::run_segments(arguments, Layout::of(&arguments.dirs), out),
        Some(Dataset::Ilc) if arguments.lengths => walker::run_segments(arguments, Layout::Ilc, out),
        Some(Dataset::Recordings) if arguments.lengths => {
            walker::run_segments(arguments, Layout::Recordings, out)
        }
        Some(Dataset::UjiMag) if arguments.lengths => walker::run_segments(arguments, Layout::UjiMag, out),
        None => score_systems(arguments, Layout::of(&arguments.dirs), out),
        Some(Dataset::Ilc) => score_systems(arguments, Layout::Ilc, out),
        Some(Dataset::Recordings) => score_systems(arguments, Layout::Recordings, out),
        Some(Dataset::UjiMag) => score_systems(arguments, Layout::UjiMag, out),
        Some(Dataset::OxfordSteps) => walker::run_oxford_steps(arguments, out),
        Some(Dataset::BleAnnotated) => walker::run(walker_evaluation::ble_annotated::score, arguments, out),
        Some(Dataset::Tyrex) => {
            let table = arguments.table.as_deref().map(table_file::read).transpose()?;
            walker::run(|dirs| walker_evaluation::tyrex::score(dirs, table), arguments, out)
        }
    }
}

fn score_systems(arguments: &EvaluateArguments, layout: Layout, out: &mut impl Write) -> Result<(), Stop> {
    if let Some(name) = &arguments.print_recipe {
        return Ok(writeln!(out, "{}", serde_json::to_string_pretty(&named(name)?)?)?);
    }
    let evaluation = Evaluation {
        recipes: recipes(arguments)?,
        start: arguments.start,
        seeds: arguments.seeds.0.clone(),
        folds: arguments.chosen_folds(),
        survey: SurveyParams::default(),
    };
    let found = find_floors(&arguments.dirs, layout)?;
    if let Some(file) = &arguments.page.report {
        probe::writable(page::ACTION, file)?;
    }
    let (scores, n_failed) = score_floors(&evaluation, &found, layout);
    let rows = all_rows(&evaluation, layout.name(), &scores);
    if arguments.json {
        for row in &rows {
            writeln!(out, "{}", serde_json::to_string(row)?)?;
        }
    } else {
        print_tables(&rows, scores.len() > 1, out)?;
    }
    if let Some(file) = &arguments.page.report {
        let n_walks = arguments.page.walks as usize;
        page::write(&played::report(&evaluation, &scores, &rows, n_walks)?, file)?;
        note("note", &format!("{} plays the worst walks: open it in a browser", file.display()));
    }
    if n_failed > 0 {
        note(
            "error",
            &format!("{n_failed} of {} floors could not be evaluated and count nowhere", found.len()),
        );
        return Err(Stop::Incomplete);
    }
    if rows.is_empty() {
        let dirs: Vec<_> = arguments.dirs.iter().map(|dir| dir.display().to_string()).collect();
        let folds: Vec<_> = evaluation.folds.iter().map(u8::to_string).collect();
        let has_test_folder = scores.iter().all(|(_, floor)| floor.has_test_folder);
        let place = if has_test_folder { "test/".into() } else { format!("fold {}", folds.join(", ")) };
        let remedy = remedy_of_none(has_test_folder);
        let dirs = dirs.join(", ");
        return Err(Stop::Failed(format!("{dirs}: no test walk with two waypoints in {place} ({remedy})")));
    }
    Ok(())
}

/// What to do about a floor without test walks.
fn remedy_of_none(has_test_folder: bool) -> &'static str {
    match has_test_folder {
        true => "put walks into its folder test/, or remove that to test with folds",
        false => "give another --fold, --folds 4, or more walks",
    }
}

/// The systems asked for, each once, and those from files.
fn recipes(arguments: &EvaluateArguments) -> Result<Vec<Recipe>, Stop> {
    let is_asked =
        |name: &&str| arguments.systems.is_empty() || arguments.systems.iter().any(|asked| asked == name);
    let mut recipes = Recipe::NAMES
        .iter()
        .filter(|name| is_asked(name))
        .map(|name| named(name))
        .collect::<Result<Vec<_>, _>>()?;
    for path in &arguments.recipes {
        let recipe = recipe_file::read(path)?;
        let is_taken = |name: &str| name == recipe.name;
        if Recipe::NAMES.into_iter().any(is_taken) || recipes.iter().any(|known| is_taken(&known.name)) {
            return Err(FormatError::malformed(
                format!("there is another system called `{}`", recipe.name),
                "change the recipe's `name`",
            )
            .at_path(path)
            .into());
        }
        recipes.push(recipe);
    }
    if arguments.with_plan {
        for recipe in &mut recipes {
            let with_plan = recipe.clone().with_plan();
            if with_plan != *recipe {
                *recipe = Recipe { name: format!("{}+plan", recipe.name), ..with_plan };
            }
        }
    }
    Ok(recipes)
}

fn named(name: &str) -> Result<Recipe, Stop> {
    let unknown =
        || Stop::Usage(format!("no system is called `{name}`: there are {}", Recipe::NAMES.join(", ")));
    Recipe::named(name).ok_or_else(unknown)
}

/// Scores the floors side by side; says on standard error what could not be scored, and counts the floors that failed.
fn score_floors(
    evaluation: &Evaluation,
    found: &[FoundFloor],
    layout: Layout,
) -> (Vec<(String, FloorScores)>, usize) {
    let floors: Vec<_> = found.iter().map(|found| (found, Floor::open(&found.dir, layout))).collect();
    let n_ticks = floors.iter().flat_map(|(_, floor)| floor).map(|floor| evaluation.n_ticks(floor)).sum();
    let bar = progress::bar("walks", n_ticks);
    let scored: Vec<_> = floors
        .into_par_iter()
        .map(|(found, floor)| {
            let scores = floor.and_then(|floor| evaluation.score_floor(&floor, || bar.inc(1)));
            (found, scores.map_err(|error| located(error, found)))
        })
        .collect();
    bar.finish_and_clear();
    let mut scores = Vec::new();
    let mut n_failed = 0;
    for (FoundFloor { label, .. }, outcome) in scored {
        match outcome {
            Ok(floor) => {
                warn(label, &floor);
                scores.push((label.clone(), floor));
            }
            Err(error) => {
                note("error", &format!("floor {label}: {error}"));
                n_failed += 1;
            }
        }
    }
    (scores, n_failed)
}

fn located(error: FormatError, found: &FoundFloor) -> FormatError {
    if error.path().is_some() { error } else { error.at_path(&found.dir) }
}

fn warn(label: &str, scores: &FloorScores) {
    for path in &scores.without_waypoints {
        note("warning", &format!("{}: no two waypoints, so nothing to score", path.display()));
    }
    for (path, name) in &scores.of_other_floors {
        let message = "left out, as it was recorded on another floor";
        note("warning", &format!("{}: {message}, {name} (move it to that floor's folder)", path.display()));
    }
    if scores.of_other_floors.len() > 1 {
        let n = scores.of_other_floors.len();
        note("warning", &format!("floor {label}: {n} walks of other floors were left out"));
    }
    if scores.n_walks() == 0 {
        let remedy = remedy_of_none(scores.has_test_folder);
        note("warning", &format!("floor {label}: no test walk ({remedy})"));
    }
    if scores.n_starts_refused() > 0 {
        let n = scores.n_starts_refused();
        note(
            "warning",
            &format!("floor {label}: {n} test walks start off the plan and were scored without a start"),
        );
    }
}

/// The rows of each floor, then of all.
fn all_rows(evaluation: &Evaluation, dataset: &str, scores: &[(String, FloorScores)]) -> Vec<Row> {
    let per_floor = scores.iter().flat_map(|(label, floor)| evaluation.rows(dataset, label, &[floor]));
    let pooled: Vec<&FloorScores> = scores.iter().map(|(_, floor)| floor).collect();
    per_floor.chain(evaluation.rows(dataset, ALL, &pooled)).collect()
}

/// One table per kind of point; the pooled rows only where there are several floors.
fn print_tables(rows: &[Row], has_several_floors: bool, out: &mut impl Write) -> Result<(), Stop> {
    let Some(first) = rows.first() else { return Ok(()) };
    let seeds = if first.seeds == 1 { "seed" } else { "seeds" };
    writeln!(out, "{}, start {}, {} {seeds}; errors in metres", first.dataset, first.start, first.seeds)?;
    for (kind, title) in [
        (PointKind::Waypoint, "At waypoints"),
        (PointKind::Midpoint, "Midway between waypoints"),
        (PointKind::CutOff, "At cut-offs"),
    ] {
        let shown = |row: &&Row| row.points == kind && (has_several_floors || row.floor != ALL);
        let shown: Vec<&Row> = rows.iter().filter(shown).collect();
        if shown.is_empty() && kind == PointKind::CutOff {
            continue;
        }
        writeln!(out, "\n{title}\n{}", error_table(&shown).trim_fmt())?;
    }
    Ok(())
}
