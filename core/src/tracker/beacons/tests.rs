use std::sync::Arc;

use super::*;
use crate::attitude::{AttitudeEstimate, CarryMode};
use crate::floor_plan::FloorPlan;
use crate::map::{FloorIndex, FloorMap, Transmitter};
use crate::sensor::TransmitterId;
use crate::step::StepCycle;
use crate::system::Recipe;

/// 60 m × 40 m without a survey; a triangle of beacons round (12, 11), whose ranges are exact.
fn floor() -> Arc<FloorIndex> {
    let beacon = |(k, (x_m, y_m)): (u8, (f64, f64))| Transmitter {
        id: TransmitterId::BleAddress([0, 0, 0, 0, 0, k]),
        position: Point2::new(x_m, y_m),
        power_at_1m_dbm: -60.0,
        path_loss_exponent: 2.0,
        sigma_db: 0.0,
        n_sightings: 9,
    };
    let transmitters = (0u8..).zip([(10.0, 10.0), (14.0, 10.0), (12.0, 13.4)]).map(beacon).collect();
    let plan = FloorPlan { width_m: 60.0, height_m: 40.0, ..FloorPlan::default() };
    Arc::new(FloorIndex::new(FloorMap { plan, transmitters, ..FloorMap::default() }))
}

struct World {
    tracker: Tracker,
    k: i64,
}

impl World {
    fn new() -> Self {
        Self { tracker: Tracker::new(Recipe::ibill(), floor(), 1), k: 0 }
    }

    /// A step of half a second along the level frame's `heading_rad`, the phone carried in `carry_mode`.
    fn step(&mut self, heading_rad: f32, carry_mode: CarryMode) {
        let at = |k: i64| Timestamp::from_millis(500 * k);
        let (start, end) = (at(self.k), at(self.k + 1));
        self.k += 1;
        let cycle = StepCycle { start, end, frequency_hz: 2.0, amplitude_m_s2: 4.0, is_first: false };
        let event = StepEvent {
            cycle,
            n_steps: 1,
            reads: [None; 3],
            level_heading_rad: heading_rad,
            forward_field: None,
            end_strength_ut: None,
            field_bias_reset: false,
            attitude: AttitudeEstimate { carry_mode, ..AttitudeEstimate::default() },
        };
        self.tracker.step(&event, &[]);
    }

    /// A round heard at `at`; at a distance where nothing is heard when that is nothing.
    fn hear(&mut self, at: Option<Point2>) -> bool {
        let transmitters = &self.tracker.floor.map().transmitters;
        let power = |t: &Transmitter, at: Point2| {
            (-60.0 - 20.0 * libm::log10(t.position.distance_m(at).max(0.1))) as f32
        };
        let radio: Vec<RadioObservation> = (0u32..)
            .zip(transmitters)
            .filter_map(|(transmitter, t)| Some(RadioObservation { transmitter, rssi_dbm: power(t, at?) }))
            .collect();
        self.tracker.hear(Timestamp::from_millis(500 * self.k), &radio)
    }

    fn place(&self) -> Point2 {
        self.tracker.estimate().map_or(Point2::default(), |e| Point2::new(e.x_m, e.y_m))
    }

    fn heading_rad(&self) -> f64 {
        self.tracker.estimate().unwrap().heading_rad
    }

    /// Up through the cluster, two steps of the level frame's `heading_rad` a round.
    fn pass(&mut self, heading_rad: f32) {
        for k in 0..4 {
            let step_m = f64::from(self.tracker.recipe.length.length_m(2.0, 4.0));
            self.step(heading_rad, CarryMode::HeldUp);
            self.step(heading_rad, CarryMode::HeldUp);
            // Rounds are heard half a round late on average.
            assert!(self.hear(Some(Point2::new(12.0, 10.5 + step_m * (2.0 * f64::from(k) + 1.0)))));
            assert_eq!(self.tracker.mode(), TrackerMode::Beacons);
        }
    }
}

#[test]
fn a_cluster_places_and_turns_whoever_was_lost() {
    let mut world = World::new();
    world.tracker.place(Point2::new(40.0, 30.0), 2.0);
    assert!(world.tracker.uses_radio_rounds());
    assert!(!world.hear(None));
    assert_eq!(world.tracker.mode(), TrackerMode::Particles);
    // Straight up on the floor; the level frame is turned by 2 rad, and there is no compass.
    world.pass(2.0);
    // Directions begin 30° apart.
    assert!((world.place().x_m - 12.0).abs() < 0.5 && world.place().y_m > 13.5, "{:?}", world.place());
    assert!(world.heading_rad().abs() < 0.3, "{}", world.heading_rad());
    // Out of range the steps go on from there, in that direction.
    let left = world.place();
    for _ in 0..3 {
        world.step(2.0, CarryMode::HeldUp);
        world.step(2.0, CarryMode::HeldUp);
        world.hear(None);
    }
    assert_eq!(world.tracker.mode(), TrackerMode::Particles);
    let way = world.place() - left;
    assert!(way.y_m > 3.0 && way.x_m.abs() < 1.2, "{way:?}");
}

#[test]
fn who_knows_the_place_is_weighed_and_not_moved() {
    let mut world = World::new();
    world.tracker.place(Point2::new(12.0, 11.0), 2.0);
    world.step(0.0, CarryMode::HeldUp);
    let before = world.tracker.particles().clone();
    assert!(world.hear(Some(Point2::new(12.0, 11.0))));
    let after = world.tracker.particles();
    assert_eq!(after.x_m, before.x_m);
    assert_eq!(after.heading_offset_rad, before.heading_offset_rad);
    // The ranges are exact, so that the likelihood is narrow; a quarter of it counts.
    let of = |k: usize| {
        Point2::new(f64::from(after.x_m[k]), f64::from(after.y_m[k])).distance_m(Point2::new(12.0, 11.0))
    };
    let near = (0..after.len()).find(|&k| of(k) < 0.2).unwrap();
    let far = (0..after.len()).find(|&k| of(k) > 1.5).unwrap();
    assert!(
        after.log_weight[near] - before.log_weight[near]
            > after.log_weight[far] - before.log_weight[far] + 1.0
    );
}

#[test]
fn one_fix_astray_is_outvoted_and_six_are_not() {
    let mut world = World::new();
    world.tracker.place(Point2::new(20.0, 11.0), 1.0);
    world.step(0.0, CarryMode::HeldUp);
    let cluster = Point2::new(12.0, 11.0);
    for _ in 0..5 {
        assert!(world.hear(Some(cluster)));
        assert!((world.place().x_m - 20.0).abs() < 1.0, "{:?}", world.place());
    }
    assert!(world.hear(Some(cluster)));
    assert!(world.place().distance_m(cluster) < 0.5, "{:?}", world.place());
}

#[test]
fn after_a_single_fix_every_direction_is_open() {
    let mut world = World::new();
    world.step(0.0, CarryMode::HeldUp);
    assert!(world.hear(Some(Point2::new(12.0, 11.0))));
    assert!(world.place().distance_m(Point2::new(12.0, 11.0)) < 0.2);
    let particles = world.tracker.particles();
    let sum: f32 = particles.heading_cos.iter().sum::<f32>() / particles.len() as f32;
    assert_eq!(particles.len(), 960);
    assert!(sum.abs() < 1e-3, "{sum}");
}

#[test]
fn a_pocket_pauses_and_the_hand_begins_in_a_circle() {
    let mut world = World::new();
    world.tracker.place(Point2::new(20.0, 20.0), 1.0);
    world.step(0.0, CarryMode::HeldUp);
    let before = world.place();
    for _ in 0..10 {
        world.step(0.0, CarryMode::FrontPocket);
        assert!(!world.hear(Some(Point2::new(12.0, 11.0))), "nothing is made of beacons either");
    }
    assert_eq!(world.tracker.mode(), TrackerMode::Paused { n_steps: 10 });
    assert_eq!(world.place(), before);
    // Held again, 12 m from the cluster: the ranges are exact, so the circle is as small as it gets.
    world.step(0.0, CarryMode::HeldUp);
    assert_eq!(world.tracker.mode(), TrackerMode::Paused { n_steps: 10 });
    let there = Point2::new(20.0, 20.0);
    assert!(world.hear(Some(there)));
    assert_eq!(world.tracker.mode(), TrackerMode::Particles);
    assert!(world.place().distance_m(there) < 0.5, "{:?}", world.place());
    let particles = world.tracker.particles();
    let apart = |i: usize| Point2::new(particles.x_m[i].into(), particles.y_m[i].into()).distance_m(there);
    assert!((0..particles.len()).all(|i| apart(i) < 4.1) && (0..particles.len()).any(|i| apart(i) > 3.0));
    // Nobody knows the direction, so steps weigh nothing.
    assert!(world.tracker.state.is_start_unknown);
    world.step(0.0, CarryMode::HeldUp);
    assert!(world.tracker.particles().log_weight.iter().all(|&w| w == 0.0));
}

#[test]
fn without_beacons_in_reach_a_pause_ends_where_it_began() {
    let mut world = World::new();
    world.tracker.place(Point2::new(20.0, 20.0), 1.0);
    world.step(0.0, CarryMode::HeldUp);
    (0..20).for_each(|_| world.step(0.0, CarryMode::Swinging));
    for _ in 0..WAIT_STEPS {
        world.step(0.0, CarryMode::HeldUp);
        assert!(!world.hear(None));
        assert!(matches!(world.tracker.mode(), TrackerMode::Paused { .. }));
    }
    world.step(0.0, CarryMode::HeldUp);
    assert_eq!(world.tracker.mode(), TrackerMode::Particles);
    let estimate = *world.tracker.estimate().unwrap();
    assert!(estimate.radius_95_m > 5.0, "{estimate:?}");
}

#[test]
fn a_cold_start_waits_for_a_cluster_and_then_begins_anywhere() {
    let mut world = World::new();
    world.step(0.0, CarryMode::HeldUp);
    assert_eq!(world.tracker.estimate(), None);
    assert!(world.hear(Some(Point2::new(20.0, 20.0))));
    assert!(world.place().distance_m(Point2::new(20.0, 20.0)) < 1.0, "{:?}", world.place());
    let mut deaf = World::new();
    (0..9).for_each(|_| deaf.step(0.0, CarryMode::HeldUp));
    assert!(deaf.tracker.estimate().is_some() && deaf.tracker.state.is_start_unknown);
}

#[test]
fn a_hint_ends_a_visit_and_a_pause() {
    let mut world = World::new();
    world.tracker.place(Point2::new(20.0, 20.0), 1.0);
    world.pass(0.0);
    world.tracker.place(Point2::new(30.0, 20.0), 1.0);
    assert_eq!(world.tracker.mode(), TrackerMode::Particles);
    world.step(0.0, CarryMode::BackPocket);
    world.tracker.place(Point2::new(30.0, 20.0), 1.0);
    assert_eq!(world.tracker.mode(), TrackerMode::Particles);
    assert!(!world.tracker.state.is_start_unknown);
}

#[test]
fn a_snapshot_fits_whatever_the_number_of_particles() {
    let mut world = World::new();
    world.tracker.place(Point2::new(20.0, 20.0), 1.0);
    for k in 0..6 {
        assert!(world.tracker.fits(world.tracker.state()), "{k}");
        if k % 2 == 0 {
            world.step(0.0, CarryMode::HeldUp)
        } else {
            world.hear(Some(Point2::new(12.0, 11.0)));
        }
    }
    let mut torn = world.tracker.state().clone();
    torn.particles.recent_strengths_ut.pop();
    assert!(!world.tracker.fits(&torn));
}

#[test]
fn one_particle_goes_all_the_way() {
    let mut world = World::new();
    world.tracker = Tracker::new(Recipe { n_particles: 1, ..Recipe::ibill() }, floor(), 1);
    world.tracker.place(Point2::new(12.0, 8.0), 1.0);
    world.pass(0.0);
    (0..3).for_each(|_| world.step(0.0, CarryMode::FrontPocket));
    (0..12).for_each(|_| world.step(0.0, CarryMode::HeldUp));
    assert_eq!(world.tracker.particles().len(), 1);
    assert!(world.place().x_m.is_finite());
}
