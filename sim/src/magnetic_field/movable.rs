//! Steel that does not stay: furniture moved and doors opened between one walk and the next, trolleys that pass.

use fieldwalk::geometry::{Point2, Segment};

use crate::building::Building;
use crate::magnetic_field::{MagneticField, Source};
use crate::noise::Noise;
use crate::vector::{Vector3, add};

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
            trolleys_per_minute: 0.15,
            trolley_ut_m3: 6.0,
        }
    }
}

/// The field of a floor during one walk: what stays, what stood so on that day, and what passed.
#[derive(Clone, Debug)]
pub struct FieldOfDay<'a> {
    lasting: &'a MagneticField,
    standing: Vec<Source>,
    passing: Vec<Trolley>,
}

/// A dipole that goes along a line at an even pace.
#[derive(Clone, Copy, Debug)]
struct Trolley {
    line: Segment,
    start_s: f64,
    end_s: f64,
    height_m: f64,
    moment_ut_m3: Vector3,
}

impl<'a> FieldOfDay<'a> {
    /// The field with nothing but what stays.
    pub fn of(lasting: &'a MagneticField) -> Self {
        Self { lasting, standing: Vec::new(), passing: Vec::new() }
    }

    /// What moves in `building` on the day of `seed`, for a walk of `duration_s`.
    ///
    /// Which doors are of steel, and how they are magnetised, follows from `building_seed` and is the same every day.
    pub fn drawn(
        lasting: &'a MagneticField,
        building: &Building,
        params: &MovableParams,
        duration_s: f64,
        [building_seed, seed]: [u64; 2],
    ) -> Self {
        let mut day = Self::of(lasting);
        day.place_furniture(building, params, seed);
        day.hang_doors(building, params, [building_seed, seed]);
        day.send_trolleys(building, params, duration_s, seed);
        day
    }

    /// The field at `place_m` (x, y, height over the floor) `time_s` into the walk: along x, along y and upward, in µT.
    pub fn field_ut(&self, place_m: [f64; 3], time_s: f64) -> [f64; 3] {
        let lasting = self.lasting.field_ut(place_m);
        let day = self.standing.iter().fold(lasting, |sum, source| add(sum, source.field_ut(place_m)));
        let passing = self.passing.iter().filter_map(|trolley| trolley.at(time_s));
        passing.fold(day, |sum, source| add(sum, source.field_ut(place_m)))
    }

    fn place_furniture(&mut self, building: &Building, params: &MovableParams, seed: u64) {
        let mut noise = Noise::new(seed, "furniture", 0);
        let (width_m, height_m) = (building.plan.width_m, building.plan.height_m);
        for _ in 0..(params.furniture_per_m2 * width_m * height_m) as usize {
            let p = Point2::new(noise.within(0.3, width_m - 0.3), noise.within(0.3, height_m - 0.3));
            let up_m = noise.within(0.3, 0.8);
            let moment_ut_m3 = noise.normal3(params.furniture_ut_m3);
            let is_in_way = |c: &crate::building::Corridor| c.line.distance_m(p) < 0.5 * c.width_m + 0.3;
            if !building.corridors.iter().any(is_in_way) {
                self.standing.push(Source::Dipole { place_m: [p.x_m, p.y_m, up_m], moment_ut_m3 });
            }
        }
    }

    fn hang_doors(&mut self, building: &Building, params: &MovableParams, seeds: [u64; 2]) {
        for (door, index) in building.doors.iter().zip(0u64..) {
            let mut lasting = Noise::new(seeds[0], "door leaf", index);
            let is_steel = lasting.chance(params.steel_doors);
            let pole_ut_m2 = lasting.normal(params.leaf_ut_m2);
            let into_room = building.inward(door);
            if !is_steel {
                continue;
            }
            // Shut, the free edge meets the other jamb; open, it stands in the room.
            let hinge = door.centre - door.along * (0.5 * door.width_m);
            let is_open = Noise::new(seeds[1], "door", index).chance(0.4);
            let edge = hinge + if is_open { into_room } else { door.along } * (0.9 * door.width_m);
            for (p, share) in [(hinge.lerp(edge, 0.25), 0.5), (hinge.lerp(edge, 0.9), 0.5)] {
                self.standing.push(Source::Bar {
                    north_pole_m: [p.x_m, p.y_m, 2.0],
                    south_pole_m: [p.x_m, p.y_m, 0.02],
                    pole_ut_m2: share * pole_ut_m2,
                });
            }
        }
    }

    fn send_trolleys(&mut self, building: &Building, params: &MovableParams, duration_s: f64, seed: u64) {
        if params.trolleys_per_minute <= 0.0 {
            return;
        }
        for (corridor, index) in building.corridors.iter().zip(0u64..) {
            let mut noise = Noise::new(seed, "trolleys", index);
            let line = corridor.line;
            let mut start_s = -60.0;
            loop {
                start_s -= 60.0 / params.trolleys_per_minute * libm::log(noise.unit());
                if start_s >= duration_s {
                    break;
                }
                let line = if noise.chance(0.5) { line } else { Segment { a: line.b, b: line.a } };
                // People step aside for a trolley: it passes 0.6 m from the phone's way.
                let along = line.b - line.a;
                let aside = Point2::new(along.y_m, -along.x_m) * (0.6 / along.norm_m().max(1e-9));
                let line = Segment { a: line.a + aside, b: line.b + aside };
                let end_s = start_s + along.norm_m() / noise.within(0.8, 1.3);
                let height_m = noise.within(0.2, 0.7);
                let moment_ut_m3 = noise.normal3(params.trolley_ut_m3);
                self.passing.push(Trolley { line, start_s, end_s, height_m, moment_ut_m3 });
            }
        }
    }
}

impl Trolley {
    fn at(&self, time_s: f64) -> Option<Source> {
        let share = (time_s - self.start_s) / (self.end_s - self.start_s);
        let p = self.line.a.lerp(self.line.b, share);
        let source =
            Source::Dipole { place_m: [p.x_m, p.y_m, self.height_m], moment_ut_m3: self.moment_ut_m3 };
        (0.0..=1.0).contains(&share).then_some(source)
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
        let day = |seed| FieldOfDay::drawn(&field, &office, &params, 200.0, [1, seed]);
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
}
