//! Particles: structure-of-arrays state, resampling, and the estimate that they stand for.

mod estimate;
mod replenish;
mod resampling;
mod spawning;

pub use estimate::{Centre, CloudEstimate, EstimateScratch};
pub use replenish::{ReplenishParams, ReplenishScratch};
pub use resampling::{ResampleScratch, Resampling};
pub use spawning::SpawningParams;

use serde::{Deserialize, Serialize};

/// The particles' state, one array a quantity; every array in use has the same length.
///
/// Arrays that a system does not use stay empty.
///
/// # Source
/// Kwak 2018, Eq. 2: place, last heading, weight, count of the BLE filter and history of a particle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Particles {
    /// Position along the floor's x, in metres.
    pub x_m: Vec<f32>,
    /// Position along the floor's y, in metres.
    pub y_m: Vec<f32>,
    /// Sine of the walking direction at the latest move (its component along x).
    pub heading_sin: Vec<f32>,
    /// Cosine of the walking direction at the latest move (its component along y).
    pub heading_cos: Vec<f32>,
    /// Walking direction minus level-frame heading of the device, in radians.
    pub heading_offset_rad: Vec<f32>,
    /// This walker's steps over the length model's.
    pub length_scale: Vec<f32>,
    /// Gene `p_a`, metres per Hz (Mass-centred 2019, Eq. 13).
    pub gene_a_m: Vec<f32>,
    /// Gene `p_b`, in metres.
    pub gene_b_m: Vec<f32>,
    /// Mean of the magnetometer's bias in the forward frame, in µT.
    pub bias_x_ut: Vec<f32>,
    /// As `bias_x_ut`, along the forward axis.
    pub bias_y_ut: Vec<f32>,
    /// As `bias_x_ut`, upward.
    pub bias_z_ut: Vec<f32>,
    /// Variance of each component of the bias, in µT².
    pub bias_variance_ut2: Vec<f32>,
    /// Latest strength read from the map, in µT; NaN where there was none.
    #[serde(deserialize_with = "null_as_nan")]
    pub strength_ut: Vec<f32>,
    /// The last terms of the mass-centred sum, newest first, in blocks of the window's length.
    #[serde(deserialize_with = "null_as_nan")]
    pub delta_errors_ut: Vec<f32>,
    /// Latest direction of the map's field, horizontal part, clockwise from the floor's y, in radians; NaN where there
    /// was none.
    #[serde(default, deserialize_with = "null_as_nan")]
    pub field_heading_rad: Vec<f32>,
    /// Latest angle of the map's field from the upward vertical, in radians; NaN where there was none.
    #[serde(default, deserialize_with = "null_as_nan")]
    pub polar_rad: Vec<f32>,
    /// The last terms of the mass-centred sum over azimuths, newest first, in blocks of the window's length.
    #[serde(default)]
    pub azimuth_errors_rad: Vec<f32>,
    /// As `azimuth_errors_rad`, over polar angles.
    #[serde(default)]
    pub polar_errors_rad: Vec<f32>,
    /// What the map said along the particle's way, in µT: a block of the history's length, plane by plane.
    pub history_ut: Vec<f32>,
    /// `Σ e` and `Σ e²` for each component of the history, with `e` what the map said less what was read, in µT and µT²:
    /// of the reads whose components are known, in blocks of two a component.
    #[serde(default)]
    pub history_sums: Vec<f32>,
    /// What the history added to the log weight at the last round.
    pub history_log_weight: Vec<f32>,
    /// Rounds in a row that the particle has been far from the matched radio fingerprint.
    pub n_rounds_outside: Vec<f32>,
    /// Strengths read from the map at the latest places, newest first, in blocks of the window's length; NaN where there
    /// was none.
    #[serde(default, deserialize_with = "null_as_nan")]
    pub recent_strengths_ut: Vec<f32>,
    /// Natural logarithm of the weight; the largest is 0 after normalisation, and −∞ that of the dead.
    #[serde(deserialize_with = "null_as_dead")]
    pub log_weight: Vec<f32>,
}

/// What an array belongs to: a recipe uses all arrays of a part, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Every system.
    Always,
    /// A direction by gyroscope, once there was a first step.
    Gyroscope,
    /// A length model that is scaled.
    ScaledLength,
    /// A length by genes.
    GeneticLength,
    /// The field vector's likelihood.
    FieldVector,
    /// The mass-centred weight.
    MassCentered,
    /// The mass-centred weight: as many values a particle as its window has steps.
    MassCenteredWindow,
    /// The mass-centred weight on the field's direction.
    FieldDirection,
    /// The same: as many values a particle as its window has steps.
    FieldDirectionWindow,
    /// The weight by histories.
    History,
    /// The weight by histories: as many values a particle as its history has.
    HistoryWindow,
    /// Histories that are compared read by read: two sums a component.
    HistorySums,
    /// The filter of a start by radio fingerprints.
    BleFilter,
    /// The three factors: as many values a particle as their window has steps.
    ThreeFactorsWindow,
}

/// The arrays of `Particles` with their parts, borrowed as the argument is.
macro_rules! arrays {
    ($particles:expr) => {
        arrays!($particles; {
            x_m: Always,
            y_m: Always,
            heading_sin: Always,
            heading_cos: Always,
            heading_offset_rad: Gyroscope,
            length_scale: ScaledLength,
            gene_a_m: GeneticLength,
            gene_b_m: GeneticLength,
            bias_x_ut: FieldVector,
            bias_y_ut: FieldVector,
            bias_z_ut: FieldVector,
            bias_variance_ut2: FieldVector,
            strength_ut: MassCentered,
            delta_errors_ut: MassCenteredWindow,
            field_heading_rad: FieldDirection,
            polar_rad: FieldDirection,
            azimuth_errors_rad: FieldDirectionWindow,
            polar_errors_rad: FieldDirectionWindow,
            history_ut: HistoryWindow,
            history_sums: HistorySums,
            history_log_weight: History,
            n_rounds_outside: BleFilter,
            recent_strengths_ut: ThreeFactorsWindow,
            log_weight: Always,
        })
    };
    ($particles:expr; { $($array:ident: $part:ident,)* }) => {{
        let Particles { $($array),* } = $particles;
        [$((Part::$part, $array)),*]
    }};
}

/// JSON has no NaN: it writes null.
fn null_as_nan<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
    null_as(f32::NAN, deserializer)
}

/// Nor has it −∞.
fn null_as_dead<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
    null_as(f32::NEG_INFINITY, deserializer)
}

/// Formats for machines write every number as it is.
fn null_as<'de, D: serde::Deserializer<'de>>(null: f32, deserializer: D) -> Result<Vec<f32>, D::Error> {
    if !deserializer.is_human_readable() {
        return Vec::deserialize(deserializer);
    }
    let values = Vec::<Option<f32>>::deserialize(deserializer)?;
    Ok(values.into_iter().map(|value| value.unwrap_or(null)).collect())
}

impl Particles {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x_m.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.x_m.is_empty()
    }

    /// Every array with what it belongs to.
    pub(crate) fn arrays(&self) -> impl Iterator<Item = (Part, &Vec<f32>)> {
        arrays!(self).into_iter()
    }

    fn arrays_mut(&mut self) -> impl Iterator<Item = (Part, &mut Vec<f32>)> {
        arrays!(self).into_iter()
    }

    /// Makes of each pair the first particle a copy of the second in all that they remember, array by array; who is copied
    /// is no pair's first.
    pub(crate) fn inherit(&mut self, pairs: impl Iterator<Item = [u32; 2]> + Clone) {
        let n = self.len().max(1);
        for (_, array) in self.arrays_mut() {
            let block = array.len() / n;
            if block == 0 {
                continue;
            }
            for [child, parent] in pairs.clone().map(|pair| pair.map(|i| i as usize * block)) {
                if child.max(parent) + block <= array.len() {
                    array.copy_within(parent..parent + block, child);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newcomer_inherits_all() {
        let mut particles = Particles {
            x_m: vec![0.0, 1.0, 2.0],
            y_m: vec![0.0; 3],
            delta_errors_ut: (0u8..9).map(f32::from).collect(),
            log_weight: vec![-1.0, -2.0, -3.0],
            ..Particles::default()
        };
        particles.inherit([[0, 2]].into_iter());
        assert_eq!(particles.x_m, [2.0, 1.0, 2.0]);
        assert_eq!(particles.delta_errors_ut, [6.0, 7.0, 8.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert_eq!(particles.log_weight, [-3.0, -2.0, -3.0]);
        particles.inherit([[1, 3]].into_iter());
        assert_eq!(particles.x_m[1], 1.0);
    }
}
