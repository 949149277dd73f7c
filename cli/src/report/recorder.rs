//! Systems run side by side over one walk, keeping what a page shows of them.

use std::sync::Arc;
use std::time::Instant;

use fieldwalk::attitude::{Attitude, CarryMode};
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::metrics::ScoredFix;
use fieldwalk::positioner::{Fix, Mode, PositionError, PositionHint, Positioner};
use fieldwalk::sensor::Sample;
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use serde::Serialize;

use crate::evaluation::{PointKind, TruthPoint, WalkScore};
use crate::report::model::{Band, points_cm};
use crate::report::packed::{NO_LENGTH, Packed, cm, length_cm, ms_after};
use crate::report::truth::Truth;

/// So many particles of a cloud are kept.
const KEPT: usize = 60;
/// So many particles of a walk are written for each system: long walks show fewer a cloud.
const MAX_WRITTEN: usize = 60_000;
/// While no step is made, a fix is kept this often.
const IDLE: Duration = Duration::from_millis(500);

/// Runs systems over the records of one walk, in order of time; memory grows with the steps, not with the samples.
#[derive(Debug)]
pub struct WalkRecorder {
    runs: Vec<SystemRun>,
}

/// One system on one walk.
#[derive(Debug)]
pub struct SystemRun {
    positioner: Positioner,
    fixes: Vec<Fix>,
    clouds: Vec<(Timestamp, Vec<Point2>)>,
    scored: Vec<(Timestamp, ScoredFix)>,
    /// Its errors at the truth points, as an evaluation has them.
    pub score: WalkScore,
}

/// One system's fixes on the page, and its clouds.
#[derive(Debug, Serialize)]
pub struct Track {
    /// In milliseconds, u32.
    time: Packed,
    /// x and y in centimetres, i32.
    place: Packed,
    /// In 256ths of a turn clockwise from +y, u8.
    heading: Packed,
    /// In centimetres, u16.
    radius_68: Packed,
    /// In centimetres, u16.
    radius_95: Packed,
    /// In centimetres, u16; 65535 where the truth is not known.
    error: Packed,
    /// Of each cloud, in milliseconds, u32.
    cloud_time: Packed,
    /// Of each cloud: x and y in centimetres, i32.
    cloud_place: Packed,
    /// Of each cloud: what one unit of its offsets is, in millimetres, u16.
    cloud_unit: Packed,
    /// Particles a cloud.
    n_particles: usize,
    /// Of each particle: x and y from the cloud's place in units, each plus 128, u8.
    particles: Packed,
    /// At waypoints: time in milliseconds, u32.
    scored_time: Packed,
    /// At waypoints: error in centimetres, u16.
    scored_error: Packed,
}

impl WalkRecorder {
    /// Runs `recipes` on `floor` with random `seed`.
    pub fn new(floor: &Arc<FloorIndex>, recipes: &[Recipe], seed: u64) -> Self {
        let run = |recipe: &Recipe| SystemRun {
            positioner: Positioner::new(Arc::clone(floor), recipe.clone(), seed),
            fixes: Vec::new(),
            clouds: Vec::new(),
            scored: Vec::new(),
            score: WalkScore::default(),
        };
        Self { runs: recipes.iter().map(run).collect() }
    }

    /// Tells all systems of a place.
    ///
    /// # Errors
    /// As [`Positioner::hint`]; no system has a start then.
    pub fn hint(&mut self, hint: PositionHint) -> Result<(), PositionError> {
        for run in &mut self.runs {
            run.positioner.hint(hint)?;
            run.keep_fix();
            run.keep_cloud();
        }
        Ok(())
    }

    /// Takes a sample in.
    pub fn push(&mut self, sample: &Sample) {
        for run in &mut self.runs {
            run.push(sample);
        }
    }

    /// Scores all systems at a known place, with what came before it.
    pub fn pass(&mut self, truth: &TruthPoint) {
        for run in &mut self.runs {
            run.pass(truth);
        }
    }

    /// Ends the walk.
    pub fn finish(mut self) -> Vec<SystemRun> {
        for run in &mut self.runs {
            run.positioner.flush();
            run.keep_fix();
        }
        self.runs
    }
}

impl SystemRun {
    fn push(&mut self, sample: &Sample) {
        let before = Instant::now();
        if self.positioner.push(*sample).is_some() {
            self.score.step_us.push(before.elapsed().as_secs_f64() * 1e6);
            self.keep_fix();
            self.keep_cloud();
        } else if self.fixes.last().is_some_and(|last| sample.time - last.time >= IDLE) {
            self.keep_fix();
        }
    }

    fn pass(&mut self, truth: &TruthPoint) {
        let scored = self.positioner.fix_at(truth.time).map(|fix| ScoredFix {
            error_m: fix.position.distance_m(truth.point),
            radius_68_m: fix.radius_68_m,
            radius_95_m: fix.radius_95_m,
        });
        if let (PointKind::Waypoint, Ok(scored)) = (truth.kind, &scored) {
            self.scored.push((truth.time, *scored));
        }
        self.score.points.push((truth.kind, scored.ok()));
    }

    fn keep_fix(&mut self) {
        let Some(fix) = self.positioner.fix() else { return };
        if self.fixes.last().is_none_or(|last| last.time < fix.time) {
            self.fixes.push(fix);
        }
    }

    fn keep_cloud(&mut self) {
        if let Some(time) = self.fixes.last().map(|fix| fix.time) {
            self.clouds.push((time, subsample(self.positioner.particles(), KEPT)));
        }
    }

    /// The last fix.
    pub(super) fn ended(&self) -> Option<Timestamp> {
        self.fixes.last().map(|fix| fix.time)
    }

    /// What the fixes rest on, how the phone was held and where it was carried by them, over time.
    pub(super) fn bands(&self, began: Timestamp) -> Vec<Band> {
        let end_s = self.ended().map_or(0.0, |ended| ended.secs_since(began));
        let band = |name: &str, said: fn(&Fix) -> &'static str| {
            let change = |fix: &Fix| (fix.time.secs_since(began).max(0.0), said(fix).to_owned());
            Band::of_changes(name, &self.fixes.iter().map(change).collect::<Vec<_>>(), end_s)
        };
        let bands = [
            band("mode", |fix| mode_name(fix.mode)),
            band("held", |fix| attitude_name(fix.attitude)),
            band("carry", |fix| carry_name(fix.carry_mode)),
        ];
        bands.into_iter().filter(|band| !band.spans.is_empty()).collect()
    }

    pub(super) fn track(&self, began: Timestamp, truth: &Truth) -> Track {
        let fixes = &self.fixes;
        let error = |fix: &Fix| {
            truth.at(fix.time).map_or(NO_LENGTH, |place| length_cm(fix.position.distance_m(place)))
        };
        let n_particles = self.clouds.iter().map(|cloud| cloud.1.len()).max().unwrap_or(0);
        let n_particles = n_particles.min((MAX_WRITTEN / self.clouds.len().max(1)).max(4));
        let clouds: Vec<Cloud> = self.clouds.iter().map(|cloud| Cloud::of(&cloud.1, n_particles)).collect();
        Track {
            time: Packed::u32s(fixes.iter().map(|fix| ms_after(began, fix.time))),
            place: points_cm(fixes.iter().map(|fix| fix.position)),
            heading: Packed::u8s(fixes.iter().map(|fix| turn_256(fix.heading_rad))),
            radius_68: Packed::u16s(fixes.iter().map(|fix| length_cm(fix.radius_68_m))),
            radius_95: Packed::u16s(fixes.iter().map(|fix| length_cm(fix.radius_95_m))),
            error: Packed::u16s(fixes.iter().map(error)),
            cloud_time: Packed::u32s(self.clouds.iter().map(|cloud| ms_after(began, cloud.0))),
            cloud_place: points_cm(clouds.iter().map(|cloud| cloud.centre)),
            cloud_unit: Packed::u16s(clouds.iter().map(|cloud| cloud.unit_mm)),
            n_particles,
            particles: Packed::u8s(clouds.iter().flat_map(|cloud| cloud.offsets.iter().copied())),
            scored_time: Packed::u32s(self.scored.iter().map(|scored| ms_after(began, scored.0))),
            scored_error: Packed::u16s(self.scored.iter().map(|scored| length_cm(scored.1.error_m))),
        }
    }
}

/// A cloud in bytes.
struct Cloud {
    centre: Point2,
    unit_mm: u16,
    offsets: Vec<u8>,
}

impl Cloud {
    /// `n` of `particles`, evenly picked.
    fn of(particles: &[Point2], n: usize) -> Self {
        let picked: Vec<Point2> =
            (0..n).filter_map(|k| particles.get(k * particles.len() / n.max(1))).copied().collect();
        let sum = picked.iter().fold(Point2::default(), |sum, &p| sum + p);
        let centre = sum * (1.0 / picked.len().max(1) as f64);
        let centre = Point2::new(f64::from(cm(centre.x_m)), f64::from(cm(centre.y_m))) * 0.01;
        let reach_m =
            picked.iter().map(|&p| (p - centre).x_m.abs().max((p - centre).y_m.abs())).fold(0.0, f64::max);
        let unit_mm = (1e3 * reach_m / 127.0).ceil().max(1.0) as u16;
        let offset = |m: f64| (128.0 + (1e3 * m / f64::from(unit_mm)).round()) as u8;
        let offsets = picked.iter().flat_map(|&p| [offset((p - centre).x_m), offset((p - centre).y_m)]);
        Self { centre, unit_mm, offsets: offsets.collect() }
    }
}

/// `n` of the particles, each as often as its weight says.
fn subsample(particles: impl Iterator<Item = (Point2, f32)> + Clone, n: usize) -> Vec<Point2> {
    let total: f64 = particles.clone().map(|(_, weight)| f64::from(weight)).sum();
    let mut kept = Vec::with_capacity(n);
    let mut reached = 0.0;
    for (place, weight) in particles {
        reached += f64::from(weight);
        while kept.len() < n && total * (kept.len() as f64 + 0.5) / n as f64 <= reached {
            kept.push(place);
        }
    }
    kept
}

fn turn_256(heading_rad: f64) -> u8 {
    (heading_rad / std::f64::consts::TAU * 256.0).round().rem_euclid(256.0) as u8
}

/// What a fix rests on, for people.
pub(crate) fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Started => "started",
        Mode::ParticleFilter => "walking",
        Mode::Beacon => "by beacons",
        Mode::Paused => "paused",
        Mode::Stale => "stale",
        _ => "other",
    }
}

/// How a phone is held, for people.
fn attitude_name(attitude: Attitude) -> &'static str {
    match attitude {
        Attitude::UpwardForwardHorizontal => "level, ahead",
        Attitude::UpwardForwardInclined => "inclined, ahead",
        Attitude::UpwardNotForward => "up, not ahead",
        Attitude::NotUpward => "not up",
        _ => "unknown",
    }
}

/// Where a phone is carried, for people.
fn carry_name(mode: CarryMode) -> &'static str {
    match mode {
        CarryMode::HeldUp => "in hand",
        CarryMode::HeldUpright => "upright in hand",
        CarryMode::Calling => "at the ear",
        CarryMode::Swinging => "swinging",
        CarryMode::FrontPocket => "front pocket",
        CarryMode::BackPocket => "back pocket",
        CarryMode::OnTable => "on a table",
        _ => "unknown",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64) -> Point2 {
        Point2::new(x_m, 0.0)
    }

    #[test]
    fn particles_are_kept_as_often_as_they_weigh() {
        let particles = [(at(0.0), 1.0), (at(1.0), 0.0), (at(2.0), 0.5), (at(3.0), 0.5)];
        let kept: Vec<f64> = subsample(particles.into_iter(), 8).iter().map(|p| p.x_m).collect();
        assert_eq!(kept, [0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 3.0, 3.0]);
        assert!(subsample([].into_iter(), 8).is_empty());
    }

    #[test]
    fn a_cloud_in_bytes_is_true_to_half_its_unit() {
        let particles: Vec<Point2> = (0..50)
            .map(|k| Point2::new(12.0 + 0.37 * f64::from(k), 3.0 - 0.11 * f64::from(k * k % 17)))
            .collect();
        let cloud = Cloud::of(&particles, 50);
        let unit_m = 1e-3 * f64::from(cloud.unit_mm);
        for (particle, bytes) in particles.iter().zip(cloud.offsets.chunks(2)) {
            let offset = |byte: u8| unit_m * (f64::from(byte) - 128.0);
            let read = cloud.centre + Point2::new(offset(bytes[0]), offset(bytes[1]));
            assert!(
                (read - *particle).x_m.abs() <= 0.51 * unit_m
                    && (read - *particle).y_m.abs() <= 0.51 * unit_m
            );
        }
        assert_eq!(Cloud::of(&particles, 7).offsets.len(), 14);
        assert!(Cloud::of(&[], 0).offsets.is_empty());
    }

    #[test]
    fn headings_are_turns() {
        let turns = [0.0, 0.5, -0.25, 1.0].map(|turns| turn_256(turns * std::f64::consts::TAU));
        assert_eq!(turns, [0, 128, 192, 0]);
    }
}
