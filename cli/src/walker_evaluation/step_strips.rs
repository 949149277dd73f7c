//! A picture of a walk whose steps were miscounted: acceleration, contacts and steps found, in strips of some seconds.

use fieldwalk::sensor::Reading;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::oxford_steps::AccelerometerReader;

use super::oxford_steps::{CountedRun, SYSTEMS};
use crate::plot::style;
use crate::plot::svg::{Anchor, Attribute, Px, Svg, points};

/// Seconds in a strip, and a strip's size with the gap below it, in the picture's units.
const STRIP_S: f64 = 20.0;
const STRIP: (f64, f64) = (1_100.0, 84.0);
const GAP: f64 = 18.0;
const TOP: f64 = 40.0;
const LEFT: f64 = 44.0;
/// Magnitudes of the specific force that a strip spans, in m/s².
const FORCE_M_S2: (f64, f64) = (2.0, 20.0);
/// Points a second that are drawn.
const DRAWN_HZ: f64 = 50.0;

/// The picture of what the first detector made of `counted`.
///
/// The steps found stand above the curve, the contacts below it.
///
/// # Errors
/// When the accelerometer's file cannot be read again.
pub fn step_strips(counted: &CountedRun) -> Result<String, FormatError> {
    let curve = magnitudes(counted)?;
    let steps = &counted.steps[0];
    let first = curve.first().map_or(0.0, |point| point.0);
    let last = curve.last().map_or(0.0, |point| point.0);
    let n_strips = ((last - first) / STRIP_S).ceil().clamp(1.0, 200.0) as usize;
    let height = TOP + n_strips as f64 * (STRIP.1 + GAP) + 8.0;
    let name = &counted.run.name;
    let title = format!(
        "{name}: {} steps by {}, {} contacts ({:+.1} %)",
        steps.len(),
        SYSTEMS[0],
        counted.contacts.len(),
        counted.signed_error_percent(0)
    );
    let mut svg = Svg::new(LEFT + STRIP.0 + 12.0, height, &title, &style::chart_sheet());
    svg.rectangle("fw-ground", (0.0, 0.0), (LEFT + STRIP.0 + 12.0, height), "#ffffff");
    svg.text("fw-title", (12.0, 22.0), Anchor::Start, &title);
    for k in 0..n_strips {
        let from_s = first + STRIP_S * k as f64;
        let strip = Strip { from_s, top: TOP + k as f64 * (STRIP.1 + GAP) };
        strip.draw(&mut svg, &curve, &counted.contacts, steps, from_s - first);
    }
    Ok(svg.finish())
}

struct Strip {
    from_s: f64,
    top: f64,
}

impl Strip {
    fn x(&self, time_s: f64) -> f64 {
        LEFT + STRIP.0 * (time_s - self.from_s) / STRIP_S
    }

    fn has(&self, time_s: f64) -> bool {
        (self.from_s..self.from_s + STRIP_S).contains(&time_s)
    }

    fn draw(
        &self,
        svg: &mut Svg,
        curve: &[(f64, f64)],
        contacts: &[Timestamp],
        steps: &[Timestamp],
        at_s: f64,
    ) {
        let bottom = self.top + STRIP.1;
        svg.line("fw-axis", (LEFT, bottom), (LEFT + STRIP.0, bottom));
        svg.text("fw-small", (LEFT - 6.0, bottom), Anchor::End, &format!("{at_s:.0} s"));
        let y = |force_m_s2: f64| {
            let share = (force_m_s2 - FORCE_M_S2.0) / (FORCE_M_S2.1 - FORCE_M_S2.0);
            bottom - STRIP.1 * share.clamp(0.0, 1.0)
        };
        let inside = curve.iter().filter(|(time_s, _)| self.has(*time_s));
        let line = points(inside.map(|&(time_s, force)| (self.x(time_s), y(force))));
        svg.element("polyline", &[("points", &line), ("fill", &"none"), ("stroke", &style::colour(0))]);
        let mut ticks = |times: &[Timestamp], (from, to): (f64, f64), colour: &str| {
            for time in times.iter().map(|time| seconds(*time)).filter(|time_s| self.has(*time_s)) {
                let x = Px(self.x(time));
                let ends: [Attribute<'_>; 5] =
                    [("x1", &x), ("x2", &x), ("y1", &Px(from)), ("y2", &Px(to)), ("stroke", &colour)];
                svg.element("line", &ends);
            }
        };
        ticks(contacts, (bottom, bottom - 0.35 * STRIP.1), style::colour(2));
        ticks(steps, (self.top, self.top + 0.35 * STRIP.1), style::colour(1));
    }
}

/// Time in seconds and magnitude of the specific force, thinned out.
fn magnitudes(counted: &CountedRun) -> Result<Vec<(f64, f64)>, FormatError> {
    let mut curve: Vec<(f64, f64)> = Vec::new();
    for sample in AccelerometerReader::open(&counted.run.accelerometer())? {
        let sample = sample?;
        let Reading::SpecificForce([x, y, z]) = sample.reading else { continue };
        let time_s = seconds(sample.time);
        if curve.last().is_none_or(|(last_s, _)| time_s >= last_s + 1.0 / DRAWN_HZ) {
            curve.push((time_s, f64::from(x * x + y * y + z * z).sqrt()));
        }
    }
    Ok(curve)
}

fn seconds(time: Timestamp) -> f64 {
    time.as_nanos() as f64 * 1e-9
}
