//! Gyroscope, gravity and compass together: biases are learnt, disturbed fields are believed little.

mod error_state;
mod params;
mod window;

pub use params::FusedHeadingParams;

use nalgebra::Vector3;

use self::error_state::{BIAS, ErrorState, FIELD, HARD_IRON, ROTATION, Row};
use self::window::{Window, WindowMeans};
use super::{HeadingEstimator, earth_from_device};
use crate::gravity::STANDARD_GRAVITY_M_S2;
use crate::rotation::{Quaternion, norm};
use crate::sensor::{Reading, Sample};
use crate::time::Timestamp;

/// Standard deviation of a turn that went unseen, per second of it, in radians.
const UNSEEN_TURN_RAD_S: f64 = 1.0;

/// Variance of the heading before a compass was heard, in rad²; no variance of an angle grows beyond.
const UNKNOWN_HEADING_RAD2: f64 = 10.0;

/// Time over which the first rotation is averaged, in seconds: short, since the device may turn meanwhile.
const START_S: f64 = 0.1;

/// Standard deviation of the mean rate of a device at rest about its bias, in rad/s.
const REST_RATE_SD_RAD_S: f64 = 0.002;

/// An error-state Kalman filter over rotation, gyroscope bias, hard iron and the place's field.
///
/// Between corrections the gyroscope, its bias removed, turns the device. Over each window the mean specific force in
/// the earth frame must point up, but for the walker's change of velocity; the mean field must be the place's usual
/// one and point north, but for a disturbance, which is a Student-t vector: a window whose field is unusual in
/// strength, dip or heading counts little. A device at rest shows its gyroscope's bias directly.
///
/// The hard iron starts at the operating system's estimate and follows it slowly, so a recalibration by the system
/// moves nothing suddenly.
#[derive(Clone, Debug, PartialEq)]
pub struct FusedHeading {
    params: FusedHeadingParams,
    earth_from_device: Option<Quaternion>,
    has_heading: bool,
    /// Gyroscope bias, in rad/s, and hard iron, in µT: device frame.
    bias_rad_s: Vector3<f64>,
    hard_iron_ut: Vector3<f64>,
    /// Usual horizontal and vertical part of the field, in µT.
    horizontal_ut: f64,
    vertical_ut: f64,
    error: ErrorState,
    has_uncalibrated: bool,
    last_rate: Option<Timestamp>,
    window: Window,
}

impl FusedHeading {
    /// An estimator that has seen nothing.
    pub fn new(params: FusedHeadingParams) -> Self {
        Self {
            params,
            earth_from_device: None,
            has_heading: false,
            bias_rad_s: Vector3::zeros(),
            hard_iron_ut: Vector3::zeros(),
            horizontal_ut: 0.0,
            vertical_ut: 0.0,
            error: ErrorState::default(),
            has_uncalibrated: false,
            last_rate: None,
            window: Window::default(),
        }
    }

    /// The gyroscope's bias as learnt so far, in rad/s, device frame.
    pub fn bias_rad_s(&self) -> [f64; 3] {
        self.bias_rad_s.into()
    }

    /// The magnetometer's hard iron as learnt so far, in µT, device frame: of the uncalibrated stream where there is
    /// one, else what the operating system left of it.
    pub fn hard_iron_ut(&self) -> [f64; 3] {
        self.hard_iron_ut.into()
    }

    /// Standard deviation of the heading, in radians; nothing before a first heading.
    pub fn heading_sd_rad(&self) -> Option<f64> {
        self.has_heading.then(|| self.error.variance(ROTATION + 2).sqrt())
    }

    fn push_rate(&mut self, time: Timestamp, rate_rad_s: [f32; 3]) {
        let rate = rate_rad_s.map(f64::from);
        let dt_s = self.last_rate.replace(time).map_or(0.0, |last| time.secs_since(last));
        let Some(q) = self.earth_from_device else { return };
        if dt_s <= 0.0 {
            return;
        }
        if dt_s > self.params.gyroscope_timeout_s {
            self.window.unseen_s += dt_s;
            return;
        }
        let bias = self.bias_rad_s;
        let angle = [0, 1, 2].map(|c| (rate[c] - bias[c]) * dt_s);
        let turned = q.turned(angle);
        self.earth_from_device = Some(turned);
        self.window.push_turn(turned, rate, angle, dt_s);
    }

    fn push_field(&mut self, field_ut: [f32; 3], system_iron_ut: [f32; 3]) {
        let system_iron = system_iron_ut.map(f64::from);
        let field = [0, 1, 2].map(|c| f64::from(field_ut[c]) - self.hard_iron_ut[c]);
        self.window.push_field(self.earth_from_device, field, system_iron);
    }

    /// Closes the window that is open when it is long enough by `now`, and corrects by what it held.
    fn close_window(&mut self, now: Timestamp) {
        let length_s = if self.earth_from_device.is_some() { self.params.window_s } else { START_S };
        let Some((window, length_s)) = self.window.take_if_over(now, length_s) else { return };
        if self.earth_from_device.is_none() {
            self.begin(&window);
            return;
        }
        self.predict(&window, length_s);
        self.correct_bias_at_rest(&window);
        self.correct_tilt(&window, length_s);
        self.correct_hard_iron(&window, length_s);
        self.correct_field(&window, length_s);
    }

    /// The first rotation: upright by the first window's forces, north by its fields if it has any.
    fn begin(&mut self, window: &WindowMeans) {
        let Some(force) = window.force_m_s2 else { return };
        let force_norm = norm(force);
        if force_norm < 1.0 {
            return;
        }
        let by_compass = window.field_ut.and_then(|field| earth_from_device(force, field));
        let upright = Quaternion::upright(force.map(|c| c / force_norm));
        self.earth_from_device = Some(by_compass.unwrap_or(upright));
        let square = |sd: f64| sd * sd;
        // A window of walking leans by some tenths of g; nothing is known of the heading before the compass corrects.
        self.error = ErrorState::from_variances([
            (ROTATION, [0.04, 0.04, UNKNOWN_HEADING_RAD2]),
            (BIAS, [square(self.params.start_bias_rad_s); 3]),
            (HARD_IRON, [square(self.params.start_iron_ut); 3]),
            (FIELD, [0.0; 3]),
        ]);
    }

    fn predict(&mut self, window: &WindowMeans, length_s: f64) {
        let params = &self.params;
        let unseen_rad = UNSEEN_TURN_RAD_S * window.unseen_s;
        self.error.turn(&window.bias_to_angle_s);
        let walk = |per_root_s: f64| per_root_s * per_root_s * length_s;
        let angle_variance = walk(params.angle_walk_rad) + unseen_rad * unseen_rad;
        self.error.add_variance(ROTATION, angle_variance, UNKNOWN_HEADING_RAD2);
        self.error.add_variance(BIAS, walk(params.bias_walk_rad_s), params.start_bias_rad_s);
        self.error.add_variance(HARD_IRON, walk(params.iron_walk_ut), f64::MAX);
        self.error.add_variance(FIELD, walk(params.field_walk_ut), f64::MAX);
    }

    /// A device that does not turn shows its bias: the mean rate.
    fn correct_bias_at_rest(&mut self, window: &WindowMeans) {
        let Some(rate) = window.rest_rate_rad_s(self.params.rest_rate_rad_s) else { return };
        // Turning evenly is rest for a gyroscope: only rates that can be a bias count.
        if rate.iter().any(|r| r.abs() > 2.0 * self.params.start_bias_rad_s) {
            return;
        }
        for c in 0..3 {
            let mut row = Row::zeros();
            row[BIAS + c] = 1.0;
            let innovation = rate[c] - self.bias_rad_s[c];
            self.correct(&row, innovation, REST_RATE_SD_RAD_S * REST_RATE_SD_RAD_S);
        }
    }

    fn correct_tilt(&mut self, window: &WindowMeans, length_s: f64) {
        let Some(force) = window.force_m_s2 else { return };
        let g = f64::from(STANDARD_GRAVITY_M_S2);
        let strength = norm(force);
        if !(0.5 * g..1.5 * g).contains(&strength) {
            return;
        }
        let excess = (strength - g) / g;
        let pace = self.params.velocity_change_m_s / (g * length_s);
        let shaking = self.params.shaking_share * window.shaking_m_s2 / g;
        let turning = self.params.turning_speed_m_s * window.turn_rad / (g * length_s);
        let variance = pace * pace + excess * excess + shaking * shaking + turning * turning;
        // The force that is seen is turned back by the error: its x shows the error about y, its y that about x.
        let mut row = Row::zeros();
        row[ROTATION + 1] = 1.0;
        self.correct(&row, -force[0] / strength, variance);
        row[ROTATION + 1] = 0.0;
        row[ROTATION] = 1.0;
        self.correct(&row, force[1] / strength, variance);
    }

    /// The system's own estimate of the hard iron, each component a Student-t reading that errs for long.
    fn correct_hard_iron(&mut self, window: &WindowMeans, length_s: f64) {
        let Some(system_iron) = window.system_iron_ut else { return };
        let params = self.params;
        let scale2 = params.system_iron_ut * params.system_iron_ut;
        let repeats = (params.system_iron_s / length_s).max(1.0);
        for c in 0..3 {
            let mut row = Row::zeros();
            row[HARD_IRON + c] = 1.0;
            let innovation = system_iron[c] - self.hard_iron_ut[c];
            let expected = self.error.variance(HARD_IRON + c) + scale2;
            let weight = student_weight(params.degrees_of_freedom, 1.0, innovation * innovation / expected);
            self.correct(&row, innovation, scale2 * repeats / weight);
        }
    }

    /// The window's field against the usual one: heading, horizontal and vertical part, in µT each.
    fn correct_field(&mut self, window: &WindowMeans, length_s: f64) {
        let Some(field) = window.field_ut else { return };
        let Some(rotation) = window.rotation else { return };
        let params = self.params;
        let horizontal_ut = (field[0] * field[0] + field[1] * field[1]).sqrt();
        if horizontal_ut < 1.0 {
            return;
        }
        if !self.has_heading {
            (self.horizontal_ut, self.vertical_ut) = (horizontal_ut, field[2]);
            // A start beside a magnet says little of the place's field.
            let start_ut = params.start_field_ut + (norm(field) - params.max_strength_ut).max(0.0);
            self.error.add_variance(FIELD, start_ut * start_ut, f64::MAX);
            self.has_heading = true;
        }
        let heading_rad = libm::atan2(field[0], field[1]);
        let (sin, cos) = (field[0] / horizontal_ut, field[1] / horizontal_ut);
        // A disturbance that adds to the field makes a heading err less: its size over the whole, not over the usual.
        let reach_ut = horizontal_ut.max(self.horizontal_ut).max(5.0);
        let innovation = Vector3::new(
            reach_ut * heading_rad,
            horizontal_ut - self.horizontal_ut,
            field[2] - self.vertical_ut,
        );
        // Directions across and along the horizontal field; what the errors add to each of the three.
        let across = [cos, -sin, 0.0];
        let along = [sin, cos, 0.0];
        let up = [0.0, 0.0, 1.0];
        let mut rows = [Row::zeros(); 3];
        let lean = reach_ut / horizontal_ut;
        for (row, (direction, scale)) in rows.iter_mut().zip([(across, lean), (along, 1.0), (up, 1.0)]) {
            // Turning by δ about x moves the field by δ·(0, −B_z, B_y), about y by δ·(B_z, 0, −B_x).
            row[ROTATION] = scale * (direction[1] * field[2] - direction[2] * field[1]);
            row[ROTATION + 1] = scale * (direction[2] * field[0] - direction[0] * field[2]);
            for c in 0..3 {
                row[HARD_IRON + c] = scale * (0..3).map(|r| direction[r] * rotation[(r, c)]).sum::<f64>();
            }
        }
        rows[0][ROTATION + 2] = reach_ut;
        rows[1][FIELD] = 1.0;
        rows[2][FIELD + 1] = 1.0;
        // What exceeds any field of the Earth is disturbance, however usual it may have become.
        let excess_ut = (norm(field) - params.max_strength_ut).max(0.0);
        let scale2 = params.disturbance_ut * params.disturbance_ut;
        let distance2 = self.error.mahalanobis2(&rows, &innovation, scale2);
        // Squared, since a magnet stays for many windows, and each would pull a little.
        let weight = student_weight(params.degrees_of_freedom, 3.0, distance2);
        let weight = weight * weight;
        let repeats = (params.disturbance_s / length_s).max(1.0);
        let error =
            self.error.correct_three(&rows, &innovation, (scale2 + excess_ut * excess_ut) * repeats / weight);
        self.apply(&error);
    }

    /// One scalar correction of the error state by `innovation = row·error + noise`.
    fn correct(&mut self, row: &Row, innovation: f64, variance: f64) {
        let error = self.error.correct(row, innovation, variance);
        self.apply(&error);
    }

    fn apply(&mut self, error: &error_state::Errors) {
        if let Some(q) = self.earth_from_device {
            let angle = [error[ROTATION], error[ROTATION + 1], error[ROTATION + 2]];
            self.earth_from_device = Some(q.turned_outside(angle));
        }
        self.bias_rad_s += error.fixed_rows::<3>(BIAS);
        self.hard_iron_ut += error.fixed_rows::<3>(HARD_IRON);
        self.horizontal_ut += error[FIELD];
        self.vertical_ut += error[FIELD + 1];
    }
}

/// Weight of a reading whose squared distance from what is expected, over `n` components, is `distance2`; at most 1.
fn student_weight(degrees_of_freedom: f64, n: f64, distance2: f64) -> f64 {
    ((degrees_of_freedom + n) / (degrees_of_freedom + distance2)).min(1.0)
}

impl HeadingEstimator for FusedHeading {
    fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            return;
        }
        match sample.reading {
            Reading::AngularRate(rate) => self.push_rate(sample.time, rate),
            Reading::SpecificForce(force) => self.window.push_force(self.earth_from_device, force),
            Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
                if !self.has_uncalibrated {
                    // The system's first word on its bias is taken; what came from the other stream is of no use.
                    self.has_uncalibrated = true;
                    self.hard_iron_ut = bias_ut.map(f64::from).into();
                    self.window.forget_fields();
                }
                self.push_field(field_ut, bias_ut);
            }
            Reading::MagneticField(field_ut) if !self.has_uncalibrated => self.push_field(field_ut, [0.0; 3]),
            _ => return,
        }
        self.close_window(sample.time);
    }

    fn earth_from_device(&self) -> Option<Quaternion> {
        self.earth_from_device.filter(|_| self.has_heading)
    }
}

#[cfg(test)]
mod tests;
