//! Which way is up, and how the device has turned: low-pass gravity and the gyroscope-aided level frame.
//!
//! The *level frame* has z up and a yaw that is fixed by where the device pointed when it was first seen; a heading
//! in it is clockwise from its y. Magnetic north is found elsewhere: nothing here reads a compass while there is a
//! gyroscope.

mod butterworth;

pub use butterworth::ButterworthLowPass;

use serde::{Deserialize, Serialize};

use crate::geometry::wrap_rad;
use crate::rotation::{Quaternion, cross, norm};
use crate::time::Timestamp;

/// Standard gravity, in m/s².
pub const STANDARD_GRAVITY_M_S2: f32 = 9.806_65;

/// A first-order low-pass over a vector: `y_i = a·x_i + (1 − a)·y_{i−1}`.
///
/// # Source
/// Kwak 2018, Eq. 1. The paper does not give `a`; here it follows from a cut-off and the sampling interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VectorLowPass {
    output: Option<[f32; 3]>,
}

impl VectorLowPass {
    /// Feeds `input` with smoothing factor `a` in [0, 1] and returns the output; the first input passes unchanged.
    pub fn update(&mut self, input: [f32; 3], a: f32) -> [f32; 3] {
        let output = match self.output {
            None => input,
            Some(y) => [0, 1, 2].map(|c| a * input[c] + (1.0 - a) * y[c]),
        };
        self.output = Some(output);
        output
    }

    /// The smoothing factor `a` of a cut-off in Hz at samples `dt_s` apart, in [0, 1]: `dt / (1/(2π·cutoff) + dt)`.
    pub fn factor(cutoff_hz: f32, dt_s: f32) -> f32 {
        let tau_s = 1.0 / (core::f32::consts::TAU * cutoff_hz);
        (dt_s / (tau_s + dt_s)).clamp(0.0, 1.0)
    }

    /// The output, once there has been an input.
    pub fn output(&self) -> Option<[f32; 3]> {
        self.output
    }
}

/// Parameters of [`LevelEstimator`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelParams {
    /// Rate at which the specific force corrects the tilt, in 1/s; default 0.5 (time constant 2 s: four steps).
    pub tilt_gain_hz: f32,
    /// The same while there is no gyroscope; default 2.
    pub tilt_gain_without_gyroscope_hz: f32,
    /// Rate at which the compass corrects the yaw while there is no gyroscope, in 1/s; default 3.
    pub yaw_gain_without_gyroscope_hz: f32,
    /// A gyroscope silent for longer than this is missing, in seconds; default 0.25.
    pub gyroscope_timeout_s: f64,
    /// Time constant of what is kept of the field's direction while there is a gyroscope, for when it falls silent, in
    /// seconds; default 2: long enough to outlast the swing of a step, short enough to be of this place.
    pub kept_field_tau_s: f32,
}

impl Default for LevelParams {
    fn default() -> Self {
        Self {
            tilt_gain_hz: 0.5,
            tilt_gain_without_gyroscope_hz: 2.0,
            yaw_gain_without_gyroscope_hz: 3.0,
            gyroscope_timeout_s: 0.25,
            kept_field_tau_s: 2.0,
        }
    }
}

/// Keeps the rotation from the device frame into the level frame.
///
/// The gyroscope turns it, the specific force pulls its z back to the vertical (a complementary filter on the unit
/// quaternion). Without a gyroscope the compass pulls the yaw, and the level frame's y is magnetic north. When a gyroscope
/// falls silent the compass holds the yaw where it was: particles know how they walk against this frame, wherever its y
/// points, and a frame that turned to north by itself would turn them all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelEstimator {
    params: LevelParams,
    level_from_device: Option<Quaternion>,
    last_gyroscope: Option<Timestamp>,
    last_force: Option<Timestamp>,
    /// The field's horizontal part in this frame, lately, while there was a gyroscope, in µT.
    #[serde(default)]
    kept_field_ut: Option<[f32; 2]>,
    /// The latest field and the time since the one before, in seconds, until the gyroscope's next sample.
    #[serde(default)]
    seen_field: Option<([f32; 2], f32)>,
}

impl LevelEstimator {
    /// An estimator that has seen nothing.
    pub fn new(params: LevelParams) -> Self {
        Self {
            params,
            level_from_device: None,
            last_gyroscope: None,
            last_force: None,
            kept_field_ut: None,
            seen_field: None,
        }
    }

    /// Turns the frame by `rate_rad_s` since the last call.
    pub fn push_angular_rate(&mut self, time: Timestamp, rate_rad_s: [f32; 3]) {
        if let Some((field_ut, dt_s)) = self.seen_field.take() {
            let share = dt_s / (self.params.kept_field_tau_s + dt_s);
            let kept = self.kept_field_ut.unwrap_or(field_ut);
            self.kept_field_ut = Some([0, 1].map(|c| kept[c] + share * (field_ut[c] - kept[c])));
        }
        if let (Some(q), Some(last)) = (self.level_from_device, self.last_gyroscope) {
            let dt_s = time.secs_since(last);
            if dt_s > 0.0 && dt_s < self.params.gyroscope_timeout_s {
                self.level_from_device = Some(turned(q, rate_rad_s.map(f64::from), dt_s));
            }
        }
        self.last_gyroscope = Some(time);
    }

    /// Pulls the frame's vertical towards the specific force and returns the force in the level frame, in m/s².
    pub fn push_specific_force(&mut self, time: Timestamp, force_m_s2: [f32; 3]) -> [f32; 3] {
        let force = force_m_s2.map(f64::from);
        let strength_m_s2 = norm(force);
        if strength_m_s2 < 1.0 {
            // Free fall says nothing about the vertical.
            return self.to_level(force_m_s2).unwrap_or(force_m_s2);
        }
        let up = force.map(|c| c / strength_m_s2);
        let Some(q) = self.level_from_device else {
            self.level_from_device = Some(Quaternion::upright(up));
            self.last_force = Some(time);
            return self.to_level(force_m_s2).unwrap_or(force_m_s2);
        };
        let dt_s = self.last_force.map_or(0.0, |last| time.secs_since(last)).clamp(0.0, 0.2);
        self.last_force = Some(time);
        let gain_hz = if self.has_gyroscope(time) {
            self.params.tilt_gain_hz
        } else {
            self.params.tilt_gain_without_gyroscope_hz
        };
        let estimated_up = q.rotate_back([0.0, 0.0, 1.0]);
        // Turning the frame about measured × estimated brings the estimate to the measurement.
        let correction = cross(up, estimated_up).map(|c| c * f64::from(gain_hz));
        self.level_from_device = Some(turned(q, correction, dt_s));
        self.to_level(force_m_s2).unwrap_or(force_m_s2)
    }

    /// Without a gyroscope, pulls the frame's y towards magnetic north; with one that fell silent, holds the field where it
    /// was in this frame; while there is one, only remembers that.
    ///
    /// `dt_s` is the time since the last field.
    pub fn push_field(&mut self, time: Timestamp, field_ut: [f32; 3], dt_s: f64) {
        let (Some(q), Some(level)) = (self.level_from_device, self.to_level(field_ut)) else { return };
        if self.has_gyroscope(time) {
            // Kept when the gyroscope goes on: what is turned before its silence is noticed stays out.
            self.seen_field = Some(([level[0], level[1]], dt_s as f32));
            return;
        }
        let heading_rad = |ut: [f32; 2]| libm::atan2(f64::from(ut[0]), f64::from(ut[1]));
        let north_rad = heading_rad([level[0], level[1]]);
        let off_rad = self.kept_field_ut.map_or(north_rad, |kept| wrap_rad(north_rad - heading_rad(kept)));
        let up_in_device = q.rotate_back([0.0, 0.0, 1.0]);
        // Turning the device anticlockwise by the field's clockwise heading would bring the field to where it belongs.
        let rate = f64::from(self.params.yaw_gain_without_gyroscope_hz) * off_rad;
        self.level_from_device = Some(turned(q, up_in_device.map(|c| c * rate), dt_s.clamp(0.0, 0.2)));
    }

    /// Whether a gyroscope was heard recently.
    pub fn has_gyroscope(&self, now: Timestamp) -> bool {
        self.last_gyroscope.is_some_and(|last| now.secs_since(last) <= self.params.gyroscope_timeout_s)
    }

    /// The rotation from the device frame into the level frame; nothing before the first specific force.
    pub fn level_from_device(&self) -> Option<Quaternion> {
        self.level_from_device
    }

    /// `vector` of the device frame, in the level frame; nothing before the first specific force.
    pub fn to_level(&self, vector: [f32; 3]) -> Option<[f32; 3]> {
        self.level_from_device.map(|q| q.rotate(vector.map(f64::from)).map(|c| c as f32))
    }

    /// The device's forward axis (top edge; the back of the screen when the top points up or down), in the level
    /// frame, projected on the horizontal and of unit length.
    pub fn forward(&self) -> Option<[f32; 2]> {
        let q = self.level_from_device?;
        let top = q.rotate([0.0, 1.0, 0.0]);
        let forward = if top[2].abs() < 0.85 { top } else { q.rotate([0.0, 0.0, -1.0]) };
        let norm = (forward[0] * forward[0] + forward[1] * forward[1]).sqrt();
        (norm > 1e-6).then(|| [(forward[0] / norm) as f32, (forward[1] / norm) as f32])
    }
}

/// `q` after the device has turned at `rate_rad_s` (device frame) for `dt_s`.
fn turned(q: Quaternion, rate_rad_s: [f64; 3], dt_s: f64) -> Quaternion {
    q.turned(rate_rad_s.map(|c| c * dt_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    #[test]
    fn kwak_equation_1_by_hand() {
        let mut low_pass = VectorLowPass::default();
        assert_eq!(low_pass.update([1.0, 2.0, 4.0], 0.25), [1.0, 2.0, 4.0]);
        // 0.25·5 + 0.75·1 = 2
        assert_eq!(low_pass.update([5.0, 2.0, 0.0], 0.25), [2.0, 2.0, 3.0]);
    }

    fn held(params: LevelParams, force: [f32; 3], rate: [f32; 3], seconds: f64) -> LevelEstimator {
        let mut level = LevelEstimator::new(params);
        for k in 0..=(seconds * 100.0) as i64 {
            let time = Timestamp::from_millis(10 * k);
            level.push_angular_rate(time, rate);
            level.push_specific_force(time, force);
        }
        level
    }

    #[test]
    fn a_quarter_turn_clockwise_is_heading_east() {
        // Flat on a turntable: clockwise seen from above is a negative rate about z.
        let level = held(LevelParams::default(), [0.0, 0.0, 9.81], [0.0, 0.0, -FRAC_PI_2], 1.0);
        let forward = level.forward().unwrap();
        assert!((forward[0] - 1.0).abs() < 1e-3 && forward[1].abs() < 1e-3, "{forward:?}");
    }

    #[test]
    fn a_tilted_phone_still_sees_the_vertical() {
        let (sin, cos) = (0.6f32, 0.8f32);
        let level = held(LevelParams::default(), [0.0, 9.81 * sin, 9.81 * cos], [0.0; 3], 1.0);
        let force = level.to_level([0.0, 9.81 * sin, 9.81 * cos]).unwrap();
        assert!(force[0].abs() < 1e-3 && force[1].abs() < 1e-3 && (force[2] - 9.81).abs() < 1e-3);
        assert_eq!(level.forward().map(|f| f.map(f32::round)), Some([0.0, 1.0]));
    }

    #[test]
    fn a_wrong_vertical_is_pulled_back() {
        let mut level = LevelEstimator::new(LevelParams::default());
        level.push_specific_force(Timestamp::from_millis(0), [9.81, 0.0, 0.0]);
        for k in 1..2_000 {
            let time = Timestamp::from_millis(10 * k);
            level.push_angular_rate(time, [0.0; 3]);
            level.push_specific_force(time, [0.0, 0.0, 9.81]);
        }
        let up = level.to_level([0.0, 0.0, 1.0]).unwrap();
        assert!(up[2] > 0.999, "{up:?}");
    }

    #[test]
    fn without_a_gyroscope_the_compass_sets_the_yaw() {
        let mut level = LevelEstimator::new(LevelParams::default());
        // The device points east: north is to its left (-x).
        let field = [-20.0, 0.0, -40.0];
        for k in 0..500 {
            let time = Timestamp::from_millis(20 * k);
            level.push_specific_force(time, [0.0, 0.0, 9.81]);
            level.push_field(time, field, 0.02);
        }
        let forward = level.forward().unwrap();
        assert!(forward[0] > 0.999, "{forward:?}");
    }

    #[test]
    fn a_gyroscope_that_falls_silent_turns_nobody_and_the_compass_follows_from_there() {
        let mut level = LevelEstimator::new(LevelParams::default());
        // Begun facing east: the frame's y is east, and stays so while the gyroscope is silent for four seconds.
        let field = [-20.0, 0.0, -40.0];
        let heading = |level: &LevelEstimator| {
            let forward = level.forward().unwrap();
            libm::atan2f(forward[0], forward[1])
        };
        for k in 0..1_000 {
            let time = Timestamp::from_millis(10 * k);
            if !(300..700).contains(&k) {
                level.push_angular_rate(time, [0.0; 3]);
            }
            level.push_specific_force(time, [0.0, 0.0, 9.81]);
            level.push_field(time, field, 0.01);
        }
        assert!(heading(&level).abs() < 1e-3, "{}", heading(&level));
        // Silent for good, the device turns to face south: what was ahead is to its left.
        for k in 1_000..2_000 {
            let time = Timestamp::from_millis(10 * k);
            level.push_specific_force(time, [0.0, 0.0, 9.81]);
            level.push_field(time, [0.0, -20.0, -40.0], 0.01);
        }
        assert!((heading(&level) - FRAC_PI_2).abs() < 1e-2, "{}", heading(&level));
    }
}
