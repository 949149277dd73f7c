//! Steel that does not stay: furniture moved and doors left open between one walk and the next; trolleys that pass, doors
//! that swing and lifts that travel during a walk.

mod door;
mod lift;
mod trolley;

use fieldwalk::geometry::Point2;

use self::door::Leaf;
use self::lift::Car;
use self::trolley::Trolley;
use crate::building::Building;
use crate::magnetic_field::{MagneticField, Source};
use crate::noise::Noise;
use crate::vector::add;

/// How much steel moves, and how strongly it is magnetised.
///
/// # Source
/// Ours: a trolley or a tool case with 10 µT·m³ shows 20 µT at 1 m on its axis; an office chair a fifth of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovableParams {
    /// Pieces of furniture in rooms per m² that stand elsewhere at every walk; default 0.04.
    pub furniture_per_m2: f64,
    /// Standard deviation of each component of a piece's moment, in µT·m³; default 2.
    pub furniture_ut_m3: f64,
    /// Share of doors whose leaf is of steel; default 0.2. It stands open or shut at every walk anew.
    pub steel_doors: f64,
    /// Pole strength of such a leaf, standard deviation, in µT·m²; default 3.
    pub leaf_ut_m2: f64,
    /// Times a minute that a door is used while one walks by; default 0.03.
    pub door_uses_per_minute: f64,
    /// Trips of each lift in a minute; default 0.7.
    pub lift_trips_per_minute: f64,
    /// Pole strength of a lift's car, standard deviation, in µT·m²; default 40.
    pub car_ut_m2: f64,
    /// Trolleys on each corridor in a minute; default 0.15.
    pub trolleys_per_minute: f64,
    /// Standard deviation of each component of a trolley's moment, in µT·m³; default 6.
    pub trolley_ut_m3: f64,
}

impl Default for MovableParams {
    fn default() -> Self {
        Self {
            furniture_per_m2: 0.04,
            furniture_ut_m3: 2.0,
            steel_doors: 0.2,
            leaf_ut_m2: 3.0,
            door_uses_per_minute: 0.03,
            lift_trips_per_minute: 0.7,
            car_ut_m2: 40.0,
            trolleys_per_minute: 0.15,
            trolley_ut_m3: 6.0,
        }
    }
}

impl MovableParams {
    /// A place full of people: trolleys, prams and cages of goods pass all the time, stands are moved over night.
    pub fn busy() -> Self {
        Self { furniture_per_m2: 0.08, trolleys_per_minute: 1.5, ..Self::default() }
    }
}

/// The field of a building during one walk: what stays, what stood so on that day, and what moved.
#[derive(Clone, Debug)]
pub struct FieldOfDay<'a> {
    lasting: &'a MagneticField,
    standing: Vec<Source>,
    moving: Vec<(f64, Moving)>,
}

/// What moves during a walk.
#[derive(Clone, Debug)]
enum Moving {
    Trolley(Trolley),
    Leaf(Leaf),
    Car(Car),
}

impl Moving {
    fn at(&self, time_s: f64) -> [Option<Source>; 2] {
        match self {
            Self::Trolley(trolley) => [trolley.at(time_s), None],
            Self::Leaf(leaf) => leaf.at(time_s).map(Some),
            Self::Car(car) => [Some(car.at(time_s)), None],
        }
    }
}

impl<'a> FieldOfDay<'a> {
    /// The field with nothing but what stays.
    pub fn of(lasting: &'a MagneticField) -> Self {
        Self { lasting, standing: Vec::new(), moving: Vec::new() }
    }

    /// With what moves on a floor whose height over the ground floor is `height_m`, on the day of `seed`, for a walk of
    /// `duration_s`.
    ///
    /// Which doors are of steel, and how doors and lifts are magnetised, follows from `building_seed` and is the same
    /// every day.
    #[must_use]
    pub fn with_floor(
        mut self,
        building: &Building,
        height_m: f64,
        params: &MovableParams,
        duration_s: f64,
        [building_seed, seed]: [u64; 2],
    ) -> Self {
        let first = self.standing.len();
        self.place_furniture(building, params, seed);
        for leaf in door::leaves(building, params, duration_s, [building_seed, seed]) {
            if leaf.is_still() {
                self.standing.extend(leaf.at(0.0));
            } else {
                self.moving.push((height_m, Moving::Leaf(leaf)));
            }
        }
        for source in &mut self.standing[first..] {
            *source = source.raised(height_m);
        }
        let trolleys = trolley::trolleys(building, params, duration_s, seed);
        self.moving.extend(trolleys.into_iter().map(|trolley| (height_m, Moving::Trolley(trolley))));
        // A shaft runs through all floors: its car belongs to the lowest.
        if height_m == 0.0 {
            let cars = lift::cars(building, params, duration_s, [building_seed, seed]);
            self.moving.extend(cars.into_iter().map(|car| (0.0, Moving::Car(car))));
        }
        self
    }

    /// The field at `place_m` (x, y, height over the ground floor) `time_s` into the walk: along x, along y and upward,
    /// in µT.
    pub fn field_ut(&self, place_m: [f64; 3], time_s: f64) -> [f64; 3] {
        let lasting = self.lasting.field_ut(place_m);
        let day = self.standing.iter().fold(lasting, |sum, source| add(sum, source.field_ut(place_m)));
        let moving = self.moving.iter().flat_map(|(height_m, moving)| {
            moving.at(time_s).into_iter().flatten().map(|source| source.raised(*height_m))
        });
        moving.fold(day, |sum, source| add(sum, source.field_ut(place_m)))
    }

    fn place_furniture(&mut self, building: &Building, params: &MovableParams, seed: u64) {
        let mut noise = Noise::new(seed, "furniture", 0);
        let (width_m, height_m) = (building.plan.width_m, building.plan.height_m);
        for _ in 0..(params.furniture_per_m2 * width_m * height_m) as usize {
            let p = Point2::new(noise.within(0.3, width_m - 0.3), noise.within(0.3, height_m - 0.3));
            let up_m = noise.within(0.3, 0.8);
            let moment_ut_m3 = noise.normal3(params.furniture_ut_m3);
            let is_in_way = |c: &crate::building::Corridor| c.line.distance_m(p) < 0.5 * c.width_m + 0.3;
            if !building.corridors.iter().any(is_in_way) && !building.ways.is_near(p, 0.3) {
                self.standing.push(Source::Dipole { place_m: [p.x_m, p.y_m, up_m], moment_ut_m3 });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::magnetic_field::{EarthField, SteelParams, steel};
    use crate::vector::{norm, subtract};

    #[test]
    fn days_differ_by_little_and_the_same_day_not_at_all() {
        let office = Building::office();
        let earth = EarthField::default();
        let field = MagneticField { sources: steel(&office, &earth, &SteelParams::default(), 1), earth };
        let params = MovableParams::default();
        let day = |seed| FieldOfDay::of(&field).with_floor(&office, 0.0, &params, 200.0, [1, seed]);
        let (first, again, other) = (day(1), day(1), day(2));
        let mut noise = Noise::new(1, "places", 0);
        let (mut square, n) = (0.0, 400);
        for k in 0..n {
            let line = office.corridors[k % office.corridors.len()].line;
            let p = line.a.lerp(line.b, noise.unit());
            let (place, time_s) = ([p.x_m, p.y_m, 1.1], noise.within(0.0, 200.0));
            assert_eq!(first.field_ut(place, time_s), again.field_ut(place, time_s));
            let apart = norm(subtract(first.field_ut(place, time_s), other.field_ut(place, time_s)));
            square += apart * apart / 3.0;
        }
        let sd_ut = (square / n as f64).sqrt();
        println!("a component differs by {sd_ut:.2} µT rms from day to day");
        assert!((0.3..4.0).contains(&sd_ut), "{sd_ut}");
    }

    #[test]
    fn metal_that_passes_is_felt_for_a_while() {
        let office = Building::office();
        let field = MagneticField::default();
        let busy = MovableParams {
            furniture_per_m2: 0.0,
            trolleys_per_minute: 5.0,
            door_uses_per_minute: 1.0,
            steel_doors: 1.0,
            ..MovableParams::default()
        };
        let day = FieldOfDay::of(&field).with_floor(&office, 0.0, &busy, 120.0, [1, 1]);
        let kinds = |is: fn(&Moving) -> bool| day.moving.iter().filter(|(_, moving)| is(moving)).count();
        assert!(kinds(|moving| matches!(moving, Moving::Trolley(_))) > 5);
        assert!(kinds(|moving| matches!(moving, Moving::Leaf(_))) > 30);
        assert_eq!(kinds(|moving| matches!(moving, Moving::Car(_))), office.lifts.len());
        // Standing in a corridor: quiet for the most part, some µT when something goes by.
        let place = [20.0, 6.0, 1.1];
        let strengths: Vec<f64> = (0..1200).map(|k| norm(day.field_ut(place, 0.1 * f64::from(k)))).collect();
        let mut sorted = strengths.clone();
        sorted.sort_by(f64::total_cmp);
        let (median, most) = (sorted[600], sorted[1199] - sorted[0]);
        let n_quiet = sorted.iter().filter(|s| (**s - median).abs() < 0.5).count();
        println!("median {median:.1} µT, range {most:.1} µT, {n_quiet} of 1200 quiet");
        assert!(most > 2.0 && n_quiet > 600, "{most} {n_quiet}");
        // Nothing jumps: people and things move at a finite pace, and so does their field.
        assert!(strengths.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 15.0));
    }
}
