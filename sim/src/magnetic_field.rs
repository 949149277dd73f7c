//! The magnetic field of a floor: the Earth's, and that of steel as dipoles and bars.
//!
//! Both are exact solutions of magnetostatics in free space, so that curl and divergence vanish outside the sources
//! and neighbouring places have the field that physics gives them.

mod movable;
mod steel;

pub use movable::{FieldOfDay, MovableParams};
pub use steel::{SteelParams, steel};

use fieldwalk::geometry::Point2;

use crate::vector::{Vector3, add, dot, scale, subtract};

/// The Earth's field where there is no steel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarthField {
    /// Horizontal component, in µT; default 30.
    pub horizontal_ut: f64,
    /// Component downward, in µT; default 40: a northern middle latitude.
    pub down_ut: f64,
    /// Heading of magnetic north in the floor frame, clockwise from +y, in radians; default 0.35 (the plan's own turn
    /// from north and the declination together).
    pub north_heading_rad: f64,
}

impl Default for EarthField {
    fn default() -> Self {
        Self { horizontal_ut: 30.0, down_ut: 40.0, north_heading_rad: 0.35 }
    }
}

impl EarthField {
    /// The field along the floor's x, along its y and upward, in µT.
    pub fn field_ut(&self) -> [f64; 3] {
        let north = Point2::from_polar(self.horizontal_ut, self.north_heading_rad);
        [north.x_m, north.y_m, -self.down_ut]
    }
}

/// A magnetised body. Places are x, y and height over the floor, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A body small beside its distance.
    Dipole {
        /// Where.
        place_m: [f64; 3],
        /// µ₀/4π times its moment, in µT·m³.
        moment_ut_m3: [f64; 3],
    },
    /// A long thin body, magnetised along itself: two opposite poles.
    Bar {
        /// The end that field lines leave.
        north_pole_m: [f64; 3],
        /// The end that they enter.
        south_pole_m: [f64; 3],
        /// µ₀/4π times the strength of either pole, in µT·m².
        pole_ut_m2: f64,
    },
}

impl Source {
    /// The same body `height_m` higher.
    #[must_use]
    pub fn raised(self, height_m: f64) -> Self {
        let up = |[x_m, y_m, z_m]: [f64; 3]| [x_m, y_m, z_m + height_m];
        match self {
            Self::Dipole { place_m, moment_ut_m3 } => Self::Dipole { place_m: up(place_m), moment_ut_m3 },
            Self::Bar { north_pole_m, south_pole_m, pole_ut_m2 } => {
                Self::Bar { north_pole_m: up(north_pole_m), south_pole_m: up(south_pole_m), pole_ut_m2 }
            }
        }
    }

    /// The source's field at `place_m`, in µT; it grows without bound at a dipole or pole itself.
    pub fn field_ut(&self, place_m: [f64; 3]) -> [f64; 3] {
        let pole = |at_m: Vector3| {
            let r = subtract(place_m, at_m);
            let square = dot(r, r);
            scale(r, 1.0 / (square * square.sqrt()))
        };
        match self {
            Source::Dipole { place_m: at_m, moment_ut_m3 } => {
                let r = subtract(place_m, *at_m);
                let square = dot(r, r);
                let along = scale(r, 3.0 * dot(r, *moment_ut_m3) / square);
                scale(subtract(along, *moment_ut_m3), 1.0 / (square * square.sqrt()))
            }
            Source::Bar { north_pole_m, south_pole_m, pole_ut_m2 } => {
                scale(subtract(pole(*north_pole_m), pole(*south_pole_m)), *pole_ut_m2)
            }
        }
    }
}

/// The field of a floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MagneticField {
    /// The Earth's part.
    pub earth: EarthField,
    /// The steel's part.
    pub sources: Vec<Source>,
}

impl MagneticField {
    /// The field at `place_m` (x, y, height over the floor): along the floor's x, along its y and upward, in µT.
    pub fn field_ut(&self, place_m: [f64; 3]) -> [f64; 3] {
        self.sources.iter().fold(self.earth.field_ut(), |sum, source| add(sum, source.field_ut(place_m)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::Building;
    use crate::noise::Noise;
    use crate::vector::norm;

    #[test]
    fn the_earths_field_points_north_and_down() {
        let earth = EarthField { north_heading_rad: 0.0, ..EarthField::default() };
        assert_eq!(earth.field_ut(), [0.0, 30.0, -40.0]);
        assert_eq!(norm(EarthField::default().field_ut()), 50.0);
    }

    #[test]
    fn a_dipole_by_hand_and_a_short_bar_like_it() {
        let dipole = Source::Dipole { place_m: [0.0; 3], moment_ut_m3: [0.0, 0.0, 4.0] };
        // On the axis 2m/r³, beside it −m/r³.
        assert_eq!(dipole.field_ut([0.0, 0.0, 2.0]), [0.0, 0.0, 1.0]);
        assert_eq!(dipole.field_ut([2.0, 0.0, 0.0]), [0.0, 0.0, -0.5]);
        let (north_pole_m, south_pole_m) = ([0.0, 0.0, 0.01], [0.0, 0.0, -0.01]);
        let bar = Source::Bar { north_pole_m, south_pole_m, pole_ut_m2: 200.0 };
        let place = [1.0, -0.7, 0.4];
        assert!(norm(subtract(bar.field_ut(place), dipole.field_ut(place))) < 1e-3);
    }

    /// ∂B_c/∂x_d by central differences, in µT/m.
    fn gradient(field: &MagneticField, place: Vector3) -> [[f64; 3]; 3] {
        let h = 1e-4;
        let along = [0, 1, 2].map(|d| {
            let step = |sign: f64| [0, 1, 2].map(|c| place[c] + if c == d { sign * h } else { 0.0 });
            scale(subtract(field.field_ut(step(1.0)), field.field_ut(step(-1.0))), 0.5 / h)
        });
        [0, 1, 2].map(|c| [0, 1, 2].map(|d| along[d][c]))
    }

    #[test]
    fn curl_and_divergence_vanish_in_the_corridors() {
        let office = Building::office();
        let field = MagneticField {
            earth: EarthField::default(),
            sources: steel(&office, &EarthField::default(), &SteelParams::default(), 1),
        };
        let mut noise = Noise::new(1, "places", 0);
        let (mut steepest, mut worst) = (0.0f64, 0.0f64);
        for k in 0..60 {
            let corridor = office.corridors[k % office.corridors.len()];
            let p = corridor.line.a.lerp(corridor.line.b, noise.unit());
            let g = gradient(&field, [p.x_m, p.y_m, noise.within(0.8, 1.6)]);
            let divergence = g[0][0] + g[1][1] + g[2][2];
            let curl = [g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]];
            steepest = g.iter().map(|row| norm(*row)).fold(steepest, f64::max);
            worst = worst.max(divergence.abs()).max(norm(curl));
        }
        assert!(steepest > 5.0, "steepest gradient {steepest} µT/m");
        assert!(worst < 1e-4, "divergence or curl {worst} µT/m");
    }
}
