//! A system from a file: a recipe as JSON.

use std::fs;
use std::path::Path;

use fieldwalk::system::Recipe;
use fieldwalk_formats::FormatError;
use serde_json::Value;

/// More particles than this do not fit a phone by a factor of a hundred.
const MAX_PARTICLES: usize = 1_000_000;

const REMEDY: &str = "compare it with `fieldwalk evaluate --print-recipe fused`";

/// Reads the recipe at `path`; every field must be there, and none that is not known.
pub fn read(path: &Path) -> Result<Recipe, FormatError> {
    let text = fs::read_to_string(path).map_err(|error| FormatError::io("read the recipe", path, error))?;
    parse(&text).map_err(|error| error.at_path(path))
}

fn parse(text: &str) -> Result<Recipe, FormatError> {
    let malformed = |error: serde_json::Error| {
        let message = error.to_string();
        // serde names the line at the end, which the error names at the start.
        let message = message.split(" at line ").next().unwrap_or(&message);
        FormatError::malformed(format!("not a recipe: {message}"), REMEDY).at_line(error.line() as u64)
    };
    let recipe: Recipe = serde_json::from_str(text).map_err(malformed)?;
    let given: Value = serde_json::from_str(text).map_err(malformed)?;
    let understood = serde_json::to_value(&recipe).map_err(malformed)?;
    if let Some(key) = unknown_key(&given, &understood) {
        return Err(FormatError::malformed(format!("no recipe has a field `{key}`"), REMEDY));
    }
    if !(1..=MAX_PARTICLES).contains(&recipe.n_particles) {
        let message = format!("n_particles is {}, not 1 to {MAX_PARTICLES}", recipe.n_particles);
        return Err(FormatError::malformed(message, "give a number in that range; 1000 is usual"));
    }
    Ok(recipe)
}

/// The first key of `given`, with those above it, that `understood` lacks: serde passes over such keys in silence.
fn unknown_key(given: &Value, understood: &Value) -> Option<String> {
    given.as_object()?.iter().find_map(|(key, value)| match understood.get(key) {
        None => Some(key.clone()),
        Some(known) => unknown_key(value, known).map(|below| format!("{key}.{below}")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(change: impl Fn(&mut Value)) -> Result<Recipe, FormatError> {
        let mut value = serde_json::to_value(Recipe::fused()).unwrap();
        change(&mut value);
        parse(&serde_json::to_string_pretty(&value).unwrap())
    }

    #[test]
    fn every_system_reads_as_it_prints() {
        for name in Recipe::NAMES {
            let recipe = Recipe::named(name).unwrap();
            assert_eq!(parse(&serde_json::to_string_pretty(&recipe).unwrap()).unwrap(), recipe);
        }
    }

    #[test]
    fn a_slip_in_a_recipe_is_named() {
        let slip = changed(|recipe| recipe["motion"]["direction_sd"] = 0.1.into()).unwrap_err();
        assert!(slip.to_string().contains("`motion.direction_sd`"), "{slip}");
        let none = changed(|recipe| recipe["n_particles"] = 0.into()).unwrap_err();
        assert!(none.to_string().contains("1 to 1000000"), "{none}");
        let text = changed(|recipe| recipe["n_particles"] = "many".into()).unwrap_err();
        assert!(text.line().is_some() && text.to_string().contains("many"), "{text}");
        assert!(parse("").is_err() && parse("[]").is_err() && parse("{}").is_err());
    }
}
