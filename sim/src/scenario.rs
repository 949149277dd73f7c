//! Scenarios: a building with its field and radio, the walks that survey it, and walks that no survey saw.

mod named;
mod recorded;
mod survey_lines;
mod walk;

pub use recorded::{Recorded, TruthPoint};
pub use survey_lines::survey_lines;
pub use walk::Walk;

use fieldwalk::geometry::Point2;
use fieldwalk::time::{Duration, Timestamp};

use crate::air::Air;
use crate::building::{Building, Stairs, keeping_right};
use crate::card::{CardReadings, SentFrame};
use crate::magnetic_field::{EarthField, FieldOfDay, MagneticField, MovableParams, SteelParams, steel};
use crate::noise::Noise;
use crate::phone::{Carried, CarryMode, Grip};
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
/// Walkers keep to this share of the free space to a side: nobody brushes a wall.
const FREE_SHARE: f64 = 0.9;

/// A building to walk in.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The name, one of [`Scenario::NAMES`] or one's own.
    pub name: String,
    /// The ground floor.
    pub building: Building,
    /// The storeys above it, from the lowest; none in most scenarios.
    pub upstairs: Vec<Storey>,
    /// Its magnetic field, as far as it lasts.
    pub field: MagneticField,
    /// What moves from walk to walk.
    pub movable: MovableParams,
    /// Its transmitters.
    pub radio: RadioScene,
    /// Standard deviation of the place that a surveyor taps about the true one, along each axis, in metres; 0 where
    /// marks on the floor are tapped.
    pub tap_sd_m: f64,
    /// What everything by chance follows from.
    pub seed: u64,
}

/// A storey above the ground floor.
#[derive(Clone, Debug, PartialEq)]
pub struct Storey {
    /// What stands on it.
    pub building: Building,
    /// Its number; the ground floor's is 0.
    pub ordinal: i32,
    /// Height of its floor over the ground floor's, in metres.
    pub height_m: f64,
}

/// One floor of a scenario, the ground floor or a storey above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor<'a> {
    /// What stands on it.
    pub building: &'a Building,
    /// Its number; the ground floor's is 0.
    pub ordinal: i32,
    /// Height over the ground floor, in metres.
    pub height_m: f64,
}

impl Scenario {
    /// `building`, of one storey, with the steel and the transmitters that `seed` gives it.
    pub fn of_building(building: Building, params: &SteelParams, seed: u64) -> Self {
        Self::of_storeys(building, Vec::new(), params, seed)
    }

    fn of_storeys(building: Building, upstairs: Vec<Storey>, params: &SteelParams, seed: u64) -> Self {
        let name = building.name.clone();
        let radio = RadioScene::of_building(&building, BEACON_SPACING_M, seed);
        let field = MagneticField::default();
        let movable = MovableParams::default();
        let mut scenario = Self { name, building, upstairs, field, movable, radio, tap_sd_m: 0.0, seed };
        let earth = EarthField::default();
        let mut sources = Vec::new();
        for floor in scenario.floors() {
            let steel = steel(floor.building, &earth, params, scenario.storey_seed(floor.ordinal));
            sources.extend(steel.into_iter().map(|source| source.raised(floor.height_m)));
        }
        scenario.field = MagneticField { earth, sources };
        scenario
    }

    /// All floors, from the ground floor up.
    pub fn floors<'a>(&'a self) -> impl Iterator<Item = Floor<'a>> {
        let ground = Floor { building: &self.building, ordinal: 0, height_m: 0.0 };
        let above = |storey: &'a Storey| Floor {
            building: &storey.building,
            ordinal: storey.ordinal,
            height_m: storey.height_m,
        };
        [ground].into_iter().chain(self.upstairs.iter().map(above))
    }

    /// The floor on which somebody stands whose feet are `height_m` over the ground floor: on stairs, the nearer one.
    pub fn floor_at(&self, height_m: f64) -> Floor<'_> {
        let apart_m = |floor: &Floor<'_>| (floor.height_m - height_m).abs();
        let ground = Floor { building: &self.building, ordinal: 0, height_m: 0.0 };
        self.floors().min_by(|a, b| apart_m(a).total_cmp(&apart_m(b))).unwrap_or(ground)
    }

    fn storey_seed(&self, ordinal: i32) -> u64 {
        // The ground floor's steel does not depend on what stands on it.
        if ordinal == 0 { self.seed } else { Noise::new(self.seed, "storey", ordinal as u64).bits() }
    }

    /// The walks that survey the building, floor by floor: every corridor's middle line and, where there is room, lines
    /// beside it, and the lanes of open rooms, in both directions, by two surveyors with a phone each.
    pub fn survey_walks(&self) -> Vec<Walk> {
        let mut walks = Vec::new();
        let lines = self.floors().flat_map(|floor| {
            survey_lines(floor.building).into_iter().map(move |line| (floor.height_m, line))
        });
        for (k, (height_m, line)) in (0..).zip(lines) {
            // Where no corridor runs one way there is no line to walk. It keeps its number, which seeds the others.
            if line.len() > 1 {
                let surveyor = Noise::new(self.seed, "surveyor", k % 2).bits();
                let seed = Noise::new(self.seed, "survey walk", k).bits();
                walks.push(Walk {
                    walker: WalkerProfile::drawn(surveyor),
                    device: surveyor,
                    heights_m: vec![height_m],
                    ..Walk::along(format!("survey-{:02}", k + 1), line, seed)
                });
            }
        }
        walks
    }

    /// `n` walks by chance, each by another walker with another phone held level, at least `length_m` long, off the
    /// surveyed lines by what the ways leave free, some with a stop. Where there are stairs they are climbed on the way.
    pub fn test_walks(&self, n: u64, length_m: f64) -> Vec<Walk> {
        (0..n).map(|k| self.test_walk(k, length_m)).collect()
    }

    fn test_walk(&self, k: u64, length_m: f64) -> Walk {
        let mut noise = Noise::new(self.seed, "test walk", k);
        let (middle, heights_m) = match (&self.building.stairs, self.upstairs.first()) {
            (Some(stairs), Some(above)) => self.climb(stairs, above, &mut noise, length_m),
            _ => (self.building.ways.wander(noise.bits(), length_m), Vec::new()),
        };
        let ways = &self.building.ways;
        let aside: Vec<f64> = middle
            .windows(2)
            .map(|pair| {
                let free_m = FREE_SHARE * ways.free_m(pair[0], pair[1]);
                noise.within(-free_m, free_m)
            })
            .collect();
        let path = keeping_right(&middle, &aside);
        let pauses = (0..noise.index(3))
            .map(|_| Pause { at_m: noise.within(5.0, length_m - 5.0), duration_s: noise.within(2.0, 8.0) })
            .collect();
        let person = noise.bits();
        let walk = Walk::along(format!("test-{:02}", k + 1), path, noise.bits());
        Walk { walker: WalkerProfile::drawn(person), device: person, pauses, heights_m, ..walk }
    }

    /// Half of the way on the ground floor, the stairs, half of it above; or the other way round.
    fn climb(
        &self,
        stairs: &Stairs,
        above: &Storey,
        noise: &mut Noise,
        length_m: f64,
    ) -> (Vec<Point2>, Vec<f64>) {
        let Some(foot) = stairs.line.first() else { return (Vec::new(), Vec::new()) };
        let mut path = self.building.ways.wander_from(*foot, noise.bits(), 0.5 * length_m);
        path.reverse();
        path.pop();
        let mut heights_m = vec![0.0; path.len()];
        path.extend(&stairs.line);
        heights_m.extend(stairs.climbed.iter().map(|share| share * above.height_m));
        let onward = above.building.ways.wander_from(*foot, noise.bits(), 0.5 * length_m);
        path.extend(onward.iter().skip(1));
        heights_m.resize(path.len(), above.height_m);
        if noise.chance(0.5) {
            path.reverse();
            heights_m.reverse();
        }
        (path, heights_m)
    }

    fn field_of_day(&self, duration_s: f64, seed: u64) -> FieldOfDay<'_> {
        self.floors().fold(FieldOfDay::of(&self.field), |field, floor| {
            let seeds = [self.storey_seed(floor.ordinal), seed.wrapping_add(floor.ordinal as u64)];
            field.with_floor(floor.building, floor.height_m, &self.movable, duration_s, seeds)
        })
    }

    /// What the sensor of the card of `walk` reads; nothing where there is no card.
    pub fn card_readings(&self, walk: &Walk) -> Option<CardReadings> {
        let card = walk.card?;
        let (gait, grip) = gait_of(walk);
        let field = self.field_of_day(gait.duration_s(), walk.seed);
        let hung = Carried::new(gait, grip, &[(0.0, CarryMode::OnStrap { height_cm: card.height_cm })]);
        Some(card.readings(&hung, &field, [walk.device, walk.seed]))
    }

    /// What the phone of `walk`, or its card, records, and the truth.
    pub fn simulate(&self, walk: &Walk) -> Recorded {
        self.simulate_with(walk, None)
    }

    /// As [`Self::simulate`], where the card of `walk` sent these frames instead of its own.
    pub fn simulate_frames(&self, walk: &Walk, frames: &[SentFrame]) -> Recorded {
        self.simulate_with(walk, Some(frames))
    }

    fn simulate_with(&self, walk: &Walk, frames: Option<&[SentFrame]>) -> Recorded {
        let (gait, grip) = gait_of(walk);
        let field = self.field_of_day(gait.duration_s(), walk.seed);
        let air = Air::drawn(walk.seed);
        let seeds = [walk.device, walk.seed];
        let mut samples = Vec::new();
        if let Some(card) = &walk.card {
            let mode = CarryMode::OnStrap { height_cm: card.height_cm };
            let hung = Carried::new(gait.clone(), grip.clone(), &[(0.0, mode)]);
            samples.extend(match frames {
                Some(frames) => card.hear(frames, &hung, &self.radio, ORIGIN, walk.seed),
                None => card.record(&hung, &field, &self.radio, ORIGIN, seeds),
            });
        }
        let carried = Carried::new(gait, grip, &walk.carrying);
        if walk.card.is_none_or(|card| !card.sends_frames) {
            samples.extend(walk.phone.record(&carried, &field, &air, ORIGIN, seeds));
        }
        if walk.card.is_none() {
            samples.extend(walk.radio.listen(&carried, &self.radio, ORIGIN, walk.device, walk.seed));
        }
        // Stable: samples of one instant keep the order of their sensors.
        samples.sort_by_key(|sample| sample.time);
        let gait = carried.gait();
        let n_truth = (gait.duration_s() * TRUTH_HZ as f64) as i64;
        let truth = (0..=n_truth).map(|k| {
            let after = Duration::from_nanos(k * 1_000_000_000 / TRUTH_HZ);
            let body = gait.body(after.as_secs_f64());
            TruthPoint {
                time: ORIGIN + after,
                position: body.position,
                heading_rad: body.heading_rad,
                height_m: body.height_m,
                floor: self.floor_at(body.height_m).ordinal,
            }
        });
        Recorded {
            name: walk.name.clone(),
            samples,
            waypoints: walk.waypoints(gait, STANDING_S, self.tap_sd_m),
            truth: truth.collect(),
            steps: gait.steps().to_vec(),
        }
    }
}

fn gait_of(walk: &Walk) -> (Gait, Grip) {
    let course = Course::with_heights(&walk.path, &walk.heights_m);
    let Walk { walker, pauses, paces, .. } = walk;
    let gait = Gait::with_paces(walker, course, pauses, paces, STANDING_S, walk.seed);
    (gait, Grip::drawn(walker.height_m, walk.seed))
}
