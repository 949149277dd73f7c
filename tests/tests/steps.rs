//! Steps: simulated walkers who carry phones in every way, hands that do anything but walk, and recordings by others.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk::gravity::{LevelEstimator, LevelParams};
use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams, StepEvent};
use fieldwalk::positioner::{PositionHint, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::step::{
    CardStepDetector, StepCycle, StepDetector, StepLengthModel, StepQueue, WilaStepDetector, WilaStepParams,
};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_formats::oxford_steps::{AccelerometerReader, ContactReader, Placement, RunFolder, find_runs};
use fieldwalk_sim::phone::{Carried, CarryMode, Grip};
use fieldwalk_sim::walker::{Course, Gait, WalkerProfile};
use fieldwalk_tests::recordings::collection;

const GRAVITY_M_S2: f64 = 9.806_65;

fn at(time_s: f64) -> Timestamp {
    Timestamp::from_millis(1_000_000) + Duration::from_secs_f64(time_s)
}

/// What a pedestrian makes of `seconds` of specific force and angular rate, both as functions of time.
fn steps_of(
    seconds: f64,
    rate_hz: f64,
    mut force: impl FnMut(f64) -> [f64; 3],
    mut rate: impl FnMut(f64) -> [f64; 3],
) -> Vec<StepEvent> {
    let mut pedestrian = Pedestrian::new(PedestrianParams::default());
    let mut events = Vec::new();
    for k in 0..(seconds * rate_hz) as i64 {
        let time_s = k as f64 / rate_hz;
        let readings = [
            Reading::AngularRate(rate(time_s).map(|c| c as f32)),
            Reading::SpecificForce(force(time_s).map(|c| c as f32)),
        ];
        events.extend(
            readings.into_iter().filter_map(|reading| pedestrian.push(&Sample { time: at(time_s), reading })),
        );
    }
    events
}

fn walk(mode: CarryMode, rate_hz: f64, seed: u64) -> (usize, Vec<StepEvent>) {
    let line = [(0.0, 0.0), (0.0, 25.0), (20.0, 25.0), (20.0, 0.0)].map(|(x, y)| Point2::new(x, y));
    let walker = WalkerProfile::drawn(seed);
    let gait = Gait::new(&walker, Course::new(&line), &[], 3.0, seed);
    let (n_steps, duration_s) = (gait.steps().len(), gait.duration_s());
    let carried = Carried::new(gait, Grip::drawn(walker.height_m, seed), &[(0.0, mode)]);
    let events =
        steps_of(duration_s, rate_hz, |t| carried.specific_force_m_s2(t), |t| carried.angular_rate_rad_s(t));
    (n_steps, events)
}

#[test]
fn every_way_to_carry_a_phone_gives_the_steps_that_were_made() {
    use CarryMode::*;
    for mode in
        [HeldLevel, HeldUpright, HeldLandscape, HeldAskew, AtEar, SwingingHand, FrontPocket, BackPocket]
    {
        let (mut n_made, mut n_found) = (0, 0);
        for seed in 1..=5 {
            let (n_steps, events) = walk(mode, 100.0, seed);
            assert!(events.windows(2).all(|pair| pair[0].cycle.end < pair[1].cycle.end));
            // A swinging hand may lose the rhythm for longer than a pause.
            let n_first = events.iter().filter(|event| event.cycle.is_first).count();
            assert!(
                events[0].cycle.is_first && (n_first == 1 || mode == SwingingHand),
                "{mode:?} {seed}: {n_first} walks"
            );
            n_made += n_steps;
            n_found += events.len();
        }
        let error_percent = 100.0 * (n_found as f64 / n_made as f64 - 1.0);
        println!("{mode:?}: {n_found} of {n_made}, {error_percent:+.1} %");
        assert!(error_percent.abs() < 5.0, "{mode:?}: {n_found} of {n_made}");
    }
}

#[test]
fn the_count_does_not_depend_on_the_sampling_rate() {
    for mode in [CarryMode::HeldLevel, CarryMode::FrontPocket, CarryMode::SwingingHand] {
        let counts = [50.0, 100.0, 200.0, 400.0].map(|rate_hz| walk(mode, rate_hz, 3).1.len());
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        assert!(most - least <= 2, "{mode:?}: {counts:?}");
    }
}

#[test]
fn the_first_steps_come_soon_and_the_others_at_once() {
    let line = [(0.0, 0.0), (0.0, 25.0)].map(|(x, y)| Point2::new(x, y));
    let walker = WalkerProfile::drawn(3);
    let gait = Gait::new(&walker, Course::new(&line), &[], 3.0, 3);
    let duration_s = gait.duration_s();
    let carried = Carried::new(gait, Grip::drawn(walker.height_m, 3), &[(0.0, CarryMode::HeldLevel)]);
    let mut pedestrian = Pedestrian::new(PedestrianParams::default());
    let mut delays_s = Vec::new();
    for k in 0..(duration_s * 100.0) as i64 {
        let time_s = k as f64 / 100.0;
        let force = carried.specific_force_m_s2(time_s).map(|c| c as f32);
        let sample = Sample { time: at(time_s), reading: Reading::SpecificForce(force) };
        delays_s.extend(pedestrian.push(&sample).map(|event| at(time_s).secs_since(event.cycle.end)));
    }
    let (first, others) = delays_s.split_at(3);
    assert!(first[0] < 1.6 && others.len() > 20, "{delays_s:?}");
    assert!(others.iter().all(|&delay_s| delay_s < 0.25), "{delays_s:?}");
}

#[test]
fn shaking_turning_and_standing_are_no_steps() {
    let none = |_: f64| [0.0; 3];
    // A shaking hand goes up and down three and more times a second, or to and fro, or harder than any runner.
    for (hz, amplitude_m_s2, direction) in [
        (3.2, 20.0, [0.0, 0.0, 1.0]),
        (4.0, 8.0, [0.0, 0.6, 0.8]),
        (5.0, 15.0, [0.0, 0.0, 1.0]),
        (6.0, 25.0, [0.0, 0.8, 0.6]),
        (2.0, 10.0, [1.0, 0.0, 0.0]),
        (2.0, 25.0, [0.0, 0.0, 1.0]),
    ] {
        let shaken = |t: f64| {
            let stroke = if t < 2.0 { 0.0 } else { amplitude_m_s2 * (TAU * hz * t).sin() };
            [0, 1, 2].map(|c| direction[c] * stroke + if c == 2 { GRAVITY_M_S2 } else { 0.0 })
        };
        let n = steps_of(30.0, 100.0, shaken, none).len();
        assert_eq!(n, 0, "{hz} Hz, {amplitude_m_s2} m/s² along {direction:?}");
    }
    // Half a turn in 1.5 s, every 3 s, the phone tilted and held 0.35 m from the axis; the body sways.
    let turn_rad_s = |t: f64| if t % 3.0 < 1.5 { PI * PI / 3.0 * (PI * (t % 3.0) / 1.5).sin() } else { 0.0 };
    let tilt: f64 = 0.4;
    let turning = |t: f64| {
        let (rate, h) = (turn_rad_s(t), 1e-3);
        let along = 0.35 * (turn_rad_s(t + h) - turn_rad_s(t - h)) / (2.0 * h);
        let up = GRAVITY_M_S2 + 0.2 * (TAU * 0.7 * t).sin();
        let outward = -0.35 * rate * rate;
        [-along, outward * tilt.cos() + up * tilt.sin(), up * tilt.cos() - outward * tilt.sin()]
    };
    let rate = |t: f64| [0.0, turn_rad_s(t) * tilt.sin(), turn_rad_s(t) * tilt.cos()];
    assert_eq!(steps_of(60.0, 100.0, turning, rate).len(), 0, "turning in place");
    let standing = |t: f64| {
        let tremor = 0.15 * (TAU * 9.0 * t).sin() + 0.2 * (TAU * 0.4 * t).sin();
        [0.3 * (TAU * 0.3 * t).sin(), 2.0, 9.6 + tremor]
    };
    assert_eq!(steps_of(600.0, 50.0, standing, none).len(), 0, "standing");
}

/// A phone in the hand of somebody who stands, shaken as the simulator shakes it, and put into a pocket.
#[test]
fn who_stands_and_handles_the_phone_makes_no_step() {
    let line = [(0.0, 0.0), (0.0, 12.0)].map(|(x, y)| Point2::new(x, y));
    for seed in 1..=5 {
        let walker = WalkerProfile::drawn(seed);
        let gait = Gait::new(&walker, Course::new(&line), &[], 40.0, seed);
        let modes = [
            (0.0, CarryMode::HeldLevel),
            (4.0, CarryMode::Shaken),
            (16.0, CarryMode::HeldLevel),
            (20.0, CarryMode::FrontPocket),
            (25.0, CarryMode::AtEar),
            (30.0, CarryMode::OnTable),
            (34.0, CarryMode::HeldLevel),
        ];
        let carried = Carried::new(gait, Grip::drawn(walker.height_m, seed), &modes);
        let events =
            steps_of(39.0, 100.0, |t| carried.specific_force_m_s2(t), |t| carried.angular_rate_rad_s(t));
        let times_s: Vec<f64> = events.iter().map(|event| event.cycle.end.secs_since(at(0.0))).collect();
        assert!(times_s.is_empty(), "seed {seed}: {times_s:?}");
    }
}

/// Pseudo-random numbers in [0, 1).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// About normal, of unit variance.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

#[test]
fn a_hand_that_fidgets_makes_few_steps() {
    // The phone is turned over and moved about at random, several times a second: 20 minutes.
    let mut n_steps = 0;
    for seed in 1..=20u64 {
        let mut chance = Chance(seed * 7_919);
        let (mut tilt, mut roll, mut tilt_to, mut roll_to) = (0.5f64, 0.0f64, 0.5, 0.0);
        let (mut push, mut moved) = ([0.0f64; 3], [0.0f64; 3]);
        let force = |_| {
            if chance.next() < 0.012 {
                tilt_to = 1.4 * chance.next();
                roll_to = 2.0 * (chance.next() - 0.5);
            }
            tilt += 0.06 * (tilt_to - tilt);
            roll += 0.06 * (roll_to - roll);
            for c in 0..3 {
                push[c] *= 0.88;
                if chance.next() < 0.02 {
                    push[c] += 1.6 * chance.normal();
                }
                moved[c] += 0.25 * (push[c] - moved[c]);
            }
            let up = [roll.sin(), roll.cos() * tilt.sin(), roll.cos() * tilt.cos()];
            [0, 1, 2].map(|c| GRAVITY_M_S2 * up[c] + moved[c])
        };
        n_steps += steps_of(60.0, 100.0, force, |_| [0.0; 3]).len();
    }
    println!("fidgeting: {n_steps} steps in 20 minutes");
    assert!(n_steps < 200, "{n_steps} steps in 20 minutes");
}

#[test]
fn a_phone_on_a_table_for_an_hour_makes_no_step_and_moves_no_fix() {
    let plan = FloorPlan { width_m: 40.0, height_m: 25.0, ..FloorPlan::default() };
    let floor = FloorIndex::new(FloorMap { name: "F1".into(), plan, ..FloorMap::default() });
    let mut positioner = Positioner::new(Arc::new(floor), Recipe::fused(), 1);
    let point = Point2::new(12.0, 7.5);
    positioner.hint(PositionHint { point, radius_m: 1.0, floor: 0, time: at(0.0), direction: None }).unwrap();
    let before = positioner.fix().unwrap();
    let mut chance = Chance(5);
    for k in 0..3_600 * 50 {
        let time_s = f64::from(k) / 50.0;
        // Noise of a middling part, and somebody who now and then knocks on the table.
        let knock = match time_s % 7.3 {
            since_s if since_s < 0.15 => 2.0 * (TAU * 18.0 * since_s).sin(),
            _ => 0.0,
        };
        let force = [0.0, 0.0, GRAVITY_M_S2 + knock].map(|c| (c + 0.03 * chance.normal()) as f32);
        let rate = [0.0, 0.0, 0.0].map(|c: f64| (c + 0.002 * chance.normal()) as f32);
        for reading in [Reading::AngularRate(rate), Reading::SpecificForce(force)] {
            assert_eq!(positioner.push(Sample { time: at(time_s), reading }), None, "at {time_s} s");
        }
    }
    positioner.flush();
    let after = positioner.fix().unwrap();
    assert_eq!((after.position, after.radius_68_m), (before.position, before.radius_68_m));
}

#[test]
fn nonsense_makes_no_step_and_no_panic_and_walking_is_found_after_it() {
    let (_, clean) = walk(CarryMode::HeldLevel, 100.0, 2);
    let line = [(0.0, 0.0), (0.0, 25.0), (20.0, 25.0), (20.0, 0.0)].map(|(x, y)| Point2::new(x, y));
    let walker = WalkerProfile::drawn(2);
    let gait = Gait::new(&walker, Course::new(&line), &[], 3.0, 2);
    let carried = Carried::new(gait, Grip::drawn(walker.height_m, 2), &[(0.0, CarryMode::HeldLevel)]);
    let mut detectors: [Box<dyn StepDetector>; 3] = [
        Box::new(fieldwalk::step::PhoneStepDetector::new(Default::default())),
        Box::new(CardStepDetector::default()),
        Box::new(WilaStepDetector::new(WilaStepParams::default())),
    ];
    for detector in &mut detectors {
        for (time_s, value) in [
            (0.0, f32::NAN),
            (1.0, f32::INFINITY),
            (2.0, -1e30),
            (3.0, 1_999.0),
            (-1e9, 9.0),
            (9e9, 9.0),
            (0.5, 0.0),
            (0.5, -0.0),
        ] {
            detector.push(at(time_s), [value, 9.0, value]);
            detector.push(Timestamp::MAX, [value; 3]);
            detector.push(Timestamp::MIN, [9.0; 3]);
        }
        let mut queue = StepQueue::new();
        let mut n_found = 0;
        let mut level = LevelEstimator::new(LevelParams::default());
        for k in 0..(carried.gait().duration_s() * 100.0) as i64 {
            let time = at(1e6 + k as f64 / 100.0);
            let force = carried.specific_force_m_s2(k as f64 / 100.0).map(|c| c as f32);
            let level_force = level.push_specific_force(time, force);
            if let Some(finding) = detector.push(time, level_force) {
                queue.push(&finding, (), 0.5);
            }
            n_found += std::iter::from_fn(|| queue.pop()).count();
        }
        assert!(n_found.abs_diff(clean.len()) < clean.len() / 3, "{n_found} of {}", clean.len());
    }
}

/// What WILA's wearable makes of the vertical motion of a walker's waist.
fn wila_cycles(gait: &Gait) -> Vec<StepCycle> {
    const H_S: f64 = 1.0 / 512.0;
    let height_m = |t: f64| {
        let body = gait.body(t);
        body.height_m + body.offset_m[2] + body.bounced_m() + body.jolt_m[2]
    };
    let mut detector = WilaStepDetector::new(WilaStepParams::default());
    let mut queue = StepQueue::new();
    let mut cycles = Vec::new();
    for k in 0..(gait.duration_s() * 50.0) as i64 {
        let t = k as f64 / 50.0;
        let up = (height_m(t - H_S) - 2.0 * height_m(t) + height_m(t + H_S)) / (H_S * H_S);
        if let Some(finding) = detector.push(at(t), [0.0, 0.0, (GRAVITY_M_S2 + up) as f32]) {
            queue.push(&finding, (), 0.55);
        }
        cycles.extend(std::iter::from_fn(|| queue.pop()).map(|(cycle, ())| cycle));
    }
    cycles
}

/// A walker's slow, usual and fast pace, over the usual one.
const PACES: [(&str, f64); 3] = [("slow", 0.65), ("normal", 1.0), ("fast", 1.35)];

fn straight(walker: &WalkerProfile, pace: f64, length_m: f64, seed: u64) -> Gait {
    let walker = WalkerProfile { speed_m_s: pace * walker.speed_m_s, ..*walker };
    let line = [Point2::new(0.0, 0.0), Point2::new(0.0, length_m)];
    Gait::new(&walker, Course::new(&line), &[], 3.0, seed)
}

/// WILA 2016, Table 2: of 50 steps at most 3 are missed slowly, 1 at the usual pace, none fast. The first shift of weight
/// may count as one more.
#[test]
fn wila_table_2_steps_of_simulated_walks() {
    for ((pace, factor), most_missed) in PACES.into_iter().zip([3i64, 1, 0]) {
        let missed: Vec<i64> = (1..=10)
            .map(|seed| {
                let walker = WalkerProfile::drawn(seed);
                let length_m = 49.5 * walker.step_length_m(factor * walker.speed_m_s);
                let gait = straight(&walker, factor, length_m, seed);
                gait.steps().len() as i64 - wila_cycles(&gait).len() as i64
            })
            .collect();
        println!("{pace}: missed {missed:?}");
        assert!(missed.iter().all(|&n| (-1..=most_missed).contains(&n)), "{pace}: missed {missed:?}");
    }
}

/// WILA 2016, Table 3: 30 m are measured within 6 % at any speed, after training `K` on one walk.
#[test]
fn wila_table_3_distances_of_simulated_walks() {
    let model = StepLengthModel::Weinberg { k_m: 0.45 };
    let walked_m = |model: &StepLengthModel, gait: &Gait| -> f32 {
        wila_cycles(gait).iter().map(|cycle| model.advance_m(cycle)).sum()
    };
    for (pace, factor) in PACES {
        let distances_m: Vec<f32> = (1..=10)
            .map(|seed| {
                let walker = WalkerProfile::drawn(seed);
                let training = straight(&walker, 1.0, 30.0, 100 + seed);
                let trained = model.trained(30.0, walked_m(&model, &training));
                walked_m(&trained, &straight(&walker, factor, 30.0, 200 + seed))
            })
            .collect();
        println!("{pace}: {distances_m:.1?} m");
        assert!(distances_m.iter().all(|m| (28.2..=31.8).contains(m)), "{pace}: {distances_m:?} m");
    }
}

/// Steps found by the phone's and the card's detector, and contacts; nothing without truth.
fn counts(run: &RunFolder) -> Option<[usize; 3]> {
    if !run.accelerometer().is_file() {
        return None;
    }
    let n_contacts = ContactReader::open(&run.contacts()).unwrap().map(Result::unwrap).count();
    let mut pedestrian = Pedestrian::new(PedestrianParams::default());
    let (mut level, mut card) = (LevelEstimator::new(LevelParams::default()), CardStepDetector::default());
    let (mut n_phone, mut n_card) = (0, 0);
    for sample in AccelerometerReader::open(&run.accelerometer()).unwrap().map(Result::unwrap) {
        n_phone += usize::from(pedestrian.push(&sample).is_some());
        let Reading::SpecificForce(force) = sample.reading else { continue };
        let level_force = level.push_specific_force(sample.time, force);
        n_card += usize::from(card.push(sample.time, level_force).is_some());
    }
    (n_contacts > 10).then_some([n_contacts, n_phone, n_card])
}

#[test]
fn steps_agree_with_foot_switches() {
    let Some(folder) = collection("oxford-steps") else { return };
    let counted: Vec<(Placement, [usize; 3])> = find_runs(&folder)
        .unwrap()
        .iter()
        .filter_map(|run| counts(run).map(|counts| (run.placement, counts)))
        .collect();
    assert!(counted.len() > 10, "{} walks", counted.len());
    // Means over walks of the relative error in percent, without and with its sign.
    let errors = |detector: usize, is_counted: fn(Placement) -> bool| {
        let errors: Vec<f64> = counted
            .iter()
            .filter(|(placement, _)| is_counted(*placement))
            .map(|(_, counts)| 100.0 * (counts[detector] as f64 / counts[0] as f64 - 1.0))
            .collect();
        let n = errors.len() as f64;
        (errors.iter().map(|error| error.abs()).sum::<f64>() / n, errors.iter().sum::<f64>() / n)
    };
    let in_hand = errors(1, |placement| placement == Placement::InHand);
    let all = errors(1, |_| true);
    println!("phone: in hand {in_hand:.2?}, all {all:.2?} %");
    assert!(in_hand.0 < 1.5 && all.0 < 2.0 && all.1.abs() < 1.0, "in hand {in_hand:?}, all {all:?} %");
    // A card hangs from the neck.
    let (at_neck, all) = (errors(2, |placement| placement == Placement::NeckPouch), errors(2, |_| true));
    println!("card: at the neck {at_neck:.2?}, all {all:.2?} %");
    assert!(at_neck.0 < 1.5 && all.0 < 7.5, "at the neck {at_neck:?}, all {all:?} %");
}
