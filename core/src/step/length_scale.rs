//! A walker's own scale on a step-length model, learnt from distances that become known.

use serde::{Deserialize, Serialize};

/// Parameters of [`LengthScaleEstimator`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LengthScaleParams {
    /// Standard deviation of walkers' scales about 1; default 0.08 (a fitted model leaves about 0.05, the static one
    /// 0.12).
    pub walker_sd: f32,
    /// Standard deviation of one step's length over its mean; default 0.08.
    pub step_sd: f32,
    /// Standard deviation along the way of a known place, in metres; default 0.7 (a waypoint tapped while walking).
    pub place_sd_m: f32,
    /// Degrees of freedom of the errors: a lower number forgives more outliers; default 4.
    pub degrees_of_freedom: f32,
}

impl Default for LengthScaleParams {
    fn default() -> Self {
        Self { walker_sd: 0.08, step_sd: 0.08, place_sd_m: 0.7, degrees_of_freedom: 4.0 }
    }
}

/// Learns by how much a walker's steps are longer than a model says.
///
/// A Kalman filter on one number. What is far off what is expected counts less, as under Student's t: a segment on which
/// somebody turned back, or a wrong fix, must not spoil what was learnt.
///
/// # Source
/// Ours; WILA 2016, Eq. 4 is its limit for one exact distance and a walker of whom nothing is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LengthScaleEstimator {
    params: LengthScaleParams,
    scale: f32,
    variance: f32,
}

/// Bounds of what a walker's scale can be.
const SCALES: core::ops::RangeInclusive<f32> = 0.5..=1.6;

impl LengthScaleEstimator {
    /// Of a walker of whom nothing is known.
    pub fn new(params: LengthScaleParams) -> Self {
        Self { params, scale: 1.0, variance: params.walker_sd * params.walker_sd }
    }

    /// Learns that the walker went `known_m` in `n_steps` steps of which the model says `modelled_m`.
    ///
    /// What is not finite and positive is passed over.
    pub fn push(&mut self, known_m: f32, modelled_m: f32, n_steps: u32) {
        let observed = known_m / modelled_m;
        if !(known_m > 0.0 && modelled_m > 0.0 && observed.is_finite()) || n_steps == 0 {
            return;
        }
        let LengthScaleParams { step_sd, place_sd_m, degrees_of_freedom, .. } = self.params;
        let places = place_sd_m / modelled_m;
        let variance = 2.0 * places * places + step_sd * step_sd / n_steps as f32;
        let innovation = observed - self.scale;
        let surprise = innovation * innovation / (self.variance + variance);
        let weight = (degrees_of_freedom + 1.0) / (degrees_of_freedom + surprise);
        let gain = self.variance / (self.variance + variance / weight);
        self.scale = (self.scale + gain * innovation).clamp(*SCALES.start(), *SCALES.end());
        self.variance *= 1.0 - gain;
    }

    /// The scale: the walker's step length over the model's.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Its standard deviation.
    pub fn scale_sd(&self) -> f32 {
        self.variance.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(walker_sd: f32) -> LengthScaleParams {
        let degrees_of_freedom = f32::MAX;
        LengthScaleParams { walker_sd, step_sd: 0.0, place_sd_m: 0.1, degrees_of_freedom }
    }

    #[test]
    fn one_segment_by_hand() {
        // Variances: 0.1² of walkers, 2·(0.1/10)² of the places: gain 0.01/0.0102; 1 + gain·0.1.
        let mut estimator = LengthScaleEstimator::new(exact(0.1));
        estimator.push(11.0, 10.0, 15);
        assert!((estimator.scale() - (1.0 + 0.1 * 0.01 / 0.0102)).abs() < 1e-6, "{}", estimator.scale());
        let expected_sd = (0.01f32 * (1.0 - 0.01 / 0.0102)).sqrt();
        assert!((estimator.scale_sd() - expected_sd).abs() < 1e-6);
    }

    #[test]
    fn it_comes_to_the_walkers_scale_in_spite_of_an_outlier() {
        let mut estimator = LengthScaleEstimator::new(LengthScaleParams::default());
        for k in 0..20 {
            let known_m = if k == 7 { 1.0 } else { 0.88 * 12.0 + [0.6, -0.6][k % 2] };
            estimator.push(known_m, 12.0, 18);
        }
        assert!((estimator.scale() - 0.88).abs() < 0.02, "{}", estimator.scale());
        assert!(estimator.scale_sd() < 0.03);
    }

    #[test]
    fn nonsense_teaches_nothing() {
        let mut estimator = LengthScaleEstimator::new(LengthScaleParams::default());
        let before = estimator;
        for (known_m, modelled_m, n) in [
            (f32::NAN, 5.0, 5),
            (5.0, f32::NAN, 5),
            (5.0, 0.0, 5),
            (-5.0, 5.0, 5),
            (5.0, 5.0, 0),
            (f32::MAX, 1e-30, 5),
        ] {
            estimator.push(known_m, modelled_m, n);
        }
        assert_eq!(estimator, before);
        for _ in 0..100 {
            estimator.push(1e9, 1.0, 1);
        }
        assert!(SCALES.contains(&estimator.scale()));
    }
}
