//! Particles: structure-of-arrays state, resampling, and the estimate that they stand for.

mod estimate;
mod replenish;
mod spawning;

pub use estimate::{CloudEstimate, EstimateScratch};
pub use replenish::{ReplenishParams, ReplenishScratch};
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
    /// What the map said along the particle's way, in µT: a block of the history's length, plane by plane.
    pub history_ut: Vec<f32>,
    /// What the history added to the log weight at the last round.
    pub history_log_weight: Vec<f32>,
    /// Strengths read from the map at the latest places, newest first, in blocks of the window's length; NaN where there
    /// was none.
    #[serde(default, deserialize_with = "null_as_nan")]
    pub recent_strengths_ut: Vec<f32>,
    /// Natural logarithm of the weight; the largest is 0 after normalisation.
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
    /// The weight by histories.
    History,
    /// The weight by histories: as many values a particle as its history has.
    HistoryWindow,
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
            history_ut: HistoryWindow,
            history_log_weight: History,
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
    let values = Vec::<Option<f32>>::deserialize(deserializer)?;
    Ok(values.into_iter().map(|value| value.unwrap_or(f32::NAN)).collect())
}

/// Memory that one step needs and the next does not remember.
#[derive(Clone, Debug, Default)]
pub struct ResampleScratch {
    ancestors: Vec<u32>,
    gathered: Vec<f32>,
}

impl ResampleScratch {
    /// Room for `n` particles with histories of `window` terms.
    pub fn with_capacity(n: usize, window: usize) -> Self {
        Self { ancestors: Vec::with_capacity(n), gathered: Vec::with_capacity(n * window.max(1)) }
    }
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

    /// Makes particle `child` a copy of `parent` in all that it remembers.
    pub(crate) fn inherit(&mut self, child: usize, parent: usize) {
        let n = self.len();
        if child >= n || parent >= n {
            return;
        }
        for (_, array) in self.arrays_mut() {
            let block = array.len() / n;
            array.copy_within(parent * block..(parent + 1) * block, child * block);
        }
    }

    /// Replaces the particles by a systematic sample of `weights` (not necessarily normalised), offset `u` in [0, 1).
    ///
    /// All log weights become 0. Does nothing when the weights sum to zero.
    pub fn resample_systematic(&mut self, weights: &[f32], u: f32, scratch: &mut ResampleScratch) {
        let n = self.len();
        let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
        if n == 0 || weights.len() != n || !(total > 0.0 && total.is_finite()) {
            return;
        }
        let step = total / n as f64;
        scratch.ancestors.clear();
        let (mut ancestor, mut reached) = (0, f64::from(weights[0]));
        for k in 0..n {
            let target = step * (k as f64 + f64::from(u));
            while reached < target && ancestor + 1 < n {
                ancestor += 1;
                reached += f64::from(weights[ancestor]);
            }
            scratch.ancestors.push(ancestor as u32);
        }
        for (_, array) in self.arrays_mut() {
            gather(array, n, scratch);
        }
        self.log_weight.fill(0.0);
    }
}

fn gather(array: &mut [f32], n: usize, scratch: &mut ResampleScratch) {
    let block = array.len() / n;
    match block {
        0 => return,
        1 => {
            scratch.gathered.clear();
            scratch.gathered.extend(scratch.ancestors.iter().map(|&a| array[a as usize]));
        }
        _ => {
            scratch.gathered.clear();
            for &a in &scratch.ancestors {
                scratch.gathered.extend_from_slice(&array[a as usize * block..(a as usize + 1) * block]);
            }
        }
    }
    array.copy_from_slice(&scratch.gathered);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cloud(n: usize) -> Particles {
        Particles {
            x_m: (0..n).map(|i| i as f32).collect(),
            y_m: vec![0.0; n],
            delta_errors_ut: (0..3 * n).map(|i| i as f32).collect(),
            log_weight: vec![-1.0; n],
            ..Particles::default()
        }
    }

    #[test]
    fn systematic_resampling_by_hand() {
        let mut particles = cloud(4);
        let mut scratch = ResampleScratch::with_capacity(4, 3);
        // Cumulative 0.1, 0.1, 0.6, 1.0 against targets 0.125, 0.375, 0.625, 0.875.
        particles.resample_systematic(&[0.1, 0.0, 0.5, 0.4], 0.5, &mut scratch);
        assert_eq!(particles.x_m, [2.0, 2.0, 3.0, 3.0]);
        assert_eq!(particles.delta_errors_ut[..6], [6.0, 7.0, 8.0, 6.0, 7.0, 8.0]);
        assert_eq!(particles.log_weight, [0.0; 4]);
    }

    #[test]
    fn a_newcomer_inherits_all() {
        let mut particles = cloud(3);
        particles.log_weight = vec![-1.0, -2.0, -3.0];
        particles.inherit(0, 2);
        assert_eq!(particles.x_m, [2.0, 1.0, 2.0]);
        assert_eq!(particles.delta_errors_ut, [6.0, 7.0, 8.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert_eq!(particles.log_weight, [-3.0, -2.0, -3.0]);
        particles.inherit(1, 3);
        assert_eq!(particles.x_m[1], 1.0);
    }

    proptest! {
        #[test]
        fn copies_stay_within_one_of_their_share(
            weights in proptest::collection::vec(0.0f32..1.0, 2..40), u in 0.0f32..1.0,
        ) {
            let n = weights.len();
            let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            prop_assume!(total > 1e-3);
            let mut particles = cloud(n);
            particles.resample_systematic(&weights, u, &mut ResampleScratch::default());
            for (i, &weight) in weights.iter().enumerate() {
                let copies = particles.x_m.iter().filter(|&&x| x == i as f32).count() as f64;
                let share = n as f64 * f64::from(weight) / total;
                prop_assert!((copies - share).abs() <= 1.0 + 1e-4);
            }
        }
    }
}
