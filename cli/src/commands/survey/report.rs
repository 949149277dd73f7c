//! What a survey gave: per floor, its walks, its coverage and its expected accuracy.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use fieldwalk::Rejections;
use fieldwalk::map::FloorIndex;
use fieldwalk::metrics::ErrorSummary;
use fieldwalk::survey::Coverage;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::map::MANIFEST_FILE;
use serde::{Deserialize, Serialize};

use crate::commands::survey::walks::{RecordingLosses, Walks};
use crate::stop::Stop;
use crate::table::{number, table};

/// One floor's line.
#[derive(Debug, Serialize)]
pub struct FloorReport {
    floor: String,
    ordinal: i32,
    file: String,
    file_bytes: u64,
    n_walks: usize,
    refused_walks: Vec<RefusedReport>,
    n_steps: usize,
    n_lines_rejected: u64,
    #[serde(skip)]
    first_line_rejected: Option<String>,
    n_stale_wifi_rows: u64,
    n_recordings_cut: u64,
    n_chunks_damaged: u64,
    n_messages_malformed: u64,
    samples_rejected: Rejections,
    n_waypoints_rejected: u64,
    n_waypoints_off_plan: usize,
    n_transmitters: usize,
    open_m2: f64,
    covered_m2: f64,
    route_m: f64,
    /// Nothing where it was not asked for, or no walk could be left out.
    expected_accuracy: Option<ExpectedReport>,
    /// The file that shows all this.
    picture: PathBuf,
}

#[derive(Debug, Serialize)]
struct RefusedReport {
    file: String,
    reason: String,
}

#[derive(Debug, Serialize)]
struct ExpectedReport {
    n_points: usize,
    median_m: f64,
    p80_m: f64,
}

/// A floor of the map on disk.
#[derive(Debug, Deserialize)]
pub struct FloorFile {
    pub name: String,
    pub file: String,
    #[serde(skip)]
    n_bytes: u64,
}

/// The files of the floors of the map in `dir`.
pub fn floor_files(dir: &Path) -> Result<Vec<FloorFile>, FormatError> {
    #[derive(Deserialize)]
    struct Manifest {
        floors: Vec<FloorFile>,
    }
    let path = dir.join(MANIFEST_FILE);
    let text = fs::read(&path).map_err(|error| FormatError::io("read the manifest", &path, error))?;
    let manifest: Manifest = serde_json::from_slice(&text)
        .map_err(|error| FormatError::malformed(error.to_string(), "write the map again").at_path(&path))?;
    let mut files = manifest.floors;
    for floor in &mut files {
        let path = dir.join(&floor.file);
        let metadata = fs::metadata(&path).map_err(|error| FormatError::io("open the map", &path, error))?;
        floor.n_bytes = metadata.len();
    }
    Ok(files)
}

impl FloorReport {
    pub fn new(
        floor: &FloorIndex,
        coverage: Coverage,
        walks: &Walks,
        file: Option<&FloorFile>,
        expected: Option<ErrorSummary>,
        picture: PathBuf,
    ) -> Self {
        let map = floor.map();
        let RecordingLosses { n_cut, n_corrupt_chunks, n_malformed } = walks.recordings;
        let refused = walks.refused.iter().map(|refused| RefusedReport {
            file: refused.path.display().to_string(),
            reason: refused.reason.clone(),
        });
        Self {
            floor: map.name.clone(),
            ordinal: map.ordinal,
            file: file.map_or_else(String::new, |file| file.file.clone()),
            file_bytes: file.map_or(0, |file| file.n_bytes),
            n_walks: walks.used.len(),
            refused_walks: refused.collect(),
            n_steps: walks.used.iter().map(|walk| walk.steps().len()).sum(),
            n_lines_rejected: walks.n_lines_rejected,
            first_line_rejected: walks.first_line_rejected.clone(),
            n_stale_wifi_rows: walks.n_stale_wifi,
            n_recordings_cut: n_cut,
            n_chunks_damaged: n_corrupt_chunks,
            n_messages_malformed: n_malformed,
            samples_rejected: walks.rejections(),
            n_waypoints_rejected: walks.used.iter().map(|walk| walk.n_refused_waypoints()).sum(),
            n_waypoints_off_plan: walks.n_waypoints_off_plan,
            n_transmitters: coverage.n_transmitters,
            open_m2: coverage.open_m2,
            covered_m2: coverage.covered_m2,
            route_m: coverage.route_m,
            expected_accuracy: expected.map(|summary| ExpectedReport {
                n_points: summary.n_points,
                median_m: summary.median_m,
                p80_m: summary.p80_m,
            }),
            picture,
        }
    }

    fn cells(&self) -> Vec<String> {
        let expected = |value: fn(&ExpectedReport) -> f64, decimals: usize| {
            number(self.expected_accuracy.as_ref().map_or(f64::NAN, value), decimals)
        };
        vec![
            self.floor.clone(),
            self.n_walks.to_string(),
            self.refused_walks.len().to_string(),
            self.n_steps.to_string(),
            number(self.route_m, 0),
            number(self.open_m2, 0),
            number(100.0 * self.covered_m2 / self.open_m2, 0),
            self.n_transmitters.to_string(),
            number(self.file_bytes as f64 / 1e6, 2),
            expected(|e| e.median_m, 2),
            expected(|e| e.p80_m, 2),
            expected(|e| e.n_points as f64, 0),
        ]
    }

    /// What was not used, a line each.
    fn remarks(&self) -> Vec<String> {
        let Rejections { implausible, late, duplicate, jumped, .. } = self.samples_rejected;
        let first = self.first_line_rejected.as_deref().unwrap_or_default();
        let counts = [
            (self.n_lines_rejected, format!("lines not understood, the first: {first}")),
            (self.n_recordings_cut, "recordings cut short".into()),
            (self.n_chunks_damaged, "damaged chunks of recordings".into()),
            (self.n_messages_malformed, "malformed messages in recordings".into()),
            (implausible, "samples with an impossible value".into()),
            (late, "samples later than the reorder window".into()),
            (duplicate, "samples given twice".into()),
            (jumped, "samples stamped far ahead of the others".into()),
            (self.n_waypoints_rejected, "waypoints out of order or not finite".into()),
            (self.n_waypoints_off_plan as u64, "waypoints beside the plan, where nothing is mapped".into()),
            (self.n_stale_wifi_rows, "WiFi rows too old to tell a place".into()),
        ];
        let counted = counts.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}"));
        let refused = self.refused_walks.iter().map(|walk| format!("refused {}: {}", walk.file, walk.reason));
        counted.chain(refused).map(|remark| format!("{}: {remark}", self.floor)).collect()
    }
}

/// Prints the table and what was not used.
pub fn print(building: &str, dir: &Path, reports: &[FloorReport], out: &mut impl Write) -> Result<(), Stop> {
    let header = [
        "floor",
        "walks",
        "refused",
        "steps",
        "route m",
        "open m²",
        "covered %",
        "transmitters",
        "file MB",
        "median m",
        "p80 m",
        "points",
    ];
    writeln!(out, "{building}: map in {}", dir.display())?;
    writeln!(out, "{}", table(&header, 1, reports.iter().map(FloorReport::cells)).trim_fmt())?;
    if reports.iter().any(|report| report.expected_accuracy.is_some()) {
        writeln!(
            out,
            "median and p80: expected error of `fused`, each walk on the map of the others, start known to ± 2 m"
        )?;
    }
    for report in reports {
        writeln!(out, "{}: picture in {}", report.floor, report.picture.display())?;
    }
    for remark in reports.iter().flat_map(FloorReport::remarks) {
        writeln!(out, "{remark}")?;
    }
    Ok(())
}
