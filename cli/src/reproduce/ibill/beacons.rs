//! Ranges and positions from beacons alone.
//!
//! One phone surveys and is positioned, as in the paper. A beacon's place comes with the map, and its path loss is fitted
//! to what a survey heard of it. Distances are in the plane, as the paper's.

use core::f64::consts::{FRAC_PI_2, TAU};

use fieldwalk::geometry::Point2;
use fieldwalk::radio::path_loss::PathLoss;
use fieldwalk::radio::range::Range;
use fieldwalk::radio::trilateration::{
    GradientDescentParams, TrilaterationParams, gradient_descent, random_start, trilaterate,
};
use fieldwalk::random::CounterRng;
use fieldwalk::sensor::Reading;
use fieldwalk::time::Timestamp;
use fieldwalk_sim::phone::{Carried, CarryMode, Grip};
use fieldwalk_sim::radio::{RadioModel, RadioScene};
use fieldwalk_sim::walker::{Course, Gait, WalkerProfile};

use rand::RngExt as _;

use crate::plot::cdf;
use crate::reproduce::estimate::mean_of;
use crate::reproduce::{Estimate, Experiment, Finding, Findings, Picture, Run, test_bed};

/// What is measured of beacons.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment { name: "ranges in the hall", claims: &["ibill-unbiased"], is_timed: false, run: ranges },
    Experiment { name: "inside a cluster", claims: &["ibill-cluster"], is_timed: false, run: cluster },
];

/// Beacons of a cluster.
const N_BEACONS: usize = 3;
/// How long the phone is at a place in or about the cluster, in seconds.
const STANDING_S: f64 = 10.0;
/// Places in the cluster a seed.
const N_PLACES: u64 = 20;
/// A cluster's survey has so many places on either side of its middle along each axis, and so far apart, in metres: as
/// far as the beacons are from each other, where the paper calls their ranges accurate.
const SURVEYED_NODES: i32 = 4;
const SURVEYED_EVERY_M: f64 = 1.0;

/// A packet heard.
struct Packet {
    beacon: usize,
    rssi_dbm: f64,
    /// Where the phone was.
    place: Point2,
    time_s: f64,
}

/// What the phone `device` hears of `scene` along `path`, with `standing_s` of standing before and after.
fn heard(
    scene: &RadioScene,
    path: &[Point2],
    standing_s: f64,
    mode: CarryMode,
    device: u64,
    seed: u64,
) -> Vec<Packet> {
    let walker = WalkerProfile::default();
    let gait = Gait::new(&walker, Course::new(path), &[], standing_s, seed);
    let grip = Grip::drawn(walker.height_m, device);
    let carried = Carried::new(gait, grip, &[(0.0, mode)]);
    let origin = Timestamp::default();
    let samples = RadioModel::default().listen(&carried, scene, origin, device, seed);
    let packet = |sample: fieldwalk::sensor::Sample| {
        let Reading::Radio(sighting) = sample.reading else { return None };
        let time_s = sample.time.secs_since(origin);
        let [x_m, y_m, _] = carried.pose(time_s).place_m;
        Some(Packet {
            beacon: scene.transmitters.iter().position(|beacon| beacon.id == sighting.transmitter)?,
            rssi_dbm: f64::from(sighting.rssi_dbm),
            place: Point2::new(x_m, y_m),
            time_s,
        })
    };
    samples.into_iter().filter_map(packet).collect()
}

fn place_of(scene: &RadioScene, beacon: usize) -> Point2 {
    let [x_m, y_m, _] = scene.transmitters[beacon].place_m;
    Point2::new(x_m, y_m)
}

/// The path loss of each beacon by a survey's packets; nothing for one that it hardly heard.
fn fitted(scene: &RadioScene, survey: &[Packet]) -> Vec<Option<PathLoss>> {
    let of_beacon = |beacon: usize| {
        let of_it = survey.iter().filter(|packet| packet.beacon == beacon);
        let sightings: Vec<(f64, f64)> =
            of_it.map(|packet| (packet.place.distance_m(place_of(scene, beacon)), packet.rssi_dbm)).collect();
        PathLoss::fit(&sightings).ok()
    };
    (0..scene.transmitters.len()).map(of_beacon).collect()
}

/// Mean range over mean distance, corrected and raw, to the nearer cluster: at places of the hall where the phone lies,
/// and on a walk with the phone held. The beacons were surveyed in the same way at other places.
fn ranges(run: &Run) -> Findings {
    let ratios = run.per_seed(32, |seed| {
        let hall = test_bed::ibill_clusters(seed);
        let walked = |k: u64, length_m: f64| {
            let path = hall.building.ways.wander(1_000 * k + seed, length_m);
            heard(&hall.radio, &path, 2.0, CarryMode::HeldLevel, seed, 1_000 * k + seed)
        };
        let lying = |k: u64, n_places: u64| -> Vec<Packet> {
            let mut rng = CounterRng::new(seed, 0x68_616c_6c00 + k);
            let (width_m, height_m) = (hall.building.plan.width_m, hall.building.plan.height_m);
            let mut place =
                || Point2::new(rng.random_range(1.0..width_m - 1.0), rng.random_range(1.0..height_m - 1.0));
            let at = |i| at_place(&hall.radio, place(), 0.0, 2.0, CarryMode::OnTable, seed, 400 * k + i);
            (0..n_places).flat_map(at).collect()
        };
        [[lying(1, 300), lying(2, 150)], [walked(1, 600.0), walked(2, 300.0)]]
            .map(|[survey, test]| range_ratios(&hall.radio, survey, test))
    });
    let of = |mode: usize, k: usize| ratios.iter().map(|modes| modes[mode][k]).collect::<Vec<f64>>();
    let (unbiased, raw, held, held_raw) = (of(0, 0), of(0, 1), of(1, 0), of(1, 1));
    let chart = cdf(
        "Mean range over mean distance",
        "ratio",
        &[
            ("lying, corrected", &unbiased),
            ("lying, raw", &raw),
            ("held, corrected", &held),
            ("held, raw", &held_raw),
        ],
    );
    let caption = format!(
        "Ranges to the nearer cluster in the hall, packet by packet, each seed another hall and phone: mean range over \
         mean distance {:.3} corrected and {:.3} raw where the phone lies, so that power is about normal as the \
         correction has it; {:.3} and {:.3} on walks, where the body takes 0 to 7 dB by the walker's direction.",
        mean_of(&unbiased),
        mean_of(&raw),
        mean_of(&held),
        mean_of(&held_raw)
    );
    Findings::default()
        .with(Finding::new("ibill-unbiased", ratios.len(), [Estimate::mean(&unbiased)]).because(
            "the power about the path loss is no normal number of one deviation: weak packets are lost, and shadowing \
             holds over metres",
        ))
        .with_picture(Picture::of(caption, chart.to_svg()))
}

/// Mean corrected and mean raw range of `test` over its mean distance, by the path loss of `survey`; each to the cluster
/// that is nearer, from which the paper estimates where a user roughly is.
fn range_ratios(scene: &RadioScene, mut survey: Vec<Packet>, mut test: Vec<Packet>) -> [f64; 2] {
    let nearer = |packet: &Packet| {
        let first_m = packet.place.distance_m(place_of(scene, 0));
        let is_first = first_m < packet.place.distance_m(place_of(scene, N_BEACONS));
        is_first == (packet.beacon < N_BEACONS)
    };
    survey.retain(nearer);
    test.retain(nearer);
    let path_loss = fitted(scene, &survey);
    let (mut unbiased_m, mut raw_m, mut distances_m) = (0.0, 0.0, 0.0);
    for packet in test {
        let centre = place_of(scene, packet.beacon);
        let range = path_loss[packet.beacon].and_then(|model| Range::new(centre, &model, packet.rssi_dbm));
        let Some(range) = range else { continue };
        unbiased_m += range.unbiased_m;
        raw_m += range.raw_m;
        distances_m += packet.place.distance_m(centre);
    }
    [unbiased_m / distances_m, raw_m / distances_m]
}

/// Errors of trilateration at places inside a cluster, the phone lying there or held by somebody who faces anywhere.
fn cluster(run: &Run) -> Findings {
    let errors_m = run.per_seed(24, |seed| {
        let mut scene = test_bed::ibill_clusters(seed).radio;
        scene.transmitters.truncate(N_BEACONS);
        [CarryMode::OnTable, CarryMode::HeldLevel].map(|mode| errors_in_cluster(&scene, mode, seed))
    });
    let of = |mode: usize, k: usize| {
        errors_m.iter().map(|modes| modes[mode][k].clone()).collect::<Vec<Vec<f64>>>()
    };
    let (lying, robust, held) = (of(0, 0), of(0, 1), of(1, 0));
    let chart = cdf(
        "Places inside a cluster of three beacons 4 m apart",
        "error (m)",
        &[
            ("phone lying, as printed", &lying.concat()),
            ("phone lying, robust", &robust.concat()),
            ("phone held, as printed", &held.concat()),
        ],
    );
    let [lying_m, robust_m, held_m] =
        [&lying, &robust, &held].map(|errors_m| Estimate::pooled_quantile(errors_m, 0.5).value);
    let caption = format!(
        "{N_PLACES} places a seed, {STANDING_S} s at each; each seed another hall and phone. Medians: {lying_m:.2} m by \
         gradient descent as printed and {robust_m:.2} m robustly, the phone lying as for a measurement; {held_m:.2} m \
         held by somebody who faces anywhere."
    );
    let cause = format!(
        "half a metre from beacons 2 to 4 m away asks for ranges good to a sixth, which is 1 dB: furniture shadows by \
         4.5 dB, and when somebody holds the phone ({held_m:.2} m) the body takes up to 7 dB more by where he faces"
    );
    Findings::default()
        .with(
            Finding::new("ibill-cluster", errors_m.len(), [Estimate::pooled_quantile(&lying, 0.5)])
                .because(cause),
        )
        .with_picture(Picture::of(caption, chart.to_svg()))
}

/// Errors as printed and robustly. The beacons' reference strengths come from a grid of places about the cluster, at
/// which the phone was carried in the same way.
fn errors_in_cluster(scene: &RadioScene, mode: CarryMode, seed: u64) -> [Vec<f64>; 2] {
    let corners = [0, 1, 2].map(|beacon| place_of(scene, beacon));
    let middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0);
    let grid = (-SURVEYED_NODES..=SURVEYED_NODES).flat_map(|i| {
        (-SURVEYED_NODES..=SURVEYED_NODES).map(move |j| Point2::new(f64::from(i), f64::from(j)))
    });
    let survey: Vec<Packet> = grid
        .zip(0u64..)
        .flat_map(|(off, k)| {
            let heading_rad = FRAC_PI_2 * (k % 4) as f64;
            at_place(scene, middle + off * SURVEYED_EVERY_M, heading_rad, STANDING_S, mode, seed, 200 + k)
        })
        .collect();
    let path_loss = fitted(scene, &survey);
    let mut rng = CounterRng::new(seed, 0x636c_7573);
    let mut errors_m: [Vec<f64>; 2] = Default::default();
    for k in 0..N_PLACES {
        let place = inside(corners, &mut rng);
        let packets = at_place(scene, place, rng.random_range(0.0..TAU), STANDING_S, mode, seed, k);
        let Some(truth) = packets.first().map(|packet| packet.place) else { continue };
        let ranges = ranges_of(scene, &path_loss, &packets);
        let start = random_start(&ranges, seed, k).unwrap_or_default();
        let printed = gradient_descent(&GradientDescentParams::default(), &ranges, start).ok();
        let robust = match trilaterate(&TrilaterationParams::default(), &ranges) {
            Ok(place) => Some(place.point),
            Err(error) => error.place().map(|place| place.point),
        };
        for (errors_m, place) in errors_m.iter_mut().zip([printed, robust]) {
            errors_m.push(place.map_or(f64::INFINITY, |place| place.distance_m(truth)));
        }
    }
    errors_m
}

/// What is heard at one place for `seconds`, facing `heading_rad`.
fn at_place(
    scene: &RadioScene,
    place: Point2,
    heading_rad: f64,
    seconds: f64,
    mode: CarryMode,
    seed: u64,
    k: u64,
) -> Vec<Packet> {
    let ahead = place + Point2::from_polar(0.6, heading_rad);
    let mut packets = heard(scene, &[place, ahead], seconds, mode, seed, 1_000 * seed + k);
    packets.retain(|packet| packet.time_s < seconds);
    packets
}

/// A place uniform in a triangle.
fn inside([a, b, c]: [Point2; 3], rng: &mut CounterRng) -> Point2 {
    let (u, v) = (rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    a + (b - a) * u + (c - a) * v
}

/// The range to each beacon by the mean of `packets`' powers in dBm, which the path loss was fitted to.
fn ranges_of(scene: &RadioScene, path_loss: &[Option<PathLoss>], packets: &[Packet]) -> Vec<Range> {
    let of_beacon = |(beacon, model): (usize, &Option<PathLoss>)| {
        let of_it = packets.iter().filter(|packet| packet.beacon == beacon);
        let powers_dbm: Vec<f64> = of_it.map(|packet| packet.rssi_dbm).collect();
        Range::new(place_of(scene, beacon), model.as_ref()?, mean_of(&powers_dbm))
    };
    path_loss.iter().enumerate().filter_map(of_beacon).collect()
}
