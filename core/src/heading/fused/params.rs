//! How the fused heading is tuned.

use serde::{Deserialize, Serialize};

/// Parameters of [`FusedHeading`](super::FusedHeading); defaults are ours, chosen on one person's recordings with two
/// phones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FusedHeadingParams {
    /// Time over which forces and fields are averaged before they correct, in seconds; default 0.5, about a step.
    pub window_s: f64,
    /// Standard deviation of the change of the walker's velocity within a window, in m/s; default 0.4.
    pub velocity_change_m_s: f64,
    /// Share of a window's shaking (the standard deviation of its forces) that its mean keeps, since gyroscope and
    /// accelerometer are some milliseconds apart and clip; default 0.2.
    pub shaking_share: f64,
    /// Speed with which a walker's turns show as force, in m/s; default 2, a fast walk.
    pub turning_speed_m_s: f64,
    /// Standard deviation of the gyroscope's angle after one second, in radians; default 0.005.
    pub angle_walk_rad: f64,
    /// Standard deviation of the gyroscope's bias at the start, in rad/s; default 0.1.
    pub start_bias_rad_s: f64,
    /// Standard deviation of the bias's random walk after one second, in rad/s; default 0.0002.
    pub bias_walk_rad_s: f64,
    /// A rate that stays within this of its mean all through a window is a device at rest, in rad/s; default 0.01.
    pub rest_rate_rad_s: f64,
    /// A gyroscope silent for longer than this has missed turns, in seconds; default 0.1.
    pub gyroscope_timeout_s: f64,
    /// Standard deviation of the operating system's first estimate of the hard iron, in µT; default 10.
    pub start_iron_ut: f64,
    /// Standard deviation of the hard iron's random walk after one second, in µT; default 0.05.
    pub iron_walk_ut: f64,
    /// Scale of the error of the operating system's later estimates of the hard iron, in µT; default 10.
    pub system_iron_ut: f64,
    /// Time over which such an estimate errs in the same way, in seconds; default 10.
    pub system_iron_s: f64,
    /// Standard deviation of the first field about the place's usual one, in µT; default 20.
    pub start_field_ut: f64,
    /// Standard deviation of the usual field's random walk after one second, in µT; default 0.5.
    pub field_walk_ut: f64,
    /// Scale of the ordinary disturbance of the field in a building, in µT; default 5.
    pub disturbance_ut: f64,
    /// What a field has above this is disturbance, in µT; default 70 (the Earth's is 22 to 67).
    pub max_strength_ut: f64,
    /// Degrees of freedom of the disturbance's Student-t; default 3.
    pub degrees_of_freedom: f64,
    /// Time over which a disturbance lasts, in seconds: windows that share one count as one; default 3.
    pub disturbance_s: f64,
}

impl Default for FusedHeadingParams {
    fn default() -> Self {
        Self {
            window_s: 0.5,
            velocity_change_m_s: 0.4,
            shaking_share: 0.2,
            turning_speed_m_s: 2.0,
            angle_walk_rad: 0.005,
            start_bias_rad_s: 0.1,
            bias_walk_rad_s: 0.0002,
            rest_rate_rad_s: 0.01,
            gyroscope_timeout_s: 0.1,
            start_iron_ut: 10.0,
            iron_walk_ut: 0.05,
            system_iron_ut: 10.0,
            system_iron_s: 10.0,
            start_field_ut: 20.0,
            field_walk_ut: 0.5,
            disturbance_ut: 5.0,
            max_strength_ut: 70.0,
            degrees_of_freedom: 3.0,
            disturbance_s: 3.0,
        }
    }
}
