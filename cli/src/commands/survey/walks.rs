//! The walks of a floor: those that a map can be made of, and why not the others.

use std::fmt;
use std::path::PathBuf;

use fieldwalk::Rejections;
use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk::survey::{SurveyTrack, SurveyWalk};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::LineRejections;
use fieldwalk_formats::recording::Losses;
use rayon::prelude::*;

use crate::evaluation::is_test_walk;
use crate::floors::Floor;
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
    /// What recordings that are no text lost, in the walks used.
    pub recordings: RecordingLosses,
    /// Waypoints beside the plan, in the walks used.
    pub n_waypoints_off_plan: usize,
}

/// A waypoint may lie this far beside the plan: outlines are drawn, and taps made, no more exactly.
const OFF_PLAN_M: f64 = 1.0;

/// What the walks' recordings lost, summed; lines of text count elsewhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct RecordingLosses {
    /// Recordings that end before their end.
    pub n_cut: u64,
    /// Chunks that have changed since they were written.
    pub n_corrupt_chunks: u64,
    /// Messages that are not of their kind's form.
    pub n_malformed: u64,
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
                let read = ReadWalk::open(path, floor.plan.georeference);
                bar.inc(1);
                read
            })
            .collect();
        bar.finish_and_clear();
        let mut walks = Self::default();
        for (path, read) in paths.into_iter().zip(read) {
            match read.map_err(reason_of).and_then(|read| usable(read, floor)) {
                Ok(ReadWalk { walk, lines, losses, .. }) => {
                    walks.count(path, &lines, &losses);
                    walks.n_waypoints_off_plan += n_off_plan(&walk, &floor.plan);
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

    fn count(&mut self, path: &std::path::Path, lines: &LineRejections, losses: &Losses) {
        self.recordings.n_cut += u64::from(losses.was_cut);
        self.recordings.n_corrupt_chunks += losses.n_corrupt_chunks;
        self.recordings.n_malformed += losses.n_malformed - lines.total();
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

/// `read`, if it places steps on `floor`.
fn usable(read: ReadWalk, floor: &Floor) -> Result<ReadWalk, String> {
    if let Some(name) = read.other_floor(&floor.name) {
        let named = &floor.name;
        return Err(format!(
            "recorded on floor {name}, where {named} is surveyed (move it to that floor's folder)"
        ));
    }
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
        Some(track) if n_off_plan(&read.walk, &floor.plan) == read.walk.waypoints().len() => {
            let point = track.waypoints()[0].point;
            let FloorPlan { width_m, height_m, .. } = floor.plan;
            Err(format!(
                "no waypoint on the plan, the first at {:.1}, {:.1}, where the plan has {width_m:.1} m x {height_m:.1} m \
                 (give plan and waypoints in one frame)",
                point.x_m, point.y_m
            ))
        }
        Some(_) => Ok(read),
    }
}

/// Number of waypoints of `walk` beside `plan`, where no map reaches.
fn n_off_plan(walk: &SurveyWalk, plan: &FloorPlan) -> usize {
    let is_within = |v_m: f64, extent_m: f64| (-OFF_PLAN_M..=extent_m + OFF_PLAN_M).contains(&v_m);
    let is_on = |point: Point2| is_within(point.x_m, plan.width_m) && is_within(point.y_m, plan.height_m);
    walk.waypoints().iter().filter(|waypoint| !is_on(waypoint.point)).count()
}

impl fmt::Display for RefusedWalk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.reason)
    }
}
