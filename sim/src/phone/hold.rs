//! How the hand follows the trunk: the arm that holds a phone is a spring.

use crate::noise::Noise;
use crate::walker::{Body, Wave};

/// Damping of the arm, as a share of the critical one.
const DAMPING: f64 = 0.3;

/// An arm that holds a phone before the body: a damped spring between trunk and hand, for motions up and down.
///
/// # Source
/// The response of a mass on a spring whose foot is moved, as in any book on vibrations. Relaxed forearms resonate at 2 to
/// 4 Hz, stiffer ones higher: Lakie, Walsh and Wright 1984, *Resonance at the wrist demonstrated by the use of a torque
/// motor*; the range and the damping are ours. In recordings the hand's amplitude is 0.8 to 2 times that of the trunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold {
    natural_hz: f64,
}

impl Hold {
    /// An arm by chance.
    pub(super) fn drawn(noise: &mut Noise) -> Self {
        Self { natural_hz: noise.within(2.6, 6.0) }
    }

    /// How much larger the hand's motion is than the trunk's at `frequency_hz`, and by how much it lags, in radians.
    pub(super) fn response(&self, frequency_hz: f64) -> (f64, f64) {
        let r = frequency_hz / self.natural_hz;
        let (stiff, damped) = (1.0 - r * r, 2.0 * DAMPING * r);
        let gain = ((1.0 + damped * damped) / (stiff * stiff + damped * damped)).sqrt();
        (gain, libm::atan2(damped, stiff) - libm::atan(damped))
    }

    /// The hand's rise by the trunk's bounce, in metres.
    pub(super) fn bounced_m(&self, body: &Body) -> f64 {
        let followed = |wave: &Wave| {
            let (gain, lag_rad) = self.response(wave.frequency_hz);
            gain * wave.amplitude_m * libm::cos(wave.phase_rad - lag_rad)
        };
        body.bounce.iter().map(followed).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_follows_slowly_resonates_and_stays_behind() {
        let hold = Hold { natural_hz: 4.0 };
        let (slow, lag_rad) = hold.response(0.1);
        assert!((slow - 1.0).abs() < 1e-2 && lag_rad.abs() < 1e-2);
        // At resonance by hand: sqrt(1 + 0.36) / 0.6 = 1.944.
        assert!((hold.response(4.0).0 - 1.943_7).abs() < 1e-3);
        let (fast, lag_rad) = hold.response(40.0);
        assert!(fast < 0.1 && lag_rad > 1.0);
    }
}
