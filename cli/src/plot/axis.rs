//! Scales and ticks.

/// A linear map from values to coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// Maps `low` to the coordinate `from` and `high` to `to`; an empty or unknown range becomes one of width 1.
    pub fn new(low: f64, high: f64, from: f64, to: f64) -> Self {
        let low = if low.is_finite() { low } else { 0.0 };
        let high = if high.is_finite() && high > low { high } else { low + 1.0 };
        Self { low, high, from, to }
    }

    /// As [`Scale::new`], widened to whole ticks, of which there are about `n`.
    pub fn rounded(low: f64, high: f64, n: usize, from: f64, to: f64) -> Self {
        let Self { low, high, .. } = Self::new(low, high, from, to);
        let step = tick_step(high - low, n);
        Self { low: (low / step).floor() * step, high: (high / step).ceil() * step, from, to }
    }

    /// The coordinate of `value`.
    pub fn at(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * (value - self.low) / (self.high - self.low)
    }

    /// The greatest value of the range.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// About `n` round values within the range, with their texts.
    pub fn ticks(&self, n: usize) -> Vec<(f64, String)> {
        let step = tick_step(self.high - self.low, n);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let first = (self.low / step - 1e-9).ceil();
        let last = (self.high / step + 1e-9).floor();
        let count = (last - first).clamp(0.0, 1_000.0) as usize;
        (0..=count)
            .map(|k| (first + k as f64) * step)
            // Without the sign of a negative zero.
            .map(|value| (value, format!("{:.decimals$}", value + 0.0)))
            .collect()
    }
}

/// 1, 2 or 5 times a power of ten that divides `range` into about `n` parts.
fn tick_step(range: f64, n: usize) -> f64 {
    let rough = (range / n.max(1) as f64).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|m| m * power >= 0.999 * rough);
    step.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: Scale, n: usize) -> Vec<String> {
        scale.ticks(n).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(texts(Scale::new(0.0, 1.0, 0.0, 1.0), 5), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(Scale::new(-3.0, 7.0, 0.0, 1.0), 5), ["-2", "0", "2", "4", "6"]);
        assert_eq!(texts(Scale::rounded(0.3, 41.0, 4, 0.0, 1.0), 4), ["0", "20", "40", "60"]);
        assert_eq!(texts(Scale::new(0.0, 2500.0, 0.0, 1.0), 5), ["0", "500", "1000", "1500", "2000", "2500"]);
    }

    #[test]
    fn no_range_is_no_division_by_zero() {
        for (low, high) in [(2.0, 2.0), (f64::NAN, f64::NAN), (f64::INFINITY, f64::NEG_INFINITY), (5.0, 1.0)]
        {
            let scale = Scale::rounded(low, high, 5, 0.0, 100.0);
            assert!(scale.at(3.0).is_finite() && !scale.ticks(5).is_empty(), "{low} to {high}");
        }
        let upward = Scale::new(0.0, 10.0, 100.0, 0.0);
        assert_eq!((upward.at(0.0), upward.at(2.5)), (100.0, 75.0));
    }
}
