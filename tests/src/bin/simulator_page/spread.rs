//! Medians and spreads of values, as text and as boxes.

use fieldwalk_cli::plot::Shape;

/// Values of one name: real ones, or simulated ones.
pub struct Spread {
    pub name: String,
    pub is_real: bool,
    pub values: Vec<f64>,
}

impl Spread {
    pub fn new(name: impl Into<String>, is_real: bool, values: Vec<f64>) -> Self {
        let mut values = values;
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        Self { name: name.into(), is_real, values }
    }

    /// The value that a share of the others lie under, between two values in proportion.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.values.len().saturating_sub(1);
        let place = share * last as f64;
        let at = |k: usize| self.values.get(k.min(last)).copied().unwrap_or(f64::NAN);
        let below = place as usize;
        at(below) + (place - below as f64) * (at(below + 1) - at(below))
    }

    /// The median, and where four fifths of the values lie.
    pub fn text(&self) -> String {
        let [low, middle, high] = [0.1, 0.5, 0.9].map(|share| self.quantile(share));
        format!("{middle:.2} ({low:.2} to {high:.2})")
    }
}

/// Boxes under each other, real ones in the first colour, simulated ones in the second.
pub fn boxes(title: &str, label: &str, spreads: &[Spread]) -> String {
    let rows = spreads.iter().fold(fieldwalk_cli::plot::Rows::new(title, label), |rows, spread| {
        let name = format!("{}{}", if spread.is_real { "real: " } else { "simulated: " }, spread.name);
        rows.with_colour(name, Shape::of(&spread.values), usize::from(!spread.is_real))
    });
    rows.to_svg()
}

pub fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for value in values {
        sum += value;
        n += 1.0;
    }
    sum / n
}

pub fn sd(values: &[f64]) -> f64 {
    let middle = mean(values.iter().copied());
    mean(values.iter().map(|value| (value - middle) * (value - middle))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_values() {
        let spread = Spread::new("", true, vec![3.0, 1.0, f64::NAN, 2.0, 4.0]);
        assert_eq!((spread.quantile(0.0), spread.quantile(0.5), spread.quantile(1.0)), (1.0, 2.5, 4.0));
        assert!(Spread::new("", true, Vec::new()).quantile(0.5).is_nan());
        assert_eq!(sd(&[1.0, 3.0]), 1.0);
    }
}
