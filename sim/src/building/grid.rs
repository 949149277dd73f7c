//! Buildings whose corridors form a grid, from a few numbers.

use fieldwalk::floor_plan::{FloorPlan, Unit};
use fieldwalk::geometry::{Point2, Segment};

use crate::building::{Building, Corridor, Door, Rectangle, Stairs, WayGraph};

/// Distance of a door from the ends of its wall, in metres, at least.
const DOOR_MARGIN_M: f64 = 0.3;

/// A corridor of the grid: where its centre line runs, and its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aisle {
    /// The centre line's constant coordinate, in metres.
    pub centre_m: f64,
    /// From wall to wall, in metres.
    pub width_m: f64,
}

/// A building described by its grid of corridors; rooms fill what is between.
///
/// Rooms outside the grid open onto its outer corridors; the blocks inside hold two rows of rooms back to back, or an
/// open hall with a door in the middle of each long side, or a lift next to its lower corridor.
#[derive(Clone, Debug, PartialEq)]
pub struct GridBuilding {
    /// The building's name.
    pub name: String,
    /// Extent along x, in metres.
    pub width_m: f64,
    /// Extent along y, in metres.
    pub height_m: f64,
    /// Corridors along y, from left to right; at least two.
    pub columns: Vec<Aisle>,
    /// Corridors along x, from bottom to top; at least two.
    pub rows: Vec<Aisle>,
    /// The width that rooms should about have, in metres.
    pub room_width_m: f64,
    /// Width of a door, in metres.
    pub door_width_m: f64,
    /// Distance that structural columns should about have, in metres.
    pub span_m: f64,
    /// From floor to ceiling, in metres.
    pub ceiling_m: f64,
    /// Blocks (column, row) that are open halls.
    pub halls: Vec<[usize; 2]>,
    /// Blocks (column, row) whose lower left room is a lift.
    pub lifts: Vec<[usize; 2]>,
    /// The block (column, row) whose upper left room holds the stairs, if there are any.
    pub stairs: Option<[usize; 2]>,
    /// Whether rooms stand between the outer corridors and the outline.
    pub has_outer_rooms: bool,
}

impl Aisle {
    fn low_m(&self) -> f64 {
        self.centre_m - 0.5 * self.width_m
    }

    fn high_m(&self) -> f64 {
        self.centre_m + 0.5 * self.width_m
    }
}

impl GridBuilding {
    /// The building.
    pub fn build(&self) -> Building {
        let mut building = Building {
            name: self.name.clone(),
            ceiling_m: self.ceiling_m,
            plan: FloorPlan {
                width_m: self.width_m,
                height_m: self.height_m,
                outline: vec![Rectangle::new(0.0, 0.0, self.width_m, self.height_m).polygon()],
                ..FloorPlan::default()
            },
            ..Building::default()
        };
        let (Some(left), Some(right)) = (self.columns.first(), self.columns.last()) else { return building };
        let (Some(bottom), Some(top)) = (self.rows.first(), self.rows.last()) else { return building };
        let ring = Rectangle::new(left.low_m(), bottom.low_m(), right.high_m(), top.high_m());
        self.add_corridors(&mut building, &ring);
        if self.has_outer_rooms {
            self.add_outer_rooms(&mut building, &ring);
        }
        for (i, x) in self.columns.windows(2).enumerate() {
            for (j, y) in self.rows.windows(2).enumerate() {
                let block = Rectangle::new(x[0].high_m(), y[0].high_m(), x[1].low_m(), y[1].low_m());
                if self.halls.contains(&[i, j]) {
                    self.add_hall(&mut building, &block);
                    building.halls.push(block);
                } else {
                    self.add_block(&mut building, &block, [i, j]);
                }
            }
        }
        self.add_columns(&mut building);
        let stairs_at = building.stairs.as_ref().and_then(|stairs| stairs.line.first()).copied();
        building.ways = WayGraph::of_grid(&self.columns, &self.rows, &building.halls, stairs_at);
        building.plan.pathways = building.corridors.iter().map(|c| vec![c.line.a, c.line.b]).collect();
        for hall in &building.halls {
            let x_m = hall.centre().x_m;
            let across = vec![Point2::new(x_m, hall.low.y_m), Point2::new(x_m, hall.high.y_m)];
            building.plan.pathways.push(across);
        }
        building
    }

    fn add_corridors(&self, building: &mut Building, ring: &Rectangle) {
        let mut add = |name: String, line: (Point2, Point2), width_m: f64, area: Rectangle| {
            building.corridors.push(Corridor { line: Segment { a: line.0, b: line.1 }, width_m });
            building.plan.units.push(Unit { name, walkable: true, polygon: area.polygon() });
        };
        for (k, row) in self.rows.iter().enumerate() {
            let ends = (Point2::new(ring.low.x_m, row.centre_m), Point2::new(ring.high.x_m, row.centre_m));
            let area = Rectangle::new(ring.low.x_m, row.low_m(), ring.high.x_m, row.high_m());
            add(format!("corridor R{}", k + 1), ends, row.width_m, area);
        }
        for (k, column) in self.columns.iter().enumerate() {
            let x_m = column.centre_m;
            let ends = (Point2::new(x_m, ring.low.y_m), Point2::new(x_m, ring.high.y_m));
            let area = Rectangle::new(column.low_m(), ring.low.y_m, column.high_m(), ring.high.y_m);
            add(format!("corridor C{}", k + 1), ends, column.width_m, area);
        }
    }

    /// Rooms between the ring of corridors and the outline; the corner rooms belong to the top and bottom rows.
    fn add_outer_rooms(&self, building: &mut Building, ring: &Rectangle) {
        let (width_m, height_m) = (self.width_m, self.height_m);
        let across = self.divided(ring.low.x_m, ring.high.x_m);
        for (k, span) in across.windows(2).enumerate() {
            let x0_m = if k == 0 { 0.0 } else { span[0] };
            let x1_m = if k + 2 == across.len() { width_m } else { span[1] };
            let below = Rectangle::new(x0_m, 0.0, x1_m, ring.low.y_m);
            let above = Rectangle::new(x0_m, ring.high.y_m, x1_m, height_m);
            let x_m = self.door_at(span[0], span[1], k);
            self.add_room(building, below, Point2::new(x_m, ring.low.y_m), Point2::new(1.0, 0.0));
            self.add_room(building, above, Point2::new(x_m, ring.high.y_m), Point2::new(1.0, 0.0));
        }
        for (k, span) in self.divided(ring.low.y_m, ring.high.y_m).windows(2).enumerate() {
            let left = Rectangle::new(0.0, span[0], ring.low.x_m, span[1]);
            let right = Rectangle::new(ring.high.x_m, span[0], width_m, span[1]);
            let y_m = self.door_at(span[0], span[1], k);
            self.add_room(building, left, Point2::new(ring.low.x_m, y_m), Point2::new(0.0, 1.0));
            self.add_room(building, right, Point2::new(ring.high.x_m, y_m), Point2::new(0.0, 1.0));
        }
    }

    /// Two rows of rooms, back to back.
    fn add_block(&self, building: &mut Building, block: &Rectangle, place: [usize; 2]) {
        let (has_lift, has_stairs) = (self.lifts.contains(&place), self.stairs == Some(place));
        let middle_m = block.centre().y_m;
        for (k, span) in self.divided(block.low.x_m, block.high.x_m).windows(2).enumerate() {
            let x_m = self.door_at(span[0], span[1], k);
            let lower = Rectangle::new(span[0], block.low.y_m, span[1], middle_m);
            let upper = Rectangle::new(span[0], middle_m, span[1], block.high.y_m);
            let is_lift = has_lift && k == 0;
            self.add_room(building, lower, Point2::new(x_m, block.low.y_m), Point2::new(1.0, 0.0));
            if has_stairs && k == 0 {
                let corridor_m = self.rows.get(place[1] + 1).map_or(block.high.y_m, |row| row.centre_m);
                self.add_stairwell(building, &upper, corridor_m);
            } else {
                self.add_room(building, upper, Point2::new(x_m, block.high.y_m), Point2::new(1.0, 0.0));
            }
            if is_lift {
                building.lifts.push(lower);
            }
        }
    }

    fn add_room(&self, building: &mut Building, area: Rectangle, door: Point2, along: Point2) {
        let name = format!("room {}", building.doors.len() + 1);
        building.plan.units.push(Unit { name, walkable: false, polygon: area.polygon() });
        building.doors.push(Door { centre: door, along, width_m: self.door_width_m });
    }

    /// An open hall: walls with a gap for the door in the middle of the lower and of the upper side.
    fn add_hall(&self, building: &mut Building, hall: &Rectangle) {
        let name = format!("hall {}", building.doors.len() + 1);
        building.plan.units.push(Unit { name, walkable: true, polygon: hall.polygon() });
        let [a, b, c, d] = hall.corners();
        let middle_m = hall.centre().x_m;
        self.add_wall_with_door(building, a, b, middle_m);
        self.add_wall_with_door(building, d, c, middle_m);
        building.plan.walls.push(Segment { a, b: d });
        building.plan.walls.push(Segment { a: b, b: c });
    }

    /// Stairs in a room whose door opens onto the corridor above it, with its middle at `corridor_m`.
    fn add_stairwell(&self, building: &mut Building, room: &Rectangle, corridor_m: f64) {
        let name = format!("stairs {}", building.doors.len() + 1);
        building.plan.units.push(Unit { name, walkable: true, polygon: room.polygon() });
        let [a, b, c, d] = room.corners();
        let stairs = Stairs::in_room(room, corridor_m);
        self.add_wall_with_door(building, d, c, stairs.line[0].x_m);
        for (a, b) in [(a, b), (a, d), (b, c)] {
            building.plan.walls.push(Segment { a, b });
        }
        building.stairs = Some(stairs);
    }

    /// A wall along x from `from` to `to` with a gap for a door about `door_m`.
    fn add_wall_with_door(&self, building: &mut Building, from: Point2, to: Point2, door_m: f64) {
        let door = Point2::new(door_m, from.y_m);
        let half = Point2::new(0.5 * self.door_width_m, 0.0);
        building.plan.walls.push(Segment { a: from, b: door - half });
        building.plan.walls.push(Segment { a: door + half, b: to });
        let along = Point2::new(1.0, 0.0);
        building.doors.push(Door { centre: door, along, width_m: self.door_width_m });
    }

    /// Structural columns on a grid, moved into the walls where they would stand in a corridor or a hall's way.
    fn add_columns(&self, building: &mut Building) {
        let places = |extent_m: f64, aisles: &[Aisle]| -> Vec<f64> {
            let n = (extent_m / self.span_m).round().max(1.0);
            let place = |k: usize| (0.2 + (extent_m - 0.4) * k as f64 / n).min(extent_m - 0.2);
            let moved = |x_m: f64| {
                let blocked = aisles.iter().find(|a| a.low_m() - 0.2 < x_m && x_m < a.high_m() + 0.2);
                // Beside the corridor, on the side that is still in the building.
                blocked.map_or(x_m, |aisle| {
                    let beyond_m = aisle.high_m() + 0.2;
                    if beyond_m < extent_m { beyond_m } else { aisle.low_m() - 0.2 }
                })
            };
            (0..=n as usize).map(place).map(moved).collect()
        };
        let (xs, ys) = (places(self.width_m, &self.columns), places(self.height_m, &self.rows));
        building.columns = xs.iter().flat_map(|&x| ys.iter().map(move |&y| Point2::new(x, y))).collect();
    }

    /// The bounds of rooms about as wide as they should be, between `low_m` and `high_m`.
    fn divided(&self, low_m: f64, high_m: f64) -> Vec<f64> {
        let n = ((high_m - low_m) / self.room_width_m).round().max(1.0) as usize;
        (0..=n).map(|k| low_m + (high_m - low_m) * k as f64 / n as f64).collect()
    }

    /// Doors sit towards one end of their wall, in neighbouring rooms towards each other.
    fn door_at(&self, low_m: f64, high_m: f64, k: usize) -> f64 {
        let reach_m = DOOR_MARGIN_M + 0.5 * self.door_width_m;
        if k.is_multiple_of(2) { high_m - reach_m } else { low_m + reach_m }
    }
}
