//! The floor as drawn: outline, units, walls and pathways.

use serde::{Deserialize, Serialize};

use crate::geometry::{Point2, Segment, ring_contains};

/// A polygon with holes: rings of vertices in the floor frame, even-odd rule, not explicitly closed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// The outer ring and any holes.
    pub rings: Vec<Vec<Point2>>,
}

/// A named area of the plan: a shop, an office, a corridor (IMDF's *unit*).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// The name on the door; may be empty.
    pub name: String,
    /// Whether one is expected to walk through it (a corridor) rather than past it (a shop).
    pub walkable: bool,
    /// Where it is.
    pub polygon: Polygon,
}

/// Where the floor frame lies on the Earth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Georeference {
    /// Latitude of the floor frame's origin, in degrees (WGS 84).
    pub origin_latitude_deg: f64,
    /// Longitude of the floor frame's origin, in degrees (WGS 84).
    pub origin_longitude_deg: f64,
    /// Degrees of latitude per metre along +y.
    pub latitude_deg_per_m: f64,
    /// Degrees of longitude per metre along +x.
    pub longitude_deg_per_m: f64,
}

/// A floor plan: everything drawn, nothing measured by a survey.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FloorPlan {
    /// Extent along x, in metres: the plan spans 0 to `width_m`.
    pub width_m: f64,
    /// Extent along y, in metres: the plan spans 0 to `height_m`.
    pub height_m: f64,
    /// The outer boundary of the floor; several polygons where wings are apart.
    pub outline: Vec<Polygon>,
    /// Rooms, shops, corridors.
    pub units: Vec<Unit>,
    /// Walls drawn as lines, beside those that the units' edges imply.
    pub walls: Vec<Segment>,
    /// Centre lines of the ways that people take, where the plan has them.
    pub pathways: Vec<Vec<Point2>>,
    /// Where the floor lies on the Earth, if known.
    pub georeference: Option<Georeference>,
}

impl Polygon {
    /// Whether `p` lies inside.
    pub fn contains(&self, p: Point2) -> bool {
        self.rings.iter().filter(|ring| ring_contains(ring, p)).count() % 2 == 1
    }

    /// The edges of all rings.
    pub fn edges(&self) -> impl Iterator<Item = Segment> {
        self.rings.iter().flat_map(|ring| {
            let closing = ring.last().copied().filter(|last| ring.first() != Some(last));
            closing
                .zip(ring.first().copied())
                .into_iter()
                .chain(ring.windows(2).map(|w| (w[0], w[1])))
                .map(|(a, b)| Segment { a, b })
        })
    }
}

impl Georeference {
    /// Latitude and longitude of `p`, in degrees.
    pub fn latitude_longitude_deg(&self, p: Point2) -> (f64, f64) {
        (
            self.origin_latitude_deg + p.y_m * self.latitude_deg_per_m,
            self.origin_longitude_deg + p.x_m * self.longitude_deg_per_m,
        )
    }

    /// The point at a latitude and longitude in degrees.
    pub fn point(&self, latitude_deg: f64, longitude_deg: f64) -> Point2 {
        Point2::new(
            (longitude_deg - self.origin_longitude_deg) / self.longitude_deg_per_m,
            (latitude_deg - self.origin_latitude_deg) / self.latitude_deg_per_m,
        )
    }
}

impl FloorPlan {
    /// Whether `p` lies on the floor: inside the outline, or inside the extent where there is no outline.
    pub fn contains(&self, p: Point2) -> bool {
        if self.outline.is_empty() {
            return (0.0..=self.width_m).contains(&p.x_m) && (0.0..=self.height_m).contains(&p.y_m);
        }
        self.outline.iter().any(|polygon| polygon.contains(p))
    }

    /// All walls: those drawn, the edges of units that are not walkable, and the outline.
    pub fn barriers(&self) -> impl Iterator<Item = Segment> {
        let units = self.units.iter().filter(|unit| !unit.walkable).flat_map(|unit| unit.polygon.edges());
        let outline = self.outline.iter().flat_map(Polygon::edges);
        self.walls.iter().copied().chain(units).chain(outline)
    }
}
