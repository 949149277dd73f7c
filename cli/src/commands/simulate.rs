//! `fieldwalk simulate`: recordings and truth of a scenario.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use fieldwalk_formats::{FormatError, write_plan};
use fieldwalk_sim::scenario::{Scenario, Walk};
use rayon::prelude::*;

use crate::arguments::{SimulateArguments, scenario};
use crate::floors::PLAN_FILE;
use crate::progress;
use crate::simulated::{write_recording, write_truth};
use crate::stop::Stop;

/// The floor's name.
const FLOOR: &str = "F1";

/// Simulates the scenario and writes its plan, its walks and their truth.
pub fn run(arguments: &SimulateArguments, out: &mut impl Write) -> Result<(), Stop> {
    let (Some(name), Some(dir)) = (&arguments.scenario, &arguments.out) else {
        for (name, what) in SimulateArguments::listed() {
            writeln!(out, "{name:<12} {what}")?;
        }
        return Ok(());
    };
    let scenario = scenario(name, arguments.seed)
        .ok_or_else(|| Stop::Usage(format!("no scenario is called `{name}`: see --list")))?;
    let survey = scenario.survey_walks();
    let mut test = scenario.test_walks(arguments.walks, f64::from(arguments.length));
    for walk in &mut test {
        walk.carrying = vec![(0.0, arguments.carry)];
    }
    let places = [(dir.join("survey"), survey), (dir.join("test"), test)];
    for (place, walks) in &places {
        make_folder(place, walks)?;
    }
    let plan = dir.join(PLAN_FILE);
    fs::write(&plan, write_plan(&scenario.building.plan))
        .map_err(|error| FormatError::io("write the plan", &plan, error))?;
    for (place, walks) in &places {
        write_walks(&scenario, walks, place)?;
    }
    let [(_, survey), (_, test)] = &places;
    let dir = dir.display();
    writeln!(
        out,
        "{dir}: {name} of seed {}, {} walks to survey and {} to test with; next:\n  fieldwalk survey {dir} --out {dir}.map\n  \
         fieldwalk replay {dir}.map {dir}/test/*.mcap",
        arguments.seed,
        survey.len(),
        test.len()
    )?;
    Ok(())
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
        write_recording(&recorded, FLOOR, &recording_file(dir, walk))?;
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
