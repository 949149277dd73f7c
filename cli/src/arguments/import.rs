//! The arguments of `fieldwalk import`.

use std::path::PathBuf;

use clap::Args;

/// Turn logs of any format into recordings: MCAP.
///
/// Records are written in order of time, as `replay` takes them, with the floor, the device and the start where the log
/// says them. What the log held and did not give is printed by cause.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk import walk.txt --out walk.mcap
  fieldwalk import traces/*.txt 2026-10-03_17-02-05/ --out recordings
  fieldwalk import ipin.log --plan plan.geojson --out office/survey
      # a log with waypoints in degrees needs the plan that places them

Formats, told apart by content: text traces of indoor-location-competition-20,
logs of GetSensorData, exports of Sensor Logger, walks of UJIIndoorLoc-Mag,
MCAP.

JSON: one object a log.
  log, recording      the files
  n_records           records written, of which
  n_waypoints         are waypoints
  duration_s          from the first record to the last
  device, floor       empty where unknown
  losses              was_cut, n_corrupt_chunks, n_malformed, n_foreign_messages
  lines_rejected      of a text log, by cause
  n_stale_wifi_rows   WiFi rows too old to tell a place

See `fieldwalk --help` for the exit codes.")]
pub struct ImportArguments {
    /// Logs of any format; a folder is an export of Sensor Logger.
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,

    /// The recording, if its name ends in `.mcap`; otherwise a folder, made if need be, for recordings named as the logs.
    /// A recording that is there is replaced.
    #[arg(long, value_name = "DIR|FILE.mcap")]
    pub out: PathBuf,

    /// The plan of the floor, GeoJSON: places waypoints that are given in degrees.
    #[arg(long, value_name = "FILE.geojson")]
    pub plan: Option<PathBuf>,

    /// The floor's name, where the log does not say it.
    #[arg(long, value_name = "NAME")]
    pub floor: Option<String>,

    /// Compress with zstd: a third of the size, but phones do not read it.
    #[arg(long)]
    pub zstd: bool,

    /// Print one JSON object a log.
    #[arg(long)]
    pub json: bool,
}
