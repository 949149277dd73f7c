//! Which way is up, and the field seen from there.

/// The smoothing factor `a` of a first-order low-pass `y_i = a·x_i + (1 − a)·y_{i−1}` with a cut-off in Hz at samples
/// `dt_s` apart, in [0, 1]: `dt / (1/(2π·cutoff) + dt)`.
///
/// # Source
/// Kwak 2018, Eq. 1. The paper does not give `a`.
pub fn low_pass_factor(cutoff_hz: f32, dt_s: f32) -> f32 {
    let tau_s = 1.0 / (core::f32::consts::TAU * cutoff_hz);
    (dt_s / (tau_s + dt_s)).clamp(0.0, 1.0)
}

/// A field seen in the gravity frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelReading {
    /// Magnitude of the horizontal part, in µT.
    pub horizontal_ut: f32,
    /// Vertical part, up positive, in µT.
    pub vertical_ut: f32,
    /// Sine and cosine of where the card points, clockwise from magnetic north; nothing where the field is vertical.
    pub heading: Option<[f32; 2]>,
}

impl LevelReading {
    /// `field_ut` of the device frame, where gravity's reaction is `gravity_m_s2`; nothing in free fall.
    ///
    /// The card points where its top edge does, or its back where the top edge points up or down.
    pub fn of(field_ut: [f32; 3], gravity_m_s2: [f32; 3]) -> Option<Self> {
        if !Self::has_up(gravity_m_s2) {
            return None;
        }
        let strength = norm(gravity_m_s2);
        let up = gravity_m_s2.map(|c| c / strength);
        let vertical_ut = dot(field_ut, up);
        let north = [0, 1, 2].map(|c| field_ut[c] - vertical_ut * up[c]);
        let forward = if up[1].abs() < 0.85 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] };
        let east = cross(north, up);
        let (sin, cos) = (dot(forward, east), dot(forward, north));
        let length = libm::sqrtf(sin * sin + cos * cos);
        let heading = (length > 1e-6).then(|| [sin / length, cos / length]);
        Some(Self { horizontal_ut: norm(north), vertical_ut, heading })
    }

    /// Whether gravity's reaction says where up is, which it does not in free fall.
    pub fn has_up(gravity_m_s2: [f32; 3]) -> bool {
        norm(gravity_m_s2) > 1.0
    }
}

pub(crate) fn norm(v: [f32; 3]) -> f32 {
    libm::sqrtf(dot(v, v))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_with_its_back_to_the_east() {
        // The back looks east, so that x, to the right of who sees the front, looks south; 20 µT north, 45 µT down.
        let level = LevelReading::of([-20.0, -45.0, 0.0], [0.0, 9.81, 0.0]).unwrap();
        assert_eq!((level.horizontal_ut, level.vertical_ut), (20.0, -45.0));
        assert_eq!(level.heading, Some([1.0, 0.0]));
    }

    #[test]
    fn free_fall_and_nonsense_give_nothing_and_a_vertical_field_no_heading() {
        assert_eq!(LevelReading::of([1.0, 2.0, 3.0], [0.1, 0.2, 0.3]), None);
        assert_eq!(LevelReading::of([1.0, 2.0, 3.0], [f32::NAN; 3]), None);
        let level = LevelReading::of([0.0, 0.0, -48.0], [0.0, 0.0, 9.8]).unwrap();
        assert_eq!((level.horizontal_ut, level.vertical_ut, level.heading), (0.0, -48.0, None));
    }

    #[test]
    fn a_factor_by_hand() {
        // 0.3 Hz: τ = 0.5305 s; 0.08 / 0.6105 = 0.1310.
        assert!((low_pass_factor(0.3, 0.08) - 0.131_04).abs() < 1e-4);
    }
}
