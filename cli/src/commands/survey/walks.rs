//! The walks of a floor: those that a map can be made of, and why not the others.

use std::fmt;
use std::path::PathBuf;

use fieldwalk::Rejections;
use fieldwalk::survey::{SurveyTrack, SurveyWalk};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::{Floor, LineRejections};
use rayon::prelude::*;

use crate::evaluation::is_test_walk;
use crate::progress;
use crate::walks::ReadWalk;

/// A floor's walks, in order of their files' names.
#[derive(Debug, Default)]
pub struct Walks {
    /// Those that the map is made of.
    pub used: Vec<SurveyWalk>,
    /// Those left out, and why.
    pub refused: Vec<RefusedWalk>,
    /// Lines not understood, in the walks used.
    pub n_lines_rejected: u64,
    /// The first of them: its file, line and fault.
    pub first_line_rejected: Option<String>,
    /// WiFi rows too old to tell a place, in the walks used.
    pub n_stale_wifi: u64,
}

/// A walk left out.
#[derive(Debug)]
pub struct RefusedWalk {
    /// Its file.
    pub path: PathBuf,
    /// What is wrong with it, and what to do.
    pub reason: String,
}

impl Walks {
    /// Reads the walks of `floor` but for the test walks of fold `without`.
    pub fn read(floor: &Floor, without: Option<u8>) -> Self {
        let is_survey_walk = |path: &&PathBuf| without.is_none_or(|fold| !is_test_walk(path, fold));
        let paths: Vec<&PathBuf> = floor.traces.iter().filter(is_survey_walk).collect();
        let bar = progress::bar(format!("{}: walks read", floor.name), paths.len());
        let read: Vec<_> = paths
            .par_iter()
            .map(|path| {
                let read = ReadWalk::open(path);
                bar.inc(1);
                read
            })
            .collect();
        bar.finish_and_clear();
        let mut walks = Self::default();
        for (path, read) in paths.into_iter().zip(read) {
            match read.map_err(reason_of).and_then(usable) {
                Ok(ReadWalk { walk, lines, .. }) => {
                    walks.count_lines(path, &lines);
                    walks.used.push(walk);
                }
                Err(reason) => walks.refused.push(RefusedWalk { path: path.clone(), reason }),
            }
        }
        walks
    }

    /// Samples rejected in the walks used, by cause.
    pub fn rejections(&self) -> Rejections {
        let mut sum = Rejections::default();
        for walk in &self.used {
            let Rejections { implausible, late, duplicate, jumped, .. } = walk.rejections();
            sum.implausible += implausible;
            sum.late += late;
            sum.duplicate += duplicate;
            sum.jumped += jumped;
        }
        sum
    }

    fn count_lines(&mut self, path: &std::path::Path, lines: &LineRejections) {
        self.n_lines_rejected += lines.total();
        self.n_stale_wifi += lines.n_stale_wifi;
        if let (None, Some((line, fault))) = (&self.first_line_rejected, lines.first()) {
            self.first_line_rejected = Some(format!("{}:{line}: {fault}", path.display()));
        }
    }
}

fn reason_of(error: FormatError) -> String {
    let line = error.line().map_or_else(String::new, |line| format!("line {line}: "));
    let remedy = if error.remedy().is_empty() { String::new() } else { format!(" ({})", error.remedy()) };
    format!("{line}{}{remedy}", error.message())
}

/// `read`, if it places steps.
fn usable(read: ReadWalk) -> Result<ReadWalk, String> {
    let lines = match read.lines.total() {
        0 => String::new(),
        n => format!("; {n} lines were not understood"),
    };
    match SurveyTrack::of(&read.walk) {
        None => {
            let n = read.walk.waypoints().len();
            Err(format!("{n} waypoints, where two are needed{lines} (tap one at both ends of a line)"))
        }
        Some(track) if track.steps().is_empty() => {
            Err(format!("no steps between its waypoints{lines} (record the accelerometer, and walk)"))
        }
        Some(_) => Ok(read),
    }
}

impl fmt::Display for RefusedWalk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.reason)
    }
}
