//! What to draw of a floor's plan.

use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use fieldwalk::geometry::{self, Segment};

use crate::fix::Point2;

/// A floor's plan as lines to draw, in the floor's frame.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct FloorDrawing {
    /// The plan's extent along x, in metres.
    pub width_m: f64,
    /// The plan's extent along y, in metres.
    pub height_m: f64,
    /// The rings of the floor's outline, not explicitly closed; holes are rings too (even-odd rule).
    pub outline: Vec<Vec<Point2>>,
    /// Rooms, shops, corridors.
    pub units: Vec<DrawnUnit>,
    /// Walls drawn beside those that the units' edges imply, each a polyline.
    pub walls: Vec<Vec<Point2>>,
    /// Centre lines of the ways that people take, each a polyline.
    pub pathways: Vec<Vec<Point2>>,
}

/// A named area of a plan.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct DrawnUnit {
    /// The name on the door; may be empty.
    pub name: String,
    /// Whether one is expected to walk through it.
    pub is_walkable: bool,
    /// Its rings, not explicitly closed; holes are rings too (even-odd rule).
    pub rings: Vec<Vec<Point2>>,
}

impl From<&FloorPlan> for FloorDrawing {
    fn from(plan: &FloorPlan) -> Self {
        // Where the floor lies on the Earth is told by fixes.
        let FloorPlan { width_m, height_m, outline, units, walls, pathways, georeference: _ } = plan;
        Self {
            width_m: *width_m,
            height_m: *height_m,
            outline: outline.iter().flat_map(rings).collect(),
            units: units.iter().map(DrawnUnit::from).collect(),
            walls: walls.iter().map(|&Segment { a, b }| line(&[a, b])).collect(),
            pathways: pathways.iter().map(|way| line(way)).collect(),
        }
    }
}

impl From<&Unit> for DrawnUnit {
    fn from(unit: &Unit) -> Self {
        let Unit { name, walkable, polygon } = unit;
        Self { name: name.clone(), is_walkable: *walkable, rings: rings(polygon) }
    }
}

fn rings(polygon: &Polygon) -> Vec<Vec<Point2>> {
    polygon.rings.iter().map(|ring| line(ring)).collect()
}

fn line(points: &[geometry::Point2]) -> Vec<Point2> {
    points.iter().copied().map(Point2::from).collect()
}
