//! Clusters of beacons: three or more that hang near each other.

use crate::geometry::Point2;
use crate::map::Transmitter;
use crate::radio::RadioObservation;
use crate::radio::range::Range;
use crate::sensor::TransmitterId;

/// Beacons are linked when they are this much farther apart than the range, at most: plans are drawn by hand.
const TOLERANCE: f64 = 1.1;
/// More beacons than this near one are not looked at: no cluster needs them.
const MAX_NEIGHBOURS: usize = 64;
/// The smallest angle of a triangle that tells a place, as its sine: 15°.
const MIN_SINE: f64 = 0.258_8;

/// Beacons of the map that hang near each other.
#[derive(Clone, Debug, PartialEq)]
pub struct BeaconCluster {
    /// Their indices among the map's transmitters, ascending; three at least.
    pub members: Vec<u32>,
    /// The mean of their places.
    pub centre: Point2,
}

/// The clusters among `transmitters`: beacons that stand in triangles with no side longer than `range_m`, and triangles that
/// share a beacon, together.
///
/// Inside such a triangle one is within range of all three. Access points make no cluster, nor do beacons in a line.
///
/// # Source
/// iBILL 2017, Eqs 2–4 and Fig. 3: triangles whose side is the accurate range are covered three times.
pub fn find_clusters(transmitters: &[Transmitter], range_m: f64) -> Vec<BeaconCluster> {
    let mut beacons: Vec<(u32, Point2)> = (0u32..)
        .zip(transmitters)
        .filter(|(_, t)| !matches!(t.id, TransmitterId::WifiBssid(_)) && t.position.is_finite())
        .map(|(index, t)| (index, t.position))
        .collect();
    // Along x, so that only what is near in x is compared.
    beacons.sort_by(|a, b| a.1.x_m.total_cmp(&b.1.x_m));
    // Of each beacon the first of its cluster, as known so far.
    let mut first: Vec<usize> = (0..beacons.len()).collect();
    let mut is_member = vec![false; beacons.len()];
    let is_near = |a: usize, b: usize| beacons[a].1.distance_m(beacons[b].1) <= TOLERANCE * range_m;
    for a in 0..beacons.len() {
        let farthest_x_m = beacons[a].1.x_m + TOLERANCE * range_m;
        let beside = (a + 1..beacons.len()).take_while(|&b| beacons[b].1.x_m <= farthest_x_m);
        let near: Vec<usize> = beside.filter(|&b| is_near(a, b)).take(MAX_NEIGHBOURS).collect();
        for (k, &b) in near.iter().enumerate() {
            for &c in &near[k + 1..] {
                if is_near(b, c) && is_triangle([a, b, c].map(|k| beacons[k].1)) {
                    [a, b, c].into_iter().for_each(|k| is_member[k] = true);
                    let (x, y, z) = (root(&first, a), root(&first, b), root(&first, c));
                    let least = x.min(y).min(z);
                    [x, y, z].into_iter().for_each(|k| first[k] = least);
                }
            }
        }
    }
    let mut clusters: Vec<(usize, BeaconCluster)> = Vec::new();
    for (k, &(index, place)) in beacons.iter().enumerate().filter(|&(k, _)| is_member[k]) {
        let of = root(&first, k);
        match clusters.iter_mut().find(|(first, _)| *first == of) {
            Some((_, cluster)) => {
                cluster.members.push(index);
                let n = cluster.members.len() as f64;
                cluster.centre = cluster.centre + (place - cluster.centre) * (1.0 / n);
            }
            None => clusters.push((of, BeaconCluster { members: vec![index], centre: place })),
        }
    }
    clusters.iter_mut().for_each(|(_, cluster)| cluster.members.sort_unstable());
    clusters.into_iter().map(|(_, cluster)| cluster).collect()
}

fn root(first: &[usize], mut k: usize) -> usize {
    while first[k] != k {
        k = first[k];
    }
    k
}

/// Whether three places span a triangle that is no line.
fn is_triangle([a, b, c]: [Point2; 3]) -> bool {
    let (u, v, w) = (b - a, c - a, c - b);
    let twice_area = (u.x_m * v.y_m - u.y_m * v.x_m).abs();
    let mut sides = [u.norm_m(), v.norm_m(), w.norm_m()];
    sides.sort_by(f64::total_cmp);
    // The smallest angle lies between the two longer sides.
    twice_area > MIN_SINE * sides[1] * sides[2]
}

/// By how many circles of radius `range_m` a place is covered on average, where beacons stand in a lattice of equilateral
/// triangles with sides of `side_m`: `2π/√3 · (range/side)²`.
///
/// Where circles touch, `range = side/2`, it is π/(2√3) = 0.91; where the side is the range, as in a cluster, 3.63.
///
/// # Source
/// iBILL 2017, Eqs 2–4.
pub fn packing_density(side_m: f64, range_m: f64) -> f64 {
    let ratio = range_m / side_m;
    2.0 * core::f64::consts::PI / 3.0f64.sqrt() * ratio * ratio
}

impl BeaconCluster {
    /// The third smallest unbiased range to the cluster's beacons, in metres; nothing when fewer than three were heard.
    pub(super) fn third_range_m(
        &self,
        transmitters: &[Transmitter],
        radio: &[RadioObservation],
    ) -> Option<f64> {
        let mut nearest_m = [f64::INFINITY; super::MIN_BEACONS];
        for range in self.heard(transmitters, radio) {
            let mut range_m = range.unbiased_m;
            for slot_m in &mut nearest_m {
                if range_m < *slot_m {
                    core::mem::swap(slot_m, &mut range_m);
                }
            }
        }
        Some(nearest_m[super::MIN_BEACONS - 1]).filter(|m| m.is_finite())
    }

    /// Puts the ranges to the cluster's beacons into `ranges`.
    pub(crate) fn ranges(
        &self,
        transmitters: &[Transmitter],
        radio: &[RadioObservation],
        ranges: &mut Vec<Range>,
    ) {
        ranges.clear();
        let room = ranges.capacity().max(super::MIN_BEACONS);
        ranges.extend(self.heard(transmitters, radio).take(room));
    }

    /// The ranges to those of the cluster's beacons that were heard.
    fn heard<'a>(
        &'a self,
        transmitters: &'a [Transmitter],
        radio: &'a [RadioObservation],
    ) -> impl Iterator<Item = Range> + 'a {
        radio
            .iter()
            .filter(|o| self.members.binary_search(&o.transmitter).is_ok())
            .filter_map(|o| Range::of(transmitters, o))
    }
}
