//! The iron in a phone, and how its operating system corrects for it.

use crate::noise::Noise;
use crate::phone::PhoneModel;
use crate::vector::{add, dot};

/// The iron in the phone, and what the operating system believes of it.
pub(super) struct Iron {
    soft: [[f64; 3]; 3],
    error_ut: [f64; 3],
    error_sd_ut: f64,
    every_s: f64,
    next_s: f64,
    noise: Noise,
}

impl Iron {
    pub(super) fn new(model: &PhoneModel, device: u64, seed: u64) -> Self {
        let mut of_device = Noise::new(device, "soft iron", 0);
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let off = [0; 6].map(|_| of_device.normal(model.soft_iron_sd));
        // Soft iron is symmetric: xx, yy, zz, xy, xz, yz.
        let off = [[off[0], off[3], off[4]], [off[3], off[1], off[5]], [off[4], off[5], off[2]]];
        let mut noise = Noise::new(seed, "os calibration", 0);
        let mut iron = Self {
            soft: [0, 1, 2].map(|r| add(unit[r], off[r])),
            error_ut: noise.normal3(model.os_bias_error_ut),
            error_sd_ut: model.os_bias_error_ut,
            every_s: model.recalibration_s,
            next_s: 0.0,
            noise,
        };
        iron.next_s = iron.wait_s();
        iron
    }

    fn wait_s(&mut self) -> f64 {
        -self.every_s * libm::log(self.noise.unit())
    }

    /// `field_ut` as the phone's soft iron bends it, in the device frame.
    pub(super) fn softened(&self, field_ut: [f64; 3]) -> [f64; 3] {
        self.soft.map(|row| dot(row, field_ut))
    }

    /// The bias that the operating system takes off at `time_s`; it jumps when the system calibrates anew.
    pub(super) fn os_bias_ut(&mut self, time_s: f64, hard_iron_ut: [f64; 3]) -> [f32; 3] {
        while time_s >= self.next_s && self.every_s > 0.0 {
            self.error_ut = self.noise.normal3(self.error_sd_ut);
            self.next_s += self.wait_s();
        }
        add(hard_iron_ut, self.error_ut).map(|c| c as f32)
    }
}
