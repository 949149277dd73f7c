//! What a compiler does not check: documents that name what exists, names, sizes, manifests.

mod architecture;
mod changelog;
mod citations;
mod equations;
mod locations;
mod manifests;
mod repository;
mod sources;

use repository::{Finding, Repository};

use crate::report::Outcome;
use crate::workspace::Workspace;

/// A rule looks at the whole repository and says what is wrong with it.
type Rule = fn(&Repository) -> Vec<Finding>;

const RULES: &[Rule] = &[
    architecture::every_module_is_named,
    architecture::every_named_path_exists,
    equations::every_equation_is_in_the_code_named,
    sources::files_are_short,
    sources::names_say_what_is_inside,
    sources::files_are_light,
    manifests::members_inherit_the_lints,
    locations::no_place_of_one_machine,
    changelog::has_unreleased_section,
];

pub fn run(workspace: &Workspace) -> Outcome {
    let repository = match Repository::read(&workspace.root) {
        Ok(repository) => repository,
        Err(reason) => return Outcome::skipped(reason),
    };
    let findings: Vec<Finding> = RULES.iter().flat_map(|rule| rule(&repository)).collect();
    for finding in &findings {
        eprintln!("{finding}");
    }
    match findings.len() {
        0 => Ok(()).into(),
        1 => Err("1 finding, above".to_owned()).into(),
        n => Err(format!("{n} findings, above")).into(),
    }
}
