//! Floor plans as GeoJSON: any plan with an outline, IMDF-like ones, and those of the public collection.
//!
//! A feature's kind stands in its property `kind`, `category`, `feature_type` or `type`, or in IMDF's member
//! `feature_type`. Coordinates are longitude and latitude unless the collection's member `fieldwalk` says otherwise:
//!
//! ```json
//! { "type": "FeatureCollection", "fieldwalk": { "frame": "metres", "width_m": 40, "height_m": 25 }, "features": [] }
//! ```

mod ilc;
mod kind;
mod placement;
mod shapes;
mod write;

use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use geojson::{Feature, FeatureCollection, GeoJson};

use self::kind::Kind;
use self::placement::{Placement, PlanMember};
use crate::error::FormatError;

pub use ilc::read_ilc_plan;
pub(crate) use placement::georeference_at;
pub use write::write_plan;

/// Reads a floor plan from a GeoJSON feature collection.
///
/// Kinds: `outline`, `floor`, `level`, `footprint` bound the floor (the last only where none of the others is
/// drawn); `unit`, `room` and IMDF's units are areas, walked through if they are a `walkway`, `corridor` or the like,
/// or if their property `walkable` says so; `wall` and `pathway` are lines. Other kinds are left out. The
/// collection's member `fieldwalk`, or the property `fieldwalk` of an outline, places the plan:
///
/// * `"frame": "metres"`: coordinates are the floor frame's;
/// * `"width_m"` and `"height_m"`: longitude and latitude, and the outline's bounding box spans the extent;
/// * neither: longitude and latitude, projected about the outline's south-west corner (WGS 84).
///
/// # Errors
/// When `bytes` are not a GeoJSON feature collection, when no outline is drawn or the outline has no extent, and when
/// a coordinate is out of range.
///
/// # Example
/// ```
/// let plan = fieldwalk_formats::read_plan(br#"{
///   "type": "FeatureCollection",
///   "fieldwalk": { "frame": "metres" },
///   "features": [{
///     "type": "Feature",
///     "properties": { "kind": "outline" },
///     "geometry": { "type": "Polygon", "coordinates": [[[0, 0], [40, 0], [40, 25], [0, 25], [0, 0]]] }
///   }]
/// }"#)?;
/// assert_eq!((plan.width_m, plan.height_m), (40.0, 25.0));
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
pub fn read_plan(bytes: &[u8]) -> Result<FloorPlan, FormatError> {
    let collection = parse_collection(bytes)?;
    let kinds: Vec<Kind> = collection.features.iter().map(Kind::of).collect();
    let of_kind = |wanted: Kind| {
        collection.features.iter().zip(&kinds).filter(move |(_, kind)| **kind == wanted).map(|(f, _)| f)
    };

    let mut outline_features: Vec<&Feature> = of_kind(Kind::Outline).collect();
    if outline_features.is_empty() {
        outline_features = of_kind(Kind::Footprint).collect();
    }
    let member = PlanMember::of(&collection, &outline_features)?;
    let outline = shapes::all_polygons(outline_features.iter().copied());
    let placement = Placement::new(&member, &outline)?;

    let mut plan = placement.empty_plan();
    plan.outline = placement.outline(&outline)?;
    for (feature, kind) in collection.features.iter().zip(&kinds) {
        match kind {
            Kind::Unit { walkable } => {
                add_units(&mut plan, feature, *walkable, placement.polygons(&shapes::polygons(feature))?);
            }
            Kind::Wall => {
                for line in placement.lines(&shapes::lines(feature))? {
                    plan.walls.extend(shapes::segments(&line));
                }
            }
            Kind::Pathway => plan.pathways.extend(placement.lines(&shapes::lines(feature))?),
            Kind::Outline | Kind::Footprint | Kind::Other => {}
        }
    }
    Ok(plan)
}

/// One unit per polygon, all with the feature's name.
fn add_units(plan: &mut FloorPlan, feature: &Feature, walkable: bool, polygons: Vec<Polygon>) {
    let name = shapes::name(feature);
    plan.units.extend(polygons.into_iter().map(|polygon| Unit { name: name.clone(), walkable, polygon }));
}

fn parse_collection(bytes: &[u8]) -> Result<FeatureCollection, FormatError> {
    const REMEDY: &str = "give a GeoJSON FeatureCollection (RFC 7946)";
    match serde_json::from_slice(bytes) {
        Ok(GeoJson::FeatureCollection(collection)) => Ok(collection),
        Ok(_) => Err(FormatError::malformed("not a GeoJSON feature collection", REMEDY)),
        Err(error) => {
            let line = error.line() as u64;
            let error = FormatError::malformed(format!("not GeoJSON: {error}"), REMEDY);
            Err(if line > 0 { error.at_line(line) } else { error })
        }
    }
}
