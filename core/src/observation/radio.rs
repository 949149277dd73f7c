//! Radio sightings against the map's transmitters: a weak, heavy-tailed log-distance likelihood.

use serde::{Deserialize, Serialize};

use crate::map::Transmitter;
use crate::particle::Particles;
use crate::radio::path_loss::PathLoss;

pub use crate::radio::RadioObservation;

/// Parameters of the radio likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadioParams {
    /// The likelihood of all sightings of a step together is raised to this power, in (0, 1].
    pub tempering: f32,
    /// The same while the cloud is wider than `wide_m`: then radio knows more than the particles do.
    pub wide_tempering: f32,
    /// The cloud is wide when its 68 % radius exceeds this, in metres.
    pub wide_m: f32,
    /// Degrees of freedom of the Student-t density of the received power.
    pub degrees_of_freedom: f32,
    /// At most this many transmitters a step are used, the strongest first.
    pub max_transmitters: usize,
    /// The same while the cloud is wide.
    pub wide_max_transmitters: usize,
}

impl Default for RadioParams {
    fn default() -> Self {
        Self {
            tempering: 0.05,
            wide_tempering: 0.3,
            wide_m: 5.0,
            degrees_of_freedom: 4.0,
            max_transmitters: 4,
            wide_max_transmitters: 12,
        }
    }
}

/// Adds the tempered log-likelihood of `observations` to every particle of a cloud that is wide, or is not.
///
/// # Source
/// iBILL 2017, Eq. 1 (log-distance path loss); the Student-t density and the tempering are ours.
pub fn update(
    params: &RadioParams,
    transmitters: &[Transmitter],
    observations: &[RadioObservation],
    is_wide: bool,
    particles: &mut Particles,
) {
    let (tempering, n) = if is_wide {
        (params.wide_tempering, params.wide_max_transmitters)
    } else {
        (params.tempering, params.max_transmitters)
    };
    for observation in observations.iter().take(n) {
        let Some(transmitter) = transmitters.get(observation.transmitter as usize) else { continue };
        let model = ExpectedPower::of(transmitter);
        for i in 0..particles.x_m.len() {
            let z = model.deviation(observation.rssi_dbm, particles.x_m[i], particles.y_m[i]);
            particles.log_weight[i] += tempering * log_student(params.degrees_of_freedom, z);
        }
    }
}

/// A transmitter's [`PathLoss`] in the arithmetic of the particle loop.
///
/// # Source
/// iBILL 2017, Eq. 1.
struct ExpectedPower {
    position_m: [f32; 2],
    power_at_1m_dbm: f32,
    /// dB per natural logarithm of the squared distance.
    per_log_square_db: f32,
    per_sigma: f32,
}

impl ExpectedPower {
    fn of(transmitter: &Transmitter) -> Self {
        let PathLoss { power_at_1m_dbm, exponent, sigma_db } = PathLoss::of(transmitter);
        Self {
            position_m: [transmitter.position.x_m as f32, transmitter.position.y_m as f32],
            power_at_1m_dbm: power_at_1m_dbm as f32,
            per_log_square_db: (5.0 * exponent * core::f64::consts::LOG10_E) as f32,
            per_sigma: (1.0 / sigma_db) as f32,
        }
    }

    /// Received power minus what the model expects, in standard deviations; never closer than a metre.
    #[inline]
    fn deviation(&self, rssi_dbm: f32, x_m: f32, y_m: f32) -> f32 {
        let (dx, dy) = (x_m - self.position_m[0], y_m - self.position_m[1]);
        let log_square = libm::logf((dx * dx + dy * dy).max(1.0));
        (rssi_dbm - (self.power_at_1m_dbm - self.per_log_square_db * log_square)) * self.per_sigma
    }
}

#[inline]
fn log_student(nu: f32, z: f32) -> f32 {
    -0.5 * (nu + 1.0) * libm::logf(1.0 + z * z / nu)
}

/// Log-density (up to a constant) of hearing `transmitter` at `rssi_dbm` from a place, Student-t about the path loss.
///
/// # Source
/// iBILL 2017, Eq. 1.
pub fn log_likelihood(nu: f32, transmitter: &Transmitter, rssi_dbm: f32, x_m: f32, y_m: f32) -> f32 {
    log_student(nu, ExpectedPower::of(transmitter).deviation(rssi_dbm, x_m, y_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point2;
    use crate::sensor::TransmitterId;

    fn at_the_origin() -> Transmitter {
        Transmitter {
            id: TransmitterId::WifiBssid([1; 6]),
            position: Point2::new(0.0, 0.0),
            power_at_1m_dbm: -40.0,
            path_loss_exponent: 2.0,
            sigma_db: 5.0,
            n_sightings: 9,
        }
    }

    #[test]
    fn path_loss_by_hand() {
        let transmitter = at_the_origin();
        // At 10 m the model says −60 dBm: no deviation, no penalty.
        assert!(log_likelihood(4.0, &transmitter, -60.0, 10.0, 0.0).abs() < 1e-5);
        // At 1 m it says −40: z = −4, −2.5·ln(1 + 16/4) = −4.0236.
        assert!((log_likelihood(4.0, &transmitter, -60.0, 1.0, 0.0) + 2.5 * libm::logf(5.0)).abs() < 1e-5);
    }

    #[test]
    fn a_wide_cloud_believes_radio_more() {
        let transmitter = at_the_origin();
        let params = RadioParams::default();
        let heard = [RadioObservation { transmitter: 0, rssi_dbm: -60.0 }];
        let log_weight = |is_wide: bool| {
            let mut particles =
                Particles { x_m: vec![1.0], y_m: vec![0.0], log_weight: vec![0.0], ..Particles::default() };
            update(&params, &[transmitter], &heard, is_wide, &mut particles);
            particles.log_weight[0]
        };
        let whole = -2.5 * libm::logf(5.0);
        assert!((log_weight(false) - params.tempering * whole).abs() < 1e-5);
        assert!((log_weight(true) - params.wide_tempering * whole).abs() < 1e-5);
    }
}
