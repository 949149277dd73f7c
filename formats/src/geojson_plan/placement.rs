//! From a plan's coordinates to the floor frame.

use fieldwalk::floor_plan::{FloorPlan, Georeference, Polygon};
use fieldwalk::geometry::Point2;
use geojson::{Feature, FeatureCollection, JsonValue, LineStringType, PolygonType, Position};
use serde::{Deserialize, Serialize};

use crate::error::FormatError;

/// What the member `fieldwalk` of a plan says about its coordinates.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct PlanMember {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) frame: Option<Frame>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) georeference: Option<Georeference>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) height_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) width_m: Option<f64>,
}

/// The frame of a plan's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Frame {
    /// Metres in the floor frame.
    Metres,
    /// Longitude and latitude in degrees, WGS 84.
    Wgs84,
}

/// How a plan's coordinates become points of the floor frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// The corner of the drawing that becomes the origin, and the drawing's extent, in the drawing's own units.
    origin: [f64; 2],
    extent: [f64; 2],
    /// The floor's extent in metres.
    extent_m: [f64; 2],
    frame: Frame,
    georeference: Option<Georeference>,
}

/// No building is larger; beyond this the units are wrong.
const MAX_EXTENT_M: f64 = 100_000.0;
/// A drawing in metres may stand out of the floor's extent by this much, as rounding and thick walls do.
const MAX_OVERHANG_M: f64 = 0.5;

impl PlanMember {
    /// The collection's member `fieldwalk`, or else that property of an outline, or else nothing.
    pub(super) fn of(collection: &FeatureCollection, outline: &[&Feature]) -> Result<Self, FormatError> {
        let of_collection = collection.foreign_members.as_ref().and_then(|members| members.get("fieldwalk"));
        let of_outline = || outline.iter().find_map(|feature| feature.property("fieldwalk"));
        let Some(member) = of_collection.or_else(of_outline) else { return Ok(Self::default()) };
        Self::deserialize(member).map_err(|error| {
            FormatError::malformed(
                format!("member `fieldwalk`: {error}"),
                "give frame `metres` or `wgs84`, and width_m and height_m as numbers",
            )
        })
    }

    /// Width and height if both are given, checked.
    pub(super) fn extent_m(&self) -> Result<Option<[f64; 2]>, FormatError> {
        let (Some(width_m), Some(height_m)) = (self.width_m, self.height_m) else { return Ok(None) };
        let is_sound = |extent_m: f64| extent_m > 0.0 && extent_m <= MAX_EXTENT_M;
        if is_sound(width_m) && is_sound(height_m) {
            return Ok(Some([width_m, height_m]));
        }
        Err(FormatError::malformed(
            format!("extent of {width_m} m x {height_m} m"),
            "give the floor's width and height in metres",
        ))
    }
}

impl Placement {
    /// The placement that `member` asks for, of a plan bounded by `outline`.
    pub(super) fn new(member: &PlanMember, outline: &[&PolygonType]) -> Result<Self, FormatError> {
        let (low, high) = bounds(outline)?;
        if member.frame == Some(Frame::Metres) {
            let extent_m = member.extent_m()?.unwrap_or(high);
            check_frame(low, high, extent_m)?;
            if !extent_m.iter().all(|extent| (f64::MIN_POSITIVE..=MAX_EXTENT_M).contains(extent)) {
                return Err(no_extent());
            }
            let georeference = member.georeference;
            return Ok(Self {
                origin: [0.0; 2],
                extent: extent_m,
                extent_m,
                frame: Frame::Metres,
                georeference,
            });
        }

        let extent = [high[0] - low[0], high[1] - low[1]];
        if extent[0] <= 0.0 || extent[1] <= 0.0 {
            return Err(no_extent());
        }
        let extent_m = match member.extent_m()? {
            Some(extent_m) => extent_m,
            None => {
                let [east_m, north_m] = metres_per_degree(low[1] + 0.5 * extent[1]);
                [extent[0] * east_m, extent[1] * north_m]
            }
        };
        let georeference = Georeference {
            origin_latitude_deg: low[1],
            origin_longitude_deg: low[0],
            latitude_deg_per_m: extent[1] / extent_m[1],
            longitude_deg_per_m: extent[0] / extent_m[0],
        };
        let placement =
            Self { origin: low, extent, extent_m, frame: Frame::Wgs84, georeference: Some(georeference) };
        placement.point(&Position::from(low))?;
        placement.point(&Position::from(high))?;
        if extent_m.iter().any(|&extent| extent > MAX_EXTENT_M) {
            return Err(no_extent());
        }
        Ok(placement)
    }

    /// A plan with extent and georeference, and nothing drawn.
    pub(super) fn empty_plan(&self) -> FloorPlan {
        let [width_m, height_m] = self.extent_m;
        FloorPlan { width_m, height_m, georeference: self.georeference, ..FloorPlan::default() }
    }

    /// The outline in the floor frame; an error when none of its rings has three corners.
    pub(super) fn outline(&self, polygons: &[&PolygonType]) -> Result<Vec<Polygon>, FormatError> {
        let outline = self.polygons(polygons)?;
        if outline.is_empty() { Err(no_outline()) } else { Ok(outline) }
    }

    /// Polygons in the floor frame, rings opened; rings without area are left out.
    pub(super) fn polygons(&self, polygons: &[&PolygonType]) -> Result<Vec<Polygon>, FormatError> {
        let mut placed = Vec::with_capacity(polygons.len());
        for rings in polygons {
            let mut polygon = Polygon::default();
            for ring in *rings {
                let mut points = self.line(ring)?;
                if points.len() > 1 && points.first() == points.last() {
                    points.pop();
                }
                if points.len() >= 3 {
                    polygon.rings.push(points);
                }
            }
            if !polygon.rings.is_empty() {
                placed.push(polygon);
            }
        }
        Ok(placed)
    }

    /// Polylines in the floor frame.
    pub(super) fn lines(&self, lines: &[&LineStringType]) -> Result<Vec<Vec<Point2>>, FormatError> {
        lines.iter().map(|line| self.line(line)).collect()
    }

    fn line(&self, line: &[Position]) -> Result<Vec<Point2>, FormatError> {
        line.iter().map(|position| self.point(position)).collect()
    }

    fn point(&self, position: &Position) -> Result<Point2, FormatError> {
        let [x, y] = coordinates(position)?;
        let (limit, remedy) = match self.frame {
            Frame::Metres => ([MAX_EXTENT_M; 2], "give metres in the floor frame"),
            Frame::Wgs84 => (
                [360.0, 90.0],
                "give longitude before latitude in degrees, or declare `\"fieldwalk\": {\"frame\": \"metres\"}`",
            ),
        };
        if x.abs() > limit[0] || y.abs() > limit[1] {
            return Err(FormatError::malformed(format!("coordinate [{x}, {y}] is out of range"), remedy));
        }
        if self.frame == Frame::Metres {
            return Ok(Point2::new(x, y));
        }
        let metres = |v: f64, axis: usize| (v - self.origin[axis]) / self.extent[axis] * self.extent_m[axis];
        Ok(Point2::new(metres(x, 0), metres(y, 1)))
    }
}

/// Lowest and highest coordinate of the outline along each axis.
fn bounds(outline: &[&PolygonType]) -> Result<([f64; 2], [f64; 2]), FormatError> {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for position in outline.iter().copied().flatten().flatten() {
        for (axis, &v) in coordinates(position)?.iter().enumerate() {
            low[axis] = low[axis].min(v);
            high[axis] = high[axis].max(v);
        }
    }
    if low[0] > high[0] {
        return Err(no_outline());
    }
    Ok((low, high))
}

/// Refuses an outline in metres, from `low` to `high`, that stands out of the floor, which reaches from the origin to
/// `extent_m`: nothing out there is ever mapped, and the map of the rest would look whole.
fn check_frame(low: [f64; 2], high: [f64; 2], extent_m: [f64; 2]) -> Result<(), FormatError> {
    if low.iter().any(|&low| low < -MAX_OVERHANG_M) {
        return Err(FormatError::malformed(
            format!("the outline begins at {:.1}, {:.1}, outside the floor frame", low[0], low[1]),
            "in metres 0, 0 is the lowest corner: move the drawing and its waypoints there",
        ));
    }
    if (0..2).any(|axis| high[axis] > extent_m[axis] + MAX_OVERHANG_M) {
        let [width_m, height_m] = extent_m;
        return Err(FormatError::malformed(
            format!(
                "the outline reaches to {:.1}, {:.1}, over the stated {width_m} m x {height_m} m",
                high[0], high[1]
            ),
            "leave width_m and height_m out, or give those of the whole outline",
        ));
    }
    Ok(())
}

fn coordinates(position: &Position) -> Result<[f64; 2], FormatError> {
    match position.as_slice() {
        [x, y, ..] if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err(FormatError::malformed("a position without two finite coordinates", "give [x, y] pairs")),
    }
}

fn no_extent() -> FormatError {
    FormatError::malformed(
        "the outline has no sensible extent",
        "give a polygon in degrees, or in metres with `\"fieldwalk\": {\"frame\": \"metres\"}`",
    )
}

/// Metres per degree of longitude and of latitude on the WGS 84 ellipsoid at `latitude_deg`.
fn metres_per_degree(latitude_deg: f64) -> [f64; 2] {
    const SEMI_MAJOR_M: f64 = 6_378_137.0;
    const ECCENTRICITY2: f64 = 6.694_379_990_141_316e-3;
    let (sin, cos) = libm::sincos(latitude_deg.to_radians());
    let w2 = 1.0 - ECCENTRICITY2 * sin * sin;
    let prime_vertical_m = SEMI_MAJOR_M / w2.sqrt();
    let meridian_m = prime_vertical_m * (1.0 - ECCENTRICITY2) / w2;
    [(prime_vertical_m * cos).to_radians(), meridian_m.to_radians()]
}

/// A frame in metres east and north of a latitude and longitude in degrees, which is not at a pole.
pub(crate) fn georeference_at([latitude_deg, longitude_deg]: [f64; 2]) -> Georeference {
    let [east_m, north_m] = metres_per_degree(latitude_deg);
    Georeference {
        origin_latitude_deg: latitude_deg,
        origin_longitude_deg: longitude_deg,
        latitude_deg_per_m: 1.0 / north_m,
        longitude_deg_per_m: 1.0 / east_m,
    }
}

/// The member as JSON.
pub(super) fn member_to_json(member: &PlanMember) -> JsonValue {
    serde_json::to_value(member).unwrap_or(JsonValue::Null)
}

fn no_outline() -> FormatError {
    FormatError::malformed(
        "the plan has no outline",
        "draw the floor's outer boundary as a polygon with the property `\"kind\": \"outline\"`",
    )
}
