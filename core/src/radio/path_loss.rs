//! Log-distance path loss: how much power arrives from how far, and the fit of it.

use core::f64::consts::LN_10;

use serde::{Deserialize, Serialize};

use crate::map::Transmitter;

/// Nearer than this path loss is not modelled, in metres: a body, a hand and the near field decide there.
pub const NEAREST_M: f64 = 1.0;

/// Path-loss exponent expected before any sighting, and how many sightings that counts for.
const PRIOR_EXPONENT: (f64, f64) = (2.5, 5.0);
/// The spread of the loss over sightings that the prior is worth, in dB².
const PRIOR_SPREAD_DB2: f64 = 25.0;
/// An exponent outside is a survey's accident, not a building's.
const EXPONENTS: (f64, f64) = (1.2, 5.0);
/// Fewest sightings of a fit.
const MIN_SIGHTINGS: usize = 4;

/// Received power by distance: `P_R = P_0 − 10·η·log10(d) + X`, `X ~ N(0, σ²)`, with `d_0` a metre.
///
/// # Source
/// iBILL 2017, Eq. 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathLoss {
    /// Mean received power at one metre, `P_0`, in dBm.
    pub power_at_1m_dbm: f64,
    /// Path-loss exponent η: 2 in free space, usually 1.2 to 4 indoors.
    pub exponent: f64,
    /// Standard deviation σ of the received power about the model, in dB.
    pub sigma_db: f64,
}

/// Why sightings give no path loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathLossError {
    /// Too few sightings had a finite power and a finite distance.
    TooFew {
        /// How many had.
        n_usable: usize,
    },
}

impl core::fmt::Display for PathLossError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFew { n_usable } => write!(
                f,
                "{n_usable} usable sightings are too few for a path loss: take {MIN_SIGHTINGS} or more, far and near"
            ),
        }
    }
}

impl core::error::Error for PathLossError {}

impl PathLoss {
    /// The path loss of a transmitter of the map.
    pub fn of(transmitter: &Transmitter) -> Self {
        Self {
            power_at_1m_dbm: transmitter.power_at_1m_dbm,
            exponent: transmitter.path_loss_exponent,
            sigma_db: transmitter.sigma_db,
        }
    }

    /// The path loss that fits `sightings`, each a distance in metres and a received power in dBm, by least squares.
    ///
    /// The exponent is drawn to 2.5 as by five sightings and kept in 1.2 to 5; σ is the residuals' standard deviation,
    /// the two fitted numbers discounted. Sightings that are not finite are left out.
    ///
    /// # Errors
    /// [`PathLossError::TooFew`] with fewer than four usable sightings.
    pub fn fit(sightings: &[(f64, f64)]) -> Result<Self, PathLossError> {
        let usable = sightings.iter().copied().filter(|(d, p)| d.is_finite() && p.is_finite());
        let n_usable = usable.clone().count();
        if n_usable < MIN_SIGHTINGS {
            return Err(PathLossError::TooFew { n_usable });
        }
        let fit = least_squares(usable.map(|(distance_m, rssi_dbm)| (loss_db(distance_m), rssi_dbm)));
        let n = n_usable as f64;
        Ok(Self {
            power_at_1m_dbm: fit.power_at_1m_dbm,
            exponent: fit.exponent,
            sigma_db: (fit.residual_db2 * n / (n - 2.0)).sqrt(),
        })
    }

    /// Mean received power at `distance_m`, in dBm; nearer than a metre as at one.
    ///
    /// # Source
    /// iBILL 2017, Eq. 1.
    pub fn expected_dbm(&self, distance_m: f64) -> f64 {
        self.power_at_1m_dbm + self.exponent * loss_db(distance_m)
    }

    /// η' = 10·η / ln 10: dB lost each time that the distance grows by a factor e.
    ///
    /// # Source
    /// iBILL 2017, Eq. 26.
    pub fn decay_db(&self) -> f64 {
        10.0 * self.exponent / LN_10
    }

    /// σ/η', the standard deviation of a range's logarithm; about 0.6 indoors.
    pub fn log_range_sd(&self) -> f64 {
        self.sigma_db / self.decay_db()
    }

    /// The range that the received power stands for: `d̂ = d_0·10^((P_0 − P_R)/10η)`, in metres; its median is the
    /// distance, its mean is not.
    ///
    /// # Source
    /// iBILL 2017, Eqs 24–25.
    pub fn raw_range_m(&self, rssi_dbm: f64) -> f64 {
        libm::exp((self.power_at_1m_dbm - rssi_dbm) / self.decay_db())
    }

    /// The range whose mean is the distance: `d̂·exp(−σ²/2η'²)`, in metres, as `E(d̂) = d·exp(σ²/2η'²)`.
    ///
    /// # Source
    /// iBILL 2017, Eqs 26–30.
    pub fn unbiased_range_m(&self, rssi_dbm: f64) -> f64 {
        let log_sd = self.log_range_sd();
        self.raw_range_m(rssi_dbm) * libm::exp(-0.5 * log_sd * log_sd)
    }
}

/// `−10·log10(d)`, in dB; nearer than a metre as at one.
#[inline]
pub(crate) fn loss_db(distance_m: f64) -> f64 {
    -10.0 * libm::log10(distance_m.max(NEAREST_M))
}

/// What least squares found.
pub(crate) struct Fit {
    pub power_at_1m_dbm: f64,
    pub exponent: f64,
    /// Mean squared residual.
    pub residual_db2: f64,
    /// Sum of squared residuals, with the prior's.
    pub cost: f64,
}

/// The path loss that fits pairs of [`loss_db`] and received power, its exponent drawn to the prior and kept in bounds.
pub(crate) fn least_squares(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Fit {
    let (mut n, mut sum_l, mut sum_r) = (0.0, 0.0, 0.0);
    for (loss_db, rssi_dbm) in pairs.clone() {
        n += 1.0;
        sum_l += loss_db;
        sum_r += rssi_dbm;
    }
    let (mean_l, mean_r) = (sum_l / n, sum_r / n);
    let (mut ll, mut lr, mut rr) = (0.0, 0.0, 0.0);
    for (loss_db, rssi_dbm) in pairs {
        let (l, r) = (loss_db - mean_l, rssi_dbm - mean_r);
        ll += l * l;
        lr += l * r;
        rr += r * r;
    }
    let (expected, counts) = PRIOR_EXPONENT;
    let pull = counts * PRIOR_SPREAD_DB2;
    let exponent = ((lr + pull * expected) / (ll + pull)).clamp(EXPONENTS.0, EXPONENTS.1);
    let residual_db2 = (rr - 2.0 * exponent * lr + exponent * exponent * ll).max(0.0) / n;
    let off = exponent - expected;
    Fit {
        power_at_1m_dbm: mean_r - exponent * mean_l,
        exponent,
        residual_db2,
        cost: residual_db2 * n + pull * off * off,
    }
}

#[cfg(test)]
mod tests {
    use rand::Rng as _;

    use super::*;
    use crate::random::CounterRng;

    const MODEL: PathLoss = PathLoss { power_at_1m_dbm: -59.0, exponent: 2.0, sigma_db: 5.0 };

    #[test]
    fn ranges_by_hand() {
        // −79 dBm is 20 dB below a metre's: 10 m at η = 2.
        assert!((MODEL.raw_range_m(-79.0) - 10.0).abs() < 1e-12);
        assert!((MODEL.expected_dbm(10.0) + 79.0).abs() < 1e-12);
        assert_eq!(MODEL.expected_dbm(0.2), -59.0);
        // η' = 20/ln 10 = 8.6859; σ/η' = 0.57565; exp(−0.57565²/2) = 0.84732.
        assert!((MODEL.decay_db() - 8.685_889_6).abs() < 1e-6);
        assert!((MODEL.unbiased_range_m(-79.0) - 8.473_2).abs() < 1e-4);
    }

    #[test]
    fn the_mean_of_unbiased_ranges_is_the_distance() {
        let mut rng = CounterRng::new(7, 0);
        let table = crate::random::NormalTable::new();
        let (mut raw_m, mut unbiased_m, n) = (0.0, 0.0, 40_000);
        for _ in 0..n {
            let fading_db = MODEL.sigma_db * f64::from(table.sample(rng.next_u32()));
            let rssi_dbm = MODEL.expected_dbm(6.0) + fading_db;
            raw_m += MODEL.raw_range_m(rssi_dbm) / f64::from(n);
            unbiased_m += MODEL.unbiased_range_m(rssi_dbm) / f64::from(n);
        }
        assert!((unbiased_m / 6.0 - 1.0).abs() < 0.015, "{unbiased_m}");
        // E(d̂)/d = exp(0.57565²/2) = 1.1802.
        assert!((raw_m / 6.0 - 1.1802).abs() < 0.02, "{raw_m}");
    }

    #[test]
    fn a_fit_finds_the_line_and_the_spread_about_it() {
        // Two powers at each distance, 3 dB above and below the line: σ² = 9·n/(n − 2).
        let distances_m: Vec<f64> = (1..=200).map(|k| 0.2 * f64::from(k)).collect();
        let sightings: Vec<_> = distances_m
            .iter()
            .flat_map(|&d| [(d, MODEL.expected_dbm(d) + 3.0), (d, MODEL.expected_dbm(d) - 3.0)])
            .chain([(f64::NAN, -60.0), (3.0, f64::NEG_INFINITY)])
            .collect();
        let fit = PathLoss::fit(&sightings).unwrap();
        assert!((fit.exponent - 2.0).abs() < 0.02 && (fit.power_at_1m_dbm + 59.0).abs() < 0.2, "{fit:?}");
        assert!((fit.sigma_db - 3.0).abs() < 0.05, "{fit:?}");
    }

    #[test]
    fn what_cannot_be_fitted_is_told() {
        let nothing = PathLoss::fit(&[]);
        assert_eq!(nothing, Err(PathLossError::TooFew { n_usable: 0 }));
        let nan = PathLoss::fit(&[(1.0, -60.0), (2.0, -66.0), (f64::NAN, -70.0), (4.0, f64::INFINITY)]);
        assert_eq!(nan, Err(PathLossError::TooFew { n_usable: 2 }));
        // All at one distance: the exponent is the prior's.
        let one = PathLoss::fit(&[(3.0, -70.0); 9]).unwrap();
        assert!((one.exponent - 2.5).abs() < 1e-12 && one.sigma_db < 1e-9, "{one:?}");
        assert!((one.expected_dbm(3.0) + 70.0).abs() < 1e-9);
    }
}
