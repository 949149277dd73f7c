//! What can be asked for on the command line.

mod card;
mod import;
mod report;
mod reproduce;
mod simulate;
mod values;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use fieldwalk::system::Recipe;

use crate::evaluation::{N_FOLDS, Start};
use crate::floors::Layout;

pub use card::{CardWalksArguments, EnergyArguments};
pub use import::ImportArguments;
pub use report::{EvaluationReport, ReportArguments};
pub use reproduce::{PaperChoice, ReproduceArguments};
pub use simulate::SimulateArguments;
pub use values::{ReplayStart, Seeds};

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  a file is missing, foreign or damaged, or holds too little: standard error
     says which, why and what to do; `evaluate` and `replay` finish the others
  2  the arguments are wrong";

/// Indoor positioning: see a demo, survey a floor, replay a walk, compare systems.
#[derive(Debug, Parser)]
#[command(name = "fieldwalk", version, propagate_version = true, after_help = EXIT_CODES, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Demo(DemoArguments),
    Survey(SurveyArguments),
    Replay(ReplayArguments),
    Evaluate(EvaluateArguments),
    Report(ReportArguments),
    Reproduce(ReproduceArguments),
    Train(TrainArguments),
    Import(ImportArguments),
    Simulate(SimulateArguments),
    Energy(EnergyArguments),
    #[command(hide = true)]
    CardWalks(CardWalksArguments),
}

/// Survey a simulated office and position walks in it: needs no recording.
///
/// The office of 60 × 40 m has steel, transmitters, walkers and phones by chance. Its map is built from simulated survey
/// walks; then `dead-reckoning`, `mass-centered` and `fused` are scored on other walks, by other walkers with other phones,
/// whose start is known to ± 2 m.
/// Scored are the fixes once a second from the fifth on, against the simulator's truth.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk demo
  fieldwalk demo --seed 2 --walks 20 --out office2 --json
      # JSON: the rows of `fieldwalk evaluate --help`, with \"truth\" for points

The same seed and number of walks give the same map and errors; the time of a
step depends on the machine.

See `fieldwalk --help` for the exit codes.")]
pub struct DemoArguments {
    /// Random seed, 0 to 2^64 - 1: of the office, its walkers and the systems.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Number of walks to position, 1 to 1000.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1_000))]
    pub walks: u32,

    /// Where office.map, office.geojson, its plan, test-01.mcap, one of the walks, and report.html, which plays all, go: a
    /// folder, made if need be; those that are there are replaced.
    #[arg(long, value_name = "DIR", default_value = "fieldwalk-demo")]
    pub out: PathBuf,

    /// Print one JSON object a system instead of a table.
    #[arg(long)]
    pub json: bool,
}

/// What is scored, and how its folders are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Dataset {
    /// indoor-location-competition-20: whole systems, in metres.
    Ilc,
    /// Recordings of one's own (see `fieldwalk survey --help`): whole systems, in metres.
    Recordings,
    /// The Oxford step-counting collection: step detectors.
    OxfordSteps,
    /// The attitude benchmark of Tyrex: attitude and heading.
    Tyrex,
    /// The position-annotated BLE collection: ranges, trilateration, fingerprints.
    BleAnnotated,
    /// UJIIndoorLoc-Mag: whole systems, in metres; its lines survey, its other walks test.
    UjiMag,
}

/// Build a building's map from surveyed floors.
///
/// Each floor's plan and walks become one file of the map; the table tells what the survey covers and how accurate
/// positions on it should be. A walk that cannot be used is listed with the reason and left out.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk survey site1/F1 --out mall.map
  fieldwalk survey site1 --out mall.map --name 'West Mall' --coverage
  fieldwalk survey site1/F1 --fold 0 --out honest.map
      # a map that has not seen the walks of fold 0: replay those on it

Layouts:
  recordings   plan.geojson, a GeoJSON plan, in degrees or in metres from the
               outline's lowest corner, 0, 0; and logs with waypoints in survey/
               (or, where there is none, beside the plan): *.mcap, *.txt, *.json,
               folders of Sensor Logger. Logs in test/ are left for `evaluate` and
               `replay`. A floor is called as its folder; if that is no floor's name,
               F1.
  ilc          indoor-location-competition-20: floor_info.json, geojson_map.json,
               and traces/ or path_data_files/.
  uji-mag      UJIIndoorLoc-Mag: lines/ surveys, curves/ and other folders are left
               for `evaluate` and `replay`; there is no plan.

See `fieldwalk --help` for the exit codes.")]
pub struct SurveyArguments {
    /// Floors: their folders, or folders that hold such folders.
    #[arg(value_name = "DIR", required = true)]
    pub dirs: Vec<PathBuf>,

    /// How the folders are laid out: `recordings`, `ilc` or `uji-mag` [default: by what they hold].
    #[arg(long, aliases = ["dataset", "dataset-layout"], value_name = "LAYOUT")]
    pub layout: Option<Layout>,

    /// The map: a folder, made if need be; a map that is there is replaced.
    #[arg(long, value_name = "MAPDIR")]
    pub out: PathBuf,

    /// Where the pictures go, an SVG file a floor such as mall-F1-survey.svg: a folder, made if need be [default: beside
    /// the map].
    #[arg(long, value_name = "DIR")]
    pub pictures: Option<PathBuf>,

    /// The building's name [default: the name of the folder that holds the floors].
    #[arg(long)]
    pub name: Option<String>,

    /// Leave the test walks of this fold out, 0 to 3 (see `fieldwalk evaluate --help`).
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u8).range(0..i64::from(N_FOLDS)))]
    pub fold: Option<u8>,

    /// Stop at the coverage: do not position each walk on the map of the others, which takes the most time.
    #[arg(long, visible_alias = "coverage")]
    pub no_expected_accuracy: bool,

    /// Print one JSON object a floor instead of a table.
    #[arg(long)]
    pub json: bool,
}

/// Run a system over recordings and print its fixes.
///
/// A fix is printed at every step, and at every waypoint with its error; then a summary with what was rejected.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk replay mall.map site1/F1/traces/walk.txt --floor F1
  fieldwalk replay mall.map walk.txt --floor F1 --start 12.5,40 --json
  fieldwalk replay mall.map walk.txt --floor F1 --bits
      # compare the line with another machine's

A log is replayed in order of time; what comes more than 16384 records late is
rejected, and counted like every other rejection.

See `fieldwalk --help` for the exit codes.")]
pub struct ReplayArguments {
    /// The building's map, as `fieldwalk survey` writes it.
    #[arg(value_name = "MAPDIR")]
    pub map: PathBuf,

    /// Recordings of any format: MCAP, text traces of indoor-location-competition-20, logs of GetSensorData, exports of
    /// Sensor Logger, walks of UJIIndoorLoc-Mag.
    #[arg(value_name = "LOG", required = true)]
    pub traces: Vec<PathBuf>,

    /// The floor by name; may be left out when the building has one.
    #[arg(long, value_name = "NAME")]
    pub floor: Option<String>,

    /// The system to run.
    #[arg(long, value_name = "NAME", default_value = "fused", value_parser = PossibleValuesParser::new(Recipe::NAMES))]
    pub system: String,

    /// Random seed, 0 to 2^64 - 1: the same recording, map, system and seed give the same fixes to the bit.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// What is known of the start: `waypoint` (the recording's first), `cold` (nothing), or `X,Y` in metres.
    #[arg(long, value_name = "START", default_value = "waypoint", allow_hyphen_values = true)]
    pub start: ReplayStart,

    /// How far off the start may be along each axis, in metres, 0.1 to 1000.
    #[arg(long, value_name = "M", default_value_t = 2.0, value_parser = values::radius_m)]
    pub start_radius: f64,

    /// Print only a SHA-256 over the exact bits of all fixes, one line a recording.
    #[arg(long)]
    pub bits: bool,

    /// Print one JSON object a line: `fix`, `waypoint`, and one `summary` a recording.
    #[arg(long)]
    pub json: bool,
}

/// Compare systems on recordings with known places.
///
/// Per floor, one map is built from the survey walks, and every system is scored on the test walks, which the map has
/// not seen. A walk is a test walk of fold K (0 to 3) when the two low bits of the last byte of SHA-1(file name) equal
/// K, so that each walk is a test walk of exactly one of four folds. Where a floor has a folder test/, its walks are the
/// test walks instead, and all others survey.
///
/// Scored are the fixes at every waypoint but the first ("waypoint"), and midway in time between two waypoints
/// ("midpoint"), the truth there being interpolated over the steps made.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk evaluate site1/F1 site1/F2
  fieldwalk evaluate site1 --systems dead-reckoning,fused --folds 4 --json
  fieldwalk evaluate site1 --report report.html
      # a page that plays the worst walks
  fieldwalk evaluate --print-recipe fused > mine.json
      # change its name and some parameters, then:
  fieldwalk evaluate site1/F1 --systems fused --recipe mine.json
  fieldwalk evaluate --dataset oxford-steps oxford-steps --json
  fieldwalk evaluate --dataset tyrex tyrex-attitude --json
  fieldwalk evaluate --dataset ble-annotated ble-annotated --json
  fieldwalk evaluate --dataset oxford-steps oxford-steps --plots miscounted
  fieldwalk evaluate --dataset ilc site1 --lengths
  fieldwalk evaluate --dataset uji-mag uji-mag --start cold

JSON for ilc, recordings and uji-mag: one object a floor (\"all\": the floors pooled), system and kind of point.
  dataset, floor, system, start
  points              \"waypoint\" or \"midpoint\"; for uji-mag also \"cut_off\": five
                      moments of each walk, by chance, at least 1.5 m from where
                      corridors end or meet, the truth lying evenly in time on the
                      segment walked
  n_walks             test walks, each counted once
  n_points            scored points, each counted once a seed
  n_without_fix       points without a fix, which are not scored
  median_m mean_m p80_m p90_m                 errors
  inside_68 inside_95                         share within the stated radii
  radius_68_median_m                          median of the stated 68 % radii
  step_us_median      time of a step on one thread, in microseconds
  seeds               number of seeds

JSON for the others, and with --lengths: one object a subset (\"all\": pooled), system and metric.
  dataset, subset, system, metric
  value               the metric's value, in the unit that its name ends in
  n                   number of runs, segments, strides or moments behind it
  oxford-steps        count_error_abs_percent, count_error_signed_percent: mean
                      over runs of the steps counted against the contacts of
                      the foot switches
  tyrex               heading_error_median_deg: median over captured frames of
                      the device's heading against motion capture
                      auc_ufh, auc_non_upward: areas under the receiver's curve of
                      once a second of the capture; UFH is what the trials of
                      texting hold, upward nothing else. The same with
                      _captured take the screen's side from the capture.
                      auc_forward_turned: the trials of texting against themselves
                      with the phone turned in quarters.
                      ufh_correct_percent, carry_mode_correct_percent: share of
                      right decisions. Systems: `printed`, the paper's table
                      stride by stride; `trained`, a table of one half of the
                      trials scored on the other, both ways; `shipped`; `file`
  ble-annotated       range_bias_m: mean over receivers and rounds of range minus
                      distance; range_error_median_m of its absolute value
                      place_error_median_m, place_error_p80_m, placed_percent:
                      places against the AR tags, and share of rounds with one;
                      reliable_percent: share whose beacons stand well
                      truth_near_match_percent: share of rounds whose truth lies
                      within 6 m of the matched cell, where the card's filter
                      keeps particles; truth_dropped_percent: outside twice in a
                      row. Subsets `fixed`, `tracks`; with _near, where three
                      receivers hang within 6 m of the truth. _1s, _5s: power
                      averaged over so long
  --lengths           segment_length_error_percent: mean over straight segments
                      between waypoints, ten steps into a walk, of the length
                      by the steps against the true one, for static 0.65 m,
                      the fitted model, and that with the walker's scale learnt
                      from the segments before
A number that does not exist is null.

See `fieldwalk --help` for the exit codes.")]
pub struct EvaluateArguments {
    /// Floors: their folders, or folders that hold such folders; for the other data sets the unpacked archives.
    #[arg(value_name = "DIR", required_unless_present = "print_recipe")]
    pub dirs: Vec<PathBuf>,

    /// The recordings, which say what is scored; the other arguments but --table, --plots and --json are for ilc,
    /// recordings and uji-mag [default: one of these, by what the folders hold].
    #[arg(long, aliases = ["layout", "dataset-layout"], value_name = "NAME")]
    pub dataset: Option<Dataset>,

    /// The systems, separated by commas [default: all].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = PossibleValuesParser::new(Recipe::NAMES))]
    pub systems: Vec<String>,

    /// Another system: a recipe as JSON, whose name must be new; may be given several times.
    #[arg(long = "recipe", value_name = "FILE.json")]
    pub recipes: Vec<PathBuf>,

    /// Give every system the floor plan and the surveyed routes of `fused`, and those of phones its dead reckoning too;
    /// those that this changes are called `NAME+plan`.
    #[arg(long)]
    pub with_plan: bool,

    /// What a system is told of the start: `known:R`, the truth ± R m along each axis, uniform and seeded (R from 0.1
    /// to 1000); `known:R:A`, the direction of the first metres ± A degrees besides (A from 1 to 180); or `cold`, nothing
    #[arg(long, default_value = "known:2")]
    pub start: Start,

    /// Random seeds: `A..B` (both included) and single ones, separated by commas; 1000 at most.
    #[arg(long, default_value = "1..5")]
    pub seeds: Seeds,

    /// Score this fold, or these, separated by commas, 0 to 3; several are pooled, each with a map of its own
    /// [default: 0].
    #[arg(
        long = "fold",
        value_name = "K",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u8).range(0..i64::from(N_FOLDS)),
        conflicts_with = "n_folds"
    )]
    pub folds: Vec<u8>,

    /// Score the first N folds, 1 to 4, pooled: with 4, every walk is tested once.
    #[arg(long = "folds", value_name = "N", value_parser = clap::value_parser!(u8).range(1..=i64::from(N_FOLDS)))]
    pub n_folds: Option<u8>,

    /// For tyrex: another table of the attitude's feature events, as `fieldwalk train attitude` writes it.
    #[arg(long, value_name = "FILE.json")]
    pub table: Option<PathBuf>,
    /// For ilc, recordings and uji-mag: score step lengths between waypoints instead of systems.
    #[arg(long)]
    pub lengths: bool,

    /// For oxford-steps: which walks are pictured, by the error of their count in percent of the true steps, 0 to 100.
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0, requires = "plots", value_parser = values::percent)]
    pub plot_errors_over: f64,

    /// Print one JSON object a line instead of tables.
    #[arg(long)]
    pub json: bool,

    /// Write a picture of each failure into this folder, as SVG: for oxford-steps and tyrex.
    #[arg(long, value_name = "FOLDER")]
    pub plots: Option<PathBuf>,

    /// The page.
    #[command(flatten)]
    pub page: EvaluationReport,

    /// Print a system's recipe as JSON, to change and give to --recipe.
    #[arg(
        long,
        value_name = "NAME",
        exclusive = true,
        value_parser = PossibleValuesParser::new(Recipe::NAMES)
    )]
    pub print_recipe: Option<String>,
}

/// Estimate parameters from recordings.
#[derive(Debug, Args)]
#[command(after_help = "See `fieldwalk --help` for the exit codes.")]
pub struct TrainArguments {
    #[command(subcommand)]
    pub part: TrainedPart,
}

/// What can be estimated.
#[derive(Debug, Subcommand)]
pub enum TrainedPart {
    Attitude(TrainAttitudeArguments),
}

/// Estimate the table of the attitude's feature events.
///
/// The recordings are walks with the phone held level before the chest, its top edge ahead. Every stride also stands for
/// the phone turned left, right and back, by turning it about the screen's normal. The table says how likely each
/// combination of the three events is for each way to point; it goes to `fieldwalk evaluate --table`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk train attitude tyrex-attitude --out table.json
  fieldwalk train attitude walk1.mcap walk2.mcap > table.json
  fieldwalk evaluate --dataset tyrex tyrex-attitude --table table.json

JSON: likelihood, eight rows (E1 E2 E3 = 111 011 101 110 001 010 100 000) of four
columns (forward, backward, leftward, rightward) that sum to 1; prior, of the four.

See `fieldwalk --help` for the exit codes.")]
pub struct TrainAttitudeArguments {
    /// Recordings of any format, exports of Sensor Logger too, or folders of the Tyrex benchmark, of which the trials of texting are taken.
    #[arg(value_name = "RECORDING|DIR", required = true)]
    pub recordings: Vec<PathBuf>,

    /// Where the table goes [default: standard output].
    #[arg(long, value_name = "FILE.json")]
    pub out: Option<PathBuf>,
}

impl EvaluateArguments {
    /// The folds to score, in order, each once.
    pub fn chosen_folds(&self) -> Vec<u8> {
        let mut folds = match self.n_folds {
            Some(n) => (0..n).collect(),
            None if self.folds.is_empty() => vec![0],
            None => self.folds.clone(),
        };
        folds.sort_unstable();
        folds.dedup();
        folds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn folds(arguments: &[&str]) -> Result<Vec<u8>, clap::Error> {
        let line = ["fieldwalk", "evaluate", "F1"].iter().chain(arguments);
        match Arguments::try_parse_from(line)?.command {
            Command::Evaluate(arguments) => Ok(arguments.chosen_folds()),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_commands_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn folds_are_a_number_or_a_choice() {
        assert_eq!(folds(&[]).unwrap(), [0]);
        assert_eq!(folds(&["--folds", "1"]).unwrap(), [0]);
        assert_eq!(folds(&["--folds", "4"]).unwrap(), [0, 1, 2, 3]);
        assert_eq!(folds(&["--fold", "2"]).unwrap(), [2]);
        assert_eq!(folds(&["--fold", "3,1,3"]).unwrap(), [1, 3]);
        for wrong in
            [&["--folds", "0"][..], &["--folds", "5"], &["--fold", "4"], &["--fold", "1", "--folds", "4"]]
        {
            assert_eq!(folds(wrong).unwrap_err().exit_code(), 2, "{wrong:?}");
        }
    }
}
