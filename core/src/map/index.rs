//! A floor map made ready for lookups by thousands of particles: flat, interleaved, no allocation, no panic.

mod reads;

use crate::floor_plan::FloorPlan;
use crate::geometry::{Point2, Segment};
use crate::map::surveyed_ways::SurveyedWays;
use crate::map::{Fingerprints, FloorMap, GridFrame, Layers};

use reads::ReadGrid;

/// How finely the plan is rasterised, in metres: half a shoulder's width.
const PLAN_CELL_M: f64 = 0.25;
/// Cell of the wall index, in metres.
const WALL_CELL_M: f64 = 0.5;
/// Longest move that one wall lookup covers, in metres; longer moves are cut.
const WALL_REACH_M: f64 = 1.0;

/// What the plan says of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Ground {
    Open = 0,
    ClosedUnit = 1,
    Outside = 2,
}

/// A [`FloorMap`] with its lookups prepared.
#[derive(Clone, Debug)]
pub struct FloorIndex {
    map: FloorMap,
    /// Field x, y, z and variance per node.
    field: Vec<[f32; 4]>,
    /// Sine and cosine of the compass deviation per node; empty when the map has no such layer.
    deviation_sin_cos: Vec<[f32; 2]>,
    ways: SurveyedWays,
    /// Direction of the mean compass deviation, in radians.
    mean_deviation_rad: f32,
    reads: ReadGrid,
    grid: GridLookup,
    ground: Vec<u8>,
    ground_grid: GridLookup,
    wall_starts: Vec<u32>,
    walls: Vec<[f32; 4]>,
    wall_grid: GridLookup,
}

/// The arithmetic of a grid in `f32`.
#[derive(Clone, Copy, Debug)]
struct GridLookup {
    origin_m: [f32; 2],
    per_m: f32,
    nx: usize,
    ny: usize,
}

impl FloorIndex {
    /// Prepares `map`; layers that are missing or of a wrong size read as unknown, fingerprints that do not fit the
    /// transmitters as none.
    pub fn new(mut map: FloorMap) -> Self {
        let n = map.frame.len();
        for (name, _) in Layers::default().named() {
            if let Some(layer) = map.layers.named_mut(name).filter(|layer| layer.len() != n) {
                layer.clear();
            }
        }
        if !map.fingerprints.is_sound(map.transmitters.len()) {
            map.fingerprints = Fingerprints::default();
        }
        let layer = |values: &[f32], node: usize| values.get(node).copied().unwrap_or(f32::NAN);
        let field = (0..n)
            .map(|node| {
                [
                    layer(&map.layers.field_x_ut, node),
                    layer(&map.layers.field_y_ut, node),
                    layer(&map.layers.field_z_ut, node),
                    layer(&map.layers.field_variance_ut2, node),
                ]
            })
            .collect();
        let ground_frame = GridFrame::covering(map.plan.width_m, map.plan.height_m, PLAN_CELL_M);
        let wall_frame = GridFrame::covering(map.plan.width_m, map.plan.height_m, WALL_CELL_M);
        let (wall_starts, walls) = bucketed_walls(&map.plan, &wall_frame);
        Self {
            field,
            mean_deviation_rad: mean_direction_rad(&map.layers.compass_deviation_rad),
            deviation_sin_cos: sines_and_cosines(&map.layers.compass_deviation_rad),
            ways: SurveyedWays::of(&map),
            reads: ReadGrid::new(&map.layers, n),
            grid: GridLookup::new(&map.frame),
            ground: rasterised(&map.plan, &ground_frame),
            ground_grid: GridLookup::new(&ground_frame),
            wall_starts,
            walls,
            wall_grid: GridLookup::new(&wall_frame),
            map,
        }
    }

    /// The map as surveyed.
    pub fn map(&self) -> &FloorMap {
        &self.map
    }

    /// Field (x, y, z, in µT) and predictive variance (µT²) at a place, bilinear; nothing where never surveyed.
    #[inline]
    pub fn field(&self, x_m: f32, y_m: f32) -> Option<[f32; 4]> {
        let (node, fx, fy) = self.grid.bilinear(x_m, y_m)?;
        let nx = self.grid.nx;
        let corners = [
            self.field.get(node)?,
            self.field.get(node + 1)?,
            self.field.get(node + nx)?,
            self.field.get(node + nx + 1)?,
        ];
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        let mut value = [0.0f32; 4];
        for (corner, weight) in corners.into_iter().zip(weights) {
            for c in 0..4 {
                value[c] += weight * corner[c];
            }
        }
        (!value[0].is_nan() && !value[3].is_nan()).then_some(value)
    }

    /// Strength, horizontal and vertical part of the field at a place (in µT), bilinear; where the map knows one of them
    /// not, the floor's mean of it. The horizontal part is derived: see `core/src/map/index/reads.rs`.
    #[inline]
    pub fn read_or_mean(&self, x_m: f32, y_m: f32) -> [f32; 3] {
        self.reads.at(&self.grid, x_m, y_m)
    }

    /// Walking direction minus compass azimuth, in radians, as a mean over the floor: how the compass stands to the plan
    /// where nothing more is known of the place.
    pub fn mean_deviation_rad(&self) -> f32 {
        self.mean_deviation_rad
    }

    /// Bilinear value of one of the map's layers at a place; nothing where unknown.
    #[inline]
    pub fn layer(&self, values: &[f32], x_m: f32, y_m: f32) -> Option<f32> {
        let (node, fx, fy) = self.grid.bilinear(x_m, y_m)?;
        let nx = self.grid.nx;
        let [a, b] = values.get(node..)?.first_chunk::<2>()?;
        let [c, d] = values.get(node + nx..)?.first_chunk::<2>()?;
        let (low, high) = (a * (1.0 - fx) + b * fx, c * (1.0 - fx) + d * fx);
        let value = low * (1.0 - fy) + high * fy;
        (!value.is_nan()).then_some(value)
    }

    /// Value of one of the map's layers at the nearest node; nothing where unknown.
    #[inline]
    pub fn nearest(&self, values: &[f32], x_m: f32, y_m: f32) -> Option<f32> {
        let value = *values.get(self.grid.nearest(x_m, y_m)?)?;
        (!value.is_nan()).then_some(value)
    }

    /// Whether the nearest surveyed line is within `reach_m`, in metres; everywhere on a map that does not know its lines.
    #[inline]
    pub fn is_surveyed(&self, x_m: f32, y_m: f32, reach_m: f32) -> bool {
        let distances_m = &self.map().layers.route_distance_m;
        distances_m.is_empty() || self.nearest(distances_m, x_m, y_m).is_some_and(|m| m <= reach_m)
    }

    /// Sine and cosine of the compass deviation at the nearest node; nothing where unknown.
    #[inline]
    pub fn deviation_sin_cos(&self, x_m: f32, y_m: f32) -> Option<[f32; 2]> {
        let [sin, cos] = *self.deviation_sin_cos.get(self.grid.nearest(x_m, y_m)?)?;
        (!sin.is_nan()).then_some([sin, cos])
    }

    /// How far a direction, clockwise from +y, lies across the surveyed lines at the nearest node: 0 along them, off
    /// them, or where they run in several directions, to 1 right across lines that all run one way.
    #[inline]
    pub fn across_ways(&self, x_m: f32, y_m: f32, sin: f32, cos: f32) -> f32 {
        self.grid.nearest(x_m, y_m).map_or(0.0, |node| self.ways.across(node, sin, cos))
    }

    /// The distance within which 95 of a hundred surveyed lines have a line of another walk, in metres, at least half a
    /// metre; infinite for fewer than two walks. In corridors it is small, in halls large.
    pub fn way_band_m(&self) -> f32 {
        self.ways.band_m()
    }

    /// Whether one may stand there by the plan: on the floor and outside every closed unit.
    #[inline]
    pub fn is_open(&self, x_m: f32, y_m: f32) -> bool {
        self.ground_grid.nearest(x_m, y_m).is_some_and(|node| self.ground[node] == Ground::Open as u8)
    }

    /// Whether the straight way between two places crosses a wall, a closed unit's edge or the outline.
    pub fn is_blocked(&self, from_m: [f32; 2], to_m: [f32; 2]) -> bool {
        let (dx, dy) = (to_m[0] - from_m[0], to_m[1] - from_m[1]);
        let reach = WALL_REACH_M as f32;
        if dx.abs() <= reach && dy.abs() <= reach {
            return self.is_short_move_blocked(from_m, to_m);
        }
        let n = ((dx.abs().max(dy.abs()) / reach).ceil()).min(1_000.0);
        let at = |k: f32| [from_m[0] + dx * (k / n), from_m[1] + dy * (k / n)];
        (0..n as u32).any(|k| self.is_short_move_blocked(at(k as f32), at(k as f32 + 1.0)))
    }

    #[inline]
    fn is_short_move_blocked(&self, from_m: [f32; 2], to_m: [f32; 2]) -> bool {
        let (x_m, y_m) = (0.5 * (from_m[0] + to_m[0]), 0.5 * (from_m[1] + to_m[1]));
        let Some(cell) = self.wall_grid.nearest(x_m, y_m) else { return false };
        let (start, end) = (self.wall_starts[cell] as usize, self.wall_starts[cell + 1] as usize);
        self.walls[start..end].iter().any(|wall| crosses(from_m, to_m, wall))
    }
}

#[inline]
fn crosses(p: [f32; 2], q: [f32; 2], wall: &[f32; 4]) -> bool {
    let [rx, ry, sx, sy] = *wall;
    let side =
        |ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32| (bx - ax) * (y - ay) - (by - ay) * (x - ax);
    let (d1, d2) = (side(p[0], p[1], q[0], q[1], rx, ry), side(p[0], p[1], q[0], q[1], sx, sy));
    let (d3, d4) = (side(rx, ry, sx, sy, p[0], p[1]), side(rx, ry, sx, sy, q[0], q[1]));
    d1 * d2 < 0.0 && d3 * d4 <= 0.0
}

impl GridLookup {
    fn new(frame: &GridFrame) -> Self {
        Self {
            origin_m: [frame.origin.x_m as f32, frame.origin.y_m as f32],
            per_m: (1.0 / frame.cell_m) as f32,
            nx: frame.nx,
            ny: frame.ny,
        }
    }

    /// Lower left node and the fractions along x and y; nothing outside the grid.
    #[inline]
    fn bilinear(&self, x_m: f32, y_m: f32) -> Option<(usize, f32, f32)> {
        let u = (x_m - self.origin_m[0]) * self.per_m;
        let v = (y_m - self.origin_m[1]) * self.per_m;
        if !(u >= 0.0 && v >= 0.0) {
            return None;
        }
        let (i, j) = (u as usize, v as usize);
        (i < self.nx.saturating_sub(1) && j < self.ny.saturating_sub(1))
            .then(|| (j * self.nx + i, u - i as f32, v - j as f32))
    }

    #[inline]
    fn nearest(&self, x_m: f32, y_m: f32) -> Option<usize> {
        let u = (x_m - self.origin_m[0]) * self.per_m + 0.5;
        let v = (y_m - self.origin_m[1]) * self.per_m + 0.5;
        if !(u >= 0.0 && v >= 0.0) {
            return None;
        }
        let (i, j) = (u as usize, v as usize);
        (i < self.nx && j < self.ny).then(|| j * self.nx + i)
    }
}

/// The sine and cosine of each angle; equal angles often follow each other, and are worked out once.
fn sines_and_cosines(angles_rad: &[f32]) -> Vec<[f32; 2]> {
    let (mut last_rad, mut last) = (0.0f32, [0.0, 1.0]);
    let of_angle = |&angle_rad: &f32| {
        if angle_rad.to_bits() != last_rad.to_bits() {
            let (sin, cos) = libm::sincosf(angle_rad);
            (last_rad, last) = (angle_rad, [sin, cos]);
        }
        last
    };
    angles_rad.iter().map(of_angle).collect()
}

/// The direction of the mean of unit vectors along `angles_rad`; 0 of none.
fn mean_direction_rad(angles_rad: &[f32]) -> f32 {
    let known = angles_rad.iter().filter(|angle_rad| !angle_rad.is_nan());
    let (mut sin, mut cos) = (0.0f64, 0.0f64);
    for [s, c] in sines_and_cosines(&known.copied().collect::<Vec<_>>()) {
        sin += f64::from(s);
        cos += f64::from(c);
    }
    libm::atan2(sin, cos) as f32
}

/// The plan's ground per node, by scan lines.
fn rasterised(plan: &FloorPlan, frame: &GridFrame) -> Vec<u8> {
    let outside = if plan.outline.is_empty() { Ground::Open } else { Ground::Outside };
    let mut ground = vec![outside as u8; frame.len()];
    let mut crossings = Vec::new();
    let mut fill = |edges: &[Segment], value: Ground| {
        for j in 0..frame.ny {
            let y_m = frame.node(0, j).y_m;
            crossings.clear();
            crossings.extend(
                edges
                    .iter()
                    .filter(|e| (e.a.y_m > y_m) != (e.b.y_m > y_m))
                    .map(|e| e.a.x_m + (e.b.x_m - e.a.x_m) * (y_m - e.a.y_m) / (e.b.y_m - e.a.y_m)),
            );
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let from = ((pair[0] - frame.origin.x_m) / frame.cell_m).ceil().max(0.0) as usize;
                let to = ((pair[1] - frame.origin.x_m) / frame.cell_m).floor();
                if to >= 0.0 {
                    for i in from..=(to as usize).min(frame.nx - 1) {
                        ground[j * frame.nx + i] = value as u8;
                    }
                }
            }
        }
    };
    for polygon in &plan.outline {
        fill(&polygon.edges().collect::<Vec<_>>(), Ground::Open);
    }
    for unit in plan.units.iter().filter(|unit| !unit.walkable) {
        fill(&unit.polygon.edges().collect::<Vec<_>>(), Ground::ClosedUnit);
    }
    ground
}

/// Per cell, the walls that a short move centred in it may meet.
fn bucketed_walls(plan: &FloorPlan, frame: &GridFrame) -> (Vec<u32>, Vec<[f32; 4]>) {
    let margin_m = 0.5 * WALL_CELL_M + 0.5 * WALL_REACH_M;
    let mut buckets = vec![Vec::new(); frame.len()];
    for wall in plan.barriers().filter(|wall| wall.a.is_finite() && wall.b.is_finite()) {
        let index = |m: f64, origin_m: f64, n: usize| {
            (((m - origin_m) / frame.cell_m).max(0.0) as usize).min(n.saturating_sub(1))
        };
        let (x0, x1) = (wall.a.x_m.min(wall.b.x_m) - margin_m, wall.a.x_m.max(wall.b.x_m) + margin_m);
        let (y0, y1) = (wall.a.y_m.min(wall.b.y_m) - margin_m, wall.a.y_m.max(wall.b.y_m) + margin_m);
        for j in index(y0, frame.origin.y_m, frame.ny)..=index(y1 + frame.cell_m, frame.origin.y_m, frame.ny)
        {
            for i in
                index(x0, frame.origin.x_m, frame.nx)..=index(x1 + frame.cell_m, frame.origin.x_m, frame.nx)
            {
                if touches_square(&wall, frame.node(i, j), margin_m) {
                    buckets[j * frame.nx + i].push(wall);
                }
            }
        }
    }
    let mut starts = vec![0];
    let mut walls = Vec::new();
    for bucket in buckets {
        let flat = |p: Point2| [p.x_m as f32, p.y_m as f32];
        walls.extend(bucket.iter().map(|w| [flat(w.a)[0], flat(w.a)[1], flat(w.b)[0], flat(w.b)[1]]));
        starts.push(walls.len() as u32);
    }
    (starts, walls)
}

/// Whether `wall` may touch the square of half side `half_m` about `centre`: exact but for rounding, never missing.
fn touches_square(wall: &Segment, centre: Point2, half_m: f64) -> bool {
    let (a, b) = (wall.a - centre, wall.b - centre);
    let apart = |p: f64, q: f64| p.min(q) > half_m || p.max(q) < -half_m;
    let d = b - a;
    let corners = [(half_m, half_m), (half_m, -half_m), (-half_m, half_m), (-half_m, -half_m)];
    let sides = corners.map(|(x, y)| d.x_m * (y - a.y_m) - d.y_m * (x - a.x_m));
    let is_beside = sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0);
    !apart(a.x_m, b.x_m) && !apart(a.y_m, b.y_m) && !is_beside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor_plan::{Polygon, Unit};

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Polygon {
        Polygon {
            rings: vec![[(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point2::new(x, y)).to_vec()],
        }
    }

    fn floor() -> FloorIndex {
        let plan = FloorPlan {
            width_m: 10.0,
            height_m: 8.0,
            outline: vec![rectangle(0.0, 0.0, 10.0, 8.0)],
            units: vec![Unit {
                name: "shop".into(),
                walkable: false,
                polygon: rectangle(4.0, 4.0, 6.0, 6.0),
            }],
            ..FloorPlan::default()
        };
        let frame = GridFrame::covering(10.0, 8.0, 1.0);
        let ramp = |scale: f32| (0..frame.len()).map(|n| scale * (n % frame.nx) as f32).collect::<Vec<_>>();
        let layers = crate::map::Layers {
            field_x_ut: ramp(1.0),
            field_y_ut: ramp(2.0),
            field_z_ut: ramp(-1.0),
            field_variance_ut2: vec![4.0; frame.len()],
            ..Default::default()
        };
        FloorIndex::new(FloorMap { plan, frame, layers, ..FloorMap::default() })
    }

    #[test]
    fn the_field_is_bilinear_and_ends_at_the_edge() {
        let floor = floor();
        assert_eq!(floor.field(2.5, 3.25), Some([2.5, 5.0, -2.5, 4.0]));
        assert_eq!(floor.field(-0.1, 3.0), None);
        assert_eq!(floor.field(f32::NAN, 3.0), None);
        assert_eq!(floor.layer(&floor.map().layers.field_y_ut, 1.5, 1.0), Some(3.0));
        assert_eq!(floor.nearest(&floor.map().layers.strength_ut, 1.0, 1.0), None);
        assert_eq!(floor.deviation_sin_cos(1.0, 1.0), None);
    }

    #[test]
    fn the_mean_deviation_goes_round_the_circle() {
        let mut map = floor().map().clone();
        map.layers.compass_deviation_rad = vec![f32::NAN; map.frame.len()];
        map.layers.compass_deviation_rad[..2].copy_from_slice(&[3.1, -3.1]);
        let mean_rad = FloorIndex::new(map).mean_deviation_rad();
        assert!((mean_rad.abs() - core::f32::consts::PI).abs() < 1e-5, "{mean_rad}");
        assert_eq!(floor().mean_deviation_rad(), 0.0);
    }

    #[test]
    fn a_deviation_turns_by_its_sine_and_cosine() {
        let mut map = floor().map().clone();
        let nx = map.frame.nx;
        let angle_rad = |n: usize| if n < nx { 0.0 } else { 0.1 * (n / 3) as f32 };
        map.layers.compass_deviation_rad = (0..map.frame.len()).map(angle_rad).collect();
        map.layers.compass_deviation_rad[2 * nx] = f32::NAN;
        let floor = FloorIndex::new(map);
        let expected = |n: usize| Some([libm::sinf(angle_rad(n)), libm::cosf(angle_rad(n))]);
        assert_eq!(floor.deviation_sin_cos(3.2, 0.4), expected(3));
        assert_eq!(floor.deviation_sin_cos(4.9, 0.6), expected(nx + 5));
        assert_eq!(floor.deviation_sin_cos(0.0, 2.0), None);
        assert_eq!(floor.deviation_sin_cos(1.0, 2.0), expected(2 * nx + 1));
        assert_eq!(floor.deviation_sin_cos(1.0, -3.0), None);
    }

    #[test]
    fn the_plan_blocks_and_opens() {
        let floor = floor();
        assert!(floor.is_open(1.0, 1.0) && !floor.is_open(5.0, 5.0) && !floor.is_open(11.0, 5.0));
        assert!(floor.is_blocked([3.6, 5.0], [4.2, 5.0]));
        assert!(!floor.is_blocked([3.0, 5.0], [3.6, 5.0]));
        assert!(floor.is_blocked([1.0, 5.0], [9.0, 5.0]));
        assert!(!floor.is_blocked([1.0, 1.0], [9.0, 1.0]));
    }

    #[test]
    fn every_crossing_is_found_whatever_the_direction() {
        let floor = floor();
        let walls: Vec<_> = floor.map().plan.barriers().collect();
        let (mut blocked, mut n) = (0, 0);
        for k in 0..4_000u32 {
            let [a, b, c, _] = crate::random::draw(3, 0, k, crate::random::Purpose::Start);
            let from = [1.0 + 8.0 * crate::random::uniform(a), 1.0 + 6.0 * crate::random::uniform(b)];
            let turn = core::f32::consts::TAU * crate::random::uniform(c);
            let to = [from[0] + 0.9 * libm::cosf(turn), from[1] + 0.9 * libm::sinf(turn)];
            let point = |p: [f32; 2]| Point2::new(f64::from(p[0]), f64::from(p[1]));
            let truth = walls.iter().any(|w| w.crosses(&Segment { a: point(from), b: point(to) }));
            n += u32::from(truth != floor.is_blocked(from, to));
            blocked += u32::from(truth);
        }
        assert_eq!(n, 0);
        assert!(blocked > 200);
    }
}
