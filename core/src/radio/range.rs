//! One received power as a range to a known place.

use serde::{Deserialize, Serialize};

use crate::geometry::Point2;
use crate::map::Transmitter;
use crate::radio::RadioObservation;
use crate::radio::path_loss::PathLoss;

/// Ranges beyond this say nothing, in metres: no indoor radio is heard so far.
const FARTHEST_M: f64 = 10_000.0;

/// How far a known place is, by the power received from there (or there).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// The place, in the floor frame.
    pub centre: Point2,
    /// The range whose logarithm is unbiased: half of the ranges are longer than the distance; in metres.
    pub raw_m: f64,
    /// The range whose mean is the distance, in metres.
    pub unbiased_m: f64,
    /// Standard deviation of the range's logarithm: 0.6 is about 60 % of the distance.
    pub log_sd: f64,
}

impl Range {
    /// The range to `centre` at which `path_loss` expects `rssi_dbm`; nothing when a number is not finite, the model has
    /// no decay, or the range is beyond 10 km.
    pub fn new(centre: Point2, path_loss: &PathLoss, rssi_dbm: f64) -> Option<Self> {
        let range = Self {
            centre,
            raw_m: path_loss.raw_range_m(rssi_dbm),
            unbiased_m: path_loss.unbiased_range_m(rssi_dbm),
            log_sd: path_loss.log_range_sd(),
        };
        range.is_usable().then_some(range)
    }

    /// The range to a transmitter of the map by a round's mean power; nothing as for [`Range::new`], and when the map has
    /// no such transmitter.
    pub fn of(transmitters: &[Transmitter], observation: &RadioObservation) -> Option<Self> {
        let transmitter = transmitters.get(observation.transmitter as usize)?;
        Self::new(transmitter.position, &PathLoss::of(transmitter), f64::from(observation.rssi_dbm))
    }

    /// Standard deviation of the unbiased range, in metres: `d·sqrt(exp(σ²/η'²) − 1)`, that of a log-normal number.
    pub fn sd_m(&self) -> f64 {
        self.unbiased_m * libm::expm1(self.log_sd * self.log_sd).sqrt()
    }

    /// Whether all numbers are finite, the ranges positive and within 10 km, the deviation not negative.
    pub fn is_usable(&self) -> bool {
        let is_range = |m: f64| m > 0.0 && m <= FARTHEST_M;
        self.centre.is_finite()
            && is_range(self.raw_m)
            && is_range(self.unbiased_m)
            && self.log_sd >= 0.0
            && self.log_sd.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::TransmitterId;

    #[test]
    fn a_range_by_hand() {
        let transmitter = Transmitter {
            id: TransmitterId::WifiBssid([1; 6]),
            position: Point2::new(3.0, 4.0),
            power_at_1m_dbm: -59.0,
            path_loss_exponent: 2.0,
            sigma_db: 5.0,
            n_sightings: 9,
        };
        let heard = RadioObservation { transmitter: 0, rssi_dbm: -79.0 };
        let range = Range::of(&[transmitter], &heard).unwrap();
        assert_eq!(range.centre, transmitter.position);
        assert!((range.raw_m - 10.0).abs() < 1e-9 && (range.unbiased_m - 8.4732).abs() < 1e-4);
        // sqrt(exp(0.57565²) − 1) = 0.62681.
        assert!((range.sd_m() - 8.4732 * 0.626_81).abs() < 1e-3, "{}", range.sd_m());
        assert_eq!(Range::of(&[transmitter], &RadioObservation { transmitter: 1, ..heard }), None);
    }

    #[test]
    fn numbers_that_are_no_range_give_none() {
        let model = PathLoss { power_at_1m_dbm: -59.0, exponent: 2.0, sigma_db: 5.0 };
        let here = Point2::new(0.0, 0.0);
        let bad = [
            (here, model, f64::NAN),
            (here, model, f64::NEG_INFINITY),
            (here, model, -1e6),
            (Point2::new(f64::NAN, 0.0), model, -70.0),
            (here, PathLoss { exponent: 0.0, ..model }, -70.0),
            (here, PathLoss { sigma_db: f64::NAN, ..model }, -70.0),
            (here, PathLoss { power_at_1m_dbm: f64::INFINITY, ..model }, -70.0),
        ];
        for (centre, model, rssi_dbm) in bad {
            assert_eq!(Range::new(centre, &model, rssi_dbm), None, "{model:?} {rssi_dbm}");
        }
    }
}
