//! How well a map will position: each walk on the map of all others.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::attitude::AttitudeEstimate;
use crate::geometry::Point2;
use crate::map::{Fingerprints, FloorIndex, FloorMap, Transmitter};
use crate::metrics::ScoredFix;
use crate::observation::radio::RadioObservation;
use crate::positioner::fix::{Inputs, assemble};
use crate::random::{Purpose, draw, uniform};
use crate::sensor::{RadioSighting, TransmitterId};
use crate::survey::build::{DeviationSums, Surveyed, grid_field, grid_routes};
use crate::survey::kriging::Kriging;
use crate::survey::radio::Heard;
use crate::survey::{SurveyParams, SurveyTrack, SurveyWalk};
use crate::system::Recipe;
use crate::time::Timestamp;
use crate::tracker::Tracker;

/// How far off the start of a left-out walk is taken to be known along each axis, in metres.
const START_RADIUS_M: f64 = 2.0;

/// A survey's walks, laid out once, each of which can be positioned on the map of the others.
pub struct LeaveOneOut<'a> {
    map: &'a FloorMap,
    walks: &'a [SurveyWalk],
    params: SurveyParams,
    surveyed: Surveyed,
    heard: Heard,
    deviations: DeviationSums,
    /// Per walk, the nodes at which the map's field rests on its readings.
    field_nodes: Vec<Vec<usize>>,
}

impl core::fmt::Debug for LeaveOneOut<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("LeaveOneOut")
            .field("floor", &self.map.name)
            .field("n_walks", &self.walks.len())
            .finish()
    }
}

impl<'a> LeaveOneOut<'a> {
    /// Lays out `walks`, of which [`crate::survey::build_floor`] made `map` with the same `params`.
    pub fn new(map: &'a FloorMap, walks: &'a [SurveyWalk], params: &SurveyParams) -> Self {
        let surveyed = Surveyed::of(walks);
        let heard = Heard::of(walks, &surveyed.tracks);
        let deviations = DeviationSums::of(&map.frame, &surveyed.deviations, params);
        let field_nodes = field_nodes(map, &surveyed, walks.len(), params);
        Self { map, walks, params: *params, surveyed, heard, deviations, field_nodes }
    }

    /// Positions walk `left_out` on the map of all others and scores it at its waypoints but the first.
    ///
    /// The field, the compass deviation, the routes and the transmitters are those of the other walks. The system hears
    /// steps and radio when a [`crate::positioner::Positioner`] would, knows the start to ± 2 m along each axis, and
    /// states its radii as fixes do. Each score comes with the waypoint's place. Empty when the walk cannot be laid out,
    /// and when it is the only one.
    pub fn score(&self, left_out: usize, recipe: &Recipe, seed: u64) -> Vec<(Point2, ScoredFix)> {
        let Some((track, walk)) = self.track(left_out).zip(self.walks.get(left_out)) else {
            return Vec::new();
        };
        let left_out = left_out as u32;
        if self.surveyed.readings.iter().all(|reading| reading.walk == left_out) {
            return Vec::new();
        }
        let mut map = self.map_without(left_out);
        let waypoints = track.waypoints();
        let first = walk.completions.iter().filter(|known| known.time <= waypoints[0].time).count();
        let radio = self.radio(left_out, walk, recipe, &mut map.transmitters);
        let mut tracker = Tracker::new(recipe.clone(), Arc::new(FloorIndex::new(map)), seed);
        // Nothing is resampled before the first step: these draws are free.
        let bits = draw(seed, 0, left_out, Purpose::Resampling);
        let off_m = |bits: u32| START_RADIUS_M * (2.0 * f64::from(uniform(bits)) - 1.0);
        tracker.place(waypoints[0].point + Point2::new(off_m(bits[0]), off_m(bits[1])), START_RADIUS_M);
        let mut steps = (first..walk.steps().len()).peekable();
        let mut last_step = None;
        let mut scored = Vec::new();
        for waypoint in &waypoints[1..] {
            while let Some(k) = steps.next_if(|&k| walk.completions[k].time <= waypoint.time) {
                tracker.step(&walk.steps()[k], &radio[k]);
                last_step = Some(walk.steps()[k].cycle);
            }
            let Some(estimate) = tracker.estimate() else { continue };
            let fix = assemble(&Inputs {
                map: tracker.floor().map(),
                accuracy: recipe.accuracy,
                estimate,
                mode: tracker.mode(),
                step_length_m: tracker.step_length_m(),
                last_step,
                turned_rad: 0.0,
                attitude: AttitudeEstimate::default(),
                last_heard: Some(waypoint.time),
                time: waypoint.time,
            });
            let error_m = fix.position.distance_m(waypoint.point);
            let (radius_68_m, radius_95_m) = (fix.radius_68_m, fix.radius_95_m);
            scored.push((waypoint.point, ScoredFix { error_m, radius_68_m, radius_95_m }));
        }
        scored
    }

    fn track(&self, walk: usize) -> Option<&SurveyTrack> {
        self.surveyed.tracks.iter().find(|(k, _)| *k as usize == walk).map(|(_, track)| track)
    }

    /// The map of all walks but one, without transmitters and their fingerprints.
    fn map_without(&self, left_out: u32) -> FloorMap {
        let mut map =
            FloorMap { transmitters: Vec::new(), fingerprints: Fingerprints::default(), ..self.map.clone() };
        map.routes = self.surveyed.routes(Some(left_out));
        grid_routes(&mut map, &self.params);
        let others = self.surveyed.readings.iter().filter(|reading| reading.walk != left_out);
        let nodes = self.field_nodes.get(left_out as usize).into_iter().flatten();
        grid_field(&mut map, others.copied().collect(), &self.params, nodes.copied());
        let own = self.surveyed.deviations.iter().filter(|deviation| deviation.walk == left_out);
        let mut deviations = self.deviations.clone();
        for node in deviations.take_out(&DeviationSums::of(&map.frame, own, &self.params)) {
            if let Some(deviation_rad) = map.layers.compass_deviation_rad.get_mut(node) {
                *deviation_rad = deviations.smoothed_rad(node);
            }
        }
        map
    }

    /// What a positioner would hear at each step of a walk from the transmitters that the other walks have mapped.
    ///
    /// Only transmitters that count are fitted, into `transmitters`: a walk hears hundreds, and a step uses a few.
    fn radio(
        &self,
        left_out: u32,
        walk: &SurveyWalk,
        recipe: &Recipe,
        transmitters: &mut Vec<Transmitter>,
    ) -> Vec<Vec<RadioObservation>> {
        let n_used = recipe.radio.map_or(0, |radio| radio.max_transmitters.max(radio.wide_max_transmitters));
        let mut fitted: BTreeMap<TransmitterId, Option<u32>> = BTreeMap::new();
        let mut from = 0;
        let observations = walk.completions.iter().map(|known| {
            let sightings = &walk.sightings()[from..known.n_sightings];
            from = known.n_sightings;
            let mut used = Vec::new();
            for (id, rssi_dbm) in if n_used > 0 { strongest_first(sightings) } else { Vec::new() } {
                let transmitter = *fitted.entry(id).or_insert_with(|| {
                    let fit = self.heard.fit_one(id, Some(left_out))?;
                    transmitters.push(fit);
                    Some(transmitters.len() as u32 - 1)
                });
                used.extend(transmitter.map(|transmitter| RadioObservation { transmitter, rssi_dbm }));
                if used.len() == n_used {
                    break;
                }
            }
            used
        });
        observations.collect()
    }
}

/// Per walk, the nodes at which `map`'s field rests on its readings.
fn field_nodes(
    map: &FloorMap,
    surveyed: &Surveyed,
    n_walks: usize,
    params: &SurveyParams,
) -> Vec<Vec<usize>> {
    let kriging = Kriging::new(params.kriging, surveyed.readings.clone());
    let mut predictor = kriging.predictor();
    let mut nodes_of = vec![Vec::new(); n_walks];
    for (node, &route_m) in map.layers.route_distance_m.iter().enumerate() {
        if f64::from(route_m) > params.field_reach_m {
            continue;
        }
        for walk in predictor.walks_used(map.frame.node(node % map.frame.nx, node / map.frame.nx)) {
            if let Some(nodes) = nodes_of.get_mut(walk as usize).filter(|nodes| nodes.last() != Some(&node)) {
                nodes.push(node);
            }
        }
    }
    nodes_of
}

/// The mean power of each transmitter, the strongest first.
fn strongest_first(sightings: &[(Timestamp, RadioSighting)]) -> Vec<(TransmitterId, f32)> {
    let mut heard: BTreeMap<TransmitterId, (f32, u32)> = BTreeMap::new();
    for (_, sighting) in sightings {
        let (sum_dbm, n) = heard.entry(sighting.transmitter).or_default();
        *sum_dbm += sighting.rssi_dbm;
        *n += 1;
    }
    let mut means: Vec<_> = heard.into_iter().map(|(id, (sum_dbm, n))| (id, sum_dbm / n as f32)).collect();
    means.sort_by(|a, b| b.1.total_cmp(&a.1));
    means
}
