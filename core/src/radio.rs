//! Radio: what a received power says of the distance, ranges into a place, and fingerprints of places.
//!
//! A *transmitter* is whatever the map names: a beacon or an access point that a phone hears, or, for a card, an access
//! point that hears the card and reports its power. Path loss knows no direction, so both are the same to all below.

pub mod fingerprint;
pub mod path_loss;
pub mod range;
pub mod trilateration;

use serde::{Deserialize, Serialize};

/// The mean received power of one known transmitter over a round or a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadioObservation {
    /// Index of the transmitter in the map.
    pub transmitter: u32,
    /// Mean received power, in dBm.
    pub rssi_dbm: f32,
}

/// The mean of received powers in milliwatts, told in dBm.
///
/// Fading is one-sided: two paths that cancel can take 20 dB away, and can add 6. A mean of dBm follows the deep fades,
/// a mean of milliwatts does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeanPower {
    sum_mw: f64,
    n: u32,
}

impl MeanPower {
    /// Takes a received power in; one that is not finite is left out.
    pub fn push(&mut self, rssi_dbm: f64) {
        let power_mw = libm::exp10(rssi_dbm / 10.0);
        if power_mw.is_finite() {
            self.sum_mw += power_mw;
            self.n += 1;
        }
    }

    /// Takes in all that `other` took in.
    pub fn add(&mut self, other: &Self) {
        self.sum_mw += other.sum_mw;
        self.n += other.n;
    }

    /// The mean, in dBm; nothing before the first power.
    pub fn dbm(&self) -> Option<f64> {
        (self.n > 0).then(|| 10.0 * libm::log10(self.sum_mw / f64::from(self.n)))
    }

    /// How many powers it is the mean of.
    pub fn n(&self) -> u32 {
        self.n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_averaged_in_milliwatts() {
        let mut mean = MeanPower::default();
        assert_eq!(mean.dbm(), None);
        // 1 mW and 0.01 mW: 0.505 mW is −2.967 dBm, where the mean of dBm is −10.
        [0.0, -20.0, f64::NAN, f64::INFINITY].into_iter().for_each(|dbm| mean.push(dbm));
        assert!((mean.dbm().unwrap() + 2.967).abs() < 1e-3);
        assert_eq!(mean.n(), 2);
        let mut both = MeanPower::default();
        both.push(-20.0);
        both.add(&mean);
        // 1.02 mW over three.
        assert!((both.dbm().unwrap() + 4.685).abs() < 1e-3 && both.n() == 3, "{both:?}");
    }
}
