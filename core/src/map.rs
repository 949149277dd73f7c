//! What a survey measured: magnetic layers, compass deviation, surveyed routes, radio transmitters and fingerprints.

mod fingerprints;
mod index;
mod surveyed_ways;

pub use fingerprints::Fingerprints;
pub use index::FloorIndex;

use serde::{Deserialize, Serialize};

use crate::floor_plan::FloorPlan;
use crate::geometry::{Point2, Segment};
use crate::sensor::TransmitterId;

/// A regular grid over the floor: node `(i, j)` lies at `origin + (i, j)·cell_m`, values stand at nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GridFrame {
    /// Position of node (0, 0).
    pub origin: Point2,
    /// Distance between neighbouring nodes, in metres.
    pub cell_m: f64,
    /// Number of nodes along x.
    pub nx: usize,
    /// Number of nodes along y.
    pub ny: usize,
}

/// A scalar at every node of a grid; row-major, `values[j * nx + i]`.
pub type Layer = Vec<f32>;

/// The gridded layers of a floor; every layer has `nx * ny` values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Magnetic field along the floor's x, in µT.
    pub field_x_ut: Layer,
    /// Magnetic field along the floor's y, in µT.
    pub field_y_ut: Layer,
    /// Magnetic field upward, in µT.
    pub field_z_ut: Layer,
    /// Predictive variance of one field component, sensor noise excluded, in µT².
    pub field_variance_ut2: Layer,
    /// Strength of the field, in µT (surveyed as such: the mean strength is not the strength of the mean).
    pub strength_ut: Layer,
    /// Walking direction minus compass azimuth, in radians, clockwise positive.
    pub compass_deviation_rad: Layer,
    /// Distance to the nearest surveyed line, in metres.
    pub route_distance_m: Layer,
    /// Number of surveyed lines that pass here, each counted by a Gaussian of its distance.
    pub route_density: Layer,
}

/// A radio transmitter as the survey heard it: a log-distance path-loss model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transmitter {
    /// Who it is.
    pub id: TransmitterId,
    /// Where it is.
    pub position: Point2,
    /// Mean received power at one metre, in dBm.
    pub power_at_1m_dbm: f64,
    /// Path-loss exponent η: 2 in free space, usually 1.5 to 4 indoors.
    pub path_loss_exponent: f64,
    /// Standard deviation of the received power about the model, in dB.
    pub sigma_db: f64,
    /// Number of sightings that the model was fitted to.
    pub n_sightings: u32,
}

/// One surveyed floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FloorMap {
    /// The floor's name, such as `F1`.
    pub name: String,
    /// The floor's number: 0 is the ground floor.
    pub ordinal: i32,
    /// The plan it was surveyed on.
    pub plan: FloorPlan,
    /// The grid that all layers share.
    pub frame: GridFrame,
    /// The gridded layers.
    pub layers: Layers,
    /// The lines walked by the survey, each a polyline.
    pub routes: Vec<Vec<Point2>>,
    /// The transmitters heard.
    pub transmitters: Vec<Transmitter>,
    /// How strongly each of them was received where.
    pub fingerprints: Fingerprints,
}

/// A building: its floors, from the lowest to the highest ordinal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildingMap {
    /// The building's name.
    pub name: String,
    /// The floors.
    pub floors: Vec<FloorMap>,
}

impl GridFrame {
    /// A grid of `cell_m` that covers `width_m` × `height_m` from the origin of the floor frame.
    pub fn covering(width_m: f64, height_m: f64, cell_m: f64) -> Self {
        let nodes = |extent_m: f64| (extent_m / cell_m).ceil().max(0.0) as usize + 1;
        Self { origin: Point2::default(), cell_m, nx: nodes(width_m), ny: nodes(height_m) }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nx * self.ny
    }

    /// Whether the grid has no node.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of node `(i, j)`.
    pub fn node(&self, i: usize, j: usize) -> Point2 {
        self.origin + Point2::new(i as f64 * self.cell_m, j as f64 * self.cell_m)
    }

    /// The nodes of the rectangle round `segment` that is larger than it by `reach_m` on each side, with their positions.
    pub(crate) fn nodes_near(
        &self,
        segment: &Segment,
        reach_m: f64,
    ) -> impl Iterator<Item = (usize, Point2)> + use<> {
        let frame = *self;
        let range = |low_m: f64, high_m: f64, origin_m: f64, n: usize| {
            let first = ((low_m - reach_m - origin_m) / frame.cell_m).ceil().max(0.0) as usize;
            let end = ((high_m + reach_m - origin_m) / frame.cell_m).floor() + 1.0;
            first..(end.max(0.0) as usize).min(n)
        };
        let (a, b) = (segment.a, segment.b);
        let columns = range(a.x_m.min(b.x_m), a.x_m.max(b.x_m), frame.origin.x_m, frame.nx);
        let rows = range(a.y_m.min(b.y_m), a.y_m.max(b.y_m), frame.origin.y_m, frame.ny);
        rows.flat_map(move |j| columns.clone().map(move |i| (j * frame.nx + i, frame.node(i, j))))
    }
}

impl Layers {
    /// The layers with their names on disk, in the order in which they are written.
    pub fn named(&self) -> [(&'static str, &Layer); 8] {
        let Self {
            field_x_ut,
            field_y_ut,
            field_z_ut,
            field_variance_ut2,
            strength_ut,
            compass_deviation_rad,
            route_distance_m,
            route_density,
        } = self;
        [
            ("field_x_ut", field_x_ut),
            ("field_y_ut", field_y_ut),
            ("field_z_ut", field_z_ut),
            ("field_variance_ut2", field_variance_ut2),
            ("strength_ut", strength_ut),
            ("compass_deviation_rad", compass_deviation_rad),
            ("route_distance_m", route_distance_m),
            ("route_density", route_density),
        ]
    }

    /// The layer called `name` on disk, if there is one.
    pub fn named_mut(&mut self, name: &str) -> Option<&mut Layer> {
        Some(match name {
            "field_x_ut" => &mut self.field_x_ut,
            "field_y_ut" => &mut self.field_y_ut,
            "field_z_ut" => &mut self.field_z_ut,
            "field_variance_ut2" => &mut self.field_variance_ut2,
            "strength_ut" => &mut self.strength_ut,
            "compass_deviation_rad" => &mut self.compass_deviation_rad,
            "route_distance_m" => &mut self.route_distance_m,
            "route_density" => &mut self.route_density,
            _ => return None,
        })
    }
}
