//! Walkers: who they are, the steps that they take along a path, and how the body moves at each instant.

mod course;
mod gait;
mod pace;
mod spline;

pub use course::{Course, Flight};
pub(crate) use gait::JOLT_HZ;
pub use gait::{Body, Gait, Wave};
pub use pace::{Pace, Pause, Step};

use crate::noise::Noise;

/// Somebody who walks.
///
/// # Source
/// Step length over step rate is constant over speeds: Sekiya, Nagasaki, Ito and Furuna 1996, *The invariant
/// relationship between step length and step rate during free walking* (about 0.0064 m per step a minute). Rise of the
/// body from step length: Zijlstra and Hof 2003, *Assessment of spatio-temporal gait parameters from trunk
/// accelerations*. People rise by 0.75 to 1.5 times that: four walkers, three with the phone in a neck pouch (Oxford
/// step counting), one under motion capture (Michel, Genevès, Fourati and Layaïda 2017, *On attitude estimation with
/// smartphones*); `docs/simulator/` compares. Variation from step to step is that of healthy adults, 2 to 4 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkerProfile {
    /// Height, in metres.
    pub height_m: f64,
    /// Speed when nothing disturbs, in m/s.
    pub speed_m_s: f64,
    /// Step length over step frequency, in m/Hz.
    pub walk_ratio_m_hz: f64,
    /// A right step lasts longer than the mean by this share, a left one shorter.
    pub asymmetry: f64,
    /// Standard deviation of a step's length over its mean.
    pub length_sd: f64,
    /// Standard deviation of a step's duration over its mean.
    pub time_sd: f64,
    /// Rise of the body at each step over that of the pendulum model.
    pub rise: f64,
    /// Peak acceleration of the jolt that a heel strike at 1.2 m/s sends up, in m/s².
    pub heel_strike_m_s2: f64,
    /// Sideways sway of the trunk to either side, in metres.
    pub sway_m: f64,
    /// How far the walker strays from the line that was meant, standard deviation in metres.
    pub stray_m: f64,
}

impl Default for WalkerProfile {
    /// Middling in all respects.
    fn default() -> Self {
        Self {
            height_m: 1.72,
            speed_m_s: 1.2,
            walk_ratio_m_hz: 0.384,
            asymmetry: 0.01,
            length_sd: 0.03,
            time_sd: 0.02,
            rise: 1.13,
            heel_strike_m_s2: 3.8,
            sway_m: 0.02,
            stray_m: 0.05,
        }
    }
}

impl WalkerProfile {
    /// A walker by chance.
    pub fn drawn(seed: u64) -> Self {
        let mut noise = Noise::new(seed, "walker", 0);
        let height_m = noise.typical(1.72, 0.09);
        Self::of_noise(height_m, &mut noise)
    }

    /// A walker of `height_m`, else by chance.
    pub fn of_height(height_m: f64, seed: u64) -> Self {
        Self::of_noise(height_m, &mut Noise::new(seed, "walker", 1))
    }

    fn of_noise(height_m: f64, noise: &mut Noise) -> Self {
        // Long legs make long steps at the same rate, and a speed by Froude's rule.
        let build = height_m / 1.72;
        Self {
            height_m,
            speed_m_s: noise.typical(1.2, 0.16) * build.sqrt(),
            walk_ratio_m_hz: noise.typical(0.384, 0.035) * build,
            asymmetry: noise.typical(0.0, 0.012),
            length_sd: noise.within(0.02, 0.04),
            time_sd: noise.within(0.015, 0.03),
            rise: noise.typical(1.13, 0.2),
            heel_strike_m_s2: noise.within(2.5, 5.0),
            sway_m: noise.within(0.012, 0.028),
            stray_m: noise.within(0.03, 0.08),
        }
    }

    /// Steps a second at `speed_m_s`.
    pub fn step_frequency_hz(&self, speed_m_s: f64) -> f64 {
        (speed_m_s / self.walk_ratio_m_hz).sqrt()
    }

    /// The length of a step at `speed_m_s`, in metres.
    pub fn step_length_m(&self, speed_m_s: f64) -> f64 {
        (speed_m_s * self.walk_ratio_m_hz).sqrt()
    }

    /// How far the body rises and falls within a step of `length_m`, in metres.
    ///
    /// # Source
    /// Zijlstra and Hof 2003: `length = 1.25·2·sqrt(2·leg·rise)`, solved for the rise; the leg is 0.53 of the height.
    pub fn rise_m(&self, length_m: f64) -> f64 {
        let half_m = 0.5 * length_m / 1.25;
        self.rise * half_m * half_m / (2.0 * 0.53 * self.height_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_middling_walker_steps_as_people_do() {
        let walker = WalkerProfile::default();
        let (hz, length_m) = (walker.step_frequency_hz(1.2), walker.step_length_m(1.2));
        assert!((hz * length_m - 1.2).abs() < 1e-12);
        assert!((1.7..1.9).contains(&hz) && (0.6..0.75).contains(&length_m), "{hz} Hz, {length_m} m");
        assert!((0.035..0.055).contains(&walker.rise_m(length_m)), "{}", walker.rise_m(length_m));
        assert_ne!(WalkerProfile::drawn(1), WalkerProfile::drawn(2));
    }

    #[test]
    fn tall_people_step_longer_on_average() {
        let mean_m = |height_m: f64| {
            let length_m = |seed| {
                let walker = WalkerProfile::of_height(height_m, seed);
                assert_eq!(walker.height_m, height_m);
                walker.step_length_m(walker.speed_m_s)
            };
            (0..50).map(length_m).sum::<f64>() / 50.0
        };
        assert!(mean_m(1.95) > 1.15 * mean_m(1.57), "{} {}", mean_m(1.95), mean_m(1.57));
    }
}
