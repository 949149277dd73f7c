//! `fieldwalk demo`: a simulated office is surveyed, and walked unseen.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::map::{BuildingMap, FloorIndex, FloorMap};
use fieldwalk::random::CounterRng;
use fieldwalk::survey::{SurveyParams, SurveyWalk, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk_formats::{FormatError, write_building, write_plan};
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_sim::scenario::Scenario;
use indicatif::ProgressBar;
use rand::Rng as _;
use rayon::prelude::*;

use crate::arguments::DemoArguments;
use crate::error_table::error_table;
use crate::evaluation::{Row, RowGroup, Start, TestWalk, WalkScore, record, score};
use crate::progress;
use crate::quoted::quoted;
use crate::report::{ErrorCurve, Report, Walk, page};
use crate::simulated::{test_walk, write_recording};
use crate::stop::Stop;

/// The data set's name in rows.
const DATASET: &str = "simulated office";
/// The floor's name, and the file's.
const FLOOR: &str = "F1";
/// By its name: the ground floor.
const ORDINAL: i32 = 0;
/// What a first look compares: no correction, a system of the papers that fits this office, and our own.
const SYSTEMS: [&str; 3] = ["dead-reckoning", "mass-centered", "fused"];
/// What systems are told of the start.
const START: Start = Start::Known { radius_m: 2.0 };
/// Test walks are at least this long, in metres.
const WALK_M: f64 = 130.0;
/// Scored once a second, the first time after this many.
const FIRST_SCORED_S: i64 = 5;

/// Surveys the office, writes its map and plan, scores every system on walks that the map has not seen.
pub fn run(arguments: &DemoArguments, out: &mut impl Write) -> Result<(), Stop> {
    let office = Scenario::office(arguments.seed);
    let (map_dir, plan_file) = (arguments.out.join("office.map"), arguments.out.join("office.geojson"));
    // First, for a folder that cannot be written should not cost a survey.
    save_plan(&office.building.plan, &arguments.out, &plan_file)?;
    let map = survey(&office)?;
    let mut building = BuildingMap { name: office.building.name.clone(), floors: vec![map] };
    write_building(&map_dir, &building)?;
    let floor = building.floors.remove(0);
    let recording = save_first_walk(&office, &arguments.out)?;
    let report_file = arguments.out.join("report.html");
    let (rows, report) = score_walks(&office, floor, arguments.walks);
    page::write(&report, &report_file)?;
    if arguments.json {
        for row in &rows {
            writeln!(out, "{}", serde_json::to_string(row)?)?;
        }
        return Ok(());
    }
    let FloorPlan { width_m, height_m, .. } = office.building.plan;
    writeln!(
        out,
        "{DATASET} of {width_m} × {height_m} m, seed {}, start {START}; errors in metres, once a second\n\n{}\n",
        arguments.seed,
        error_table(&rows.iter().collect::<Vec<_>>()).trim_fmt()
    )?;
    if let Some(recording) = recording {
        let (map, recording) = (quoted(&map_dir), quoted(&recording));
        writeln!(out, "To see the fixes of the first walk: fieldwalk replay {map} {recording}\n")?;
    }
    writeln!(
        out,
        "The walks play in {}: open it in a browser\nThe map is in {}, its plan in {}; next, map a floor of yours: fieldwalk survey --help",
        report_file.display(),
        map_dir.display(),
        plan_file.display()
    )?;
    Ok(())
}

fn save_plan(plan: &FloorPlan, dir: &Path, file: &Path) -> Result<(), FormatError> {
    fs::create_dir_all(dir).map_err(|error| FormatError::io("make the folder", dir, error))?;
    fs::write(file, write_plan(plan)).map_err(|error| FormatError::io("write the plan", file, error))
}

/// Saves the first of the walks that the map has not seen, with its waypoints.
fn save_first_walk(office: &Scenario, dir: &Path) -> Result<Option<PathBuf>, FormatError> {
    let Some(walk) = office.test_walks(1, WALK_M).pop() else { return Ok(None) };
    let path = dir.join(format!("{}.mcap", walk.name));
    write_recording(&office.simulate(&walk), &path)?;
    Ok(Some(path))
}

fn survey(office: &Scenario) -> Result<FloorMap, Stop> {
    let walks = office.survey_walks();
    let bar = progress::bar("survey walks", walks.len());
    let walks: Vec<SurveyWalk> = walks
        .par_iter()
        .map(|walk| {
            let walk = office.simulate(walk).survey_walk();
            bar.inc(1);
            walk
        })
        .collect();
    bar.finish_and_clear();
    build_floor(FLOOR, ORDINAL, &office.building.plan, &walks, &SurveyParams::default())
        .map_err(|error| Stop::Failed(format!("no map of the simulated walks: {error}")))
}

/// One row a system, and the page that plays the walks.
fn score_walks(office: &Scenario, floor: FloorMap, n_walks: u32) -> (Vec<Row>, Report) {
    let floor = Arc::new(FloorIndex::new(floor));
    let recipes: Vec<Recipe> = SYSTEMS.into_iter().filter_map(Recipe::named).collect();
    let walks: Vec<_> = (0..).zip(office.test_walks(n_walks.into(), WALK_M)).collect();
    let bar = progress::bar("walks that the map has not seen", walks.len() * recipes.len());
    let (scored, played): (Vec<Vec<WalkScore>>, Vec<Walk>) = walks
        .into_par_iter()
        .filter_map(|(k, walk)| {
            let name = walk.name.clone();
            let carry = carry_changes(&walk);
            let walk = test_walk(office.simulate(&walk), FIRST_SCORED_S)?;
            // All recordings begin at one instant, so the start is off by as much in all under one seed.
            let seed = CounterRng::new(office.seed, k).next_u64();
            let played = record(&floor, &recipes, START, seed, &walk, &name).with_changes("truly", &carry);
            Some((score_systems(&floor, &recipes, seed, &walk, &bar), played))
        })
        .unzip();
    bar.finish_and_clear();
    let start = START.to_string();
    let of_system = |k: usize| scored.iter().map(move |walk| &walk[k]).collect::<Vec<_>>();
    let rows_of = |(k, recipe): (usize, &Recipe)| {
        let group = RowGroup {
            dataset: DATASET,
            floor: FLOOR,
            system: &recipe.name,
            start: &start,
            n_walks: scored.len(),
            seeds: 1,
        };
        group.rows(&of_system(k))
    };
    let rows: Vec<Row> = recipes.iter().enumerate().flat_map(rows_of).collect();
    let (n, seed, start) = (scored.len(), office.seed, START.in_words());
    let about = format!("{n} walks that the map has not seen in a {DATASET}, seed {seed}; {start}");
    let systems = recipes.iter().map(|recipe| recipe.name.clone()).collect();
    let mut report = Report::new("Fieldwalk demo", about, systems);
    let curve_of = |(k, recipe): (usize, &Recipe)| ErrorCurve::of(&recipe.name, &of_system(k));
    report.set_errors(scored.len(), rows.clone(), recipes.iter().enumerate().filter_map(curve_of).collect());
    played.into_iter().for_each(|walk| report.add(&floor, FLOOR, walk));
    report.sort_worst_first();
    (rows, report)
}

/// How the phone is carried, from which second on.
fn carry_changes(walk: &fieldwalk_sim::scenario::Walk) -> Vec<(f64, String)> {
    let name = |mode| match mode {
        CarryMode::HeldLevel => "held level",
        CarryMode::HeldUpright => "held upright",
        CarryMode::HeldLandscape => "held across",
        CarryMode::HeldAskew => "held askew",
        CarryMode::AtEar => "at the ear",
        CarryMode::SwingingHand => "swinging hand",
        CarryMode::FrontPocket => "front pocket",
        CarryMode::BackPocket => "back pocket",
        CarryMode::Shaken => "shaken",
        CarryMode::OnTable => "on a table",
        _ => "other",
    };
    walk.carrying.iter().map(|&(from_s, mode)| (from_s, name(mode).to_owned())).collect()
}

fn score_systems(
    floor: &Arc<FloorIndex>,
    recipes: &[Recipe],
    seed: u64,
    walk: &TestWalk,
    bar: &ProgressBar,
) -> Vec<WalkScore> {
    let score_system = |recipe| {
        let scored = score(floor, recipe, START, seed, walk);
        bar.inc(1);
        scored
    };
    recipes.iter().map(score_system).collect()
}
