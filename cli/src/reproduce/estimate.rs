//! A measured value with its 95 % interval.
//!
//! Seeds are independent: each makes a building, a walker, a phone and a filter anew. So intervals are over seeds, never
//! over the fixes of one walk, which are alike.

use fieldwalk::metrics::quantile;
use fieldwalk::random::CounterRng;
use rand::RngExt;

/// Samples drawn for a bootstrap.
const N_BOOTSTRAP: u64 = 400;

/// A value and the interval in which it lies with 95 % confidence.
///
/// All are NaN where there is nothing to estimate from, and the interval where there is but one seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The best single number.
    pub value: f64,
    /// The interval's lower end.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
}

impl Estimate {
    /// A value that chance has no part in.
    pub fn exact(value: f64) -> Self {
        Self { value, low: value, high: value }
    }

    /// The mean of one value a seed, with Student's interval.
    pub fn mean(per_seed: &[f64]) -> Self {
        let n = per_seed.len() as f64;
        let value = per_seed.iter().sum::<f64>() / n;
        let square = per_seed.iter().map(|x| (x - value) * (x - value)).sum::<f64>();
        let half = student_975(per_seed.len()) * (square / (n - 1.0) / n).sqrt();
        Self { value, low: value - half, high: value + half }
    }

    /// The mean of `more − less`, seed by seed, with Student's interval: positive where `more` is the greater.
    pub fn paired(less: &[f64], more: &[f64]) -> Self {
        if less.len() != more.len() {
            return Self::exact(f64::NAN);
        }
        Self::mean(&less.iter().zip(more).map(|(less, more)| more - less).collect::<Vec<_>>())
    }

    /// What `statistic` says of all seeds' samples together, with the interval of a bootstrap over seeds.
    pub fn pooled<S>(per_seed: &[S], statistic: impl Fn(&[&S]) -> f64) -> Self {
        let all: Vec<&S> = per_seed.iter().collect();
        let value = if all.is_empty() { f64::NAN } else { statistic(&all) };
        if all.len() < 2 {
            return Self { value, low: f64::NAN, high: f64::NAN };
        }
        let mut drawn: Vec<f64> = (0..N_BOOTSTRAP)
            .map(|k| {
                let mut rng = CounterRng::new(k, 0x626f_6f74);
                let sample: Vec<&S> = all.iter().map(|_| all[rng.random_range(0..all.len())]).collect();
                statistic(&sample)
            })
            .collect();
        drawn.sort_by(f64::total_cmp);
        Self { value, low: quantile(&drawn, 0.025), high: quantile(&drawn, 0.975) }
    }

    /// The `p`-quantile of all seeds' values together, with the interval of a bootstrap over seeds.
    pub fn pooled_quantile(per_seed: &[Vec<f64>], p: f64) -> Self {
        Self::pooled(per_seed, |seeds| quantile_of(seeds.iter().flat_map(|values| values.iter().copied()), p))
    }
}

/// The `p`-quantile of `values` in any order; NaN when there are none.
pub fn quantile_of(values: impl IntoIterator<Item = f64>, p: f64) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, p)
}

/// The mean of `values`; NaN when there are none.
pub fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The 0.975 quantile of Student's t for a mean of `n` values; NaN below two.
fn student_975(n: usize) -> f64 {
    /// For 1, 2, … 20 degrees of freedom.
    const TABLE: [f64; 20] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145,
        2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
    ];
    let Some(k) = n.checked_sub(2) else { return f64::NAN };
    let freedom = (n - 1) as f64;
    // Fisher's expansion about the normal quantile: within 1e-3 beyond the table.
    TABLE.get(k).copied().unwrap_or(1.959_964 + 2.372_3 / freedom + 2.822_5 / (freedom * freedom))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_with_students_interval_by_hand() {
        // Mean 2, standard deviation 1, standard error 1/√3; t(2) = 4.303.
        let estimate = Estimate::mean(&[1.0, 2.0, 3.0]);
        assert!((estimate.value - 2.0).abs() < 1e-12);
        assert!((estimate.high - (2.0 + 4.303 / 3f64.sqrt())).abs() < 1e-9, "{estimate:?}");
        assert!((estimate.low + estimate.high - 4.0).abs() < 1e-9);
        let single = Estimate::mean(&[5.0]);
        assert!(single.value == 5.0 && single.low.is_nan() && single.high.is_nan());
        assert!(Estimate::mean(&[]).value.is_nan());
        // Tables: 2.042 for 30 degrees of freedom, 1.980 for 120.
        assert!((student_975(31) - 2.042).abs() < 1e-3 && (student_975(121) - 1.980).abs() < 1e-3);
    }

    #[test]
    fn pairing_takes_out_what_seeds_have_in_common() {
        let (less, more) = ([1.0, 10.0, 100.0], [1.5, 10.6, 100.4]);
        let paired = Estimate::paired(&less, &more);
        assert!((paired.value - 0.5).abs() < 1e-9 && paired.low > 0.0, "{paired:?}");
        assert!(Estimate::mean(&more).low < Estimate::mean(&less).high);
        assert!(Estimate::paired(&less, &more[..2]).value.is_nan());
    }

    #[test]
    fn quantiles_pool_all_seeds() {
        let seeds: Vec<Vec<f64>> =
            (0..10).map(|s| (0..10).map(|k| f64::from(s + 10 * k)).collect()).collect();
        let median = Estimate::pooled_quantile(&seeds, 0.5);
        assert!((median.value - 49.5).abs() < 1e-9, "{median:?}");
        assert!(median.low < median.value && median.value < median.high, "{median:?}");
        assert_eq!(median, Estimate::pooled_quantile(&seeds, 0.5));
        assert!(Estimate::pooled_quantile(&[], 0.5).value.is_nan());
        assert!(Estimate::pooled_quantile(&seeds[..1], 0.5).low.is_nan());
    }
}
