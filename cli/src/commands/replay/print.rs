//! A replay, printed: lines for people, JSON for programs, or a digest.

use std::io::Write;
use std::path::Path;

use fieldwalk::Rejections;
use fieldwalk::metrics::{ErrorSummary, ScoredFix};
use fieldwalk::positioner::Fix;
use fieldwalk_formats::ilc::LineFault;
use fieldwalk_formats::recording::Losses;
use serde_json::{Map, Value, json};

use crate::arguments::ReplayArguments;
use crate::bits::FixBits;
use crate::commands::replay::run::{Ending, PassedWaypoint, Sink};
use crate::report::mode_name;
use crate::stop::{Stop, note};
use crate::table::number;

/// How a replay is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Text,
    Json,
    Bits,
    BitsJson,
}

/// Prints the replay of one recording.
#[derive(Debug)]
pub struct Printer<'a, W> {
    shape: Shape,
    trace: String,
    out: &'a mut W,
    bits: FixBits,
    has_header: bool,
    n_fixes: usize,
    n_without_fix: usize,
    scored: Vec<ScoredFix>,
}

impl<'a, W: Write> Printer<'a, W> {
    pub fn new(arguments: &ReplayArguments, trace: &Path, out: &'a mut W) -> Self {
        let shape = match (arguments.bits, arguments.json) {
            (false, false) => Shape::Text,
            (false, true) => Shape::Json,
            (true, false) => Shape::Bits,
            (true, true) => Shape::BitsJson,
        };
        Self {
            shape,
            trace: trace.display().to_string(),
            out,
            bits: FixBits::default(),
            has_header: false,
            n_fixes: 0,
            n_without_fix: 0,
            scored: Vec::new(),
        }
    }

    fn print_json(&mut self, record: &str, fields: Value) -> Result<(), Stop> {
        let mut object = Map::new();
        object.insert("record".into(), record.into());
        object.insert("trace".into(), self.trace.clone().into());
        if let Value::Object(fields) = fields {
            object.extend(fields);
        }
        Ok(writeln!(self.out, "{}", serde_json::to_string(&object)?)?)
    }

    fn print_header(&mut self) -> Result<(), Stop> {
        if !self.has_header {
            self.has_header = true;
            writeln!(self.out, "{}", self.trace)?;
            let [a, b, c, d, e, f, g] = ["time s", "x m", "y m", "heading °", "m/s", "r68 m", "r95 m"];
            writeln!(
                self.out,
                "{a:>8} {b:>8} {c:>8} {d:>9} {e:>5} {f:>6} {g:>6}  mode, error m at waypoints"
            )?;
        }
        Ok(())
    }

    fn print_line(&mut self, time_s: f64, fix: &Fix, remark: &str) -> Result<(), Stop> {
        self.print_header()?;
        let Fix { position, speed_m_s, radius_68_m, radius_95_m, .. } = fix;
        let heading_deg = heading_deg(fix);
        writeln!(
            self.out,
            "{time_s:8.2} {:8.2} {:8.2} {heading_deg:9.0} {speed_m_s:5.2} {radius_68_m:6.2} {radius_95_m:6.2}  {remark}",
            position.x_m, position.y_m
        )?;
        Ok(())
    }

    fn print_summary(&mut self, ending: &Ending<'_>) -> Result<(), Stop> {
        let Rejections { implausible, late, duplicate, jumped, .. } = ending.samples;
        let summary = ErrorSummary::of(&self.scored);
        self.print_header()?;
        let start = if ending.is_started { "start given" } else { "no start given" };
        let (n_fixes, duration_s) = (self.n_fixes, ending.duration_s);
        writeln!(
            self.out,
            "{n_fixes} fixes in {duration_s:.1} s, {start}, {} recoveries",
            ending.n_recoveries
        )?;
        if let Some(summary) = summary {
            writeln!(
                self.out,
                "error at {} waypoints: median {} m, p80 {} m, {} % within the 68 % radius; {} waypoints without a fix",
                summary.n_points,
                number(summary.median_m, 2),
                number(summary.p80_m, 2),
                number(100.0 * summary.inside_68, 0),
                self.n_without_fix
            )?;
        }
        writeln!(
            self.out,
            "samples rejected: {implausible} implausible, {late} late, {duplicate} duplicate, {jumped} stamped ahead"
        )?;
        let Some(lines) = ending.lines else {
            return Ok(writeln!(self.out, "recording: {}", ending.losses)?);
        };
        let causes: String = faults(ending).map(|(fault, n)| format!("; {n} {fault}")).collect();
        let (n_lines, n_stale) = (lines.total(), lines.n_stale_wifi);
        writeln!(self.out, "lines rejected: {n_lines}{causes}; stale WiFi rows left out: {n_stale}")?;
        Ok(())
    }

    fn print_json_summary(&mut self, ending: &Ending<'_>) -> Result<(), Stop> {
        let lines: Map<String, Value> =
            faults(ending).map(|(fault, n)| (fault.to_string().replace(' ', "_"), n.into())).collect();
        let Losses { was_cut, n_corrupt_chunks, n_malformed, n_foreign_messages } = ending.losses;
        let fields = json!({
            "n_fixes": self.n_fixes,
            "duration_s": ending.duration_s,
            "is_started": ending.is_started,
            "n_recoveries": ending.n_recoveries,
            "n_waypoints_without_fix": self.n_without_fix,
            "errors": ErrorSummary::of(&self.scored),
            "samples_rejected": ending.samples,
            "losses": {
                "was_cut": was_cut,
                "n_corrupt_chunks": n_corrupt_chunks,
                "n_malformed": n_malformed,
                "n_foreign_messages": n_foreign_messages,
            },
            "lines_rejected": lines,
            "n_stale_wifi_rows": ending.lines.map_or(0, |lines| lines.n_stale_wifi),
            "bits_sha256": self.bits.hex(),
        });
        self.print_json("summary", fields)
    }
}

impl<W: Write> Sink for Printer<'_, W> {
    fn fix(&mut self, time_s: f64, fix: &Fix) -> Result<(), Stop> {
        self.bits.push(fix);
        self.n_fixes += 1;
        match self.shape {
            Shape::Text => self.print_line(time_s, fix, mode_name(fix.mode)),
            Shape::Json => self.print_json("fix", fix_fields(time_s, fix)),
            Shape::Bits | Shape::BitsJson => Ok(()),
        }
    }

    fn waypoint(&mut self, time_s: f64, passed: &PassedWaypoint) -> Result<(), Stop> {
        let PassedWaypoint { truth, fix, is_first } = passed;
        let error_m = fix.as_ref().ok().map(|fix| fix.position.distance_m(*truth));
        match (fix, error_m) {
            (Ok(fix), Some(error_m)) => {
                self.bits.push(fix);
                if !is_first {
                    let Fix { radius_68_m, radius_95_m, .. } = *fix;
                    self.scored.push(ScoredFix { error_m, radius_68_m, radius_95_m });
                }
            }
            _ if *is_first => {}
            _ => self.n_without_fix += 1,
        }
        match self.shape {
            Shape::Text => match fix {
                Ok(fix) => {
                    let name = if *is_first { "first waypoint" } else { "waypoint" };
                    let error = number(error_m.unwrap_or(f64::NAN), 2);
                    self.print_line(time_s, fix, &format!("{name}, error {error}"))
                }
                Err(cause) => {
                    self.print_header()?;
                    Ok(writeln!(self.out, "{time_s:8.2} waypoint without a fix: {cause}")?)
                }
            },
            Shape::Json => {
                let mut fields =
                    fix.as_ref().map_or_else(|_| json!({"time_s": time_s}), |fix| fix_fields(time_s, fix));
                fields["truth_x_m"] = truth.x_m.into();
                fields["truth_y_m"] = truth.y_m.into();
                fields["error_m"] = error_m.into();
                self.print_json("waypoint", fields)
            }
            Shape::Bits | Shape::BitsJson => Ok(()),
        }
    }

    fn end(&mut self, ending: &Ending<'_>) -> Result<(), Stop> {
        if let Some(why) = ending.unused {
            note("warning", &format!("{}: {why}", self.trace));
        }
        match self.shape {
            Shape::Text => self.print_summary(ending),
            Shape::Json => self.print_json_summary(ending),
            Shape::Bits => Ok(writeln!(self.out, "{}  {}", self.bits.hex(), self.trace)?),
            Shape::BitsJson => {
                let fields = json!({"bits_sha256": self.bits.hex(), "n_fixes": self.n_fixes});
                self.print_json("bits", fields)
            }
        }
    }
}

fn fix_fields(time_s: f64, fix: &Fix) -> Value {
    json!({
        "time_s": time_s,
        "floor": fix.floor,
        "x_m": fix.position.x_m,
        "y_m": fix.position.y_m,
        "latitude_longitude_deg": fix.latitude_longitude_deg,
        "heading_deg": heading_deg(fix),
        "speed_m_s": fix.speed_m_s,
        "radius_68_m": fix.radius_68_m,
        "radius_95_m": fix.radius_95_m,
        "mode": fix.mode,
        "attitude": fix.attitude,
        "carry_mode": fix.carry_mode,
    })
}

/// Clockwise from +y, 0 to 360.
fn heading_deg(fix: &Fix) -> f64 {
    fix.heading_rad.to_degrees().rem_euclid(360.0)
}

fn faults<'a>(ending: &Ending<'a>) -> impl Iterator<Item = (LineFault, u64)> + use<'a> {
    let lines = ending.lines;
    let count = move |fault| lines.map_or(0, |lines| lines.count(fault));
    LineFault::ALL.into_iter().map(move |fault| (fault, count(fault))).filter(|(_, n)| *n > 0)
}
