//! What a page knows, as it is written into it: plain JSON, with long arrays packed.

use std::sync::Arc;

use fieldwalk::map::FloorIndex;
use fieldwalk::time::Timestamp;
use serde::Serialize;

use crate::evaluation::Row;
use crate::report::floor::FloorPage;
use crate::report::packed::{Packed, cm};
use crate::report::recorder::{SystemRun, Track};
use crate::report::summary::{ErrorCurve, WalkErrors};
use crate::report::truth::{Truth, TruthTrack};

/// Everything on a page.
#[derive(Debug, Serialize)]
pub struct Report {
    pub(super) title: String,
    /// What was done, in a line.
    about: String,
    software: String,
    systems: Vec<String>,
    /// Index of the system by which walks are ordered: the last, since recipes are listed from simple to complete.
    primary: usize,
    floors: Vec<FloorPage>,
    walks: Vec<Walk>,
    /// Walks that count in the errors, whether or not they are on the page.
    n_walks: usize,
    rows: Vec<Row>,
    curves: Vec<ErrorCurve>,
    #[serde(skip)]
    indices: Vec<Arc<FloorIndex>>,
}

/// One walk that can be played.
#[derive(Debug, Serialize)]
pub struct Walk {
    name: String,
    /// Index of its floor.
    floor: usize,
    /// As text: a script's numbers have no 64 bits.
    seed: String,
    duration_s: f64,
    truth: TruthTrack,
    tracks: Vec<Track>,
    errors: Vec<Option<WalkErrors>>,
    bands: Vec<Band>,
}

/// A named strip under the time axis.
#[derive(Clone, Debug, Serialize)]
pub struct Band {
    /// What it tells, such as `mode`.
    pub name: String,
    /// Its spans, in order of time.
    pub spans: Vec<Span>,
}

/// A stretch of time with a label.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Span {
    /// Its beginning, in seconds after the walk's.
    pub from_s: f64,
    /// Its end, in seconds after the walk's beginning.
    pub to_s: f64,
    /// What holds then.
    pub label: String,
}

impl Report {
    /// A report called `title`, on `systems`; `about` says in a line what was done.
    pub fn new(title: impl Into<String>, about: impl Into<String>, systems: Vec<String>) -> Self {
        Self {
            title: title.into(),
            about: about.into(),
            software: concat!("fieldwalk ", env!("CARGO_PKG_VERSION")).into(),
            primary: systems.len().saturating_sub(1),
            systems,
            floors: Vec::new(),
            walks: Vec::new(),
            n_walks: 0,
            rows: Vec::new(),
            curves: Vec::new(),
            indices: Vec::new(),
        }
    }

    /// Adds a walk on `floor`, which is called `label`; floors are written once however many walks they have.
    pub fn add(&mut self, floor: &Arc<FloorIndex>, label: &str, mut walk: Walk) {
        walk.floor = match self.indices.iter().position(|known| Arc::ptr_eq(known, floor)) {
            Some(known) => known,
            None => {
                self.indices.push(Arc::clone(floor));
                self.floors.push(FloorPage::of(floor.map(), label));
                self.floors.len() - 1
            }
        };
        self.walks.push(walk);
    }

    /// States the errors of all `n_walks` walks: the table, and each system's errors in full.
    pub fn set_errors(&mut self, n_walks: usize, rows: Vec<Row>, curves: Vec<ErrorCurve>) {
        (self.n_walks, self.rows, self.curves) = (n_walks, rows, curves);
    }

    /// Orders walks by the mean error of the last system, the largest first, and those without truth last.
    pub fn sort_worst_first(&mut self) {
        let primary = self.primary;
        let mean_m = |walk: &Walk| {
            walk.errors.get(primary).copied().flatten().map_or(f64::NEG_INFINITY, |errors| errors.mean_m)
        };
        self.walks.sort_by(|a, b| mean_m(b).total_cmp(&mean_m(a)));
    }

    /// Leaves only the first `n` walks on the page; all keep counting in the errors.
    pub fn truncate(&mut self, n: usize) {
        self.walks.truncate(n);
    }
}

impl Walk {
    /// The walk `name` from what a recorder has seen, against `truth`.
    pub(crate) fn new(
        name: impl Into<String>,
        seed: u64,
        began: Timestamp,
        runs: &[SystemRun],
        truth: &Truth,
    ) -> Self {
        let ended = runs.iter().filter_map(SystemRun::ended).chain(truth.ended()).max().unwrap_or(began);
        Self {
            name: name.into(),
            floor: 0,
            seed: seed.to_string(),
            duration_s: ended.secs_since(began).max(0.0),
            truth: truth.track(began),
            tracks: runs.iter().map(|run| run.track(began, truth)).collect(),
            errors: runs.iter().map(|run| WalkErrors::of(&run.score)).collect(),
            bands: runs.last().map(|run| run.bands(began)).unwrap_or_default(),
        }
    }

    /// Adds a strip under the time axis, called `name`: what begins at some second and holds until the next.
    #[must_use]
    pub fn with_changes(mut self, name: &str, changes: &[(f64, String)]) -> Self {
        self.bands.push(Band::of_changes(name, changes, self.duration_s));
        self
    }
}

impl Band {
    /// A strip of what is known to begin at some times and to hold until the next.
    pub fn of_changes(name: &str, changes: &[(f64, String)], end_s: f64) -> Self {
        let mut spans: Vec<Span> = Vec::new();
        for (k, (from_s, label)) in changes.iter().enumerate() {
            let to_s = changes.get(k + 1).map_or(end_s, |next| next.0);
            match spans.last_mut() {
                Some(last) if last.label == *label => last.to_s = to_s,
                _ => spans.push(Span { from_s: *from_s, to_s, label: label.clone() }),
            }
        }
        Self { name: name.into(), spans }
    }
}

/// Points as packed centimetres, x and y in turn.
pub(super) fn points_cm(points: impl Iterator<Item = fieldwalk::geometry::Point2>) -> Packed {
    Packed::i32s(points.flat_map(|point| [cm(point.x_m), cm(point.y_m)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_of_a_band_are_one_span() {
        let changes = [(0.0, "a".into()), (1.0, "b".into()), (2.5, "b".into()), (4.0, "a".into())];
        let spans = Band::of_changes("mode", &changes, 6.0).spans;
        let span = |from_s, to_s, label: &str| Span { from_s, to_s, label: label.into() };
        assert_eq!(spans, [span(0.0, 1.0, "a"), span(1.0, 4.0, "b"), span(4.0, 6.0, "a")]);
    }
}
