//! `fieldwalk survey`: walks become a building's map.

mod expected;
mod picture;
mod report;
mod walks;

use std::io::Write;
use std::path::Path;

use fieldwalk::map::{BuildingMap, FloorIndex, FloorMap};
use fieldwalk::metrics::{ErrorSummary, ScoredFix};
use fieldwalk::survey::{Coverage, SurveyParams, build_floor};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::{floor_ordinal, is_floor_name};
use fieldwalk_formats::map::write_building;

use crate::arguments::SurveyArguments;
use crate::floors::{Floor, FoundFloor, Layout, find_floors};
use crate::stop::{Stop, note};

use picture::Picture;
use report::FloorReport;
use walks::Walks;

/// Maps the floors, writes the building and its pictures, and prints what it is worth.
pub fn run(arguments: &SurveyArguments, out: &mut impl Write) -> Result<(), Stop> {
    let layout = arguments.layout.unwrap_or_else(|| Layout::of(&arguments.dirs));
    let found = find_floors(&arguments.dirs, layout)?;
    let floors = open_floors(&found, layout)?;
    let params = SurveyParams::default();
    let mut building = BuildingMap { name: building_name(arguments, &floors)?, floors: Vec::new() };
    let mut surveys = Vec::new();
    for (found, floor) in found.iter().zip(&floors) {
        let walks = Walks::read(floor, arguments.fold);
        let map = map_floor(found, floor, &walks, &params)?;
        building.floors.push(map);
        surveys.push(walks);
    }
    write_building(&arguments.out, &building)?;
    let files = report::floor_files(&arguments.out)?;
    let mut reports = Vec::new();
    for (map, walks) in building.floors.into_iter().zip(&surveys) {
        let scores =
            if arguments.no_expected_accuracy { Vec::new() } else { expected::scores(&map, walks, &params) };
        let fixes: Vec<ScoredFix> = scores.iter().map(|(_, fix)| *fix).collect();
        let expected = ErrorSummary::of(&fixes);
        let index = FloorIndex::new(map);
        let coverage = Coverage::of(&index);
        let file = files.iter().find(|file| file.name == index.map().name);
        let path =
            picture::path(&arguments.out, arguments.pictures.as_deref(), file.map_or("", |file| &file.file));
        Picture { building: &building.name, floor: &index, coverage, scores: &scores }.write(&path)?;
        reports.push(FloorReport::new(&index, coverage, walks, file, expected, path));
    }
    if arguments.json {
        for report in &reports {
            writeln!(out, "{}", serde_json::to_string(report)?)?;
        }
        return Ok(());
    }
    report::print(&building.name, &arguments.out, &reports, out)
}

/// Opens the floors, which must be of different names: a map tells floors apart by them.
fn open_floors(found: &[FoundFloor], layout: Layout) -> Result<Vec<Floor>, FormatError> {
    let mut floors: Vec<Floor> = Vec::new();
    for FoundFloor { dir, .. } in found {
        let floor = Floor::open(dir, layout)?;
        if floors.iter().any(|other| other.name == floor.name) {
            let message = format!("another floor is called {} as well", floor.name);
            return Err(FormatError::malformed(message, remedy_of_one_name(dir)).at_path(dir));
        }
        if let Some(other) =
            floors.iter().find(|other| floor_ordinal(&other.name) == floor_ordinal(&floor.name))
        {
            let ordinal = floor_ordinal(&floor.name);
            note(
                "warning",
                &format!("by their names, {} and {} are both floor number {ordinal}", other.name, floor.name),
            );
        }
        floors.push(floor);
    }
    Ok(floors)
}

/// What to do about floors of one name, the second of them in `dir`.
fn remedy_of_one_name(dir: &Path) -> &'static str {
    let name = dir.file_name().unwrap_or_default().to_string_lossy();
    match is_floor_name(&name) {
        true => "survey one building at a time",
        // Its folder has been taken for a building's.
        false => "call the folders of one building's floors F1, F2 …, or survey one building at a time",
    }
}

fn building_name(arguments: &SurveyArguments, floors: &[Floor]) -> Result<String, Stop> {
    if let Some(name) = &arguments.name {
        return Ok(name.clone());
    }
    let site = floors.first().map_or("", |floor| &floor.site);
    match floors.iter().find(|floor| floor.site != site) {
        None => Ok(site.into()),
        Some(other) => Err(Stop::Usage(format!(
            "floors of the buildings {site} and {} are given: survey one at a time, or give --name",
            other.site
        ))),
    }
}

fn map_floor(
    found: &FoundFloor,
    floor: &Floor,
    walks: &Walks,
    params: &SurveyParams,
) -> Result<FloorMap, Stop> {
    if walks.used.is_empty() {
        return Err(Stop::Failed(no_walk(found, floor, walks)));
    }
    build_floor(&floor.name, floor_ordinal(&floor.name), &floor.plan, &walks.used, params)
        .map_err(|error| Stop::Failed(format!("{}: {error}", found.dir.display())))
}

/// Why none of a floor's walks can be used.
fn no_walk(found: &FoundFloor, floor: &Floor, walks: &Walks) -> String {
    let dir = found.dir.display();
    match walks.refused.as_slice() {
        [] if floor.traces.is_empty() => {
            format!(
                "{dir}: no walk to survey with (put recordings into its folder of walks: see `fieldwalk survey --help`)"
            )
        }
        [] => format!(
            "{dir}: every walk is a test walk of the fold left out (give another --fold, or more walks)"
        ),
        refused => {
            let reasons: Vec<String> = refused.iter().map(|refused| format!("\n  {refused}")).collect();
            format!(
                "{dir}: none of {} walks can be used (tap a waypoint at the start and the end of every line){}",
                refused.len(),
                reasons.concat()
            )
        }
    }
}
