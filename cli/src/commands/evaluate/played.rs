//! The page of an evaluation: its worst walks, played again, and the errors of all.

use fieldwalk::metrics::ErrorSummary;
use fieldwalk_formats::FormatError;
use rayon::prelude::*;

use super::ALL;
use crate::evaluation::{
    Evaluation, FloorScores, PointKind, ReadTest, Row, ScoredWalk, TestWalk, WalkScore, record,
};
use crate::report::{ErrorCurve, Report, Walk};

/// The report on `scores`, playing the `n_walks` worst walks.
///
/// A walk is as bad as the last system's mean error under its worst seed, which is the one that is played.
pub fn report(
    evaluation: &Evaluation,
    scores: &[(String, FloorScores)],
    rows: &[Row],
    n_walks: usize,
) -> Result<Report, FormatError> {
    let mut worst: Vec<(f64, u64, &str, &ScoredWalk)> = scores
        .iter()
        .flat_map(|(label, floor)| floor.walks.iter().map(move |walk| (label.as_str(), walk)))
        .map(|(label, walk)| {
            let (mean_m, seed) = worst_seed(evaluation, walk);
            (mean_m, seed, label, walk)
        })
        .collect();
    let n_all = worst.len();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    worst.truncate(n_walks);
    let played: Vec<Option<Walk>> = worst
        .par_iter()
        .map(|(_, seed, _, walk)| play(evaluation, walk, *seed))
        .collect::<Result<_, FormatError>>()?;
    let systems = evaluation.recipes.iter().map(|recipe| recipe.name.clone()).collect();
    let n_seeds = evaluation.seeds.len();
    let seeds = if n_seeds == 1 { "seed" } else { "seeds" };
    let about = format!(
        "{n_all} walks that the map has not seen, {}, {n_seeds} {seeds}; shown are the {} worst, each with its worst \
         seed",
        evaluation.start.in_words(),
        played.iter().flatten().count()
    );
    let labels: Vec<&str> = scores.iter().map(|(label, _)| label.as_str()).collect();
    let mut report = Report::new(format!("Evaluation: {}", labels.join(", ")), about, systems);
    let has_several = scores.len() > 1;
    let shown = rows.iter().filter(|row| has_several || row.floor != ALL).cloned().collect();
    report.set_errors(n_all, shown, curves(evaluation, scores));
    for ((_, _, label, scored), walk) in worst.iter().zip(played) {
        if let Some(walk) = walk {
            report.add(&scored.floor, label, walk);
        }
    }
    Ok(report)
}

fn worst_seed(evaluation: &Evaluation, walk: &ScoredWalk) -> (f64, u64) {
    let by_seed = walk.scores.last().into_iter().flatten().zip(&evaluation.seeds);
    let worst = by_seed.map(|(score, &seed)| (mean_m(score), seed)).max_by(|a, b| a.0.total_cmp(&b.0));
    worst.unwrap_or((f64::NEG_INFINITY, 0))
}

/// Mean error at waypoints; the least of all where nothing was scored.
fn mean_m(score: &WalkScore) -> f64 {
    let waypoints = score.points.iter().filter(|point| point.0 == PointKind::Waypoint);
    let fixes: Vec<_> = waypoints.filter_map(|point| point.1).collect();
    ErrorSummary::of(&fixes).map_or(f64::NEG_INFINITY, |summary| summary.mean_m)
}

fn play(evaluation: &Evaluation, walk: &ScoredWalk, seed: u64) -> Result<Option<Walk>, FormatError> {
    let name = walk.path.file_stem().unwrap_or_default().to_string_lossy();
    let map = walk.floor.map();
    let test = TestWalk::read(&walk.path, &map.name, map.plan.georeference, None)?;
    let ReadTest::Walk(test) = test else { return Ok(None) };
    Ok(Some(record(&walk.floor, &evaluation.recipes, evaluation.start, seed, &test, &name)))
}

fn curves(evaluation: &Evaluation, scores: &[(String, FloorScores)]) -> Vec<ErrorCurve> {
    let walks: Vec<&ScoredWalk> = scores.iter().flat_map(|(_, floor)| &floor.walks).collect();
    let of_system = |(k, recipe): (usize, &fieldwalk::system::Recipe)| {
        let scores: Vec<&WalkScore> = walks.iter().flat_map(|walk| &walk.scores[k]).collect();
        ErrorCurve::of(&recipe.name, &scores)
    };
    evaluation.recipes.iter().enumerate().filter_map(of_system).collect()
}
