//! Cubic splines through given points.

/// A twice continuously differentiable curve through points, by a cubic between each two.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spline {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Second derivatives at the points.
    bend: Vec<f64>,
}

/// What holds at both ends of a spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ends {
    /// The curve is level: something starts from rest and comes to rest.
    Level,
    /// The curve is straight.
    Straight,
}

impl Spline {
    /// The spline through (`x`, `y`); `x` must increase. Beyond its ends the spline keeps its end values.
    pub(crate) fn new(x: Vec<f64>, y: Vec<f64>, ends: Ends) -> Self {
        let n = x.len().min(y.len());
        let mut bend = vec![0.0; n];
        if n < 2 {
            return Self { x, y, bend };
        }
        let slope = |k: usize| (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
        // Thomas's algorithm on the tridiagonal system of the second derivatives.
        let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..n {
            let before = if k > 0 { x[k] - x[k - 1] } else { 0.0 };
            let after = if k + 1 < n { x[k + 1] - x[k] } else { 0.0 };
            let (low, middle, high, value) = match (k == 0, k + 1 == n, ends) {
                (true, _, Ends::Straight) | (_, true, Ends::Straight) => (0.0, 1.0, 0.0, 0.0),
                (true, _, Ends::Level) => (0.0, 2.0 * after, after, 6.0 * slope(k)),
                (_, true, Ends::Level) => (before, 2.0 * before, 0.0, -6.0 * slope(k - 1)),
                _ => (before, 2.0 * (before + after), after, 6.0 * (slope(k) - slope(k - 1))),
            };
            let (last_upper, last_right) = if k > 0 { (upper[k - 1], right[k - 1]) } else { (0.0, 0.0) };
            let pivot = middle - low * last_upper;
            upper[k] = high / pivot;
            right[k] = (value - low * last_right) / pivot;
        }
        for k in (0..n).rev() {
            bend[k] = right[k] - if k + 1 < n { upper[k] * bend[k + 1] } else { 0.0 };
        }
        Self { x, y, bend }
    }

    pub(crate) fn at(&self, x: f64) -> f64 {
        let (Some(first), Some(last)) = (self.y.first(), self.y.last()) else { return 0.0 };
        let k = self.x.partition_point(|&knot| knot <= x);
        if k == 0 {
            return *first;
        }
        if k == self.x.len() {
            return *last;
        }
        let width = self.x[k] - self.x[k - 1];
        let b = (x - self.x[k - 1]) / width;
        let a = 1.0 - b;
        let bent = (a * a * a - a) * self.bend[k - 1] + (b * b * b - b) * self.bend[k];
        a * self.y[k - 1] + b * self.y[k] + bent * width * width / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_passes_its_points_and_is_smooth() {
        let x = vec![0.0, 1.0, 1.8, 3.0, 4.1];
        let y = vec![0.0, 0.5, 1.4, 1.9, 2.0];
        for ends in [Ends::Level, Ends::Straight] {
            let spline = Spline::new(x.clone(), y.clone(), ends);
            for (x, y) in x.iter().zip(&y) {
                assert!((spline.at(*x) - y).abs() < 1e-12);
            }
            let h = 1e-4;
            let rate = |x: f64| (spline.at(x + h) - spline.at(x - h)) / (2.0 * h);
            assert!((rate(1.8 + 2.0 * h) - rate(1.8 - 2.0 * h)).abs() < 1e-2);
            if ends == Ends::Level {
                assert!(rate(h).abs() < 1e-2 && rate(4.1 - h).abs() < 1e-2);
            }
        }
    }
}
