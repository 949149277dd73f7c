//! Scenarios: a building with its field and radio, the walks that survey it, and walks that no survey saw.

mod recorded;
mod survey_lines;
mod walk;

pub use recorded::{Recorded, TruthPoint};
pub use survey_lines::survey_lines;
pub use walk::Walk;

use fieldwalk::time::{Duration, Timestamp};

use crate::building::{Building, keeping_right};
use crate::magnetic_field::{EarthField, FieldOfDay, MagneticField, MovableParams, SteelParams, steel};
use crate::noise::Noise;
use crate::phone::{Carried, Grip};
use crate::radio::RadioScene;
use crate::walker::{Course, Gait, Pause, WalkerProfile};

/// The instant at which every recording begins.
pub const ORIGIN: Timestamp = Timestamp::from_millis(1_000_000);
/// The truth is told this often, in Hz.
const TRUTH_HZ: i64 = 10;
/// Walkers stand this long before and after a walk, in seconds.
const STANDING_S: f64 = 2.0;
/// Distance between beacons along corridors, in metres.
const BEACON_SPACING_M: f64 = 12.0;

/// A building to walk in.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The building.
    pub building: Building,
    /// Its magnetic field, as far as it lasts.
    pub field: MagneticField,
    /// What moves from walk to walk.
    pub movable: MovableParams,
    /// Its transmitters.
    pub radio: RadioScene,
    /// What everything by chance follows from.
    pub seed: u64,
}

impl Scenario {
    /// The office of 60 × 40 m ([`Building::office`]) with the steel and the transmitters that `seed` gives it.
    pub fn office(seed: u64) -> Self {
        Self::of_building(Building::office(), &SteelParams::default(), seed)
    }

    /// `building` with the steel and the transmitters that `seed` gives it.
    pub fn of_building(building: Building, params: &SteelParams, seed: u64) -> Self {
        let earth = EarthField::default();
        let sources = steel(&building, &earth, params, seed);
        let radio = RadioScene::of_building(&building, BEACON_SPACING_M, seed);
        let field = MagneticField { earth, sources };
        Self { building, field, movable: MovableParams::default(), radio, seed }
    }

    /// The walks that survey the building: every corridor's middle line and, where there is room, a line beside it, in
    /// both directions, by two surveyors with a phone each.
    pub fn survey_walks(&self) -> Vec<Walk> {
        let lines = survey_lines(&self.building);
        let mut walks = Vec::with_capacity(lines.len());
        for (line, k) in lines.into_iter().zip(0u64..) {
            let surveyor = Noise::new(self.seed, "surveyor", k % 2).bits();
            let seed = Noise::new(self.seed, "survey walk", k).bits();
            walks.push(Walk {
                walker: WalkerProfile::drawn(surveyor),
                device: surveyor,
                ..Walk::along(format!("survey-{:02}", k + 1), line, seed)
            });
        }
        walks
    }

    /// `n` walks by chance, each by another walker with another phone held level, at least `length_m` long, off the
    /// surveyed lines by what the corridors leave free, some with a stop.
    pub fn test_walks(&self, n: u64, length_m: f64) -> Vec<Walk> {
        (0..n).map(|k| self.test_walk(k, length_m)).collect()
    }

    fn test_walk(&self, k: u64, length_m: f64) -> Walk {
        let mut noise = Noise::new(self.seed, "test walk", k);
        let ways = &self.building.ways;
        let middle = ways.wander(noise.bits(), length_m);
        let aside: Vec<f64> = middle
            .windows(2)
            .map(|pair| {
                let free_m = ways.free_m(pair[0], pair[1]).min(0.45);
                noise.within(-free_m, free_m)
            })
            .collect();
        let path = keeping_right(&middle, &aside);
        let pauses = (0..noise.index(3))
            .map(|_| Pause { at_m: noise.within(5.0, length_m - 5.0), duration_s: noise.within(2.0, 8.0) })
            .collect();
        let person = noise.bits();
        let walk = Walk::along(format!("test-{:02}", k + 1), path, noise.bits());
        Walk { walker: WalkerProfile::drawn(person), device: person, pauses, ..walk }
    }

    /// What the phone of `walk` records, and the truth.
    pub fn simulate(&self, walk: &Walk) -> Recorded {
        let course = Course::new(&walk.path);
        let gait = Gait::new(&walk.walker, course, &walk.pauses, STANDING_S, walk.seed);
        let grip = Grip::drawn(walk.walker.height_m, walk.seed);
        let carried = Carried::new(gait, grip, &walk.carrying);
        let seeds = [self.seed, walk.seed];
        let duration_s = carried.gait().duration_s();
        let field = FieldOfDay::drawn(&self.field, &self.building, &self.movable, duration_s, seeds);
        let mut samples = walk.phone.record(&carried, &field, ORIGIN, walk.device, walk.seed);
        samples.extend(walk.radio.listen(&carried, &self.radio, ORIGIN, walk.device, walk.seed));
        // Stable: samples of one instant keep the order of their sensors.
        samples.sort_by_key(|sample| sample.time);
        let gait = carried.gait();
        let n_truth = (gait.duration_s() * TRUTH_HZ as f64) as i64;
        let truth = (0..=n_truth).map(|k| {
            let after = Duration::from_nanos(k * 1_000_000_000 / TRUTH_HZ);
            let body = gait.body(after.as_secs_f64());
            TruthPoint { time: ORIGIN + after, position: body.position, heading_rad: body.heading_rad }
        });
        Recorded {
            name: walk.name.clone(),
            samples,
            waypoints: walk.waypoints(gait, STANDING_S),
            truth: truth.collect(),
            steps: gait.steps().to_vec(),
        }
    }
}
