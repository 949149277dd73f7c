//! A floor for the page: its plan in centimetres, its layers as bytes.

use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorMap;
use fieldwalk::metrics::quantile;
use serde::Serialize;

use crate::report::packed::{Packed, cm};

/// A layer has at most about so many values on the page; larger ones are thinned.
const MAX_VALUES: usize = 50_000;
/// Field layers are shown up to this distance from a surveyed line, in metres: beyond, nothing was measured.
const SHOWN_M: f32 = 3.0;
/// The byte of a place without a value.
const UNKNOWN: u8 = u8::MAX;

/// A floor.
#[derive(Debug, Serialize)]
pub struct FloorPage {
    name: String,
    width_m: f64,
    height_m: f64,
    outline: Vec<Vec<Ring>>,
    units: Vec<UnitPage>,
    walls: Vec<Ring>,
    routes: Vec<Ring>,
    layers: Vec<LayerPage>,
}

/// Points in centimetres, x and y in turn.
type Ring = Vec<i32>;

#[derive(Debug, Serialize)]
struct UnitPage {
    name: String,
    walkable: bool,
    rings: Vec<Ring>,
}

/// A layer: byte `v` stands for `low + v/254·(high − low)`, 255 for no value; values beyond the two are cut.
#[derive(Debug, Serialize)]
struct LayerPage {
    name: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    /// Whether zero is a middle, so that both signs are told apart.
    is_signed: bool,
    x_m: f64,
    y_m: f64,
    cell_m: f64,
    nx: usize,
    ny: usize,
    values: Packed,
}

impl FloorPage {
    /// The page of `map`, called `name`.
    pub fn of(map: &FloorMap, name: &str) -> Self {
        let FloorPlan { width_m, height_m, outline, units, walls, .. } = &map.plan;
        Self {
            name: name.into(),
            width_m: *width_m,
            height_m: *height_m,
            outline: outline.iter().map(rings).collect(),
            units: units.iter().map(UnitPage::of).collect(),
            walls: walls.iter().map(|wall| ring(&[wall.a, wall.b])).collect(),
            routes: map.routes.iter().map(|route| ring(route)).collect(),
            layers: layers(map),
        }
    }
}

impl UnitPage {
    fn of(unit: &Unit) -> Self {
        Self { name: unit.name.clone(), walkable: unit.walkable, rings: rings(&unit.polygon) }
    }
}

fn rings(polygon: &Polygon) -> Vec<Ring> {
    polygon.rings.iter().map(|points| ring(points)).collect()
}

fn ring(points: &[Point2]) -> Ring {
    points.iter().flat_map(|point| [cm(point.x_m), cm(point.y_m)]).collect()
}

fn layers(map: &FloorMap) -> Vec<LayerPage> {
    let layers = &map.layers;
    let at = |layer: &[f32], node: usize| layer.get(node).copied().unwrap_or(f32::NAN);
    let surveyed = |node: usize| {
        // A map without distances hides nothing.
        layers.route_distance_m.get(node).is_none_or(|&distance_m| distance_m <= SHOWN_M)
    };
    let field = |value: f32, node: usize| if surveyed(node) { value } else { f32::NAN };
    let (x, y, z) = (&layers.field_x_ut, &layers.field_y_ut, &layers.field_z_ut);
    let page = |name, unit, value: &dyn Fn(usize) -> f32| LayerPage::of(map, name, unit, value);
    let all = [
        page("Strength", "µT", &|node| field(at(&layers.strength_ut, node), node)),
        page("Horizontal part", "µT", &|node| field(at(x, node).hypot(at(y, node)), node)),
        page("Vertical part, up", "µT", &|node| field(at(z, node), node)),
        page("Along x", "µT", &|node| field(at(x, node), node)),
        page("Along y", "µT", &|node| field(at(y, node), node)),
        page("Uncertainty", "µT", &|node| at(&layers.field_variance_ut2, node).sqrt()),
        page("Compass deviation", "°", &|node| {
            field(at(&layers.compass_deviation_rad, node).to_degrees(), node)
        }),
        page("Route density", "lines", &|node| at(&layers.route_density, node)),
    ];
    all.into_iter().flatten().collect()
}

impl LayerPage {
    /// Nothing where no place has a value.
    fn of(
        map: &FloorMap,
        name: &'static str,
        unit: &'static str,
        value: &dyn Fn(usize) -> f32,
    ) -> Option<Self> {
        let frame = &map.frame;
        let stride =
            (1..).find(|stride| frame.nx.div_ceil(*stride) * frame.ny.div_ceil(*stride) <= MAX_VALUES)?;
        let nodes = || {
            (0..frame.ny)
                .step_by(stride)
                .flat_map(|j| (0..frame.nx).step_by(stride).map(move |i| j * frame.nx + i))
        };
        let mut known: Vec<f64> =
            nodes().map(|node| f64::from(value(node))).filter(|v| v.is_finite()).collect();
        known.sort_by(f64::total_cmp);
        let (mut low, mut high) = (quantile(&known, 0.01), quantile(&known, 0.99));
        if known.is_empty() {
            return None;
        }
        let is_signed = name == "Compass deviation";
        if is_signed {
            high = high.abs().max(low.abs());
            low = -high;
        }
        let span = if high > low { high - low } else { 1.0 };
        let byte = |value: f32| {
            let share = ((f64::from(value) - low) / span).clamp(0.0, 1.0);
            if value.is_finite() { (share * f64::from(UNKNOWN - 1)).round() as u8 } else { UNKNOWN }
        };
        Some(Self {
            name,
            unit,
            low,
            high: low + span,
            is_signed,
            x_m: frame.origin.x_m,
            y_m: frame.origin.y_m,
            cell_m: frame.cell_m * stride as f64,
            nx: frame.nx.div_ceil(stride),
            ny: frame.ny.div_ceil(stride),
            values: Packed::u8s(nodes().map(|node| byte(value(node)))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::map::{GridFrame, Layers};

    fn map(nx: usize, ny: usize) -> FloorMap {
        let frame = GridFrame { origin: Point2::new(1.0, 2.0), cell_m: 0.5, nx, ny };
        let strength_ut = (0..nx * ny).map(|node| 40.0 + node as f32).collect();
        let mut route_distance_m = vec![1.0; nx * ny];
        route_distance_m[0] = 9.0;
        FloorMap {
            frame,
            layers: Layers { strength_ut, route_distance_m, ..Layers::default() },
            ..FloorMap::default()
        }
    }

    #[test]
    fn a_layer_is_quantised_and_hides_what_was_not_surveyed() {
        let layers = layers(&map(3, 2));
        let [strength] = &layers[..] else { panic!("only the layer that has values: {layers:?}") };
        // Known are 41 to 45; one and ninety-nine hundredths of the way between them.
        assert!((strength.low - 41.04).abs() < 1e-9 && (strength.high - 44.96).abs() < 1e-9, "{strength:?}");
        assert_eq!(strength.values, Packed::u8s([UNKNOWN, 0, 62, 127, 192, 254]));
        assert_eq!((strength.nx, strength.ny, strength.cell_m), (3, 2, 0.5));
    }

    #[test]
    fn a_large_layer_is_thinned() {
        let layers = layers(&map(401, 300));
        let strength = &layers[0];
        assert_eq!((strength.nx, strength.ny, strength.cell_m), (201, 150, 1.0));
    }
}
