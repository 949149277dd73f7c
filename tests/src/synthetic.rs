//! A small synthetic building for tests: one floor, its magnetic field and beacons, and walkers with a phone.
//!
//! Physical but simple: dipoles over the Earth's field, a sinusoidal gait, sensors with noise and bias. Everything is a
//! pure function of seeds, computed with `libm`, so that every machine makes the same recordings.

mod walker;

use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorMap;
use fieldwalk::positioner::PositionHint;
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::survey::{SurveyError, SurveyParams, SurveyWalk, Waypoint, build_floor};
use fieldwalk::time::{Duration, Timestamp};

use walker::{Body, Course, Noise, Phone, in_walker_frame};

/// The floor's name, also in its map.
pub const FLOOR_NAME: &str = "synthetic";
/// The floor's ordinal.
pub const FLOOR_ORDINAL: i32 = 1;
/// The instant at which every walk begins.
pub const WALK_START: Timestamp = Timestamp::from_millis(1_000_000);

const WIDTH_M: f64 = 30.0;
const HEIGHT_M: f64 = 20.0;
/// The Earth's field in the floor frame (x, y, up), in µT: north lies 0.2 rad off the plan's y.
const EARTH_UT: [f64; 3] = [4.4, 21.6, -42.0];
const N_DIPOLES: usize = 12;
const N_BEACONS: usize = 5;

const SAMPLE_MS: i64 = 20;
const STEP_HZ: f64 = 1.9;
const STEP_M: f64 = 0.62;

/// A floor of 30 m × 20 m: two closed units, a way round them and a corridor between them.
#[derive(Clone, Debug)]
pub struct Floor {
    seed: u64,
    plan: FloorPlan,
    dipoles: Vec<Dipole>,
    beacons: Vec<(TransmitterId, Point2)>,
}

#[derive(Clone, Copy, Debug)]
struct Dipole {
    /// x, y, and height over the phone, in metres.
    place_m: [f64; 3],
    /// µ0/4π times the moment, in µT·m³.
    moment: [f64; 3],
}

/// A walk as a phone records it, with the truth.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// All samples, in order of time.
    pub samples: Vec<Sample>,
    /// The places at which the walker tapped: the ends of the walk and its corners.
    pub waypoints: Vec<Waypoint>,
}

impl Floor {
    /// The floor with the steel and the beacons that `seed` gives it.
    pub fn new(seed: u64) -> Self {
        let mut noise = Noise::new(seed, 0);
        let dipoles = (0..N_DIPOLES)
            .map(|_| {
                let above_m = noise.within(1.0, 2.5) * if noise.within(-1.0, 1.0) < 0.0 { -1.0 } else { 1.0 };
                let strength = noise.within(20.0, 80.0);
                Dipole {
                    place_m: [noise.within(0.0, WIDTH_M), noise.within(0.0, HEIGHT_M), above_m],
                    moment: noise.direction().map(|c| strength * c),
                }
            })
            .collect();
        let beacons = (0..N_BEACONS as u8)
            .map(|k| {
                let place = Point2::new(noise.within(1.0, WIDTH_M - 1.0), noise.within(1.0, HEIGHT_M - 1.0));
                (TransmitterId::BleAddress([0xC0, 0, 0, 0, 0, k]), place)
            })
            .collect();
        Self { seed, plan: plan(), dipoles, beacons }
    }

    /// The floor's plan.
    pub fn plan(&self) -> &FloorPlan {
        &self.plan
    }

    /// The magnetic field at `p` in the height of the phone: x, y and up in the floor frame, in µT.
    pub fn field_ut(&self, p: Point2) -> [f64; 3] {
        let mut field = EARTH_UT;
        for Dipole { place_m, moment } in &self.dipoles {
            let r = [p.x_m - place_m[0], p.y_m - place_m[1], -place_m[2]];
            let square: f64 = r.iter().map(|c| c * c).sum();
            let along: f64 = r.iter().zip(moment).map(|(a, b)| a * b).sum();
            let cube = square * square.sqrt();
            for c in 0..3 {
                field[c] += (3.0 * along * r[c] / square - moment[c]) / cube;
            }
        }
        field
    }

    /// A walk along the straight lines that join `waypoints`; `seed` decides on the walker, the phone and its noise.
    pub fn walk(&self, seed: u64, waypoints: &[Point2]) -> Recorded {
        let mut noise = Noise::new(seed, 1 + self.seed);
        let course = Course::new(waypoints, STEP_HZ * STEP_M * noise.within(0.95, 1.05));
        let phone = Phone::new(&mut noise);
        let step_hz = STEP_HZ * noise.within(0.97, 1.03);
        let mut recorded = Recorded { samples: Vec::new(), waypoints: course.waypoints.clone() };
        let n_ticks = (course.end_s * 1_000.0) as i64 / SAMPLE_MS;
        for tick in 0..n_ticks {
            let ms = tick * SAMPLE_MS;
            let body = Body::at(&course, step_hz, ms as f64 * 1e-3);
            let field_ut = in_walker_frame(self.field_ut(body.position), body.heading_rad);
            let mut push = |after_ms: i64, reading: Reading| {
                let time = WALK_START + Duration::from_millis(ms + after_ms);
                recorded.samples.push(Sample { time, reading });
            };
            push(0, phone.angular_rate([0.0, 0.0, -body.turning_rad_s], &mut noise));
            push(3, phone.specific_force(body.force_m_s2, &mut noise));
            push(7, phone.field(field_ut, &mut noise));
            // Beacons take turns: each is heard three times a second.
            if tick % 3 == 0 {
                let (transmitter, place) = self.beacons[(tick / 3) as usize % self.beacons.len()];
                let distance_m = body.position.distance_m(place).max(0.5);
                let rssi_dbm = (-59.0 - 22.0 * libm::log10(distance_m) + noise.normal(4.0)).round() as f32;
                if rssi_dbm > -95.0 {
                    push(11, Reading::Radio(RadioSighting { transmitter, rssi_dbm }));
                }
            }
        }
        recorded
    }

    /// Ten walks that survey every way of the floor in both directions, each by another walker.
    pub fn survey(&self) -> Vec<SurveyWalk> {
        let mut routes = Vec::new();
        for inset_m in [1.5, 2.5] {
            let (x0, x1, y0, y1) = (inset_m, WIDTH_M - inset_m, inset_m, HEIGHT_M - inset_m);
            let x = 0.5 * WIDTH_M + inset_m - 2.0;
            routes.push(points(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]));
            routes.push(points(&[(x, y0), (x, y1), (x0, y1), (x0, y0), (x, y0)]));
            routes.push(points(&[(x, y1), (x, y0), (x1, y0), (x1, y1), (x, y1)]));
        }
        let backwards: Vec<Vec<Point2>> =
            routes[..4].iter().map(|route| route.iter().rev().copied().collect()).collect();
        routes.extend(backwards);
        (1_000..)
            .zip(&routes)
            .map(|(seed, route)| self.walk(seed, route).survey_walk(&format!("survey {seed}")))
            .collect()
    }

    /// The map that [`Floor::survey`] gives.
    ///
    /// # Errors
    /// Those of [`build_floor`].
    pub fn surveyed_map(&self) -> Result<FloorMap, SurveyError> {
        build_floor(FLOOR_NAME, FLOOR_ORDINAL, &self.plan, &self.survey(), &SurveyParams::default())
    }

    /// A walk that no survey made: round the floor and through the corridor, 110 m along other lines.
    pub fn round_trip(&self, seed: u64) -> Recorded {
        let corners = [
            (2.0, 6.0),
            (2.0, 18.0),
            (14.5, 18.0),
            (15.5, 2.2),
            (28.0, 2.0),
            (27.6, 17.8),
            (16.0, 18.2),
            (15.0, 10.0),
        ];
        self.walk(seed, &points(&corners))
    }
}

impl Recorded {
    /// Where the walker was at `time`; before the walk its start, after it its end.
    pub fn truth(&self, time: Timestamp) -> Option<Point2> {
        let (first, last) = (self.waypoints.first()?, self.waypoints.last()?);
        let between = self.waypoints.windows(2).find(|pair| pair[0].time <= time && time < pair[1].time);
        Some(match between {
            Some(pair) => {
                let share = time.secs_since(pair[0].time) / pair[1].time.secs_since(pair[0].time);
                pair[0].point.lerp(pair[1].point, share)
            }
            None if time < first.time => first.point,
            None => last.point,
        })
    }

    /// A hint at the walk's start, `off` the truth.
    pub fn hint(&self, off: Point2) -> Option<PositionHint> {
        let Waypoint { time, point } = *self.waypoints.first()?;
        Some(PositionHint { point: point + off, radius_m: 1.5, floor: FLOOR_ORDINAL, time, direction: None })
    }

    /// The walk as a surveyor's.
    pub fn survey_walk(&self, name: &str) -> SurveyWalk {
        let mut walk = SurveyWalk::new(name);
        for sample in &self.samples {
            walk.push(sample);
        }
        for waypoint in &self.waypoints {
            walk.push_waypoint(*waypoint);
        }
        walk.finish();
        walk
    }
}

fn plan() -> FloorPlan {
    let unit = |name: &str, walkable: bool, (x0, y0): (f64, f64), (x1, y1): (f64, f64)| Unit {
        name: name.into(),
        walkable,
        polygon: Polygon { rings: vec![points(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)])] },
    };
    FloorPlan {
        width_m: WIDTH_M,
        height_m: HEIGHT_M,
        outline: vec![unit("", true, (0.0, 0.0), (WIDTH_M, HEIGHT_M)).polygon],
        units: vec![
            unit("archive", false, (4.0, 4.0), (13.0, 16.0)),
            unit("workshop", false, (17.0, 4.0), (26.0, 16.0)),
            unit("corridor", true, (13.0, 4.0), (17.0, 16.0)),
        ],
        ..FloorPlan::default()
    }
}

fn points(coordinates: &[(f64, f64)]) -> Vec<Point2> {
    coordinates.iter().map(|&(x_m, y_m)| Point2::new(x_m, y_m)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::geometry::wrap_rad;

    #[test]
    fn a_walk_is_the_same_twice_and_another_with_another_seed() {
        let floor = Floor::new(1);
        let walk = floor.round_trip(1);
        assert_eq!(walk.samples, Floor::new(1).round_trip(1).samples);
        assert_ne!(walk.samples, floor.round_trip(2).samples);
        assert_ne!(floor.field_ut(Point2::new(9.0, 2.0)), Floor::new(2).field_ut(Point2::new(9.0, 2.0)));
        assert!(walk.samples.iter().all(Sample::is_plausible));
        assert!(walk.samples.windows(2).all(|pair| pair[0].time < pair[1].time));
    }

    #[test]
    fn a_walker_makes_the_steps_that_the_way_takes() {
        for seed in 0..5 {
            let recorded = Floor::new(seed).round_trip(seed);
            let walk = recorded.survey_walk("round trip");
            let length_m: f64 =
                recorded.waypoints.windows(2).map(|pair| pair[0].point.distance_m(pair[1].point)).sum();
            let expected = length_m / STEP_M;
            let n_steps = walk.steps().len() as f64;
            assert!((n_steps / expected - 1.0).abs() < 0.1, "{n_steps} steps over {length_m} m");
        }
    }

    #[test]
    fn the_phone_feels_the_turns_of_the_walk() {
        let recorded = Floor::new(1).round_trip(1);
        let walk = recorded.survey_walk("round trip");
        let (first, last) = (&walk.steps()[3], &walk.steps()[walk.steps().len() - 3]);
        // The first line leads along +y, the last from (16, 18.2) to (15, 10).
        let turned_rad = wrap_rad(f64::from(last.level_heading_rad - first.level_heading_rad));
        let truth_rad = Point2::new(-1.0, -8.2).heading_rad();
        assert!(wrap_rad(turned_rad - truth_rad).abs() < 0.5, "{turned_rad} for {truth_rad}");
    }
}
