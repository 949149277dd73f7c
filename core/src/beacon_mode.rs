//! Positioning inside a cluster of iBeacons: when it begins and ends, the places that it finds, and the direction that
//! follows from them.

mod cluster;
mod density;

pub use cluster::{BeaconCluster, find_clusters, packing_density};
pub(crate) use density::{ASTRAY_M, FixDensity, contradict};

use serde::{Deserialize, Serialize};

use crate::geometry::{Point2, wrap_rad};
use crate::map::Transmitter;
use crate::radio::RadioObservation;
use crate::radio::range::Range;
use crate::radio::trilateration::{TrilateratedPlace, TrilaterationParams, trilaterate};

/// Beacons in reach that make a place: fewer leave two.
const MIN_BEACONS: usize = 3;
/// The most fixes of a visit that a direction follows from.
const MAX_FIXES: usize = 16;
/// A direction less certain than this is none, in radians.
const MAX_HEADING_SD_RAD: f64 = 1.0;
/// A direction is never more certain than this, in radians: nobody walks straight.
const MIN_HEADING_SD_RAD: f64 = 0.1;

/// So many fixes in a row outvote particles that contradict them.
const MAX_CONTRADICTED: u32 = 6;
/// Opinions farther apart than this contradict each other, in standard deviations of their difference.
const CONTRADICTION_SD: f64 = 3.0;

/// When beacons are believed, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeaconModeParams {
    /// A beacon's accurate range, in metres, which is also the longest side of a cluster's triangles; the paper says several
    /// metres, and hangs its beacons 4 m apart.
    pub range_m: f64,
    /// The mode begins when three beacons of a cluster are within this by their unbiased ranges, in metres.
    pub enter_m: f64,
    /// It ends when fewer than three are within this, in metres: farther than `enter_m`, so that it does not flicker.
    pub leave_m: f64,
    /// For so many rounds in a row.
    pub leave_rounds: u32,
    /// Ranges to a place.
    pub trilateration: TrilaterationParams,
    /// A direction follows from at most so many of the last fixes; 2 as the paper has it, up to 16.
    pub n_heading_fixes: usize,
    /// Whether the direction that was known before a visit counts with that of the visit's fixes, each by its variance. The
    /// paper forgets it.
    pub keeps_direction: bool,
    /// The share of a fix's likelihood that weighs particles which know their place, above 0 and at most 1. Rounds of one
    /// visit hear the same shadows, so that their fixes are off alike and each counts for less than it says. Without, every
    /// fix places all particles anew, as the paper has it.
    pub fix_share: Option<f64>,
    /// Whether positioning pauses while the phone is in a pocket or shaken, and begins anew after.
    pub pauses: bool,
}

impl Default for BeaconModeParams {
    fn default() -> Self {
        Self {
            range_m: 4.0,
            enter_m: 3.0,
            leave_m: 5.0,
            leave_rounds: 2,
            trilateration: TrilaterationParams::default(),
            n_heading_fixes: 8,
            keeps_direction: true,
            fix_share: Some(0.25),
            pauses: true,
        }
    }
}

/// What is remembered of a visit to a cluster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeaconVisit {
    /// The cluster, by its index; nothing outside all.
    cluster: Option<u32>,
    n_outside: u32,
    /// Fixes in a row that the particles contradict.
    #[serde(default)]
    n_contradicted: u32,
    /// The places found, newest first.
    fixes: [Option<VisitFix>; MAX_FIXES],
    /// The direction when it began: walking direction minus level heading, and its standard deviation, in radians.
    offset_before_rad: Option<[f64; 2]>,
    /// Where the steps had led at the last round, whatever was heard.
    last_walked: Option<Point2>,
}

/// A place found by beacons, and where the steps alone had led by then.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VisitFix {
    /// The place, in the floor frame.
    pub point: Point2,
    /// Standard deviation along an axis, in metres.
    pub sd_m: f64,
    /// The steps' sum until the middle of the round, in the level frame, in metres.
    pub walked: Point2,
}

/// What a round of radio came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RoundOutcome {
    /// No cluster is near.
    Outside,
    /// Inside a cluster; nothing when the ranges gave no place to rely on.
    Inside(Option<BeaconFix>),
}

/// A place inside a cluster, and what the last ones say of the direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeaconFix {
    /// The place at the middle of the round.
    pub place: TrilateratedPlace,
    /// What the steps have added since, in the level frame, in metres.
    pub since: Point2,
    /// Walking direction minus level-frame heading of the steps, and its standard deviation, in radians; nothing after a
    /// single fix, or when the fixes do not tell.
    pub offset_rad: Option<[f64; 2]>,
}

/// What a second brought.
#[derive(Clone, Copy, Debug)]
pub struct BeaconRound<'a> {
    /// What was heard.
    pub radio: &'a [RadioObservation],
    /// The sum of the steps so far, in the level frame, in metres.
    pub walked: Point2,
    /// Walking direction minus level-frame heading as the particles have it, and its standard deviation, in radians.
    pub offset_before_rad: Option<[f64; 2]>,
}

impl BeaconVisit {
    /// Whether a cluster is believed to be near.
    pub fn is_inside(&self) -> bool {
        self.cluster.is_some()
    }

    /// Counts a fix that agrees with the particles or contradicts them; true when so many in a row did that the fixes are to
    /// be believed instead.
    pub(crate) fn contradicts(&mut self, is_contradicted: bool) -> bool {
        self.n_contradicted = if is_contradicted { self.n_contradicted + 1 } else { 0 };
        self.n_contradicted >= MAX_CONTRADICTED
    }

    /// Forgets the visit.
    pub fn leave(&mut self) {
        *self = Self::default();
    }

    /// Takes in what a second brought; `ranges` is memory.
    ///
    /// # Source
    /// iBILL 2017, Fig. 4 and §IV-A: the mode begins where three or more beacons of a cluster are within accurate range.
    /// Where it ends, and the rounds that it waits, are ours.
    pub fn hear(
        &mut self,
        params: &BeaconModeParams,
        clusters: &[BeaconCluster],
        transmitters: &[Transmitter],
        round: &BeaconRound<'_>,
        ranges: &mut Vec<Range>,
    ) -> RoundOutcome {
        let BeaconRound { radio, walked, offset_before_rad } = *round;
        let middle = self.last_walked.replace(walked).map_or(walked, |last| last.lerp(walked, 0.5));
        let nearest = clusters
            .iter()
            .zip(0u32..)
            .filter_map(|(cluster, k)| Some((cluster.third_range_m(transmitters, radio)?, k)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match (self.cluster, nearest) {
            (_, Some((third_m, k))) if third_m <= params.enter_m => {
                if self.cluster != Some(k) {
                    *self = Self {
                        cluster: Some(k),
                        last_walked: self.last_walked,
                        offset_before_rad: offset_before_rad.filter(|_| params.keeps_direction),
                        ..Self::default()
                    };
                }
                self.n_outside = 0;
            }
            (Some(cluster), Some((third_m, k))) if cluster == k && third_m <= params.leave_m => {
                self.n_outside = 0;
            }
            _ => self.n_outside += 1,
        }
        if self.n_outside >= params.leave_rounds.max(1) {
            self.leave();
            self.last_walked = Some(walked);
        }
        let Some(cluster) = self.cluster.and_then(|k| clusters.get(k as usize)) else {
            return RoundOutcome::Outside;
        };
        if self.n_outside > 0 {
            return RoundOutcome::Inside(None);
        }
        cluster.ranges(transmitters, radio, ranges);
        let Ok(place) = trilaterate(&params.trilateration, ranges) else { return RoundOutcome::Inside(None) };
        let sd_m = place.sd_m() * core::f64::consts::FRAC_1_SQRT_2;
        self.fixes.copy_within(..MAX_FIXES - 1, 1);
        self.fixes[0] = Some(VisitFix { point: place.point, sd_m, walked: middle });
        let n = params.n_heading_fixes.clamp(2, MAX_FIXES);
        let by_fixes_rad = heading_offset_rad(self.fixes[..n].iter().flatten());
        let offset_rad = agreed(self.offset_before_rad, by_fixes_rad);
        RoundOutcome::Inside(Some(BeaconFix { place, since: walked - middle, offset_rad }))
    }
}

/// The turn, clockwise, that lays the steps onto the fixes, with its standard deviation, in radians; nothing when it is
/// less certain than one radian.
///
/// Of two fixes on a straight way it makes the direction of the line from the one to the other, Eq. 5. Of more it is the
/// least-squares turn, and turns of the way are taken out, since the steps turn with it.
///
/// # Source
/// iBILL 2017, Eq. 5, `θ = arctan((y_l − y_{l−1})/(x_l − x_{l−1}))`: two fixes. A second's walk is as long as a fix is
/// uncertain, so more of them are used.
fn heading_offset_rad<'a>(fixes: impl Iterator<Item = &'a VisitFix> + Clone) -> Option<[f64; 2]> {
    let n = fixes.clone().count() as f64;
    if n < 2.0 {
        return None;
    }
    let mean = |of: fn(&VisitFix) -> Point2| {
        fixes.clone().fold(Point2::default(), |sum, fix| sum + of(fix) * (1.0 / n))
    };
    let (point_mean, walked_mean) = (mean(|fix| fix.point), mean(|fix| fix.walked));
    let (mut along, mut across, mut square_m2, mut variance_m2) = (0.0, 0.0, 0.0, 0.0);
    for fix in fixes {
        let (p, d) = (fix.point - point_mean, fix.walked - walked_mean);
        along += p.x_m * d.x_m + p.y_m * d.y_m;
        across += p.x_m * d.y_m - p.y_m * d.x_m;
        square_m2 += d.x_m * d.x_m + d.y_m * d.y_m;
        variance_m2 += fix.sd_m * fix.sd_m / n;
    }
    let sd_rad = (variance_m2 / square_m2).sqrt();
    // Not a number where nobody walked.
    (sd_rad <= MAX_HEADING_SD_RAD).then(|| [libm::atan2(across, along), sd_rad.max(MIN_HEADING_SD_RAD)])
}

/// Two opinions on an angle, each with its standard deviation, as one; the second alone where they contradict each other.
fn agreed(before_rad: Option<[f64; 2]>, by_fixes_rad: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let (Some([before, before_sd]), Some([fixes, fixes_sd])) = (before_rad, by_fixes_rad) else {
        return by_fixes_rad.or(before_rad);
    };
    let apart = wrap_rad(fixes - before);
    let variances = [before_sd * before_sd, fixes_sd * fixes_sd];
    let total = variances[0] + variances[1];
    if apart * apart > CONTRADICTION_SD * CONTRADICTION_SD * total {
        return by_fixes_rad;
    }
    Some([before + apart * variances[0] / total, (variances[0] * variances[1] / total).sqrt()])
}

#[cfg(test)]
mod tests;
