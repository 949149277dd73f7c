use proptest::prelude::*;

use super::*;

fn range(x_m: f64, y_m: f64, range_m: f64) -> Range {
    Range { centre: Point2::new(x_m, y_m), raw_m: range_m, unbiased_m: range_m, log_sd: 0.5 }
}

fn exact(beacons: &[(f64, f64)], truth: Point2) -> Vec<Range> {
    beacons.iter().map(|&(x_m, y_m)| range(x_m, y_m, Point2::new(x_m, y_m).distance_m(truth))).collect()
}

/// An equilateral triangle, 4 m a side, as iBILL hangs its clusters.
const CLUSTER: [(f64, f64); 3] = [(0.0, 0.0), (4.0, 0.0), (2.0, 3.464_101_615_137_754_6)];

fn place(ranges: &[Range]) -> Result<TrilateratedPlace, TrilaterationError> {
    trilaterate(&TrilaterationParams::default(), ranges)
}

#[test]
fn exact_ranges_give_the_place_and_its_dilution_by_hand() {
    // At the centroid the unit vectors stand 120° apart: Σ u·uᵀ = 1.5·I, and sqrt(2/1.5) = 1.1547.
    let truth = Point2::new(2.0, 1.154_700_538_379_251_7);
    let found = place(&exact(&CLUSTER, truth)).unwrap();
    assert!(found.point.distance_m(truth) < 1e-6, "{found:?}");
    assert!((found.dilution - 1.154_700_5).abs() < 1e-6, "{found:?}");
    // Each range is 2.3094 m, known to half: information 1.5·(5/7)/(2.3094·0.5)² an axis, 1.2444 m² each.
    let [xx, xy, yy] = found.covariance_m2;
    assert!((xx - 1.244_444).abs() < 1e-5 && xy.abs() < 1e-6 && (yy - 1.244_444).abs() < 1e-5, "{found:?}");
    assert!((found.sd_m() - libm::sqrt(2.488_888)).abs() < 1e-5);
}

#[test]
fn one_descent_step_by_hand() {
    // At (1, 0), ranges 2, 4, 5: distances 1, 3, sqrt(1 + 12) = 3.605551.
    let ranges = [range(0.0, 0.0, 2.0), range(4.0, 0.0, 4.0), range(2.0, CLUSTER[2].1, 5.0)];
    let once = GradientDescentParams { training_times: 0, ..GradientDescentParams::default() };
    let found = gradient_descent(&once, &ranges, Point2::new(1.0, 0.0)).unwrap();
    // 2·(1−2)·(1, 0) + 2·(3−4)·(−1, 0) + 2·(3.605551−5)/3.605551·(−1, −3.464102) = (0.773499, 2.679479); times −0.1.
    assert!((found.x_m - 0.922_650).abs() < 1e-5 && (found.y_m + 0.267_948).abs() < 1e-5, "{found:?}");
}

#[test]
fn the_descent_runs_once_more_than_its_training_times() {
    let ranges = exact(&CLUSTER, Point2::new(1.0, 1.0));
    let start = Point2::new(3.0, 2.0);
    let times = |training_times| GradientDescentParams { training_times, ..Default::default() };
    let by_hand = (0..51).fold(start, |place, _| gradient_descent(&times(0), &ranges, place).unwrap());
    assert_eq!(gradient_descent(&GradientDescentParams::default(), &ranges, start), Ok(by_hand));
    assert!(by_hand.distance_m(Point2::new(1.0, 1.0)) < 0.01, "{by_hand:?}");
}

#[test]
fn starts_are_seeded_and_inside_the_beacons() {
    let ranges = exact(&CLUSTER, Point2::new(1.0, 1.0));
    let start = |seed, round| random_start(&ranges, seed, round).unwrap();
    assert_eq!(start(3, 8), start(3, 8));
    assert_ne!(start(3, 8), start(3, 9));
    assert_ne!(start(3, 8), start(4, 8));
    for round in 0..100 {
        let p = start(1, round);
        assert!((0.0..=4.0).contains(&p.x_m) && (0.0..=CLUSTER[2].1).contains(&p.y_m), "{p:?}");
    }
    assert_eq!(random_start(&[], 1, 1), None);
}

#[test]
fn the_printed_rate_overshoots_with_many_beacons_and_says_so() {
    // The curvature is about half a unit a beacon and axis: 0.2·30 is beyond 2.
    let beacons: Vec<_> = (0..60).map(|k| (f64::from(k % 8) * 3.0, f64::from(k / 8) * 3.0)).collect();
    let truth = Point2::new(9.5, 8.5);
    let ranges = exact(&beacons, truth);
    let start = Point2::new(4.2, 4.4);
    let printed = gradient_descent(&GradientDescentParams::default(), &ranges, start);
    assert!(printed.is_err() || printed.unwrap().distance_m(truth) > 1.0, "{printed:?}");
    assert!(place(&ranges).unwrap().point.distance_m(truth) < 1e-6);
    let wild = GradientDescentParams { learning_rate: 1e9, ..GradientDescentParams::default() };
    assert_eq!(gradient_descent(&wild, &ranges, start), Err(TrilaterationError::Diverged));
}

#[test]
fn too_few_places_are_told() {
    let too_few = |n_places| Err(TrilaterationError::TooFew { n_places });
    let descend = |ranges: &[Range]| {
        gradient_descent(&GradientDescentParams::default(), ranges, Point2::default()).map(|_| ())
    };
    let nan = Range { raw_m: f64::NAN, ..range(2.0, 2.0, 1.0) };
    let one = range(0.0, 0.0, 2.0);
    for (ranges, n_places) in [
        (vec![], 0),
        (vec![one], 1),
        (vec![one; 12], 1),
        (vec![one, range(0.01, 0.0, 2.0), nan, nan], 1),
        (vec![one, range(4.0, 0.0, 3.0), nan, one], 2),
    ] {
        assert_eq!(place(&ranges).map(|_| ()), too_few(n_places), "{ranges:?}");
        assert_eq!(descend(&ranges), too_few(n_places), "{ranges:?}");
    }
}

#[test]
fn beacons_in_a_line_have_a_mirror() {
    let truth = Point2::new(3.0, 2.5);
    let beacons = [(0.0, 0.0), (4.0, 0.0), (8.0, 0.0), (12.0, 0.0)];
    let error = place(&exact(&beacons, truth)).unwrap_err();
    let TrilaterationError::Mirrored { place, mirror } = error else { panic!("{error:?}") };
    let (a, b) = (place.point, mirror);
    assert!((a.x_m - 3.0).abs() < 1e-5 && (b.x_m - 3.0).abs() < 1e-5, "{error:?}");
    assert!((a.y_m.abs() - 2.5).abs() < 1e-5 && (a.y_m + b.y_m).abs() < 1e-5, "{error:?}");
    assert!(error.to_string().contains("off the line"));
}

#[test]
fn a_far_place_is_diluted() {
    let truth = Point2::new(60.0, 3.0);
    let error = place(&exact(&CLUSTER, truth)).unwrap_err();
    assert!(error.place().is_some_and(|place| place.point.is_finite()), "{error:?}");
    // On the line itself no range tells how far to the side.
    let on_line = place(&exact(&[(0.0, 0.0), (4.0, 0.0), (8.0, 0.0)], Point2::new(5.5, 0.0))).unwrap_err();
    let TrilaterationError::Diluted { place } = on_line else { panic!("{on_line:?}") };
    assert!(place.dilution > 100.0, "{place:?}");
}

#[test]
fn one_blocked_beacon_does_little() {
    let beacons = [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0), (4.0, 0.0), (0.0, 4.0)];
    let truth = Point2::new(3.0, 4.5);
    let mut ranges = exact(&beacons, truth);
    ranges.iter_mut().for_each(|range| range.log_sd = 0.2);
    ranges[2].raw_m *= 4.0;
    ranges[2].unbiased_m *= 4.0;
    let robust = place(&ranges).unwrap().point.distance_m(truth);
    let start = random_start(&ranges, 1, 1).unwrap();
    let plain = gradient_descent(&GradientDescentParams::default(), &ranges, start).unwrap();
    assert!(robust < 0.5 && plain.distance_m(truth) > 2.0, "{robust} {plain:?}");
}

/// Any number, the ones that break things among them.
fn hostile() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -50.0..50.0,
        1 => prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(0.0), Just(-0.0),
            Just(1e300), Just(-1e300), Just(f64::MIN_POSITIVE), Just(1e-9), Just(9_999.0),
        ],
    ]
}

proptest! {
    #[test]
    fn exact_ranges_give_the_exact_place(
        beacons in prop::collection::vec((0.0..30.0, 0.0..30.0), 4..12),
        x_m in 2.0..28.0, y_m in 2.0..28.0,
    ) {
        let truth = Point2::new(x_m, y_m);
        let ranges = exact(&beacons, truth);
        prop_assume!(ranges.iter().all(|range| range.raw_m > 1.0));
        match place(&ranges) {
            Ok(found) => prop_assert!(found.point.distance_m(truth) < 1e-4, "{found:?}"),
            Err(TrilaterationError::Mirrored { place, mirror }) => {
                prop_assert!(place.point.distance_m(truth) < 1e-4 || mirror.distance_m(truth) < 1e-4);
            }
            Err(TrilaterationError::Diluted { place }) => prop_assert!(place.dilution > 5.0),
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    #[test]
    fn no_number_panics_and_a_place_is_finite(
        numbers in prop::collection::vec((hostile(), hostile(), hostile(), hostile(), hostile()), 0..9),
        start in (hostile(), hostile()),
    ) {
        let ranges: Vec<_> = numbers.iter().map(|&(x_m, y_m, raw_m, unbiased_m, log_sd)| {
            Range { centre: Point2::new(x_m, y_m), raw_m, unbiased_m, log_sd }
        }).collect();
        if let Ok(found) = place(&ranges) {
            prop_assert!(found.point.is_finite() && found.dilution <= 5.0, "{found:?}");
        }
        let start = Point2::new(start.0, start.1);
        if let Ok(found) = gradient_descent(&GradientDescentParams::default(), &ranges, start) {
            prop_assert!(found.is_finite());
        }
        let _ = random_start(&ranges, 1, 2);
    }

    #[test]
    fn the_order_of_ranges_does_not_matter(x_m in 0.0..20.0, y_m in 0.0..20.0) {
        let beacons = [(0.0, 0.0), (20.0, 1.0), (19.0, 18.0), (1.0, 20.0), (9.0, 11.0)];
        let mut ranges = exact(&beacons, Point2::new(x_m, y_m));
        ranges.iter_mut().zip([1.3, 0.8, 1.1, 0.7, 1.2]).for_each(|(range, factor)| range.raw_m *= factor);
        let forward = place(&ranges).map(|found| found.point);
        ranges.reverse();
        let backward = place(&ranges).map(|found| found.point);
        if let (Ok(a), Ok(b)) = (forward, backward) {
            prop_assert!(a.distance_m(b) < 1e-5, "{a:?} {b:?}");
        }
    }
}
