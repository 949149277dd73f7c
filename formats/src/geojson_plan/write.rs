//! Floor plans out, as GeoJSON in metres.

use fieldwalk::floor_plan::{FloorPlan, Polygon};
use fieldwalk::geometry::Point2;
use geojson::{
    Feature, FeatureCollection, GeoJson, Geometry, GeometryValue, JsonObject, JsonValue, Position,
};

use super::placement::{Frame, PlanMember, member_to_json};

/// Writes `plan` as a GeoJSON feature collection in metres; [`read_plan`](super::read_plan) reads it back unchanged.
///
/// Viewers that take GeoJSON's coordinates for degrees show the plan near latitude and longitude 0. A coordinate that
/// is not finite becomes `null`, which no reader takes.
pub fn write_plan(plan: &FloorPlan) -> String {
    let FloorPlan { width_m, height_m, outline, units, walls, pathways, georeference } = plan;
    let outline = outline.iter().map(|polygon| feature("outline", polygon_geometry(polygon)));
    let units = units.iter().map(|unit| {
        let mut feature = feature("unit", polygon_geometry(&unit.polygon));
        feature.set_property("name", unit.name.as_str());
        feature.set_property("walkable", unit.walkable);
        feature
    });
    let walls = walls.iter().map(|wall| feature("wall", line_geometry(&[wall.a, wall.b])));
    let pathways = pathways.iter().map(|pathway| feature("pathway", line_geometry(pathway)));
    let features = outline.chain(units).chain(walls).chain(pathways).collect();

    let member = PlanMember {
        frame: Some(Frame::Metres),
        georeference: *georeference,
        height_m: Some(*height_m),
        width_m: Some(*width_m),
    };
    let foreign_members = JsonObject::from_iter([("fieldwalk".to_owned(), member_to_json(&member))]);
    GeoJson::FeatureCollection(FeatureCollection {
        bbox: None,
        features,
        foreign_members: Some(foreign_members),
    })
    .to_string()
}

fn feature(kind: &str, geometry: GeometryValue) -> Feature {
    let properties = JsonObject::from_iter([("kind".to_owned(), JsonValue::from(kind))]);
    Feature { geometry: Some(Geometry::new(geometry)), properties: Some(properties), ..Feature::default() }
}

fn position(point: &Point2) -> Position {
    Position::from([point.x_m, point.y_m])
}

/// GeoJSON closes its rings.
fn polygon_geometry(polygon: &Polygon) -> GeometryValue {
    let close = |ring: &Vec<Point2>| {
        let closing = ring.first().filter(|first| ring.last() != Some(first));
        ring.iter().chain(closing).map(position).collect()
    };
    GeometryValue::Polygon { coordinates: polygon.rings.iter().map(close).collect() }
}

fn line_geometry(line: &[Point2]) -> GeometryValue {
    GeometryValue::LineString { coordinates: line.iter().map(position).collect() }
}
