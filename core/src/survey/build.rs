//! Walks become a floor map.

use serde::{Deserialize, Serialize};

use crate::floor_plan::FloorPlan;
use crate::geometry::{Point2, Segment, wrap_rad};
use crate::map::{FloorMap, GridFrame, Layers};
use crate::survey::kriging::{Kriging, KrigingParams, Reading};
use crate::survey::radio::Heard;
use crate::survey::{SurveyTrack, SurveyWalk};

/// Parameters of [`build_floor`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurveyParams {
    /// Distance between the map's nodes, in metres; default 0.5 (Kwak 2018, §5.2; iBILL 2017, §IV).
    pub cell_m: f64,
    /// The field's spatial covariance.
    pub kriging: KrigingParams,
    /// The field is worked out up to this distance from a surveyed line, in metres; beyond, the floor's mean stands.
    pub field_reach_m: f64,
    /// Length over which the compass deviation is smoothed, in metres.
    pub deviation_length_m: f64,
    /// Route distances are given up to this, in metres.
    pub route_reach_m: f64,
    /// Standard deviation of the Gaussian by which a line counts at a distance, in metres.
    pub route_width_m: f64,
    /// Side of a radio fingerprint's cell, in metres; default 2: at a walk a cell of the map's half metre would hear one
    /// packet of each beacon.
    pub fingerprint_cell_m: f64,
}

impl Default for SurveyParams {
    fn default() -> Self {
        Self {
            cell_m: 0.5,
            kriging: KrigingParams::default(),
            field_reach_m: 8.0,
            deviation_length_m: 2.0,
            route_reach_m: 10.0,
            route_width_m: 0.8,
            fingerprint_cell_m: 2.0,
        }
    }
}

/// Why a survey gives no map.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurveyError {
    /// No walk had two waypoints with steps between them.
    NoTrack {
        /// How many walks there were.
        n_walks: usize,
    },
    /// No step was taken with a magnetometer.
    NoField,
    /// The plan's width or height is not a positive number of metres, or is beyond 10 km.
    BadPlan,
    /// The map would have more than [`MAX_NODES`] nodes.
    TooManyNodes {
        /// The plan's width, in metres.
        width_m: u32,
        /// The plan's height, in metres.
        height_m: u32,
    },
}

/// The most nodes that a floor's map may have: at the default of half a metre, a little over one square kilometre.
///
/// The eight layers of such a map take 134 MB.
pub const MAX_NODES: usize = 4_200_000;

impl core::fmt::Display for SurveyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoTrack { n_walks } => write!(
                f,
                "none of {n_walks} walks has steps between two waypoints: tap a waypoint at the start and end of every line"
            ),
            Self::NoField => {
                write!(f, "no walk holds magnetometer readings: survey with a device that has one")
            }
            Self::BadPlan => write!(f, "the plan has no extent in metres: give its width and height"),
            Self::TooManyNodes { width_m, height_m } => write!(
                f,
                "the plan of {width_m} m by {height_m} m needs a map of more than {MAX_NODES} nodes: check its units, \
                 divide it, or choose larger cells"
            ),
        }
    }
}

impl core::error::Error for SurveyError {}

/// The tracks of a survey and what was read along them, ready to be gridded.
pub(super) struct Surveyed {
    pub tracks: Vec<(u32, SurveyTrack)>,
    /// Field x, y, z and strength.
    pub readings: Vec<Reading<4>>,
    pub deviations: Vec<Deviation>,
}

/// The compass read on one step.
pub(super) struct Deviation {
    pub position: Point2,
    /// Walking direction minus compass azimuth, in radians.
    pub deviation_rad: f64,
    /// The walk that it comes from.
    pub walk: u32,
}

/// Whether a map of `plan` can be made: a survey app asks before anybody walks.
///
/// # Errors
/// [`SurveyError::BadPlan`] and [`SurveyError::TooManyNodes`].
pub fn check_extent(plan: &FloorPlan, params: &SurveyParams) -> Result<(), SurveyError> {
    let is_extent = |m: f64| m > 0.0 && m <= 10_000.0;
    if !is_extent(plan.width_m) || !is_extent(plan.height_m) {
        return Err(SurveyError::BadPlan);
    }
    let n_nodes = (plan.width_m / params.cell_m + 1.0) * (plan.height_m / params.cell_m + 1.0);
    // Not a number where the cell's size is none.
    if !(params.cell_m > 0.0 && n_nodes <= MAX_NODES as f64) {
        let (width_m, height_m) = (plan.width_m as u32, plan.height_m as u32);
        return Err(SurveyError::TooManyNodes { width_m, height_m });
    }
    Ok(())
}

/// Builds a floor's map from its plan and the walks that surveyed it.
///
/// # Errors
/// [`SurveyError`] when the plan has no extent or is too large, no walk can be laid out, or none has a magnetometer.
pub fn build_floor(
    name: &str,
    ordinal: i32,
    plan: &FloorPlan,
    walks: &[SurveyWalk],
    params: &SurveyParams,
) -> Result<FloorMap, SurveyError> {
    check_extent(plan, params)?;
    let surveyed = Surveyed::of(walks);
    if surveyed.tracks.is_empty() {
        return Err(SurveyError::NoTrack { n_walks: walks.len() });
    }
    if surveyed.readings.is_empty() {
        return Err(SurveyError::NoField);
    }
    let frame = GridFrame::covering(plan.width_m, plan.height_m, params.cell_m);
    let heard = Heard::of(walks, &surveyed.tracks);
    let transmitters = heard.fit(None);
    let mut map = FloorMap {
        name: name.into(),
        ordinal,
        plan: plan.clone(),
        frame,
        routes: surveyed.routes(None),
        fingerprints: heard.fingerprints(&transmitters, params.fingerprint_cell_m),
        transmitters,
        layers: Layers::default(),
    };
    grid_routes(&mut map, params);
    grid_field(&mut map, surveyed.readings, params, 0..frame.len());
    let deviations = DeviationSums::of(&frame, &surveyed.deviations, params);
    map.layers.compass_deviation_rad = (0..frame.len()).map(|node| deviations.smoothed_rad(node)).collect();
    Ok(map)
}

impl Surveyed {
    /// Lays out all `walks`.
    pub fn of(walks: &[SurveyWalk]) -> Self {
        let tracks: Vec<(u32, SurveyTrack)> = walks
            .iter()
            .enumerate()
            .filter_map(|(k, walk)| Some((k as u32, SurveyTrack::of(walk)?)))
            .filter(|(_, track)| !track.steps().is_empty())
            .collect();
        let (mut readings, mut deviations) = (Vec::new(), Vec::new());
        for (walk, track) in &tracks {
            for step in track.steps() {
                let Some(field) = step.event.forward_field else { continue };
                let (sin, cos) = libm::sincos(step.heading_rad);
                let [right, ahead, up] = field.field_ut.map(f64::from);
                let strength = f64::from(field.strength_ut());
                let values_ut = [right * cos + ahead * sin, ahead * cos - right * sin, up, strength];
                readings.push(Reading { position: step.position, values_ut, walk: *walk });
                let azimuth_rad = -f64::from(field.heading_rad());
                deviations.push(Deviation {
                    position: step.position,
                    deviation_rad: wrap_rad(step.heading_rad - azimuth_rad),
                    walk: *walk,
                });
            }
        }
        Self { tracks, readings, deviations }
    }

    /// The surveyed lines: the waypoints of each walk but `left_out`, joined.
    pub fn routes(&self, left_out: Option<u32>) -> Vec<Vec<Point2>> {
        let others = self.tracks.iter().filter(|(walk, _)| Some(*walk) != left_out);
        others.map(|(_, track)| track.waypoints().iter().map(|w| w.point).collect()).collect()
    }
}

/// Grids the field at `nodes`: the floor's mean where no route is near. Elsewhere it leaves what was there.
pub(super) fn grid_field(
    map: &mut FloorMap,
    readings: Vec<Reading<4>>,
    params: &SurveyParams,
    nodes: impl IntoIterator<Item = usize>,
) {
    let frame = map.frame;
    let kriging = Kriging::new(params.kriging, readings);
    let mut predictor = kriging.predictor();
    let (mean_ut, sill_ut2) = predictor.predict(Point2::new(-1e6, -1e6));
    let layers = &mut map.layers;
    let means = [mean_ut[0], mean_ut[1], mean_ut[2], sill_ut2, mean_ut[3]];
    let targets = [
        &mut layers.field_x_ut,
        &mut layers.field_y_ut,
        &mut layers.field_z_ut,
        &mut layers.field_variance_ut2,
        &mut layers.strength_ut,
    ];
    for (layer, mean) in targets.into_iter().zip(means) {
        if layer.len() != frame.len() {
            *layer = vec![mean as f32; frame.len()];
        }
    }
    for node in nodes {
        let place = frame.node(node % frame.nx, node / frame.nx);
        let is_near = f64::from(layers.route_distance_m[node]) <= params.field_reach_m;
        let (values_ut, variance_ut2) = if is_near { predictor.predict(place) } else { (mean_ut, sill_ut2) };
        layers.field_x_ut[node] = values_ut[0] as f32;
        layers.field_y_ut[node] = values_ut[1] as f32;
        layers.field_z_ut[node] = values_ut[2] as f32;
        layers.field_variance_ut2[node] = variance_ut2 as f32;
        layers.strength_ut[node] = values_ut[3] as f32;
    }
}

/// Grids the distance to the map's routes and their density.
pub(super) fn grid_routes(map: &mut FloorMap, params: &SurveyParams) {
    let frame = map.frame;
    map.layers.route_distance_m = route_distances_m(&frame, &map.routes, params.route_reach_m);
    let mut density = vec![0.0f32; frame.len()];
    for line in map.routes.iter().flat_map(|route| route.windows(2)) {
        let segment = Segment { a: line[0], b: line[1] };
        for (node, place) in frame.nodes_near(&segment, 3.0 * params.route_width_m) {
            let apart = segment.distance_m(place) / params.route_width_m;
            density[node] += libm::exp(-0.5 * apart * apart) as f32;
        }
    }
    map.layers.route_density = density;
}

/// Distance of every node to the nearest route, up to `reach_m`.
pub(super) fn route_distances_m(frame: &GridFrame, routes: &[Vec<Point2>], reach_m: f64) -> Vec<f32> {
    let mut distances_m = vec![reach_m as f32; frame.len()];
    for line in routes.iter().flat_map(|route| route.windows(2)) {
        let segment = Segment { a: line[0], b: line[1] };
        for (node, place) in frame.nodes_near(&segment, reach_m) {
            let distance_m = segment.distance_m(place) as f32;
            if distance_m < distances_m[node] {
                distances_m[node] = distance_m;
            }
        }
    }
    distances_m
}

/// Compass deviations summed about every node, weighted by a Gaussian of the distance: a circular mean in the making.
#[derive(Clone)]
pub(super) struct DeviationSums {
    /// Sine and cosine per node.
    nodes: Vec<[f64; 2]>,
    /// Sine and cosine of all readings.
    all: [f64; 2],
    n: usize,
}

impl DeviationSums {
    /// The sums of `deviations`.
    pub fn of<'a>(
        frame: &GridFrame,
        deviations: impl IntoIterator<Item = &'a Deviation>,
        params: &SurveyParams,
    ) -> Self {
        let mut sums = Self { nodes: vec![[0.0; 2]; frame.len()], all: [0.0; 2], n: 0 };
        for &Deviation { position, deviation_rad, .. } in deviations {
            let (sin, cos) = libm::sincos(deviation_rad);
            sums.all[0] += sin;
            sums.all[1] += cos;
            sums.n += 1;
            let here = Segment { a: position, b: position };
            for (node, place) in frame.nodes_near(&here, 3.0 * params.deviation_length_m) {
                let apart = place.distance_m(position) / params.deviation_length_m;
                let weight = libm::exp(-0.5 * apart * apart);
                sums.nodes[node][0] += weight * sin;
                sums.nodes[node][1] += weight * cos;
            }
        }
        sums
    }

    /// Takes the readings of `part`, which are among these, out at the nodes that they reach; says which nodes.
    pub fn take_out(&mut self, part: &Self) -> Vec<usize> {
        let reached: Vec<usize> =
            (0..part.nodes.len()).filter(|&node| part.nodes[node] != [0.0; 2]).collect();
        for &node in &reached {
            self.nodes[node][0] -= part.nodes[node][0];
            self.nodes[node][1] -= part.nodes[node][1];
        }
        self.all[0] -= part.all[0];
        self.all[1] -= part.all[1];
        self.n -= part.n.min(self.n);
        reached
    }

    /// The mean deviation at a node, in radians.
    pub fn smoothed_rad(&self, node: usize) -> f32 {
        let n = self.n.max(1) as f64;
        // The floor's mean, as if read once: nodes far from all readings fall back to it.
        let prior = [self.all[0] / n, self.all[1] / n];
        let [sin, cos] = self.nodes[node];
        libm::atan2(sin + 0.5 * prior[0], cos + 0.5 * prior[1]) as f32
    }
}
