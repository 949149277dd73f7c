use super::*;
use crate::floor_plan::FloorPlan;
use crate::map::{FloorMap, GridFrame, Layers};
use proptest::prelude::*;

fn params(metric: HistoryMetric, feature: HistoryFeature) -> HistoryParams {
    HistoryParams { metric, feature, window: 6, reads_a_move: 3, sigma_ut: 2.0, counts_once: true }
}

const WARPING: HistoryMetric = HistoryMetric::DynamicTimeWarping { band: None };

/// 12 m × 2 m; northward 30 + 2x, upward −40 + y.
fn floor() -> FloorIndex {
    let plan = FloorPlan { width_m: 12.0, height_m: 2.0, ..FloorPlan::default() };
    let frame = GridFrame::covering(plan.width_m, plan.height_m, 1.0);
    let field_y_ut: Vec<f32> = (0..frame.len()).map(|n| 30.0 + 2.0 * (n % frame.nx) as f32).collect();
    let field_z_ut: Vec<f32> = (0..frame.len()).map(|n| -40.0 + (n / frame.nx) as f32).collect();
    let strength_ut = field_y_ut.iter().zip(&field_z_ut).map(|(&y, &z)| strength_ut([y, z])).collect();
    let layers = Layers {
        field_x_ut: vec![0.0; frame.len()],
        field_y_ut,
        field_z_ut,
        strength_ut,
        ..Layers::default()
    };
    FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
}

fn cloud(params: &HistoryParams, x_m: &[f32]) -> Particles {
    let n = x_m.len();
    Particles {
        x_m: x_m.to_vec(),
        y_m: vec![1.0; n],
        log_weight: vec![0.0; n],
        history_log_weight: vec![0.0; n],
        history_ut: vec![0.0; n * params.n_values()],
        history_sums: vec![0.0; n * params.n_sums()],
        ..Particles::default()
    }
}

fn read(horizontal_ut: f32, vertical_ut: f32) -> Option<FieldRead> {
    let strength_ut = strength_ut([horizontal_ut, vertical_ut]);
    Some(FieldRead { strength_ut, horizontal_vertical_ut: Some([horizontal_ut, vertical_ut]) })
}

/// Walks each particle three metres along x with what is read.
fn walk(
    params: &HistoryParams,
    particles: &mut Particles,
    device: &mut DeviceHistory,
    reads: [Option<FieldRead>; 3],
) {
    let (from_x_m, from_y_m) = (particles.x_m.clone(), particles.y_m.clone());
    particles.x_m.iter_mut().for_each(|x_m| *x_m += 3.0);
    let scratch = &mut HistoryScratch::default();
    update(params, &floor(), &reads, [&from_x_m, &from_y_m], device, particles, scratch);
}

#[test]
fn distances_by_hand() {
    // Means 2 and 5: differences 0, 0, 0; then e = −1, 1 about their mean: sqrt(2)/2 each side.
    assert_eq!(euclidean_ut(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]), 0.0);
    assert_eq!(euclidean_ut(&[0.0, 2.0], &[0.0, 0.0]), 2f32.sqrt());
    assert_eq!(euclidean_ut(&[], &[]), 0.0);
    // The same bump a read later: warping finds it, the diagonal does not. Means are 1 in both.
    let (early, late) = ([0.0, 4.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]);
    assert_eq!(dynamic_time_warping_ut(&early, &late, None), 0.0);
    assert_eq!(dynamic_time_warping_ut(&early, &late, Some(1)), 0.0);
    assert_eq!(dynamic_time_warping_ut(&early, &late, Some(0)), 32f32.sqrt());
    // Off their means −1, 0, 1 and −2, 0, 2: (1, 1), (0, 0), (1, 1) along the diagonal, and no way is shorter.
    assert_eq!(dynamic_time_warping_ut(&[1.0, 2.0, 3.0], &[1.0, 3.0, 5.0], None), 2f32.sqrt());
    // A longer row: 0 pairs with both noughts.
    assert_eq!(dynamic_time_warping_ut(&[-1.0, 0.0, 1.0], &[-1.0, 0.0, 0.0, 1.0], None), 0.0);
}

#[test]
fn kwak_equations_4_and_5_by_hand() {
    let params = params(HistoryMetric::Euclidean, HistoryFeature::HorizontalVertical);
    let mut particles = cloud(&params, &[0.0, 3.0]);
    let mut device = DeviceHistory::default();
    // From 0 m to 3 m the map is read at 0.5, 1.5 and 2.5 m: 31, 33, 35 µT; the other reads 37, 39, 41 and −39 always.
    walk(&params, &mut particles, &mut device, [read(31.0, -39.0), read(33.0, -38.0), read(35.0, -40.0)]);
    assert_eq!(particles.history_ut[..3], [31.0, 33.0, 35.0]);
    assert_eq!(particles.history_ut[6..9], [-39.0; 3]);
    assert_eq!(particles.history_ut[12..15], [37.0, 39.0, 41.0]);
    // Six off, always: the mean takes it away. B_v is off by 0, −1, 1: ‖d‖² = 2, and 2σ² = 8.
    for log_weight in &particles.log_weight {
        assert!((log_weight + 0.25).abs() < 1e-5, "{log_weight}");
    }
    // The next move, flat against a slope: reads 31 … 41 against 33 and five times 33. Afresh: not −0.25 more.
    walk(&params, &mut particles, &mut device, [read(33.0, -39.0), read(33.0, -39.0), read(33.0, -39.0)]);
    let off = [0.0, 0.0, 0.0, 4.0, 6.0, 8.0].map(|e: f32| e - 3.0);
    let square: f32 = off.iter().map(|e| e * e).sum::<f32>() + 2.0;
    assert!((particles.log_weight[0] + square / 8.0).abs() < 1e-4, "{:?}", particles.log_weight);
    assert_eq!(particles.history_log_weight, particles.log_weight);
}

#[test]
fn what_else_weighs_on_a_particle_stays() {
    let params = params(HistoryMetric::Euclidean, HistoryFeature::Strength);
    let mut particles = cloud(&params, &[0.0, 0.0]);
    particles.log_weight = vec![-3.0, f32::NEG_INFINITY];
    let mut device = DeviceHistory::default();
    for _ in 0..3 {
        walk(&params, &mut particles, &mut device, [read(30.0, -40.0), None, read(33.0, -38.0)]);
    }
    assert!((particles.log_weight[0] - particles.history_log_weight[0] + 3.0).abs() < 1e-5);
    assert_eq!(particles.log_weight[1], f32::NEG_INFINITY);
    assert_eq!(device.len(), 6);
    forget(&params, &mut device, &mut particles);
    assert!((particles.log_weight[0] + 3.0).abs() < 1e-5 && device.is_empty());
}

#[test]
fn a_strength_alone_is_compared_by_strength() {
    let strength = |strength_ut| Some(FieldRead { strength_ut, horizontal_vertical_ut: None });
    for metric in [HistoryMetric::Euclidean, HistoryMetric::DynamicTimeWarping { band: Some(0) }] {
        let params = params(metric, HistoryFeature::HorizontalVertical);
        let mut particles = cloud(&params, &[0.0]);
        let mut device = DeviceHistory::default();
        // Along x the strengths are those of (31, −39), (33, −39), (35, −39).
        let own = [31.0, 33.0, 35.0].map(|horizontal_ut| strength_ut([horizontal_ut, -39.0]));
        let reads = [read(31.0, -39.0), strength(own[1] + 3.0), read(35.0, -39.0)];
        walk(&params, &mut particles, &mut device, reads);
        // The level reads agree. Strengths are off by 0, −3, 0: about their mean of −1 the one that counts is off by −2.
        assert!((particles.log_weight[0] + 4.0 / 8.0).abs() < 1e-4, "{metric:?} {:?}", particles.log_weight);
    }
}

#[test]
fn a_full_history_lets_go_of_its_oldest_reads() {
    let params = params(WARPING, HistoryFeature::Strength);
    let mut particles = cloud(&params, &[0.0]);
    let mut device = DeviceHistory::default();
    walk(&params, &mut particles, &mut device, [read(300.0, 0.0), read(200.0, 0.0), read(100.0, 0.0)]);
    assert!(particles.log_weight[0] < -100.0);
    // Two moves along what the map says push the nonsense out of six slots.
    for x_m in [3.0f32, 6.0] {
        let own = [0.5, 1.5, 2.5].map(|share| read(30.0 + 2.0 * (x_m + share), -39.0));
        walk(&params, &mut particles, &mut device, own);
    }
    assert!(particles.log_weight[0].abs() < 1e-3, "{:?}", particles.log_weight);
    assert!(device.fits(6) && !device.fits(5));
    device.start_anew(&params);
    assert!(device.is_empty());
}

#[test]
fn one_read_a_move_is_the_mean_of_its_thirds() {
    let params =
        HistoryParams { reads_a_move: 1, ..params(HistoryMetric::Euclidean, HistoryFeature::Strength) };
    let mut particles = cloud(&params, &[0.0]);
    let mut device = DeviceHistory::default();
    walk(&params, &mut particles, &mut device, [read(3.0, 4.0), None, read(6.0, 8.0)]);
    assert_eq!((device.len(), device.planes_ut[0][0]), (1, 7.5));
    assert_eq!(particles.history_ut[0], floor().read_or_mean(1.5, 1.0)[0]);
    // Nothing read, nothing remembered.
    walk(&params, &mut particles, &mut device, [None; 3]);
    assert_eq!(device.len(), 1);
}

proptest! {
    #[test]
    fn warping_never_lengthens(rows in proptest::collection::vec((0.0f32..80.0, 0.0f32..80.0), 1..40), band in 0usize..8) {
        let (a, b): (Vec<f32>, Vec<f32>) = rows.into_iter().unzip();
        let euclidean = euclidean_ut(&a, &b);
        let [free, banded] = [None, Some(band)].map(|band| dynamic_time_warping_ut(&a, &b, band));
        let slack = 1e-3 * (1.0 + euclidean);
        prop_assert!(free <= banded + slack && banded <= euclidean + slack, "{free} {banded} {euclidean}");
        prop_assert!((free - dynamic_time_warping_ut(&b, &a, None)).abs() <= slack);
        prop_assert!((euclidean - euclidean_ut(&b, &a)).abs() <= slack);
        prop_assert!(dynamic_time_warping_ut(&a, &a, None) <= 1e-3 && euclidean_ut(&a, &a) <= 1e-3);
        prop_assert!((dynamic_time_warping_ut(&a, &b, Some(0)) - euclidean).abs() <= slack);
    }

    /// The lanes of the filter's loop against the plain functions.
    #[test]
    fn particles_in_lanes_are_weighed_as_one_by_one(
        x_m in proptest::collection::vec(0.0f32..6.0, 1..20),
        reads in proptest::collection::vec((20.0f32..60.0, -50.0f32..-20.0), 12),
    ) {
        for metric in [HistoryMetric::Euclidean, WARPING] {
            let params = params(metric, HistoryFeature::Strength);
            let mut particles = cloud(&params, &x_m);
            let mut device = DeviceHistory::default();
            // Round the ring of six slots more than once; to its end where their order counts.
            let moves: &[usize] = if metric == WARPING { &[0, 3, 6, 9] } else { &[0, 3, 6, 0, 9] };
            for &k in moves {
                let reads = core::array::from_fn(|i| read(reads[k + i].0, reads[k + i].1));
                walk(&params, &mut particles, &mut device, reads);
            }
            for (i, log_weight) in particles.log_weight.iter().enumerate() {
                let own = &particles.history_ut[i * 6..(i + 1) * 6];
                let distance = match metric {
                    HistoryMetric::Euclidean => euclidean_ut(own, &device.planes_ut[0]),
                    HistoryMetric::DynamicTimeWarping { band } => {
                        dynamic_time_warping_ut(own, &device.planes_ut[0], band)
                    }
                };
                let expected = -distance * distance / 8.0;
                prop_assert!((log_weight - expected).abs() < 1e-2 * (1.0 - expected), "{log_weight} {expected}");
            }
        }
    }
}
