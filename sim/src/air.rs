//! The air: pressure by height and by weather.

use crate::noise::{Noise, SmoothNoise};

/// Height of the ground floor over the sea, in metres.
const GROUND_M: f64 = 60.0;
/// Pressure at sea level, in hPa, and its standard deviation from day to day.
const SEA_LEVEL_HPA: f64 = 1013.25;
const WEATHER_HPA: f64 = 8.0;

/// The air in and around a building during one walk.
///
/// # Source
/// Height: the standard atmosphere of ISO 2533, below 11 km. Weather: pressure changes by about 1 hPa in an hour or three
/// when a front passes, hardly otherwise. Doors, wind and ventilation move the pressure indoors by 1 to 3 Pa within
/// seconds to minutes; the numbers are ours.
#[derive(Clone, Debug)]
pub struct Air {
    sea_level_hpa: f64,
    weather: SmoothNoise,
    draught: SmoothNoise,
}

impl Default for Air {
    /// A still day at the standard pressure.
    fn default() -> Self {
        let mut noise = Noise::new(0, "air", 0);
        let still = SmoothNoise::new(&mut noise, 0.0, [0.0, 0.0]);
        Self { sea_level_hpa: SEA_LEVEL_HPA, weather: still.clone(), draught: still }
    }
}

impl Air {
    /// The air on the day of `seed`.
    pub fn drawn(seed: u64) -> Self {
        let mut noise = Noise::new(seed, "air", 0);
        Self {
            sea_level_hpa: noise.typical(SEA_LEVEL_HPA, WEATHER_HPA),
            weather: SmoothNoise::new(&mut noise, 0.8, [1.0 / 40_000.0, 1.0 / 8_000.0]),
            draught: SmoothNoise::new(&mut noise, 0.015, [0.005, 0.2]),
        }
    }

    /// The pressure at `height_m` over the ground floor, `time_s` into the walk, in hPa.
    pub fn pressure_hpa(&self, height_m: f64, time_s: f64) -> f64 {
        let sea_level_hpa = self.sea_level_hpa + self.weather.at(time_s) + self.draught.at(time_s);
        standard_pressure_hpa(sea_level_hpa, GROUND_M + height_m)
    }
}

/// The pressure at `altitude_m` over the sea where it is `sea_level_hpa` at sea level, in hPa.
///
/// # Source
/// ISO 2533: `p = p₀·(1 − 0.0065·h/288.15)^5.2559`.
pub fn standard_pressure_hpa(sea_level_hpa: f64, altitude_m: f64) -> f64 {
    sea_level_hpa * libm::pow(1.0 - 0.006_5 * altitude_m / 288.15, 5.255_88)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_falls_with_height_as_the_standard_atmosphere() {
        // ISO 2533's table: 898.75 hPa at 1000 m.
        assert!((standard_pressure_hpa(1013.25, 1_000.0) - 898.75).abs() < 0.01);
        // By hand near the ground: ρ·g = 1.225·9.807 = 12.01 Pa a metre, 0.6 % less 60 m up.
        let air = Air::default();
        let storey_hpa = air.pressure_hpa(0.0, 0.0) - air.pressure_hpa(3.4, 0.0);
        assert!((storey_hpa - 0.406).abs() < 0.002, "{storey_hpa}");
    }

    #[test]
    fn weather_is_slow_and_draughts_are_small() {
        let mut fastest_hpa = 0.0f64;
        for seed in 0..20 {
            let air = Air::drawn(seed);
            for k in 0..600 {
                let t = f64::from(k);
                fastest_hpa =
                    fastest_hpa.max((air.pressure_hpa(0.0, t + 1.0) - air.pressure_hpa(0.0, t)).abs());
            }
            let hour_hpa = air.pressure_hpa(0.0, 3_600.0) - air.pressure_hpa(0.0, 0.0);
            assert!(hour_hpa.abs() < 4.0, "{hour_hpa}");
        }
        assert!(fastest_hpa < 0.1, "{fastest_hpa}");
    }
}
