//! The iBeacon mode in the loop: rounds of radio, fixes that the particles begin from, pauses, and starts from nothing.

use serde::{Deserialize, Serialize};

use crate::beacon_mode::{ASTRAY_M, BeaconFix, BeaconRound, FixDensity, RoundOutcome, contradict};
use crate::geometry::Point2;
use crate::observation::history;
use crate::particle::{Centre, Particles};
use crate::pedestrian::StepEvent;
use crate::radio::RadioObservation;
use crate::radio::range::Range;
use crate::radio::trilateration::{TrilateratedPlace, trilaterate};
use crate::random::{Purpose, draw, uniform};
use crate::system::{MagneticRule, StartRule};
use crate::time::Timestamp;
use crate::tracker::{Tracker, TrackerMode};

/// Steps that a start from nothing is put off for a round in which a cluster is heard.
const WAIT_STEPS: u32 = 8;
/// Without beacons a pause ends in a circle that grows so much a step of it, in metres, from `PAUSE_RADIUS_M`: half a step,
/// for few walk straight.
const PAUSE_GROWTH_M: f64 = 0.35;
const PAUSE_RADIUS_M: f64 = 2.0;
/// The largest such circle, in metres: beyond it magnetic fingerprints alone do not tell a place.
const MAX_RADIUS_M: f64 = 30.0;
/// A direction is never more certain than this, in radians.
const MIN_OFFSET_SD_RAD: f64 = 0.1;
/// Directions of a start where the recipe does not say.
const N_DIRECTIONS: usize = 12;

/// Whether positioning pauses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Pause {
    /// It does not.
    #[default]
    Running,
    /// The phone is in a pocket or shaken.
    Paused { n_steps: u32 },
    /// It is held again, and the place is not known yet.
    Resuming { n_steps: u32, n_waited: u32 },
}

/// Where particles begin: places about a centre, and directions.
struct Spread {
    centre: Point2,
    /// What makes two standard normal numbers a distance from the centre; a disc where it is nothing.
    root_m: Option<[f64; 3]>,
    /// The disc's radius, in metres.
    radius_m: f64,
    /// Walking direction minus level heading of the steps, with its standard deviation; every direction where it is nothing.
    offset_rad: Option<[f64; 2]>,
    /// A move in the level frame that turns with each particle's direction, in metres.
    since: Point2,
}

impl Tracker {
    /// Whether this recipe wants to know once a second what radio was heard.
    pub fn uses_radio_rounds(&self) -> bool {
        self.recipe.radar.is_some() || !self.clusters.is_empty()
    }

    /// What the place rests on.
    pub fn mode(&self) -> TrackerMode {
        match self.state.pause {
            Pause::Paused { n_steps } | Pause::Resuming { n_steps, .. } => TrackerMode::Paused { n_steps },
            Pause::Running if self.state.visit.is_inside() => TrackerMode::Beacons,
            Pause::Running => TrackerMode::Particles,
        }
    }

    /// Consumes what radio was heard in the second before `now`, the strongest first; true when the fix may have changed.
    ///
    /// Inside a cluster of beacons the fix of the ranges weighs particles that know their place. Others it places anew, in
    /// the direction that the last fixes make, or in `N_d` directions, and so does every fix as the paper has it. Steps move
    /// them from there: that is what a walker does who leaves.
    ///
    /// # Source
    /// iBILL 2017, Fig. 4, §IV-A and §IV-C. There a fix replaces the particles, being good to half a metre; among furniture
    /// and beside bodies it is good to two or three, and the particles may know better.
    pub fn hear(&mut self, now: Timestamp, radio: &[RadioObservation]) -> bool {
        let Some(params) = self.recipe.beacons else { return self.match_fingerprint(now, radio) };
        if matches!(self.state.pause, Pause::Paused { .. }) {
            return false;
        }
        let before_rad = self.offset_rad();
        let transmitters = &self.floor.map().transmitters;
        let (visit, ranges) = (&mut self.state.visit, &mut self.scratch.ranges);
        let round = BeaconRound { radio, walked: self.state.walked, offset_before_rad: before_rad };
        match visit.hear(&params, &self.clusters, transmitters, &round, ranges) {
            RoundOutcome::Inside(None) => false,
            RoundOutcome::Inside(Some(fix)) => {
                if !params.fix_share.is_some_and(|share| self.weigh_by_fix(share, &fix)) {
                    self.begin_at_fix(&fix);
                }
                true
            }
            RoundOutcome::Outside => {
                let is_lost = !self.state.is_placed || self.state.pause != Pause::Running;
                is_lost && self.begin_round_cluster(radio)
            }
        }
    }

    /// Whether positioning pauses at this step, or waits for a start after a pause.
    pub(super) fn is_paused_by(&mut self, event: &StepEvent) -> bool {
        if !self.recipe.beacons.is_some_and(|beacons| beacons.pauses) {
            return false;
        }
        let is_hidden = event.attitude.carry_mode.is_pocketed_or_shaken();
        let (pause, is_paused) = match self.state.pause {
            Pause::Running if !is_hidden => return false,
            Pause::Running => (Pause::Paused { n_steps: 1 }, true),
            Pause::Paused { n_steps } | Pause::Resuming { n_steps, .. } if is_hidden => {
                (Pause::Paused { n_steps: n_steps.saturating_add(1) }, true)
            }
            Pause::Paused { n_steps } => (Pause::Resuming { n_steps, n_waited: 0 }, true),
            Pause::Resuming { n_steps, n_waited } => {
                (Pause::Resuming { n_steps: n_steps.saturating_add(1), n_waited: n_waited + 1 }, true)
            }
        };
        self.state.pause = pause;
        match pause {
            Pause::Paused { .. } => self.state.visit.leave(),
            Pause::Resuming { n_steps, n_waited } if n_waited >= WAIT_STEPS || self.clusters.is_empty() => {
                return !self.begin_round_estimate(n_steps);
            }
            _ => {}
        }
        is_paused
    }

    /// Walking direction minus level heading over the particles, and its standard deviation, in radians; nothing where it was
    /// never known.
    fn offset_rad(&self) -> Option<[f64; 2]> {
        if self.state.is_start_unknown || !self.state.is_oriented {
            return None;
        }
        let particles = &self.state.particles;
        let (mut sin, mut cos, mut total) = (0.0, 0.0, 0.0);
        for (&offset_rad, &log_weight) in particles.heading_offset_rad.iter().zip(&particles.log_weight) {
            let weight = f64::from(libm::expf(log_weight));
            let (s, c) = libm::sincos(f64::from(offset_rad));
            (sin, cos, total) = (sin + weight * s, cos + weight * c, total + weight);
        }
        let resultant = (sin * sin + cos * cos).sqrt() / total;
        // The standard deviation of a wrapped normal distribution; not a number where there are no offsets.
        let sd_rad = (-2.0 * libm::log(resultant.min(1.0))).max(0.0).sqrt();
        (resultant > 0.5).then(|| [libm::atan2(sin, cos), sd_rad.max(MIN_OFFSET_SD_RAD)])
    }

    /// Weighs the particles by `share` of the likelihood of `fix`; false when they know no place, when it is out of the
    /// fix's reach, or when fixes contradict them again and again.
    fn weigh_by_fix(&mut self, share: f64, fix: &BeaconFix) -> bool {
        let knows_place =
            self.state.is_placed && !self.state.is_start_unknown && self.state.pause == Pause::Running;
        let Some(estimate) = self.state.estimate.filter(|_| knows_place) else { return false };
        let TrilateratedPlace { point, covariance_m2, .. } = fix.place;
        let [xx, xy, yy] = covariance_m2;
        let [[cloud_xx, cloud_xy], [_, cloud_yy]] = estimate.covariance_m2;
        let off = Point2::new(estimate.x_m, estimate.y_m) - point;
        let is_contradicted = contradict(off, [xx + cloud_xx, xy + cloud_xy, yy + cloud_yy]);
        let is_out_of_reach = off.norm_m() > ASTRAY_M + estimate.radius_95_m;
        if self.state.visit.contradicts(is_contradicted) || is_out_of_reach {
            return false;
        }
        let density = FixDensity::new(covariance_m2);
        let Particles { x_m, y_m, heading_offset_rad, log_weight, .. } = &mut self.state.particles;
        for (i, log_weight) in log_weight.iter_mut().enumerate() {
            let offset_rad = heading_offset_rad.get(i).copied().map(f64::from);
            let since = offset_rad.map_or(Point2::default(), |rad| fix.since.turned(rad));
            let place = Point2::new(f64::from(x_m[i]), f64::from(y_m[i]));
            *log_weight += (share * density.log_at(place - since - point)) as f32;
        }
        self.weigh_alike();
        if !self.weigh() {
            return false;
        }
        self.estimate_cloud(Centre::Mean);
        true
    }

    fn begin_at_fix(&mut self, fix: &BeaconFix) {
        let [xx, xy, yy] = fix.place.covariance_m2;
        // The lower root of the covariance, so that places vary as the ranges do.
        let a = xx.max(0.01).sqrt();
        let b = xy / a;
        let root_m = [a, b, (yy - b * b).max(0.01).sqrt()];
        let is_sound = root_m.iter().all(|m| m.is_finite());
        self.begin(&Spread {
            centre: fix.place.point,
            root_m: is_sound.then_some(root_m),
            radius_m: 1.0,
            offset_rad: fix.offset_rad,
            since: fix.since,
        });
        self.state.is_start_unknown = false;
    }

    /// Begins in a circle round the place that the ranges to the nearest cluster give, roughly; false when none was heard.
    ///
    /// # Source
    /// iBILL 2017, Fig. 7: unbiased distances to the nearest cluster make the initial place, roughly. Its circle is
    /// ours: the uncertainty of the place, or the cluster's middle and how far off it is where the geometry is bad.
    fn begin_round_cluster(&mut self, radio: &[RadioObservation]) -> bool {
        let Some(params) = self.recipe.beacons else { return false };
        let transmitters = &self.floor.map().transmitters;
        let mean_m = |ranges: &[Range]| {
            let (sum, n) =
                ranges.iter().fold((0.0, 0.0), |(sum, n), range| (sum + range.unbiased_m, n + 1.0));
            sum / n
        };
        let ranges = &mut self.scratch.ranges;
        let mut nearest: Option<(f64, usize)> = None;
        for (k, cluster) in self.clusters.iter().enumerate() {
            cluster.ranges(transmitters, radio, ranges);
            let apart_m = mean_m(ranges);
            // Not a number where none of its beacons was heard.
            if apart_m.is_finite() && nearest.is_none_or(|(least_m, _)| apart_m < least_m) {
                nearest = Some((apart_m, k));
            }
        }
        let Some((apart_m, k)) = nearest else { return false };
        let cluster = &self.clusters[k];
        cluster.ranges(transmitters, radio, ranges);
        let sd_m = ranges.iter().map(Range::sd_m).fold(0.0, f64::max);
        let (centre, radius_m) = match trilaterate(&params.trilateration, ranges) {
            Ok(place) => (place.point, 2.0 * place.sd_m()),
            Err(_) => (cluster.centre, apart_m + sd_m),
        };
        let radius_m = radius_m.clamp(params.range_m, MAX_RADIUS_M.max(params.range_m));
        self.begin(&Spread { centre, root_m: None, radius_m, offset_rad: None, since: Point2::default() });
        self.state.is_start_unknown = true;
        true
    }

    /// Begins round the last estimate after a pause of `n_steps` without beacons; false when there is none.
    fn begin_round_estimate(&mut self, n_steps: u32) -> bool {
        self.state.pause = Pause::Running;
        let Some(estimate) = self.state.estimate else { return false };
        let radius_m = (PAUSE_RADIUS_M + PAUSE_GROWTH_M * f64::from(n_steps)).min(MAX_RADIUS_M);
        let centre = Point2::new(estimate.x_m, estimate.y_m);
        self.begin(&Spread { centre, root_m: None, radius_m, offset_rad: None, since: Point2::default() });
        self.state.is_start_unknown = true;
        true
    }

    /// Places the particles anew, what they have learnt of walker and device kept; no allocation once they had a place.
    fn begin(&mut self, spread: &Spread) {
        let (n_directions, n) = self.directions_and_number();
        if !self.state.is_placed {
            self.occupy(vec![0.0; n], vec![0.0; n]);
        }
        let level_rad = self.state.last_level_heading_rad.map(f64::from);
        let particles = &mut self.state.particles;
        particles.repeat_to(n);
        particles.heading_offset_rad.clear();
        for i in 0..n {
            let bits = draw(self.seed, self.state.n_steps, i as u32, Purpose::Start);
            let away = match spread.root_m {
                Some([a, b, c]) => {
                    let [u, v] = [bits[0], bits[1]].map(|b| f64::from(self.normal.sample(b)));
                    Point2::new(a * u, b * u + c * v)
                }
                None => {
                    // Uniform over the disc.
                    let radius_m = spread.radius_m * f64::from(uniform(bits[0])).sqrt();
                    Point2::from_polar(radius_m, core::f64::consts::TAU * f64::from(uniform(bits[1])))
                }
            };
            let offset_rad = match spread.offset_rad {
                Some([mean_rad, sd_rad]) => mean_rad + sd_rad * f64::from(self.normal.sample(bits[2])),
                None => core::f64::consts::TAU * (i % n_directions) as f64 / n_directions as f64,
            };
            let place = spread.centre + away + spread.since.turned(offset_rad);
            particles.x_m[i] = place.x_m as f32;
            particles.y_m[i] = place.y_m as f32;
            if let Some(level_rad) = level_rad {
                let (sin, cos) = libm::sincos(level_rad + offset_rad);
                particles.heading_sin[i] = sin as f32;
                particles.heading_cos[i] = cos as f32;
                particles.heading_offset_rad.push(offset_rad as f32);
            }
        }
        particles.forget_places();
        if let MagneticRule::History(params) = &self.recipe.magnetic {
            history::forget(params, &mut self.state.history, &mut self.state.particles);
        }
        self.state.is_oriented = level_rad.is_some();
        self.state.pause = Pause::Running;
        self.weigh_alike();
        self.estimate_cloud(Centre::Mean);
    }

    /// `N_d`, and how many particles begin: every direction at every place, as far as particles go.
    pub(super) fn directions_and_number(&self) -> (usize, usize) {
        let most = self.recipe.n_particles.max(1);
        match (self.recipe.start, self.recipe.spawning) {
            (StartRule::Circle { n_directions, n_places }, Some(_)) => {
                (n_directions.max(1), n_directions.saturating_mul(n_places).clamp(1, most))
            }
            (StartRule::Circle { n_directions, .. }, None) => (n_directions.max(1), most),
            _ => (N_DIRECTIONS, most),
        }
    }
}

#[cfg(test)]
mod tests;
