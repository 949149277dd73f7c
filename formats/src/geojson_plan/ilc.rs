//! The plans of the indoor-location-competition-20 collection.

use fieldwalk::floor_plan::FloorPlan;
use geojson::{Feature, JsonValue};
use serde::Deserialize;

use super::placement::{Placement, PlanMember};
use super::{add_units, parse_collection, shapes};
use crate::error::FormatError;

#[derive(Deserialize)]
struct FloorInfo {
    map_info: MapInfo,
}

#[derive(Deserialize)]
struct MapInfo {
    width: f64,
    height: f64,
}

/// Reads a plan of the collection: `floor_info.json` for the extent, `geojson_map.json` for the outline and shops.
///
/// The outline is the feature of type `floor`, or else the first; its bounding box in longitude and latitude spans
/// the extent in metres, north up. All other polygons are units, none walkable: the collection does not say.
///
/// # Errors
/// When one of the files is not of the collection's form, or there is no outline. The error's path is the name of the
/// file that is wrong.
pub fn read_ilc_plan(floor_info_json: &[u8], geojson_json: &[u8]) -> Result<FloorPlan, FormatError> {
    let member = read_extent(floor_info_json).map_err(|error| error.at_path("floor_info.json"))?;
    draw(&member, geojson_json).map_err(|error| error.at_path("geojson_map.json"))
}

fn read_extent(floor_info_json: &[u8]) -> Result<PlanMember, FormatError> {
    let info: FloorInfo = serde_json::from_slice(floor_info_json).map_err(|error| {
        FormatError::malformed(
            error.to_string(),
            "give `{\"map_info\": {\"width\": ..., \"height\": ...}}` in metres",
        )
    })?;
    let MapInfo { width, height } = info.map_info;
    let member = PlanMember { width_m: Some(width), height_m: Some(height), ..PlanMember::default() };
    member.extent_m()?;
    Ok(member)
}

fn draw(member: &PlanMember, geojson_json: &[u8]) -> Result<FloorPlan, FormatError> {
    let collection = parse_collection(geojson_json)?;
    let is_floor = |feature: &Feature| feature.property("type").and_then(JsonValue::as_str) == Some("floor");
    let outline_index = collection.features.iter().position(is_floor).unwrap_or(0);
    let outline = shapes::all_polygons(collection.features.get(outline_index).into_iter());

    let placement = Placement::new(member, &outline)?;
    let mut plan = placement.empty_plan();
    plan.outline = placement.outline(&outline)?;
    for (index, feature) in collection.features.iter().enumerate() {
        if index != outline_index {
            add_units(&mut plan, feature, false, placement.polygons(&shapes::polygons(feature))?);
        }
    }
    Ok(plan)
}
