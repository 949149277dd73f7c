//! What a field looks like from a device whose vertical is known.

use serde::{Deserialize, Serialize};

/// A magnetic field in a frame whose z is up: x to the right, y forward (or north), in µT.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LevelField {
    /// Components x, y, z, in µT.
    pub field_ut: [f32; 3],
}

impl LevelField {
    /// `|B|`, in µT: needs no attitude at all.
    pub fn strength_ut(&self) -> f32 {
        let [x, y, z] = self.field_ut;
        (x * x + y * y + z * z).sqrt()
    }

    /// `B_v`, upward, in µT.
    ///
    /// # Source
    /// Kwak 2018, §3.2: `B_v = B·ĝ_up`.
    pub fn vertical_ut(&self) -> f32 {
        self.field_ut[2]
    }

    /// `B_h = sqrt(|B|² − B_v²)`, in µT.
    ///
    /// # Source
    /// Kwak 2018, §3.2.
    pub fn horizontal_ut(&self) -> f32 {
        let [x, y, _] = self.field_ut;
        (x * x + y * y).sqrt()
    }

    /// Direction of the horizontal part, clockwise from y, in radians.
    pub fn heading_rad(&self) -> f32 {
        libm::atan2f(self.field_ut[0], self.field_ut[1])
    }

    /// Angle from the upward vertical, in [0, π] radians; 0 for no field.
    ///
    /// # Source
    /// Mass-centred 2019, Fig. 1.
    pub fn polar_rad(&self) -> f32 {
        libm::atan2f(self.horizontal_ut(), self.vertical_ut())
    }
}

/// What one reading says without a heading: what histories are made of.
///
/// # Source
/// Kwak 2018, §3.2: `|B|` needs no attitude, `B_h` and `B_v` need gravity alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldRead {
    /// `|B|`, in µT.
    pub strength_ut: f32,
    /// `B_h` and `B_v`, in µT; nothing where only the strength is known.
    pub horizontal_vertical_ut: Option<[f32; 2]>,
}

impl FieldRead {
    /// All three of a field whose vertical is known.
    pub fn of(field: &LevelField) -> Self {
        Self {
            strength_ut: field.strength_ut(),
            horizontal_vertical_ut: Some([field.horizontal_ut(), field.vertical_ut()]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_by_hand() {
        let field = LevelField { field_ut: [3.0, 4.0, -12.0] };
        assert_eq!(field.strength_ut(), 13.0);
        assert_eq!(field.horizontal_ut(), 5.0);
        assert_eq!(field.vertical_ut(), -12.0);
        assert!((field.heading_rad() - 0.643_501_1).abs() < 1e-6);
        // atan2(5, −12) = π − atan(5/12)
        assert!((field.polar_rad() - (core::f32::consts::PI - 0.394_791_1)).abs() < 1e-6);
    }
}
