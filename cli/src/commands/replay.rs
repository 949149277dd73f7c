//! `fieldwalk replay`: a recording becomes fixes.

mod print;
mod run;

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::system::Recipe;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::map::open_building;

use crate::arguments::ReplayArguments;
use crate::stop::{Stop, note};

use print::Printer;
use run::Replay;
pub use run::{check_floor, off_plan};

/// Replays the recordings one after the other; one that fails does not stop the others.
pub fn run(arguments: &ReplayArguments, out: &mut impl Write) -> Result<(), Stop> {
    let (_, floor) = open_floor(&arguments.map, arguments.floor.as_deref())?;
    let floor = Arc::new(FloorIndex::new(floor));
    let recipe = Recipe::named(&arguments.system)
        .ok_or_else(|| Stop::Usage(format!("no system is called `{}`", arguments.system)))?;
    let replay = Replay {
        floor,
        recipe,
        seed: arguments.seed,
        start: arguments.start,
        start_radius_m: arguments.start_radius,
    };
    let mut n_failed = 0;
    for trace in &arguments.traces {
        let mut printer = Printer::new(arguments, trace, &mut *out);
        match replay.run(trace, &mut printer) {
            Ok(()) => {}
            Err(Stop::Failed(message)) => {
                note("error", &message);
                n_failed += 1;
            }
            Err(other) => return Err(other),
        }
    }
    if n_failed == 0 {
        return Ok(());
    }
    if arguments.traces.len() > 1 {
        note("error", &format!("{n_failed} of {} recordings could not be replayed", arguments.traces.len()));
    }
    Err(Stop::Incomplete)
}

/// The building's name, and its floor called `name`, or the only one.
pub fn open_floor(dir: &Path, name: Option<&str>) -> Result<(String, FloorMap), Stop> {
    let building = open_building(dir)?;
    let building_name = building.name;
    let names: Vec<String> = building.floors.iter().map(|floor| floor.name.clone()).collect();
    let n_floors = names.len();
    let mut matching = building.floors.into_iter().filter(|floor| name.is_none_or(|name| floor.name == name));
    let (floor, other) = (matching.next(), matching.next());
    let names = names.join(", ");
    match (floor, other, name) {
        (Some(floor), None, _) => Ok((building_name, floor)),
        (None, _, Some(name)) if n_floors > 0 => Err(Stop::Failed(format!(
            "{}: no floor is called {name} (give --floor one of: {names})",
            dir.display()
        ))),
        (None, ..) => {
            let error = FormatError::malformed("the building has no floor", "survey it again").at_path(dir);
            Err(error.into())
        }
        (Some(_), Some(_), _) => Err(Stop::Failed(format!(
            "{}: the building has several floors (give --floor one of: {names})",
            dir.display()
        ))),
    }
}
