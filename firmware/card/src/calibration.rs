//! Hard and soft iron undone.

/// What turns a raw field into one that is as strong in every direction: `matrix · (raw − offset)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Hard iron, in µT, device frame.
    pub offset_ut: [f32; 3],
    /// Soft iron undone: xx, yy, zz, xy, xz, yz of a symmetric matrix of determinant 1.
    pub matrix: [f32; 6],
    /// Strength of the calibrated field where it was found, in µT.
    pub strength_ut: f32,
}

impl Calibration {
    /// Numbers that it consists of.
    pub const N: usize = 10;

    /// The calibrated field of a raw one, both in µT.
    pub fn apply(&self, raw_ut: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = [0, 1, 2].map(|c| raw_ut[c] - self.offset_ut[c]);
        let [xx, yy, zz, xy, xz, yz] = self.matrix;
        [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
    }

    /// Its numbers in a row.
    pub fn to_array(self) -> [f32; Self::N] {
        let ([ox, oy, oz], [xx, yy, zz, xy, xz, yz]) = (self.offset_ut, self.matrix);
        [ox, oy, oz, xx, yy, zz, xy, xz, yz, self.strength_ut]
    }

    /// The calibration of these numbers; nothing where they are not plausible: an offset beyond the sensor's 1200 µT, a
    /// matrix that is not near the unit matrix, a strength that the Earth has nowhere.
    pub fn from_array(numbers: [f32; Self::N]) -> Option<Self> {
        let [ox, oy, oz, xx, yy, zz, xy, xz, yz, strength_ut] = numbers;
        let is_plausible = [ox, oy, oz].iter().all(|c| c.abs() <= 1_200.0)
            && [xx, yy, zz].iter().all(|c| (0.5..=2.0).contains(c))
            && [xy, xz, yz].iter().all(|c| c.abs() <= 0.5)
            && (10.0..=150.0).contains(&strength_ut);
        is_plausible.then_some(Self {
            offset_ut: [ox, oy, oz],
            matrix: [xx, yy, zz, xy, xz, yz],
            strength_ut,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_by_hand() {
        let calibration = Calibration {
            offset_ut: [10.0, -20.0, 30.0],
            matrix: [1.0, 2.0, 0.5, 0.1, 0.0, -0.2],
            strength_ut: 48.0,
        };
        // (1, 2, 4) off the offset: 1 + 0.2, 0.1 + 4 − 0.8, −0.4 + 2.
        let field_ut = calibration.apply([11.0, -18.0, 34.0]);
        for (got, expected) in field_ut.into_iter().zip([1.2, 3.3, 1.6]) {
            assert!((got - expected).abs() < 1e-6, "{field_ut:?}");
        }
        assert_eq!(Calibration::from_array(calibration.to_array()), Some(calibration));
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let good =
            Calibration { offset_ut: [0.0; 3], matrix: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], strength_ut: 48.0 };
        for k in 0..Calibration::N {
            for bad in [f32::NAN, f32::INFINITY, -2_000.0] {
                let mut numbers = good.to_array();
                numbers[k] = bad;
                assert_eq!(Calibration::from_array(numbers), None, "{k} {bad}");
            }
        }
    }
}
