//! The steel of a building: columns, beams, reinforcement, door frames, cabinets and lifts.
//!
//! Steel is magnetised by the Earth's field, and keeps a magnetisation of its own from making and lifting. A long piece
//! of cross-section A in which the flux density is B shows poles of A·B/4π at its ends.

use fieldwalk::geometry::{Point2, Segment};

use crate::building::Building;
use crate::magnetic_field::{EarthField, Source};
use crate::noise::Noise;

/// How much steel there is and how strongly it is magnetised.
///
/// A pole's strength is the Earth's field along the piece times an *induced* area, plus a *remanent* part of random
/// sign. The areas are µ_eff·A/4π: for a column with 0.02 m² of steel in its section and a ratio of length to
/// thickness of 12, µ_eff ≈ 60 and the area is about 0.1 m²; for the sheet of a door frame it is less than 0.01 m² and
/// left out.
///
/// # Source
/// Demagnetising factors of long rods: Osborn 1945, *Demagnetizing factors of the general ellipsoid*. The remanent
/// parts are ours, set so that the field along corridors varies as published (anomalies of 10 to 20 µT in offices:
/// mass-centred 2019).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteelParams {
    /// Structural columns: induced area in m²; default 0.10.
    pub column_m2: f64,
    /// Remanent pole of a column, standard deviation, in µT·m²; default 16.
    pub column_ut_m2: f64,
    /// Beams under the floor and above the ceiling, between neighbouring columns: induced area, in m²; default 0.10.
    pub beam_m2: f64,
    /// Remanent pole of a beam, standard deviation, in µT·m²; default 16.
    pub beam_ut_m2: f64,
    /// Pieces of reinforcement in the floor slab per m²; default 0.25.
    pub bars_per_m2: f64,
    /// Remanent pole of a piece of reinforcement, standard deviation, in µT·m²; default 5.
    pub reinforcement_ut_m2: f64,
    /// Remanent pole of each jamb of a steel door frame, standard deviation, in µT·m²; default 3.
    pub door_ut_m2: f64,
    /// Cabinets per metre of corridor, on either side behind the wall; default 0.12.
    pub cabinets_per_m: f64,
    /// Remanent pole of a cabinet, standard deviation, in µT·m²; default 8.
    pub cabinet_ut_m2: f64,
    /// Remanent pole of each guide rail of a lift, standard deviation, in µT·m²; default 40.
    pub lift_ut_m2: f64,
}

impl Default for SteelParams {
    fn default() -> Self {
        Self {
            column_m2: 0.10,
            column_ut_m2: 16.0,
            beam_m2: 0.10,
            beam_ut_m2: 16.0,
            bars_per_m2: 0.25,
            reinforcement_ut_m2: 5.0,
            door_ut_m2: 3.0,
            cabinets_per_m: 0.12,
            cabinet_ut_m2: 8.0,
            lift_ut_m2: 40.0,
        }
    }
}

impl SteelParams {
    /// A frame of reinforced concrete: the steel of a column is a few thin bars that close on themselves through their
    /// ties, beams are slabs; shop fronts have shutters that run in rails of steel.
    ///
    /// # Source
    /// Ours: about 1.5 % of a concrete section of 0.5 m² is steel, 0.0075 m², against the 0.02 m² of a steel column.
    pub const fn concrete_frame() -> Self {
        Self {
            column_m2: 0.04,
            column_ut_m2: 8.0,
            beam_m2: 0.04,
            beam_ut_m2: 8.0,
            bars_per_m2: 0.25,
            reinforcement_ut_m2: 5.0,
            door_ut_m2: 8.0,
            cabinets_per_m: 0.12,
            cabinet_ut_m2: 8.0,
            lift_ut_m2: 40.0,
        }
    }
}

/// Heights over the floor, in metres.
const SLAB_M: f64 = -0.12;
const BEAM_M: f64 = -0.35;
const DOOR_TOP_M: f64 = 2.05;
/// Slabs are open so far to either side of a flight's middle, in metres.
const STAIRS_OPENING_M: f64 = 0.7;

/// The steel of `building` as `seed` has it.
pub fn steel(building: &Building, earth: &EarthField, params: &SteelParams, seed: u64) -> Vec<Source> {
    let mut sources = Vec::new();
    let mut place = |kind: &str, pieces: &dyn Fn(&mut Noise, &mut Vec<Source>)| {
        pieces(&mut Noise::new(seed, kind, 0), &mut sources);
    };
    let [earth_x_ut, earth_y_ut, earth_up_ut] = earth.field_ut();
    let ceiling_m = building.ceiling_m;
    place("columns", &|noise, sources| {
        for p in &building.columns {
            let pole_ut_m2 = params.column_m2 * earth_up_ut + noise.normal(params.column_ut_m2);
            sources.push(upright(*p, BEAM_M, ceiling_m + 0.3, pole_ut_m2));
        }
    });
    place("beams", &|noise, sources| {
        for (a, b) in neighbours(&building.columns) {
            let along = (b - a) * (1.0 / a.distance_m(b).max(1e-9));
            let along_ut = along.x_m * earth_x_ut + along.y_m * earth_y_ut;
            for height_m in [BEAM_M, ceiling_m + 0.3] {
                if spans_stairs(building, a, b) {
                    continue;
                }
                // Cut short of the column: the poles of beams meet there, but do not coincide.
                let (from, to) = (a.lerp(b, 0.04), a.lerp(b, 0.96));
                let pole_ut_m2 = params.beam_m2 * along_ut + noise.normal(params.beam_ut_m2);
                sources.push(bar(level(to, height_m), level(from, height_m), pole_ut_m2));
            }
        }
    });
    place("reinforcement", &|noise, sources| {
        let (width_m, height_m) = (building.plan.width_m, building.plan.height_m);
        for _ in 0..(params.bars_per_m2 * width_m * height_m) as usize {
            let from = Point2::new(noise.within(0.0, width_m), noise.within(0.0, height_m));
            let along_m = noise.within(2.0, 6.0);
            let to =
                from + if noise.chance(0.5) { Point2::new(along_m, 0.0) } else { Point2::new(0.0, along_m) };
            let pole_ut_m2 = noise.normal(params.reinforcement_ut_m2);
            if spans_stairs(building, from, to) {
                continue;
            }
            sources.push(bar(level(to, SLAB_M), level(from, SLAB_M), pole_ut_m2));
        }
    });
    place("doors", &|noise, sources| {
        for door in &building.doors {
            for side in [-0.5, 0.5] {
                let jamb = door.centre + door.along * (side * door.width_m);
                sources.push(upright(jamb, 0.0, DOOR_TOP_M, noise.normal(params.door_ut_m2)));
            }
        }
    });
    place("cabinets", &|noise, sources| cabinets(building, params, noise, sources));
    place("lifts", &|noise, sources| {
        for shaft in &building.lifts {
            for corner in shaft.corners() {
                let rail = shaft.centre().lerp(corner, 0.7);
                sources.push(upright(rail, -1.5, ceiling_m + 1.5, noise.normal(params.lift_ut_m2)));
            }
        }
    });
    sources
}

/// Whether a piece from `a` to `b` would bridge the opening above a flight of stairs.
fn spans_stairs(building: &Building, a: Point2, b: Point2) -> bool {
    let Some(stairs) = &building.stairs else { return false };
    let flights =
        stairs.line.windows(2).zip(stairs.climbed.windows(2)).filter(|(_, climbed)| climbed[0] != climbed[1]);
    let lines: Vec<Segment> = flights.map(|(line, _)| Segment { a: line[0], b: line[1] }).collect();
    (0..=40).any(|k| {
        let p = a.lerp(b, f64::from(k) / 40.0);
        lines.iter().any(|line| line.distance_m(p) < STAIRS_OPENING_M)
    })
}

/// Cabinets stand in the rooms, back to the corridor's wall.
fn cabinets(building: &Building, params: &SteelParams, noise: &mut Noise, sources: &mut Vec<Source>) {
    for corridor in &building.corridors {
        let line = corridor.line.b - corridor.line.a;
        let right = Point2::new(line.y_m, -line.x_m) * (1.0 / line.norm_m().max(1e-9));
        for _ in 0..(params.cabinets_per_m * line.norm_m()) as usize {
            let side = if noise.chance(0.5) { 1.0 } else { -1.0 };
            let aside_m = 0.5 * corridor.width_m + noise.within(0.25, 0.45);
            let p = corridor.line.a.lerp(corridor.line.b, noise.unit()) + right * (side * aside_m);
            let top_m = noise.within(1.0, 2.0);
            let pole_ut_m2 = noise.normal(params.cabinet_ut_m2);
            let is_way = |c: &&crate::building::Corridor| c.line.distance_m(p) < 0.5 * c.width_m + 0.15;
            if building.corridors.iter().find(is_way).is_none() {
                sources.push(upright(p, 0.05, top_m, pole_ut_m2));
            }
        }
    }
}

/// Pairs of columns next to each other along x or along y.
fn neighbours(columns: &[Point2]) -> Vec<(Point2, Point2)> {
    let next = |a: &Point2, is_along_x: bool| {
        columns
            .iter()
            .filter(|b| {
                let d = **b - *a;
                if is_along_x {
                    d.y_m.abs() < 1e-6 && d.x_m > 1e-6
                } else {
                    d.x_m.abs() < 1e-6 && d.y_m > 1e-6
                }
            })
            .min_by(|b, c| a.distance_m(**b).total_cmp(&a.distance_m(**c)))
            .map(|b| (*a, *b))
    };
    columns.iter().flat_map(|a| [next(a, true), next(a, false)]).flatten().collect()
}

fn level(p: Point2, height_m: f64) -> [f64; 3] {
    [p.x_m, p.y_m, height_m]
}

fn bar(north_pole_m: [f64; 3], south_pole_m: [f64; 3], pole_ut_m2: f64) -> Source {
    Source::Bar { north_pole_m, south_pole_m, pole_ut_m2 }
}

/// An upright piece at `p`; a positive pole is at its top.
fn upright(p: Point2, low_m: f64, high_m: f64, pole_ut_m2: f64) -> Source {
    bar(level(p, high_m), level(p, low_m), pole_ut_m2)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::magnetic_field::MagneticField;
    use crate::vector::norm;

    const SPACING_M: f64 = 0.1;
    const PHONE_M: f64 = 1.1;

    fn office_field(seed: u64) -> (Building, MagneticField) {
        let (office, earth) = (Building::office(), EarthField::default());
        let sources = steel(&office, &earth, &SteelParams::default(), seed);
        (office, MagneticField { earth, sources })
    }

    /// The field along a corridor's middle.
    fn along(field: &MagneticField, line: &fieldwalk::geometry::Segment) -> Vec<[f64; 3]> {
        let n = (line.a.distance_m(line.b) / SPACING_M) as usize;
        (0..=n).map(|k| field.field_ut(level(line.a.lerp(line.b, k as f64 / n as f64), PHONE_M))).collect()
    }

    fn sd(values: &[f64]) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64).sqrt()
    }

    /// The share of the variance of `values` that lies below `cycles_per_m`, by a discrete Fourier transform.
    fn share_below(values: &[f64], cycles_per_m: f64) -> f64 {
        let n = values.len();
        let mean = values.iter().sum::<f64>() / n as f64;
        let (mut low, mut all) = (0.0, 0.0);
        for k in 1..=n / 2 {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, v) in values.iter().enumerate() {
                // Hann's window: the ends of a corridor do not meet.
                let window = 0.5 - 0.5 * libm::cos(TAU * i as f64 / n as f64);
                let (sin, cos) = libm::sincos(TAU * (k * i % n) as f64 / n as f64);
                re += window * (v - mean) * cos;
                im += window * (v - mean) * sin;
            }
            let energy = re * re + im * im;
            all += energy;
            if k as f64 / (n as f64 * SPACING_M) <= cycles_per_m {
                low += energy;
            }
        }
        low / all
    }

    /// Office fields vary by 5 to 15 µT along a corridor, and hardly within a step.
    ///
    /// # Source
    /// Mass-centred 2019: anomalies of 10 to 20 µT in the office, and more than 98 % of the energy below 0.765 cycles
    /// per metre.
    #[test]
    fn the_office_varies_as_offices_do() {
        for seed in 1..=3 {
            let (office, field) = office_field(seed);
            let mut strengths = Vec::new();
            let mut components = [const { Vec::new() }; 3];
            let (mut largest_ut, mut least_share) = (0.0f64, 1.0f64);
            for corridor in &office.corridors {
                let readings = along(&field, &corridor.line);
                let strength: Vec<f64> = readings.iter().map(|b| norm(*b)).collect();
                least_share = least_share.min(share_below(&strength, 0.765));
                largest_ut = strength.iter().map(|s| (s - 50.0).abs()).fold(largest_ut, f64::max);
                for (c, component) in components.iter_mut().enumerate() {
                    component.extend(readings.iter().map(|b| b[c]));
                }
                println!("seed {seed}: width {:.1} m, sd of |B| {:.1} µT", corridor.width_m, sd(&strength));
                strengths.extend(strength);
            }
            let sd_ut = sd(&strengths);
            let components_ut = components.map(|c| sd(&c));
            println!(
                "seed {seed}: |B| sd {sd_ut:.1} µT, x y z sd {components_ut:.1?} µT, largest anomaly {largest_ut:.0} µT, \
                 least share below 0.765 cycles/m {least_share:.4}"
            );
            assert!((5.0..15.0).contains(&sd_ut), "{sd_ut}");
            assert!(least_share > 0.98, "{least_share}");
            assert!((10.0..80.0).contains(&largest_ut), "{largest_ut}");
        }
    }

    #[test]
    fn steel_is_seeded() {
        assert_eq!(office_field(1).1, office_field(1).1);
        assert_ne!(office_field(1).1, office_field(2).1);
    }
}
