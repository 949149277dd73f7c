use super::*;
use crate::sensor::TransmitterId;
use proptest::prelude::*;

/// A beacon that is heard at −60 dBm from a metre, 20 dB less from ten; its ranges are exact.
fn beacon(k: u8, x_m: f64, y_m: f64) -> Transmitter {
    Transmitter {
        id: TransmitterId::BleAddress([0, 0, 0, 0, 0, k]),
        position: Point2::new(x_m, y_m),
        power_at_1m_dbm: -60.0,
        path_loss_exponent: 2.0,
        sigma_db: 0.0,
        n_sightings: 9,
    }
}

fn triangle() -> Vec<Transmitter> {
    vec![beacon(0, 10.0, 10.0), beacon(1, 14.0, 10.0), beacon(2, 12.0, 13.4)]
}

fn heard(transmitters: &[Transmitter], at: Point2) -> Vec<RadioObservation> {
    let power = |t: &Transmitter| (-60.0 - 20.0 * libm::log10(t.position.distance_m(at).max(0.1))) as f32;
    (0u32..)
        .zip(transmitters)
        .map(|(transmitter, t)| RadioObservation { transmitter, rssi_dbm: power(t) })
        .collect()
}

#[test]
fn triangles_make_clusters_and_nothing_else_does() {
    let mut transmitters = triangle();
    transmitters.insert(1, Transmitter { id: TransmitterId::WifiBssid([1; 6]), ..beacon(9, 12.0, 11.0) });
    // A line of three, a pair, and one alone.
    for (k, x_m) in (10u8..).zip([30.0, 33.0, 36.0, 50.0, 53.0, 70.0]) {
        transmitters.push(beacon(k, x_m, 5.0));
    }
    let clusters = find_clusters(&transmitters, 4.0);
    assert_eq!(clusters.len(), 1);
    assert_eq!(clusters[0].members, [0, 2, 3]);
    assert!(clusters[0].centre.distance_m(Point2::new(12.0, 11.133)) < 1e-3);
    // One off the line turns it into a cluster of four; one more elsewhere makes the pair one of three.
    transmitters.extend([beacon(20, 33.0, 8.0), beacon(21, 51.5, 7.5)]);
    let sizes: Vec<usize> =
        find_clusters(&transmitters, 4.0).iter().map(|cluster| cluster.members.len()).collect();
    assert_eq!(sizes, [3, 4, 3]);
    assert!(find_clusters(&transmitters, 2.0).is_empty());
    let broken = [f64::NAN, f64::INFINITY, 0.0].map(|x_m| beacon(1, x_m, 0.0));
    assert!(find_clusters(&broken, 4.0).is_empty());
}

#[test]
fn equations_3_and_4_by_hand() {
    // π/(2√3) where the circles touch, 2π/√3 ≈ 3.6 where the side is their radius.
    assert!((packing_density(8.0, 4.0) - 0.906_9).abs() < 1e-4);
    assert!((packing_density(4.0, 4.0) - 3.627_6).abs() < 1e-4);
}

proptest! {
    #[test]
    fn inside_a_triangle_all_three_are_within_its_longest_side(
        corners in proptest::array::uniform6(0.0f64..10.0), u in 0.0f64..1.0, v in 0.0f64..1.0,
    ) {
        let [a, b, c] = [0, 2, 4].map(|k| Point2::new(corners[k], corners[k + 1]));
        let side_m = a.distance_m(b).max(b.distance_m(c)).max(c.distance_m(a));
        let p = a.lerp(b, u).lerp(c, v);
        prop_assert!([a, b, c].iter().all(|corner| corner.distance_m(p) <= side_m + 1e-9));
    }
}

fn fix(x_m: f64, y_m: f64, walked: (f64, f64)) -> VisitFix {
    VisitFix { point: Point2::new(x_m, y_m), sd_m: 0.5, walked: Point2::new(walked.0, walked.1) }
}

#[test]
fn equation_5_by_hand() {
    // From (1, 1) to (4, 5), while the steps led 5 m along y: θ = arctan(3/4) clockwise from y.
    let straight = [fix(4.0, 5.0, (0.0, 5.0)), fix(1.0, 1.0, (0.0, 0.0))];
    let [offset_rad, sd_rad] = heading_offset_rad(straight.iter()).unwrap();
    assert!((offset_rad - libm::atan2(3.0, 4.0)).abs() < 1e-9);
    // Two fixes 2.5 m from their mean: 0.5/sqrt(2·2.5²).
    assert!((sd_rad - 0.141_4).abs() < 1e-4);
    // The steps led along x: the walker walks 0.6435 rad from y, the level heading is π/2.
    let turned = straight.map(|f| VisitFix { walked: f.walked.turned(core::f64::consts::FRAC_PI_2), ..f });
    let [offset_rad, _] = heading_offset_rad(turned.iter()).unwrap();
    assert!((offset_rad - (libm::atan2(3.0, 4.0) - core::f64::consts::FRAC_PI_2)).abs() < 1e-9);
}

#[test]
fn a_turn_between_fixes_does_not_turn_the_direction() {
    // North, then east, as the steps were; all 0.3 rad clockwise on the floor.
    let walked = [(0.0, 0.0), (0.0, 3.0), (3.0, 3.0)];
    let fixes = walked.map(|(x, y)| {
        let p = Point2::new(x, y).turned(0.3) + Point2::new(7.0, 8.0);
        fix(p.x_m, p.y_m, (x, y))
    });
    assert!((heading_offset_rad(fixes.iter()).unwrap()[0] - 0.3).abs() < 1e-9);
}

#[test]
fn who_stands_has_no_direction() {
    assert_eq!(heading_offset_rad([fix(1.0, 1.0, (0.0, 0.0))].iter()), None);
    assert_eq!(heading_offset_rad([fix(1.0, 1.0, (2.0, 2.0)), fix(1.5, 1.0, (2.0, 2.0))].iter()), None);
    // 0.6 m of steps between fixes of half a metre: 0.5/sqrt(2·0.3²) = 1.18 rad is no direction.
    assert_eq!(heading_offset_rad([fix(1.0, 1.0, (0.0, 0.0)), fix(1.0, 1.6, (0.0, 0.6))].iter()), None);
}

#[test]
fn opinions_count_by_their_variances() {
    let near = agreed(Some([3.1, 0.1]), Some([-3.1, 0.2])).unwrap();
    // 0.0832 rad apart over the wrap, a fifth of it towards the second; 0.01·0.04/0.05 = 0.008.
    assert!((near[0] - (3.1 + 0.2 * (core::f64::consts::TAU - 6.2))).abs() < 1e-9);
    assert!((near[1] - 0.008f64.sqrt()).abs() < 1e-9);
    assert_eq!(agreed(Some([0.0, 0.1]), Some([2.0, 0.2])), Some([2.0, 0.2]));
    assert_eq!((agreed(Some([1.0, 0.1]), None), agreed(None, None)), (Some([1.0, 0.1]), None));
}

/// Rounds at `places`, without steps.
fn visited(places: &[Point2]) -> (BeaconVisit, Vec<RoundOutcome>) {
    let transmitters = triangle();
    let clusters = find_clusters(&transmitters, 4.0);
    let (params, mut ranges) = (BeaconModeParams::default(), Vec::with_capacity(8));
    let mut visit = BeaconVisit::default();
    let outcomes = places
        .iter()
        .map(|&at| {
            let radio = heard(&transmitters, at);
            let round = BeaconRound { radio: &radio, walked: at, offset_before_rad: Some([0.0, 0.5]) };
            visit.hear(&params, &clusters, &transmitters, &round, &mut ranges)
        })
        .collect();
    (visit, outcomes)
}

#[test]
fn the_mode_begins_near_three_beacons_and_ends_a_little_farther_off() {
    // Up through the cluster: the third range is 3.5 m, 2.4 m, 4.4 m and 7 m.
    let along = |y_m: f64| Point2::new(12.0, y_m);
    let (visit, outcomes) = visited(&[along(9.0), along(11.1), along(14.0), along(17.0), along(17.0)]);
    assert_eq!(outcomes[0], RoundOutcome::Outside);
    let place = |outcome: &RoundOutcome| match outcome {
        RoundOutcome::Inside(Some(fix)) => fix.place.point,
        other => panic!("{other:?}"),
    };
    assert!(place(&outcomes[1]).distance_m(along(11.1)) < 0.05);
    // 4.4 m would not begin it, but does not end it.
    assert!(place(&outcomes[2]).distance_m(along(14.0)) < 0.05);
    assert_eq!(outcomes[3..], [RoundOutcome::Inside(None), RoundOutcome::Outside]);
    assert!(!visit.is_inside());
}

#[test]
fn the_fix_is_of_the_middle_of_its_round() {
    let (_, outcomes) = visited(&[Point2::new(12.0, 10.5), Point2::new(12.0, 11.5)]);
    let RoundOutcome::Inside(Some(fix)) = outcomes[1] else { panic!("{outcomes:?}") };
    assert!((fix.since - Point2::new(0.0, 0.5)).norm_m() < 1e-9);
}

#[test]
fn fewer_than_three_beacons_are_no_cluster_s_inside() {
    let transmitters = triangle();
    let clusters = find_clusters(&transmitters, 4.0);
    let radio = heard(&transmitters, clusters[0].centre);
    let mut visit = BeaconVisit::default();
    for n in 0..3 {
        let round = BeaconRound { radio: &radio[..n], walked: Point2::default(), offset_before_rad: None };
        let outcome =
            visit.hear(&BeaconModeParams::default(), &clusters, &transmitters, &round, &mut Vec::new());
        assert_eq!(outcome, RoundOutcome::Outside, "{n}");
    }
}
