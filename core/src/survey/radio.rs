//! Transmitters from sightings: a log-distance model each, its place found by search.

use std::collections::BTreeMap;

use crate::geometry::Point2;
use crate::map::{Fingerprints, Transmitter};
use crate::radio::path_loss::{Fit, least_squares, loss_db};
use crate::sensor::TransmitterId;
use crate::survey::{SurveyTrack, SurveyWalk};

/// A transmitter heard less often is not mapped.
const MIN_SIGHTINGS: usize = 8;
/// At most this many sightings enter a fit, evenly taken.
const MAX_SIGHTINGS: usize = 200;
/// The search covers this far around the strongest sighting, in metres, first coarsely, then finely.
const SEARCH_M: [(f64, f64); 2] = [(24.0, 3.0), (3.0, 0.75)];
/// Added to the residual variance of a fit, in dB²: fading that a straight walk does not show.
const EXTRA_VARIANCE_DB2: f64 = 9.0;

/// What every transmitter was heard at, and where.
pub(super) struct Heard(BTreeMap<TransmitterId, Vec<Sighting>>);

/// A power received at a place on a walk.
struct Sighting {
    place: Point2,
    rssi_dbm: f64,
    walk: u32,
}

impl Heard {
    /// The sightings of `walks`, placed along their `tracks`.
    pub fn of(walks: &[SurveyWalk], tracks: &[(u32, SurveyTrack)]) -> Self {
        let mut heard: BTreeMap<TransmitterId, Vec<Sighting>> = BTreeMap::new();
        for (walk, track) in tracks {
            for (time, sighting) in walks[*walk as usize].sightings() {
                if let Some(place) = track.position(*time) {
                    let rssi_dbm = f64::from(sighting.rssi_dbm);
                    let sightings = heard.entry(sighting.transmitter).or_default();
                    sightings.push(Sighting { place, rssi_dbm, walk: *walk });
                }
            }
        }
        Self(heard)
    }

    /// Fits every transmitter that was heard often enough outside the walk `left_out`, in order of identity.
    pub fn fit(&self, left_out: Option<u32>) -> Vec<Transmitter> {
        self.0.keys().filter_map(|&id| self.fit_one(id, left_out)).collect()
    }

    /// The fingerprints of `transmitters`, in cells of `cell_m`.
    pub fn fingerprints(&self, transmitters: &[Transmitter], cell_m: f64) -> Fingerprints {
        let sightings = transmitters.iter().zip(0..).flat_map(|(transmitter, index)| {
            let sightings = self.0.get(&transmitter.id).into_iter().flatten();
            sightings.map(move |sighting| (sighting.place, index, sighting.rssi_dbm))
        });
        Fingerprints::of(cell_m, transmitters.len(), sightings)
    }

    /// Fits one transmitter; nothing when it was not heard often enough outside the walk `left_out`.
    pub fn fit_one(&self, id: TransmitterId, left_out: Option<u32>) -> Option<Transmitter> {
        let others = self.0.get(&id)?.iter().filter(|sighting| Some(sighting.walk) != left_out);
        fit(id, &others.map(|sighting| (sighting.place, sighting.rssi_dbm)).collect::<Vec<_>>())
    }
}

fn fit(id: TransmitterId, sightings: &[(Point2, f64)]) -> Option<Transmitter> {
    if sightings.len() < MIN_SIGHTINGS {
        return None;
    }
    let stride = sightings.len().div_ceil(MAX_SIGHTINGS);
    let used: Vec<_> = sightings.iter().copied().step_by(stride).collect();
    let strongest = sightings.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut losses = Vec::with_capacity(used.len());
    let mut best = model_at(strongest.0, &used, &mut losses);
    for (reach_m, step_m) in SEARCH_M {
        let centre = best.position;
        let n = (reach_m / step_m) as i32;
        for (i, j) in (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j))) {
            let place = centre + Point2::new(f64::from(i) * step_m, f64::from(j) * step_m);
            let candidate = model_at(place, &used, &mut losses);
            if candidate.fit.cost < best.fit.cost {
                best = candidate;
            }
        }
    }
    Some(Transmitter {
        id,
        position: best.position,
        power_at_1m_dbm: best.fit.power_at_1m_dbm,
        path_loss_exponent: best.fit.exponent,
        sigma_db: (best.fit.residual_db2 + EXTRA_VARIANCE_DB2).sqrt(),
        n_sightings: sightings.len().min(u32::MAX as usize) as u32,
    })
}

struct Model {
    position: Point2,
    fit: Fit,
}

/// The least-squares path loss for a transmitter at `position`.
///
/// What stands in `losses` does not matter: it is memory.
fn model_at(position: Point2, sightings: &[(Point2, f64)], losses: &mut Vec<f64>) -> Model {
    losses.clear();
    losses.extend(sightings.iter().map(|&(place, _)| loss_db(place.distance_m(position))));
    let powers = sightings.iter().map(|&(_, rssi_dbm)| rssi_dbm);
    Model { position, fit: least_squares(losses.iter().copied().zip(powers)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transmitter_is_found_where_it_stands() {
        let truth = Point2::new(12.0, 7.0);
        let sightings: Vec<_> = (0..60)
            .map(|k| {
                let p = Point2::new(f64::from(k % 10) * 3.0, f64::from(k / 10) * 3.0);
                (p, -45.0 - 22.0 * libm::log10(p.distance_m(truth).max(1.0)))
            })
            .collect();
        let found = fit(TransmitterId::WifiBssid([1; 6]), &sightings).unwrap();
        assert!(found.position.distance_m(truth) < 1.0, "{found:?}");
        assert!((found.path_loss_exponent - 2.2).abs() < 0.2 && (found.power_at_1m_dbm + 45.0).abs() < 3.0);
        assert_eq!(fit(found.id, &sightings[..7]), None);
    }
}
