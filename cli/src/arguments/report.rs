//! What can be asked of `fieldwalk report`, and of the report that an evaluation leaves.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use fieldwalk::system::Recipe;

use super::values::{ReplayStart, radius_m};

/// Replay recordings and write a page that plays them.
///
/// The page is one file that any browser opens, offline: the floor plan with its magnetic field, every system's fixes,
/// radii and particles along a time slider, and the errors where a recording has waypoints. Walks with the largest mean
/// error come first.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk report mall.map site1/F1/traces/*.txt --floor F1
  fieldwalk report mall.map walk.mcap --systems fused --start 12.5,40 --out walk.html
  fieldwalk evaluate site1 --report report.html
      # the same page for a whole data set, with the errors of all its test walks

See `fieldwalk --help` for the exit codes.")]
pub struct ReportArguments {
    /// The building's map, as `fieldwalk survey` writes it.
    #[arg(value_name = "MAPDIR")]
    pub map: PathBuf,

    /// Recordings: MCAP, text traces of indoor-location-competition-20, GetSensorData logs,
    /// exports of Sensor Logger, walks of UJIIndoorLoc-Mag.
    #[arg(value_name = "TRACE", required = true)]
    pub traces: Vec<PathBuf>,

    /// The floor by name; may be left out when the building has one.
    #[arg(long, value_name = "NAME")]
    pub floor: Option<String>,

    /// The systems, separated by commas [default: all].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = PossibleValuesParser::new(Recipe::NAMES))]
    pub systems: Vec<String>,

    /// Random seed, 0 to 2^64 - 1.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// What is known of the start: `waypoint` (the recording's first), `cold` (nothing), or `X,Y` in metres.
    #[arg(long, value_name = "START", default_value = "waypoint", allow_hyphen_values = true)]
    pub start: ReplayStart,

    /// How far off the start may be along each axis, in metres, 0.1 to 1000.
    #[arg(long, value_name = "M", default_value_t = 2.0, value_parser = radius_m)]
    pub start_radius: f64,

    /// The page; one that is there is replaced.
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    pub out: PathBuf,

    /// The page's title [default: the building's and the floor's name].
    #[arg(long)]
    pub title: Option<String>,

    /// Only so many walks can be played, those with the largest errors; all count in the errors.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=1_000))]
    pub walks: u32,
}

/// The page that an evaluation leaves beside its rows.
#[derive(Debug, Args)]
pub struct EvaluationReport {
    /// Also write a page that plays the worst walks, each with the seed on which it was worst, and shows the errors of
    /// all (see `fieldwalk report --help`).
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,

    /// Number of walks that the page can play.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 12,
        requires = "report",
        value_parser = clap::value_parser!(u32).range(1..=1_000)
    )]
    pub walks: u32,
}
