//! RADAR on BLE and WiFi alone: a baseline.

use crate::radio::fingerprint::FingerprintParams;
use crate::system::{AccuracyParams, Recipe};

impl Recipe {
    /// The place of the nearest radio fingerprint, once a second, and nothing else: no steps, no field, no smoothing.
    ///
    /// The stated accuracy is that on four floors of a mall; among beacons hung more densely it is better than stated.
    ///
    /// Particles only carry a hint until the first match. Five seconds without a known transmitter make the fix stale.
    ///
    /// # Source
    /// Kwak 2018, §5.3.4 and §6 (`BLE_RADAR`), after RADAR (Bahl and Padmanabhan 2000).
    pub fn radar() -> Self {
        Self {
            name: "radar".into(),
            n_particles: 100,
            radar: Some(FingerprintParams::default()),
            accuracy: AccuracyParams { scale: 1.0, floor_m: 10.5, tail: 1.8 },
            ..Self::dead_reckoning()
        }
    }
}
