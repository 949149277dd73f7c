//! What must hold of a floor map before it is written and after it is read.

use fieldwalk::floor_plan::{FloorPlan, Georeference, Polygon};
use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorMap, GridFrame, Transmitter};

use super::tensors::unfit;
use crate::error::FormatError;

/// Nodes along one side of a grid, and of a whole grid.
const MAX_SIDE: usize = 1 << 16;
const MAX_NODES: usize = 1 << 25;

/// Checks the grid's spacing and size.
pub(super) fn check_frame(frame: &GridFrame) -> Result<(), FormatError> {
    let GridFrame { origin, cell_m, nx, ny } = *frame;
    let n_nodes = nx.checked_mul(ny).filter(|&n| nx <= MAX_SIDE && ny <= MAX_SIDE && n <= MAX_NODES);
    let has_spacing = cell_m.is_finite() && (cell_m > 0.0 || cell_m == 0.0 && n_nodes == Some(0));
    if n_nodes.is_some() && has_spacing && origin.is_finite() {
        return Ok(());
    }
    Err(unfit(format!("a grid of {nx} x {ny} nodes, {cell_m} m apart, is out of range")))
}

/// Checks that every layer has a value for every node, and that every other number is finite.
pub(super) fn check_floor(floor: &FloorMap) -> Result<(), FormatError> {
    check_frame(&floor.frame)?;
    for (name, layer) in floor.layers.named() {
        if layer.len() != floor.frame.len() {
            let (found, expected) = (layer.len(), floor.frame.len());
            return Err(unfit(format!("layer {name} has {found} values for {expected} nodes")));
        }
    }
    if !floor.routes.iter().flatten().all(is_finite_f32) {
        return Err(unfit("a route has a point that is not finite".to_owned()));
    }
    if !floor.transmitters.iter().all(is_finite_transmitter) {
        return Err(unfit("a transmitter has a parameter that is not finite".to_owned()));
    }
    if !floor.fingerprints.is_sound(floor.transmitters.len())
        || !floor.fingerprints.places.iter().all(is_finite_f32)
    {
        return Err(unfit(
            "the radio fingerprints do not fit the transmitters, or are not finite".to_owned(),
        ));
    }
    check_plan(&floor.plan)
}

fn check_plan(plan: &FloorPlan) -> Result<(), FormatError> {
    let FloorPlan { width_m, height_m, outline, units, walls, pathways, georeference } = plan;
    let is_finite = |polygon: &Polygon| polygon.rings.iter().flatten().all(|point| point.is_finite());
    let georeference = georeference.unwrap_or_default();
    let Georeference { origin_latitude_deg, origin_longitude_deg, latitude_deg_per_m, longitude_deg_per_m } =
        georeference;
    let numbers = [
        *width_m,
        *height_m,
        origin_latitude_deg,
        origin_longitude_deg,
        latitude_deg_per_m,
        longitude_deg_per_m,
    ];
    if numbers.iter().all(|number| number.is_finite())
        && outline.iter().all(is_finite)
        && units.iter().all(|unit| is_finite(&unit.polygon))
        && walls.iter().all(|wall| wall.a.is_finite() && wall.b.is_finite())
        && pathways.iter().flatten().all(|point| point.is_finite())
    {
        return Ok(());
    }
    Err(unfit("the floor plan has a number that is not finite".to_owned()))
}

fn is_finite_transmitter(transmitter: &Transmitter) -> bool {
    let Transmitter { position, power_at_1m_dbm, path_loss_exponent, sigma_db, .. } = transmitter;
    is_finite_f32(position)
        && [power_at_1m_dbm, path_loss_exponent, sigma_db].iter().all(|v| (**v as f32).is_finite())
}

fn is_finite_f32(point: &Point2) -> bool {
    (point.x_m as f32).is_finite() && (point.y_m as f32).is_finite()
}
