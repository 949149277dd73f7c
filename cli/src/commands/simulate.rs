//! `fieldwalk simulate`: recordings and truth of a scenario.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use fieldwalk_formats::{FormatError, write_plan};
use fieldwalk_sim::card::CardModel;
use fieldwalk_sim::scenario::{Floor, Scenario, Walk};
use rayon::prelude::*;

use crate::arguments::SimulateArguments;
use crate::floors::PLAN_FILE;
use crate::progress;
use crate::quoted::quoted;
use crate::simulated::{floor_name, write_recording, write_truth};
use crate::stop::Stop;

/// Simulates the scenario and writes its plan, its walks and their truth.
pub fn run(arguments: &SimulateArguments, out: &mut impl Write) -> Result<(), Stop> {
    let (Some(name), Some(dir)) = (&arguments.scenario, &arguments.out) else {
        for (name, what) in SimulateArguments::listed() {
            writeln!(out, "{name:<12} {what}")?;
        }
        return Ok(());
    };
    let scenario = Scenario::named(name, arguments.seed)
        .ok_or_else(|| Stop::Usage(format!("no scenario is called `{name}`: see --list")))?;
    let places = places(&scenario, arguments, dir);
    for (place, walks) in &places {
        make_folder(place, walks)?;
    }
    for floor in scenario.floors() {
        let plan = floor_folder(&scenario, &floor, dir).join(PLAN_FILE);
        fs::write(&plan, write_plan(&floor.building.plan))
            .map_err(|error| FormatError::io("write the plan", &plan, error))?;
    }
    for (place, walks) in &places {
        write_walks(&scenario, walks, place)?;
    }
    writeln!(out, "{}", next_steps(&scenario, arguments, dir, &places))?;
    Ok(())
}

/// What was written, and the commands that go on with it.
fn next_steps(
    scenario: &Scenario,
    arguments: &SimulateArguments,
    dir: &Path,
    places: &[(PathBuf, Vec<Walk>)],
) -> String {
    let test = places.last().map_or(&[][..], |(_, test)| test);
    let n_survey = places.iter().map(|(_, walks)| walks.len()).sum::<usize>() - test.len();
    let mut map = dir.components().collect::<PathBuf>().into_os_string();
    map.push(".map");
    let (folder, map) = (quoted(dir), quoted(Path::new(&map)));
    let mut said = format!(
        "{}: {} of seed {}, {n_survey} walks to survey and {} to test with; next:\n  fieldwalk survey {folder} --out {map}",
        dir.display(),
        scenario.name,
        arguments.seed,
        test.len()
    );
    let Some(first) = test.first() else { return said };
    let walks = match scenario.upstairs.is_empty() {
        true => format!("{}/*.mcap", quoted(&dir.join("test"))),
        // Others may begin on another floor, of which this one's map knows nothing.
        false => {
            let begins_there =
                |floor: &Floor<'_>| first.heights_m.first().is_none_or(|&m| m == floor.height_m);
            let floor = scenario.floors().find(begins_there).map_or(0, |floor| floor.ordinal);
            format!("{} --floor {}", quoted(&recording_file(&dir.join("test"), first)), floor_name(floor))
        }
    };
    let system = if arguments.card { " --system card" } else { "" };
    said.push_str(&format!("\n  fieldwalk replay {map} {walks}{system}"));
    said
}

/// The folder of a floor: the scenario's, where there is but one.
fn floor_folder(scenario: &Scenario, floor: &Floor<'_>, dir: &Path) -> PathBuf {
    if scenario.upstairs.is_empty() { dir.into() } else { dir.join(floor_name(floor.ordinal)) }
}

/// The folders with the walks that go into each: those of the floors' surveys, then the test walks.
fn places(scenario: &Scenario, arguments: &SimulateArguments, dir: &Path) -> Vec<(PathBuf, Vec<Walk>)> {
    let mut survey = scenario.survey_walks();
    if arguments.card {
        let silent = CardModel { sends_frames: false, ..CardModel::default() };
        survey.iter_mut().for_each(|walk| walk.card = Some(silent));
    }
    let surveys = scenario.floors().map(|floor| {
        let starts_here = |walk: &&Walk| walk.heights_m.first().is_none_or(|&m| m == floor.height_m);
        let walks = survey.iter().filter(starts_here).cloned().collect();
        (floor_folder(scenario, &floor, dir).join("survey"), walks)
    });
    let mut test = scenario.test_walks(arguments.walks, f64::from(arguments.length));
    for walk in &mut test {
        walk.carrying = vec![(0.0, arguments.carry)];
        walk.card = arguments.card.then(CardModel::default);
    }
    surveys.chain([(dir.join("test"), test)]).collect()
}

/// Makes the folder `dir`; one with other files than those of `walks` is refused, for they would count as walks.
fn make_folder(dir: &Path, walks: &[Walk]) -> Result<(), FormatError> {
    fs::create_dir_all(dir).map_err(|error| FormatError::io("make the folder", dir, error))?;
    let failed = |error| FormatError::io("list the folder", dir, error);
    let own: Vec<PathBuf> =
        walks.iter().flat_map(|walk| [recording_file(dir, walk), truth_file(dir, walk)]).collect();
    for entry in fs::read_dir(dir).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if !own.contains(&path) {
            let message = "a file of something else, in the way of simulated walks";
            return Err(FormatError::malformed(message, "give another --out, or remove it").at_path(path));
        }
    }
    Ok(())
}

fn write_walks(scenario: &Scenario, walks: &[Walk], dir: &Path) -> Result<(), FormatError> {
    let bar = progress::bar("walks", walks.len());
    let written = walks.par_iter().try_for_each(|walk| {
        let recorded = scenario.simulate(walk);
        write_recording(&recorded, &recording_file(dir, walk))?;
        write_truth(&recorded, &truth_file(dir, walk))?;
        bar.inc(1);
        Ok(())
    });
    bar.finish_and_clear();
    written
}

fn recording_file(dir: &Path, walk: &Walk) -> PathBuf {
    dir.join(format!("{}.mcap", walk.name))
}

fn truth_file(dir: &Path, walk: &Walk) -> PathBuf {
    dir.join(format!("{}.truth.csv", walk.name))
}
