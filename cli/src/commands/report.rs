//! `fieldwalk report`: recordings become a page that plays them.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::PositionHint;
use fieldwalk::survey::SurveyTrack;
use fieldwalk::system::Recipe;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::recording::{InOrder, Record, open_recording_on};

use crate::arguments::{ReplayStart, ReportArguments};
use crate::commands::replay::{check_floor, off_plan, open_floor};
use crate::evaluation::{RowGroup, TruthPoint, WalkScore, truth_points};
use crate::report::{ErrorCurve, Report, Truth, Walk, WalkRecorder, page};
use crate::simulated::read_truth;
use crate::stop::{Stop, note};
use crate::walks::ReadWalk;
use crate::{probe, progress};

/// Where the truth is known at all times, it is scored once a second from this one on, as the demo does.
const FIRST_SCORED_S: i64 = 5;

/// Replays every recording under every system and writes the page; a recording that fails does not stop the others.
pub fn run(arguments: &ReportArguments, out: &mut impl Write) -> Result<(), Stop> {
    let (building, floor) = open_floor(&arguments.map, arguments.floor.as_deref())?;
    let is_asked =
        |name: &&str| arguments.systems.is_empty() || arguments.systems.iter().any(|asked| asked == name);
    let replays = Replays {
        floor: Arc::new(FloorIndex::new(floor)),
        recipes: Recipe::NAMES.into_iter().filter(|name| is_asked(name)).filter_map(Recipe::named).collect(),
        arguments,
    };
    probe::writable(page::ACTION, &arguments.out)?;
    let (mut walks, mut scores) = (Vec::new(), Vec::new());
    let bar = progress::bar("recordings", arguments.traces.len());
    for trace in &arguments.traces {
        match replays.replay(trace) {
            Ok((walk, score)) => {
                walks.push(walk);
                scores.push(score);
            }
            Err(Stop::Failed(message)) => bar.suspend(|| note("error", &message)),
            Err(other) => return Err(other),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let (n_walks, n_failed) = (walks.len(), arguments.traces.len() - walks.len());
    if n_walks == 0 {
        return Err(Stop::Incomplete);
    }
    page::write(&replays.report(&building, walks, &scores), &arguments.out)?;
    writeln!(out, "{} plays {n_walks} walks: open it in a browser", arguments.out.display())?;
    if n_failed == 0 { Ok(()) } else { Err(Stop::Incomplete) }
}

/// What to run, and how.
struct Replays<'a> {
    floor: Arc<FloorIndex>,
    recipes: Vec<Recipe>,
    arguments: &'a ReportArguments,
}

impl Replays<'_> {
    /// Runs the recording at `trace`: what the page shows, and each system's scores.
    fn replay(&self, trace: &Path) -> Result<(Walk, Vec<WalkScore>), Stop> {
        let map = self.floor.map();
        let read = ReadWalk::open(trace, map.plan.georeference)?;
        check_floor(map, read.floor_name.as_deref(), trace)?;
        let (truth, points) =
            match (read_truth(trace, self.floor.map().ordinal)?, SurveyTrack::of(&read.walk)) {
                (Some(line), _) => {
                    let truth = Truth::continuous(line);
                    let points = truth.every_second(FIRST_SCORED_S);
                    (truth, points)
                }
                (None, Some(track)) => (Truth::of_track(&track), truth_points(&track)),
                (None, None) => (Truth::of_marks(read.walk.waypoints()), Vec::new()),
            };
        let mut recorder = WalkRecorder::new(&self.floor, &self.recipes, self.arguments.seed);
        let began = self.feed(&mut recorder, trace, &points)?;
        let mut runs = recorder.finish();
        let name = trace.file_stem().unwrap_or_default().to_string_lossy();
        let walk = Walk::new(name, self.arguments.seed, began, &runs, &truth);
        Ok((walk, runs.iter_mut().map(|run| std::mem::take(&mut run.score)).collect()))
    }

    /// Gives all records to `recorder`, the start when it comes, and stops at every truth point; gives the first
    /// record's time.
    fn feed(
        &self,
        recorder: &mut WalkRecorder,
        trace: &Path,
        points: &[TruthPoint],
    ) -> Result<Timestamp, Stop> {
        let map = self.floor.map();
        let mut points = points.iter().peekable();
        let (mut began, mut is_started) = (None, false);
        for record in InOrder::new(open_recording_on(trace, map.plan.georeference)?) {
            let record = record?;
            let time = record.time();
            began.get_or_insert(time);
            while let Some(point) = points.next_if(|point| point.time < time) {
                recorder.pass(point);
            }
            let start = match (self.arguments.start, &record) {
                (ReplayStart::At(point), _) => Some(point),
                (ReplayStart::Waypoint, Record::Waypoint { point, .. }) => Some(*point),
                _ => None,
            };
            if let Some(point) = start.filter(|_| !is_started) {
                let radius_m = self.arguments.start_radius;
                let hint = PositionHint { point, radius_m, floor: map.ordinal, time, direction: None };
                recorder.hint(hint).map_err(|_| off_plan(map, point, trace))?;
                is_started = true;
            }
            if let Record::Sample(sample) = record {
                recorder.push(&sample);
            }
        }
        points.for_each(|point| recorder.pass(point));
        began.ok_or_else(|| {
            FormatError::malformed("the recording holds no record", "give another").at_path(trace).into()
        })
    }

    fn report(&self, building: &str, walks: Vec<Walk>, scores: &[Vec<WalkScore>]) -> Report {
        let label = &self.floor.map().name;
        let title = self.arguments.title.clone().unwrap_or_else(|| format!("{building}, floor {label}"));
        let systems = self.recipes.iter().map(|recipe| recipe.name.clone()).collect();
        let about = match self.arguments.start {
            ReplayStart::Cold => "replayed from an unknown start".into(),
            _ => format!("replayed from a start known to ± {} m", self.arguments.start_radius),
        };
        let mut report = Report::new(title, about, systems);
        let n_walks = walks.len();
        let (mut rows, mut curves) = (Vec::new(), Vec::new());
        for (k, recipe) in self.recipes.iter().enumerate() {
            let of_system: Vec<&WalkScore> = scores.iter().map(|walk| &walk[k]).collect();
            let group = RowGroup {
                dataset: "recordings",
                floor: label,
                system: &recipe.name,
                start: "",
                n_walks,
                seeds: 1,
            };
            rows.extend(group.rows(&of_system));
            curves.extend(ErrorCurve::of(&recipe.name, &of_system));
        }
        report.set_errors(n_walks, rows, curves);
        walks.into_iter().for_each(|walk| report.add(&self.floor, label, walk));
        report.sort_worst_first();
        report.truncate(self.arguments.walks as usize);
        report
    }
}
