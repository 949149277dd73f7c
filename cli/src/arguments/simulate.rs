//! The arguments of `fieldwalk simulate`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_sim::scenario::Scenario;

/// Makes a scenario from a seed.
type Make = fn(u64) -> Scenario;

/// The scenarios: a line each, with the name, what it is, and how a seed makes it.
const SCENARIOS: [(&str, &str, Make); 1] =
    [("office", "60 x 40 m, steel, beacons every 12 m in corridors of 0.7 to 1.6 m", Scenario::office)];

/// The ways to carry a phone, by name.
const CARRY_MODES: [(&str, CarryMode); 5] = [
    ("level", CarryMode::HeldLevel),
    ("pocket", CarryMode::FrontPocket),
    ("ear", CarryMode::AtEar),
    ("hand", CarryMode::SwingingHand),
    ("table", CarryMode::OnTable),
];

/// Simulate walks in a building: recordings to survey it with, others to test with, and the truth.
///
/// The same scenario, seed and options give the same bytes.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk simulate office --out office
  fieldwalk survey office --out office.map
  fieldwalk replay office.map office/test/*.mcap
  fieldwalk simulate office --out pocket --seed 7 --walks 20 --carry pocket
  fieldwalk simulate --list

Written into DIR, the layout `recordings` of `fieldwalk survey --help`:
  plan.geojson        the floor plan, in metres
  survey/NAME.mcap    walks that survey, the phone held level
  test/NAME.mcap      walks that the survey has not seen
  survey/NAME.truth.csv, test/NAME.truth.csv
                      time_ns (the recording's clock), x_m, y_m (the floor frame),
                      heading_rad (of the trunk, clockwise from +y); ten a second

See `fieldwalk --help` for the exit codes.")]
pub struct SimulateArguments {
    /// The scenario's name; see --list.
    #[arg(value_name = "SCENARIO", required_unless_present = "list", value_parser = PossibleValuesParser::new(SCENARIOS.map(|(name, ..)| name)))]
    pub scenario: Option<String>,

    /// Where the files go: a folder, made if need be.
    #[arg(long, value_name = "DIR", required_unless_present = "list")]
    pub out: Option<PathBuf>,

    /// Random seed, 0 to 2^64 - 1: of the building's steel, its walkers and their phones.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Number of test walks, 0 to 1000.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(0..=1_000))]
    pub walks: u64,

    /// Length of a test walk, at least, in metres, 20 to 10000.
    #[arg(long, value_name = "M", default_value_t = 130, value_parser = clap::value_parser!(u32).range(20..=10_000))]
    pub length: u32,

    /// How the phone is carried in test walks: level, pocket, ear, hand or table.
    #[arg(long, value_name = "MODE", default_value = "level", value_parser = carry_mode)]
    pub carry: CarryMode,

    /// List the scenarios.
    #[arg(long, exclusive = true)]
    pub list: bool,
}

impl SimulateArguments {
    /// A line a scenario: its name and what it is.
    pub fn listed() -> impl Iterator<Item = (&'static str, &'static str)> {
        SCENARIOS.into_iter().map(|(name, what, _)| (name, what))
    }
}

/// The scenario called `name`, from `seed`.
pub fn scenario(name: &str, seed: u64) -> Option<Scenario> {
    SCENARIOS.into_iter().find(|(known, ..)| *known == name).map(|(_, _, make)| make(seed))
}

fn carry_mode(text: &str) -> Result<CarryMode, String> {
    let known = CARRY_MODES.into_iter().find(|(name, _)| *name == text);
    known.map(|(_, mode)| mode).ok_or_else(|| "expected level, pocket, ear, hand or table".into())
}
