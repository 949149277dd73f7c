//! What the sensors said between two corrections, as sums.

use nalgebra::Matrix3;

use crate::rotation::Quaternion;
use crate::time::Timestamp;

/// Fewest rates in a window that can show rest.
const MIN_REST_RATES: u32 = 10;

/// Sums over the window that is open. Vectors are in the earth frame once there is a rotation, in the device frame
/// before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Window {
    start: Option<Timestamp>,
    /// Integral of the rotation matrix over time.
    bias_to_angle_s: Matrix3<f64>,
    turn_rad: f64,
    seen_s: f64,
    n_forces: u32,
    force_m_s2: [f64; 3],
    force2_m2_s4: f64,
    n_fields: u32,
    field_ut: [f64; 3],
    system_iron_ut: [f64; 3],
    /// Sum of the rotation matrix over the fields.
    field_rotation: Matrix3<f64>,
    n_rates: u32,
    rate_rad_s: [f64; 3],
    least_rate_rad_s: [f64; 3],
    greatest_rate_rad_s: [f64; 3],
    /// Time between two rates that were too far apart, in seconds.
    pub(super) unseen_s: f64,
}

/// A window that is over: the means of what it held, nothing where it held none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WindowMeans {
    /// How a bias of the rate became a rotation in the earth frame: the integral of the rotation matrix, in seconds.
    pub(super) bias_to_angle_s: Matrix3<f64>,
    /// Turn about the vertical, anticlockwise, in radians.
    pub(super) turn_rad: f64,
    /// Time for which turns went unseen, in seconds.
    pub(super) unseen_s: f64,
    pub(super) force_m_s2: Option<[f64; 3]>,
    /// Standard deviation of the forces about their mean, in m/s².
    pub(super) shaking_m_s2: f64,
    pub(super) field_ut: Option<[f64; 3]>,
    pub(super) system_iron_ut: Option<[f64; 3]>,
    /// The mean rotation matrix over the fields.
    pub(super) rotation: Option<Matrix3<f64>>,
    rate_rad_s: Option<[f64; 3]>,
    /// The greatest less the least rate, in rad/s.
    rate_spread_rad_s: [f64; 3],
}

impl Window {
    /// Adds a turn of the device by `angle_rad` (device frame) at `rate_rad_s`, which ended at `earth_from_device`.
    pub(super) fn push_turn(
        &mut self,
        earth_from_device: Quaternion,
        rate_rad_s: [f64; 3],
        angle_rad: [f64; 3],
        dt_s: f64,
    ) {
        let rotation = matrix(earth_from_device);
        self.bias_to_angle_s += rotation * dt_s;
        self.seen_s += dt_s;
        self.turn_rad += (0..3).map(|c| rotation[(2, c)] * angle_rad[c]).sum::<f64>();
        if self.n_rates == 0 {
            (self.least_rate_rad_s, self.greatest_rate_rad_s) = (rate_rad_s, rate_rad_s);
        }
        self.n_rates += 1;
        add(&mut self.rate_rad_s, rate_rad_s);
        self.least_rate_rad_s = [0, 1, 2].map(|c| self.least_rate_rad_s[c].min(rate_rad_s[c]));
        self.greatest_rate_rad_s = [0, 1, 2].map(|c| self.greatest_rate_rad_s[c].max(rate_rad_s[c]));
    }

    /// Adds a specific force of the device frame.
    pub(super) fn push_force(&mut self, earth_from_device: Option<Quaternion>, force_m_s2: [f32; 3]) {
        let force = force_m_s2.map(f64::from);
        self.n_forces += 1;
        self.force2_m2_s4 += force[0] * force[0] + force[1] * force[1] + force[2] * force[2];
        add(&mut self.force_m_s2, earth_from_device.map_or(force, |q| q.rotate(force)));
    }

    /// Adds a field of the device frame, its hard iron removed, and the system's word on that iron.
    pub(super) fn push_field(
        &mut self,
        earth_from_device: Option<Quaternion>,
        field_ut: [f64; 3],
        system_iron_ut: [f64; 3],
    ) {
        self.n_fields += 1;
        add(&mut self.system_iron_ut, system_iron_ut);
        match earth_from_device {
            None => add(&mut self.field_ut, field_ut),
            Some(q) => {
                add(&mut self.field_ut, q.rotate(field_ut));
                self.field_rotation += matrix(q);
            }
        }
    }

    /// Leaves out the fields so far.
    pub(super) fn forget_fields(&mut self) {
        self.n_fields = 0;
        (self.field_ut, self.system_iron_ut) = ([0.0; 3], [0.0; 3]);
        self.field_rotation = Matrix3::zeros();
    }

    /// Closes the window when it has lasted `length_s` by `now`, and opens the next; what it held, and how long it
    /// was, in seconds. Time that goes backwards opens a new window and tells nothing.
    pub(super) fn take_if_over(&mut self, now: Timestamp, length_s: f64) -> Option<(WindowMeans, f64)> {
        let start = *self.start.get_or_insert(now);
        let lasted_s = now.secs_since(start);
        if (0.0..length_s).contains(&lasted_s) {
            return None;
        }
        let over = core::mem::replace(self, Self { start: Some(now), ..Self::default() });
        (lasted_s > 0.0).then(|| (over.means(lasted_s), lasted_s))
    }

    fn means(&self, lasted_s: f64) -> WindowMeans {
        let force_m_s2 = mean(self.force_m_s2, self.n_forces);
        let shaking2 = force_m_s2.map_or(0.0, |f| {
            self.force2_m2_s4 / f64::from(self.n_forces) - (f[0] * f[0] + f[1] * f[1] + f[2] * f[2])
        });
        WindowMeans {
            bias_to_angle_s: self.bias_to_angle_s,
            turn_rad: self.turn_rad,
            // A little is always missing at the ends of a window; a gyroscope that fell silent misses much.
            unseen_s: if self.seen_s < 0.5 * lasted_s { lasted_s - self.seen_s } else { self.unseen_s },
            force_m_s2,
            shaking_m_s2: shaking2.max(0.0).sqrt(),
            field_ut: mean(self.field_ut, self.n_fields),
            system_iron_ut: mean(self.system_iron_ut, self.n_fields),
            rotation: (self.n_fields > 0).then(|| self.field_rotation / f64::from(self.n_fields)),
            rate_rad_s: mean(self.rate_rad_s, self.n_rates).filter(|_| self.n_rates >= MIN_REST_RATES),
            rate_spread_rad_s: [0, 1, 2].map(|c| self.greatest_rate_rad_s[c] - self.least_rate_rad_s[c]),
        }
    }
}

impl WindowMeans {
    /// The mean rate, in rad/s, of a device that turned evenly: all rates within `tolerance_rad_s` of each other's
    /// middle.
    pub(super) fn rest_rate_rad_s(&self, tolerance_rad_s: f64) -> Option<[f64; 3]> {
        self.rate_rad_s.filter(|_| self.rate_spread_rad_s.iter().all(|&s| s < 2.0 * tolerance_rad_s))
    }
}

fn add(sum: &mut [f64; 3], v: [f64; 3]) {
    for (sum, v) in sum.iter_mut().zip(v) {
        *sum += v;
    }
}

fn mean(sum: [f64; 3], n: u32) -> Option<[f64; 3]> {
    (n > 0).then(|| sum.map(|c| c / f64::from(n)))
}

/// The rotation matrix of `q`.
fn matrix(q: Quaternion) -> Matrix3<f64> {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| q.rotate(axis).into());
    Matrix3::from_columns(&columns)
}
