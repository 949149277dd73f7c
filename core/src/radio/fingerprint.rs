//! RADAR: the surveyed cell whose fingerprint is nearest in signal space.

use serde::{Deserialize, Serialize};

use crate::geometry::Point2;
use crate::map::Fingerprints;
use crate::radio::RadioObservation;

/// Parameters of [`FingerprintMatcher::nearest`].
///
/// What is missing counts thus: a transmitter that is heard now and that the survey did not hear in a cell counts there
/// as if the survey had heard it at `missing_dbm`. A transmitter that the survey heard and this round did not counts
/// nothing: a round is a second, which misses one card's beacon in seven at 15 m (Kwak 2018, Table 1) and most of a
/// WiFi scan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FingerprintParams {
    /// What a transmitter unheard by the survey counts as, in dBm; default −100, below what receivers hear.
    pub missing_dbm: f32,
    /// Standard deviation of a round's mean power about the fingerprint's, in dB; default 6, Rayleigh fading's. It
    /// says how much worse a cell may match and still be possible, which the stated spread follows; the match does not.
    pub sigma_db: f32,
}

impl Default for FingerprintParams {
    fn default() -> Self {
        Self { missing_dbm: -100.0, sigma_db: 6.0 }
    }
}

/// The nearest fingerprint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FingerprintMatch {
    /// The cell's index in the fingerprints.
    pub cell: usize,
    /// The cell's place.
    pub place: Point2,
    /// Root mean square difference of powers over the transmitters heard, in dB.
    pub difference_db: f32,
    /// How many transmitters were heard that the survey knows.
    pub n_heard: usize,
}

/// Matches rounds against fingerprints; keeps the memory, so that a match allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct FingerprintMatcher {
    /// Per cell, the sum of squared differences, in dB².
    square_db2: Vec<f32>,
}

impl FingerprintMatcher {
    /// A matcher for `fingerprints`.
    pub fn new(fingerprints: &Fingerprints) -> Self {
        Self { square_db2: vec![0.0; fingerprints.n_cells()] }
    }

    /// The cell nearest to `observations` in signal space; the first of equals. Nothing when no transmitter is heard
    /// that the fingerprints know; powers that are not finite are left out.
    ///
    /// # Source
    /// Kwak 2018, §5.3.4, after RADAR (Bahl and Padmanabhan 2000): the Euclidean distance of mean powers, one
    /// neighbour. What is missing is ours: see [`FingerprintParams`].
    pub fn nearest(
        &mut self,
        params: &FingerprintParams,
        fingerprints: &Fingerprints,
        observations: &[RadioObservation],
    ) -> Option<FingerprintMatch> {
        self.square_db2.clear();
        self.square_db2.resize(fingerprints.n_cells(), 0.0);
        let (mut n_heard, mut all_missing_db2) = (0, 0.0);
        for observation in observations.iter().filter(|observation| observation.rssi_dbm.is_finite()) {
            let missing_db = observation.rssi_dbm - params.missing_dbm;
            let mut is_known = false;
            for (cell, rssi_dbm) in fingerprints.of_transmitter(observation.transmitter) {
                let off_db = observation.rssi_dbm - rssi_dbm;
                if let Some(square_db2) = self.square_db2.get_mut(cell) {
                    *square_db2 += off_db * off_db - missing_db * missing_db;
                    is_known = true;
                }
            }
            if is_known {
                n_heard += 1;
                all_missing_db2 += missing_db * missing_db;
            }
        }
        if n_heard == 0 {
            return None;
        }
        let (cell, least_db2) =
            self.square_db2.iter().enumerate().fold((0, f32::INFINITY), |best, (cell, &square_db2)| {
                if square_db2 < best.1 { (cell, square_db2) } else { best }
            });
        let place = *fingerprints.places.get(cell)?;
        let mean_db2 = (least_db2 + all_missing_db2).max(0.0) / n_heard as f32;
        Some(FingerprintMatch { cell, place, difference_db: mean_db2.sqrt(), n_heard })
    }

    /// Each cell's place and how likely it is after [`FingerprintMatcher::nearest`], the matched cell's likelihood as 1.
    pub fn likelihoods<'a>(
        &'a self,
        params: &FingerprintParams,
        fingerprints: &'a Fingerprints,
    ) -> impl Iterator<Item = (Point2, f32)> + Clone + use<'a> {
        let least_db2 = self.square_db2.iter().copied().fold(f32::INFINITY, f32::min);
        let per_db2 = -0.5 / (params.sigma_db * params.sigma_db);
        let likelihood = move |square_db2: f32| libm::expf(per_db2 * (square_db2 - least_db2));
        fingerprints.places.iter().zip(&self.square_db2).map(move |(&place, &s)| (place, likelihood(s)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Two transmitters: one heard in all of three cells, one in the last two.
    fn corridor() -> Fingerprints {
        let at = |x_m| Point2::new(x_m, 0.5);
        Fingerprints::of(
            1.0,
            2,
            [
                (at(0.5), 0, -50.0),
                (at(1.5), 0, -60.0),
                (at(2.5), 0, -70.0),
                (at(1.5), 1, -80.0),
                (at(2.5), 1, -60.0),
            ],
        )
    }

    fn heard(powers: &[(u32, f32)]) -> Vec<RadioObservation> {
        powers.iter().map(|&(transmitter, rssi_dbm)| RadioObservation { transmitter, rssi_dbm }).collect()
    }

    fn nearest(powers: &[(u32, f32)]) -> Option<FingerprintMatch> {
        let fingerprints = corridor();
        let params = FingerprintParams::default();
        FingerprintMatcher::new(&fingerprints).nearest(&params, &fingerprints, &heard(powers))
    }

    #[test]
    fn the_nearest_cell_by_hand() {
        // Squares: (−66 + 50)² + (−66 + 100)² = 1412, 6² + 14² = 232, 4² + 6² = 52: rms sqrt(52/2).
        let found = nearest(&[(0, -66.0), (1, -66.0)]).unwrap();
        assert_eq!((found.cell, found.n_heard), (2, 2));
        assert!((found.difference_db - libm::sqrtf(26.0)).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn heard_and_not_surveyed_counts_as_weak_and_surveyed_but_not_heard_counts_nothing() {
        // By transmitter 0 alone cell 0 is best; transmitter 1 at −62 dBm is 38 dB above nothing there.
        assert_eq!(nearest(&[(0, -50.0)]).map(|m| (m.cell, m.difference_db)), Some((0, 0.0)));
        assert_eq!(nearest(&[(0, -50.0), (1, -62.0)]).map(|m| m.cell), Some(2));
    }

    #[test]
    fn what_says_nothing_gives_nothing() {
        assert_eq!(nearest(&[]), None);
        assert_eq!(nearest(&[(7, -50.0), (u32::MAX, -40.0)]), None);
        assert_eq!(nearest(&[(0, f32::NAN), (1, f32::INFINITY)]), None);
        let mut matcher = FingerprintMatcher::default();
        let none = Fingerprints::default();
        assert_eq!(matcher.nearest(&FingerprintParams::default(), &none, &heard(&[(0, -50.0)])), None);
    }

    #[test]
    fn likelihoods_by_hand() {
        let (fingerprints, params) = (corridor(), FingerprintParams::default());
        let mut matcher = FingerprintMatcher::new(&fingerprints);
        matcher.nearest(&params, &fingerprints, &heard(&[(0, -60.0)])).unwrap();
        let of: Vec<_> = matcher.likelihoods(&params, &fingerprints).map(|(_, l)| l).collect();
        // 10 dB off at 6 dB: exp(−100/72).
        let off = libm::expf(-100.0 / 72.0);
        assert!((of[0] - off).abs() < 1e-6 && of[1] == 1.0 && (of[2] - off).abs() < 1e-6, "{of:?}");
    }

    proptest! {
        #[test]
        fn a_cells_own_fingerprint_matches_it(
            powers in prop::collection::vec(prop::collection::vec(-95.0f64..-40.0, 5), 1..20),
        ) {
            let sightings = powers.iter().enumerate().flat_map(|(cell, powers)| {
                let place = Point2::new(cell as f64 + 0.5, 0.5);
                powers.iter().zip(0..).map(move |(&rssi_dbm, transmitter)| (place, transmitter, rssi_dbm))
            });
            let fingerprints = Fingerprints::of(1.0, 5, sightings);
            let mut matcher = FingerprintMatcher::new(&fingerprints);
            for (cell, powers) in powers.iter().enumerate() {
                let heard: Vec<_> = powers.iter().zip(0..)
                    .map(|(&rssi_dbm, transmitter)| RadioObservation { transmitter, rssi_dbm: rssi_dbm as f32 })
                    .collect();
                let found = matcher.nearest(&FingerprintParams::default(), &fingerprints, &heard).unwrap();
                prop_assert_eq!(found.cell, cell);
                prop_assert!(found.difference_db < 0.1, "{found:?}");
            }
        }
    }
}
