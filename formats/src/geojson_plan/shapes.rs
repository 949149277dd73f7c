//! Coordinates of features, as drawn: before they are placed in the floor frame.

use fieldwalk::geometry::{Point2, Segment};
use geojson::{Feature, GeometryValue, JsonValue, LineStringType, PolygonType};

/// The polygons of a feature, parts of a multi-polygon apart.
pub(super) fn polygons(feature: &Feature) -> Vec<&PolygonType> {
    match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(GeometryValue::Polygon { coordinates }) => vec![coordinates],
        Some(GeometryValue::MultiPolygon { coordinates }) => coordinates.iter().collect(),
        _ => Vec::new(),
    }
}

/// The polygons of all `features`.
pub(super) fn all_polygons<'a>(features: impl Iterator<Item = &'a Feature>) -> Vec<&'a PolygonType> {
    features.flat_map(polygons).collect()
}

/// The lines of a feature, parts of a multi-line apart.
pub(super) fn lines(feature: &Feature) -> Vec<&LineStringType> {
    match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(GeometryValue::LineString { coordinates }) => vec![coordinates],
        Some(GeometryValue::MultiLineString { coordinates }) => coordinates.iter().collect(),
        _ => Vec::new(),
    }
}

/// The property `name`: text, or IMDF's object of one text per language, of which the first counts.
pub(super) fn name(feature: &Feature) -> String {
    let name = match feature.property("name") {
        Some(JsonValue::Object(by_language)) => by_language.values().next(),
        name => name,
    };
    name.and_then(JsonValue::as_str).unwrap_or_default().to_owned()
}

/// The pieces of a polyline.
pub(super) fn segments(line: &[Point2]) -> impl Iterator<Item = Segment> {
    line.windows(2).map(|ends| Segment { a: ends[0], b: ends[1] })
}
