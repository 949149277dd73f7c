//! Named buildings: a floor plan, and what the plan does not draw (doors, columns, ceiling).

mod grid;
mod named;
mod open;
mod routes;
mod stairs;

pub use grid::{Aisle, GridBuilding};
pub use open::OpenBuilding;
pub(crate) use open::lanes;
pub use routes::{Way, WayGraph, keeping_right};
pub(crate) use stairs::GOING_M;
pub use stairs::Stairs;

use fieldwalk::floor_plan::{FloorPlan, Polygon};
use fieldwalk::geometry::{Point2, Segment};

/// One storey of a building.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Building {
    /// The building's name.
    pub name: String,
    /// The floor as drawn.
    pub plan: FloorPlan,
    /// The corridors' centre lines and widths.
    pub corridors: Vec<Corridor>,
    /// The doors of all rooms.
    pub doors: Vec<Door>,
    /// Where structural columns stand.
    pub columns: Vec<Point2>,
    /// Open halls that are crossed through their doors.
    pub halls: Vec<Rectangle>,
    /// Rooms and squares that are walked in all directions.
    pub squares: Vec<Rectangle>,
    /// Lift shafts.
    pub lifts: Vec<Rectangle>,
    /// The stairs to the storey above, if there are any.
    pub stairs: Option<Stairs>,
    /// From floor to ceiling, in metres.
    pub ceiling_m: f64,
    /// The ways that people take.
    pub ways: WayGraph,
}

/// A straight corridor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corridor {
    /// The centre line.
    pub line: Segment,
    /// From wall to wall, in metres.
    pub width_m: f64,
}

/// A door in a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Door {
    /// The middle of the opening.
    pub centre: Point2,
    /// The wall's direction, of unit length.
    pub along: Point2,
    /// The opening's width, in metres.
    pub width_m: f64,
}

/// A rectangle along the floor's axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rectangle {
    /// The corner of least x and y.
    pub low: Point2,
    /// The corner of greatest x and y.
    pub high: Point2,
}

impl Rectangle {
    /// The rectangle from (`x0_m`, `y0_m`) to (`x1_m`, `y1_m`).
    pub const fn new(x0_m: f64, y0_m: f64, x1_m: f64, y1_m: f64) -> Self {
        Self { low: Point2::new(x0_m, y0_m), high: Point2::new(x1_m, y1_m) }
    }

    /// Whether `p` lies inside or on the edge.
    pub fn contains(&self, p: Point2) -> bool {
        (self.low.x_m..=self.high.x_m).contains(&p.x_m) && (self.low.y_m..=self.high.y_m).contains(&p.y_m)
    }

    /// The middle.
    pub fn centre(&self) -> Point2 {
        self.low.lerp(self.high, 0.5)
    }

    /// The corners, anticlockwise.
    pub fn corners(&self) -> [Point2; 4] {
        let (low, high) = (self.low, self.high);
        [low, Point2::new(high.x_m, low.y_m), high, Point2::new(low.x_m, high.y_m)]
    }

    /// The rectangle as a polygon.
    pub fn polygon(&self) -> Polygon {
        Polygon { rings: vec![self.corners().to_vec()] }
    }
}

impl Building {
    /// The direction from `door`, across its wall, into the room that it closes: away from the corridor.
    pub fn inward(&self, door: &Door) -> Point2 {
        let across = Point2::new(-door.along.y_m, door.along.x_m);
        let is_corridor = |p: Point2| self.corridors.iter().any(|c| c.line.distance_m(p) < 0.5 * c.width_m);
        if is_corridor(door.centre + across * 0.2) { across * -1.0 } else { across }
    }

    /// Whether a straight move from `from` to `to` crosses neither a wall nor the outline.
    pub fn is_clear(&self, from: Point2, to: Point2) -> bool {
        let step = Segment { a: from, b: to };
        !self.plan.barriers().any(|barrier| barrier.crosses(&step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_office_has_rooms_corridors_and_doors() {
        let office = Building::office();
        let plan = &office.plan;
        assert_eq!((plan.width_m, plan.height_m), (60.0, 40.0));
        let n_rooms = plan.units.iter().filter(|unit| !unit.walkable).count();
        assert!((70..140).contains(&n_rooms), "{n_rooms} rooms");
        assert!(office.doors.len() >= n_rooms);
        let widths: Vec<f64> = office.corridors.iter().map(|c| c.width_m).collect();
        assert_eq!(widths, [1.6, 0.9, 0.7, 1.6, 1.6, 1.2, 1.6]);
        for corridor in &office.corridors {
            let middle = corridor.line.a.lerp(corridor.line.b, 0.37);
            assert!(plan.units.iter().filter(|u| !u.walkable).all(|u| !u.polygon.contains(middle)));
        }
    }

    #[test]
    fn every_room_has_a_door_to_a_corridor() {
        let office = Building::office();
        for door in &office.doors {
            let aside = Point2::new(door.along.y_m, door.along.x_m) * 0.2;
            let is_corridor =
                |p: Point2| office.plan.units.iter().any(|u| u.walkable && u.polygon.contains(p));
            assert!(is_corridor(door.centre + aside) || is_corridor(door.centre - aside), "{door:?}");
        }
    }

    #[test]
    fn no_column_stands_in_a_corridor() {
        let office = Building::office();
        assert!(office.columns.len() > 40);
        for column in &office.columns {
            let apart_m = |c: &Corridor| c.line.distance_m(*column) - 0.5 * c.width_m;
            assert!(office.corridors.iter().all(|c| apart_m(c) > 0.1), "{column:?}");
        }
    }
}
