//! Moments inside a walk at which it is scored as if it ended there.

use std::path::Path;

use fieldwalk::geometry::Point2;
use fieldwalk::random::CounterRng;
use fieldwalk::survey::Waypoint;
use fieldwalk::time::Duration;
use rand::RngExt;
use sha1::{Digest, Sha1};

use crate::evaluation::{PointKind, TruthPoint};

/// Number of cut-offs of a walk.
const N_CUT_OFFS: usize = 5;
/// Nearer to a node than this, in metres, no walk is cut off: a system that snaps to nodes gains nothing.
const NODE_CLEARANCE_M: f64 = 1.5;
/// Draws before a walk that is all nodes is given up.
const MAX_DRAWS: usize = 1_000;

/// Five moments of a walk, uniform in time where it is at least 1.5 m from all `nodes`, in order of time.
///
/// The truth lies on the straight line between two waypoints, evenly in time: no step detector has a part in it. The
/// moments depend on the name of the walk's file alone. A walk that never is far from a node has fewer, or none.
pub(super) fn cut_offs(path: &Path, waypoints: &[Waypoint], nodes: &[Point2]) -> Vec<TruthPoint> {
    let (Some(first), Some(last)) = (waypoints.first(), waypoints.last()) else { return Vec::new() };
    let digest = Sha1::digest(path.file_name().unwrap_or_default().as_encoded_bytes());
    let key = digest.iter().take(8).fold(0, |key, &byte| (key << 8) | u64::from(byte));
    let mut rng = CounterRng::new(key, N_CUT_OFFS as u64);
    let span_ns = (last.time - first.time).as_nanos();
    let mut cut_offs: Vec<TruthPoint> = (0..MAX_DRAWS)
        .filter_map(|_| {
            let time = first.time + Duration::from_nanos(rng.random_range(0..=span_ns));
            let pair = waypoints.windows(2).find(|pair| time <= pair[1].time)?;
            let share = time.secs_since(pair[0].time) / pair[1].time.secs_since(pair[0].time);
            let point = pair[0].point.lerp(pair[1].point, share);
            let is_clear = nodes.iter().all(|node| node.distance_m(point) >= NODE_CLEARANCE_M);
            is_clear.then_some(TruthPoint { kind: PointKind::CutOff, time, point })
        })
        .take(N_CUT_OFFS)
        .collect();
    cut_offs.sort_by_key(|cut_off| cut_off.time);
    cut_offs
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::time::Timestamp;

    fn waypoints() -> Vec<Waypoint> {
        let at = |s: i64, x_m: f64, y_m: f64| Waypoint {
            time: Timestamp::from_millis(1_000 * s),
            point: Point2::new(x_m, y_m),
        };
        vec![at(0, 0.0, 0.0), at(10, 10.0, 0.0), at(15, 10.0, 4.0)]
    }

    #[test]
    fn cut_offs_lie_on_the_way_away_from_nodes() {
        let nodes = [Point2::new(0.0, 0.0), Point2::new(10.0, 0.0), Point2::new(10.0, 4.0)];
        let mut is_on_second = false;
        for name in 0..20 {
            let path = format!("folder/{name}.txt");
            let found = cut_offs(Path::new(&path), &waypoints(), &nodes);
            assert_eq!(found.len(), N_CUT_OFFS);
            for TruthPoint { time, point, .. } in &found {
                let s = time.secs_since(Timestamp::from_millis(0));
                // One metre a second, then 0.8.
                let (x_m, y_m) = if s < 10.0 { (s, 0.0) } else { (10.0, 0.8 * (s - 10.0)) };
                assert!(point.distance_m(Point2::new(x_m, y_m)) < 1e-9, "{s} {point:?}");
                assert!(nodes.iter().all(|node| node.distance_m(*point) >= NODE_CLEARANCE_M));
                is_on_second |= s > 10.0;
            }
            assert!(found.windows(2).all(|pair| pair[0].time <= pair[1].time));
        }
        assert!(is_on_second);
    }

    #[test]
    fn the_name_of_the_file_decides() {
        let times = |path: &str| -> Vec<Timestamp> {
            cut_offs(Path::new(path), &waypoints(), &[]).iter().map(|cut_off| cut_off.time).collect()
        };
        assert_eq!(times("a/w.txt"), times("b/w.txt"));
        assert_ne!(times("a/w.txt"), times("a/v.txt"));
    }

    #[test]
    fn a_walk_between_near_nodes_has_none() {
        let nodes: Vec<Point2> = (0..=10).map(|x| Point2::new(f64::from(x), 0.0)).collect();
        assert!(cut_offs(Path::new("w"), &waypoints()[..2], &nodes).is_empty());
        assert!(cut_offs(Path::new("w"), &[], &[]).is_empty());
    }
}
