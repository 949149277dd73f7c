//! Which options go with what is scored: one that changed nothing would be believed to have.

use crate::arguments::{Dataset, EvaluateArguments};
use crate::stop::Stop;

/// What is scored, as far as options differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scored {
    Systems,
    Lengths,
    OxfordSteps,
    Tyrex,
    BleAnnotated,
}

/// Refuses options of something else than is scored.
pub fn check(arguments: &EvaluateArguments) -> Result<(), Stop> {
    let scored = match arguments.dataset {
        Some(Dataset::OxfordSteps) => Scored::OxfordSteps,
        Some(Dataset::Tyrex) => Scored::Tyrex,
        Some(Dataset::BleAnnotated) => Scored::BleAnnotated,
        None | Some(Dataset::Ilc | Dataset::Recordings | Dataset::UjiMag) if arguments.lengths => {
            Scored::Lengths
        }
        None | Some(Dataset::Ilc | Dataset::Recordings | Dataset::UjiMag) => Scored::Systems,
    };
    let is_of_systems = scored == Scored::Systems;
    let has_floors = matches!(scored, Scored::Systems | Scored::Lengths);
    let has_pictures = matches!(scored, Scored::OxfordSteps | Scored::Tyrex);
    let systems = "whole systems are scored: ilc, recordings and uji-mag without --lengths";
    let given = [
        ("--systems", !arguments.systems.is_empty(), is_of_systems, systems),
        ("--recipe", !arguments.recipes.is_empty(), is_of_systems, systems),
        ("--with-plan", arguments.with_plan, is_of_systems, systems),
        ("--fold", !arguments.folds.is_empty(), is_of_systems, systems),
        ("--folds", arguments.n_folds.is_some(), is_of_systems, systems),
        ("--report", arguments.page.report.is_some(), is_of_systems, systems),
        ("--lengths", arguments.lengths, has_floors, "floors are given: ilc, recordings and uji-mag"),
        ("--table", arguments.table.is_some(), scored == Scored::Tyrex, "--dataset tyrex is"),
        ("--plots", arguments.plots.is_some(), has_pictures, "--dataset oxford-steps or tyrex is"),
    ];
    match given.into_iter().find(|(_, is_given, is_used, _)| *is_given && !is_used) {
        Some((option, _, _, used)) => Err(Stop::Usage(format!("{option} is of use only where {used}"))),
        None => Ok(()),
    }
}
