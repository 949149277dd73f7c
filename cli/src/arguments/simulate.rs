//! The arguments of `fieldwalk simulate`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_sim::scenario::Scenario;

/// What the scenarios are, in the order of [`Scenario::NAMES`].
const SCENARIOS: [&str; Scenario::NAMES.len()] = [
    "60 x 40 m, steel, beacons every 12 m in corridors of 0.7 to 1.6 m",
    "60 x 40 m of corridors of 0.7 and 1.6 m, access points only",
    "1800 m2 without walls, two clusters of three beacons 50 m apart",
    "20.5 x 16 m, three rooms, a beacon in each corner",
    "a ring of corridors, 67 x 12 m, no radio",
    "120 x 80 m, ways 8 to 12 m wide, weak steel, few beacons",
    "two floors of 40 x 24 m, a folder each; test walks climb the stairs",
];

/// The ways to carry a phone, by name.
const CARRY_MODES: [(&str, CarryMode); CarryMode::ALL.len()] = [
    ("level", CarryMode::HeldLevel),
    ("upright", CarryMode::HeldUpright),
    ("landscape", CarryMode::HeldLandscape),
    ("askew", CarryMode::HeldAskew),
    ("ear", CarryMode::AtEar),
    ("hand", CarryMode::SwingingHand),
    ("pocket", CarryMode::FrontPocket),
    ("back-pocket", CarryMode::BackPocket),
    ("shaken", CarryMode::Shaken),
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
  fieldwalk simulate card-office --out cards --card
  fieldwalk simulate --list

Written into DIR, the layout `recordings` of `fieldwalk survey --help`:
  plan.geojson        the floor plan, in metres
  survey/NAME.mcap    walks that survey, the phone held level
  test/NAME.mcap      walks that the survey has not seen
  survey/NAME.truth.csv, test/NAME.truth.csv
                      time_ns (the recording's clock), x_m, y_m (the floor frame),
                      heading_rad (of the trunk, clockwise from +y), floor (0: ground);
                      ten a second
Of several floors each has a folder of its own, F1 the lowest, with plan.geojson
and survey/; test walks go from floor to floor, with waypoints on the first.

See `fieldwalk --help` for the exit codes.")]
pub struct SimulateArguments {
    /// The scenario's name; see --list.
    #[arg(value_name = "SCENARIO", required_unless_present = "list", value_parser = PossibleValuesParser::new(Scenario::NAMES))]
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

    /// How the phone is carried in test walks: level, upright, landscape, askew, ear, hand, pocket, back-pocket,
    /// shaken or table.
    #[arg(long, value_name = "MODE", default_value = "level", value_parser = carry_mode)]
    pub carry: CarryMode,

    /// Who walks wears an ID card at the chest: test walks are its frames, as the scenario's beacons hear them as access
    /// points, with their strengths; the survey is by phone, with those strengths.
    #[arg(long, conflicts_with = "carry")]
    pub card: bool,

    /// List the scenarios.
    #[arg(long, exclusive = true)]
    pub list: bool,
}

impl SimulateArguments {
    /// A line a scenario: its name and what it is.
    pub fn listed() -> impl Iterator<Item = (&'static str, &'static str)> {
        Scenario::NAMES.into_iter().zip(SCENARIOS)
    }
}

fn carry_mode(text: &str) -> Result<CarryMode, String> {
    let known = CARRY_MODES.into_iter().find(|(name, _)| *name == text);
    known.map(|(_, mode)| mode).ok_or_else(|| {
        "expected level, upright, landscape, askew, ear, hand, pocket, back-pocket, shaken or table".into()
    })
}
