//! `fieldwalk import`: logs of any format become recordings.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::Georeference;
use fieldwalk_formats::ilc::{LineFault, LineRejections};
use fieldwalk_formats::recording::{
    InOrder, Losses, Record, RecordingInfo, RecordingWriter, open_recording_on,
};
use fieldwalk_formats::{FormatError, read_plan};
use serde_json::{Map, Value, json};

use crate::arguments::ImportArguments;
use crate::stop::{Stop, note};

/// What became of one log.
#[derive(Debug)]
struct Imported {
    info: RecordingInfo,
    n_records: u64,
    n_waypoints: u64,
    /// From the first record to the last, in seconds.
    duration_s: f64,
    losses: Losses,
    lines: Option<LineRejections>,
}

/// Imports the logs one after the other; one that fails does not stop the others, and leaves no file.
pub fn run(arguments: &ImportArguments, out: &mut impl Write) -> Result<(), Stop> {
    let targets = targets(arguments)?;
    let georeference = arguments.plan.as_deref().map(georeference).transpose()?;
    let mut n_failed = 0;
    for (log, target) in &targets {
        match import(arguments, log, target, georeference) {
            Ok(imported) if arguments.json => {
                writeln!(out, "{}", serde_json::to_string(&imported.to_json(log, target))?)?;
            }
            Ok(imported) => imported.print(log, target, out)?,
            Err(error) => {
                note("error", &error.to_string());
                n_failed += 1;
            }
        }
    }
    if n_failed == 0 {
        return Ok(());
    }
    if targets.len() > 1 {
        note("error", &format!("{n_failed} of {} logs could not be imported", targets.len()));
    }
    Err(Stop::Incomplete)
}

/// The recording that each log becomes: never the log itself, nor one file for two.
fn targets(arguments: &ImportArguments) -> Result<Vec<(PathBuf, PathBuf)>, Stop> {
    let is_file =
        |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
    let (logs, dir) = (&arguments.logs, &arguments.out);
    if is_file(dir) {
        if let [log] = &logs[..] {
            return Ok(vec![(log.clone(), unlike(log, dir.clone())?)]);
        }
        let message =
            format!("--out {} names one recording, and there are {} logs", dir.display(), logs.len());
        return Err(Stop::Usage(message));
    }
    fs::create_dir_all(dir).map_err(|error| FormatError::io("make the folder", dir, error))?;
    let mut targets: Vec<(PathBuf, PathBuf)> = Vec::new();
    for log in logs {
        // One that is not there fails when its turn comes, and stops no other.
        let name = log.canonicalize().unwrap_or_else(|_| log.clone());
        let stem = if name.is_dir() { name.file_name() } else { name.file_stem() };
        let mut file = stem.unwrap_or(OsStr::new("log")).to_owned();
        file.push(".mcap");
        let target = unlike(log, dir.join(file))?;
        if let Some((other, _)) = targets.iter().find(|(_, known)| *known == target) {
            return Err(Stop::Usage(format!(
                "{} and {} would both become {}",
                other.display(),
                log.display(),
                target.display()
            )));
        }
        targets.push((log.clone(), target));
    }
    Ok(targets)
}

/// `target`, if it is not `log`.
fn unlike(log: &Path, target: PathBuf) -> Result<PathBuf, Stop> {
    match (log.canonicalize(), target.canonicalize()) {
        (Ok(a), Ok(b)) if a == b => {
            Err(Stop::Usage(format!("{} would replace itself: give another --out", log.display())))
        }
        _ => Ok(target),
    }
}

fn georeference(plan: &Path) -> Result<Georeference, FormatError> {
    let bytes = fs::read(plan).map_err(|error| FormatError::io("read the plan", plan, error))?;
    let plan_read = read_plan(&bytes).map_err(|error| error.at_path(plan))?;
    plan_read.georeference.ok_or_else(|| {
        FormatError::malformed("the plan has no georeference", "draw it in longitude and latitude")
            .at_path(plan)
    })
}

fn import(
    arguments: &ImportArguments,
    log: &Path,
    target: &Path,
    georeference: Option<Georeference>,
) -> Result<Imported, FormatError> {
    let mut records = InOrder::new(open_recording_on(log, georeference)?);
    // What a log says about itself is known once it has been read a little; nothing is written before.
    let first = records.next().transpose()?;
    let mut info = records.source().info();
    if let Some(floor) = &arguments.floor {
        info.floor.clone_from(floor);
    }
    // Beside the target first, so that a log that fails halfway leaves nothing that looks whole.
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = target.with_file_name(name);
    let written = write(arguments, &part, &info, log, first, &mut records);
    let counts = written.and_then(|counts| {
        fs::rename(&part, target)
            .map_err(|error| FormatError::io("write the recording", target, error))
            .map(|()| counts)
    });
    if counts.is_err() {
        let _ = fs::remove_file(&part);
    }
    let Counts { n_records, n_waypoints, duration_s } = counts?;
    let source = records.source();
    Ok(Imported {
        info,
        n_records,
        n_waypoints,
        duration_s,
        losses: source.losses(),
        lines: source.line_rejections().cloned(),
    })
}

#[derive(Debug)]
struct Counts {
    n_records: u64,
    n_waypoints: u64,
    duration_s: f64,
}

type Log = InOrder<Box<dyn fieldwalk_formats::recording::RecordSource + Send>>;

fn write(
    arguments: &ImportArguments,
    part: &Path,
    info: &RecordingInfo,
    log: &Path,
    first: Option<Record>,
    records: &mut Log,
) -> Result<Counts, FormatError> {
    let mut writer = start(part, info, arguments.zstd)?;
    let begin = first.map(|record| record.time());
    let (mut last, mut n_waypoints) = (begin, 0);
    let mut next = first.map(Ok).or_else(|| records.next());
    while let Some(record) = next {
        let record = record?;
        if matches!(record, Record::Waypoint { .. }) {
            if !records.source().is_in_floor_frame() {
                return Err(FormatError::malformed(
                    "its waypoints are in degrees, and no plan places them",
                    "give the floor's plan, drawn in longitude and latitude, with --plan",
                )
                .at_path(log));
            }
            n_waypoints += 1;
        }
        writer.write(&record)?;
        last = last.max(Some(record.time()));
        next = records.next();
    }
    let n_records = writer.n_written();
    writer.finish()?;
    let duration_s = begin.zip(last).map_or(0.0, |(begin, last)| last.secs_since(begin));
    Ok(Counts { n_records, n_waypoints, duration_s })
}

#[cfg(feature = "compression")]
fn start(path: &Path, info: &RecordingInfo, zstd: bool) -> Result<RecordingWriter<File>, FormatError> {
    if !zstd {
        return RecordingWriter::create(path, info);
    }
    let file = File::create(path).map_err(|error| FormatError::io("create the recording", path, error))?;
    RecordingWriter::new_compressed(file, path, info)
}

#[cfg(not(feature = "compression"))]
fn start(path: &Path, info: &RecordingInfo, zstd: bool) -> Result<RecordingWriter<File>, FormatError> {
    if zstd {
        let remedy = "leave --zstd out, or build with the feature `compression`";
        return Err(FormatError::malformed("this build does not compress", remedy).at_path(path));
    }
    RecordingWriter::create(path, info)
}

impl Imported {
    fn print(&self, log: &Path, target: &Path, out: &mut impl Write) -> Result<(), Stop> {
        let Self { info, n_records, n_waypoints, duration_s, losses, lines } = self;
        let or_unknown = |text: &str| if text.is_empty() { "unknown".to_owned() } else { text.to_owned() };
        writeln!(
            out,
            "{} -> {}: {n_records} records in {duration_s:.1} s, {n_waypoints} waypoints; floor {}, device {}",
            log.display(),
            target.display(),
            or_unknown(&info.floor),
            or_unknown(&info.device)
        )?;
        match lines {
            None => writeln!(out, "  {losses}")?,
            Some(lines) => {
                let causes: String = faults(lines).map(|(fault, n)| format!("; {n} {fault}")).collect();
                let (n, n_stale) = (lines.total(), lines.n_stale_wifi);
                writeln!(out, "  lines rejected: {n}{causes}; stale WiFi rows left out: {n_stale}")?;
            }
        }
        Ok(())
    }

    fn to_json(&self, log: &Path, target: &Path) -> Value {
        let Losses { was_cut, n_corrupt_chunks, n_malformed, n_foreign_messages } = self.losses;
        let lines: Map<String, Value> = self
            .lines
            .iter()
            .flat_map(faults)
            .map(|(fault, n)| (fault.to_string().replace(' ', "_"), n.into()))
            .collect();
        json!({
            "log": log.display().to_string(),
            "recording": target.display().to_string(),
            "n_records": self.n_records,
            "n_waypoints": self.n_waypoints,
            "duration_s": self.duration_s,
            "device": self.info.device,
            "floor": self.info.floor,
            "losses": {
                "was_cut": was_cut,
                "n_corrupt_chunks": n_corrupt_chunks,
                "n_malformed": n_malformed,
                "n_foreign_messages": n_foreign_messages,
            },
            "lines_rejected": lines,
            "n_stale_wifi_rows": self.lines.as_ref().map_or(0, |lines| lines.n_stale_wifi),
        })
    }
}

fn faults(lines: &LineRejections) -> impl Iterator<Item = (LineFault, u64)> {
    LineFault::ALL.into_iter().map(|fault| (fault, lines.count(fault))).filter(|(_, n)| *n > 0)
}
