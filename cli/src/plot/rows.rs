//! Bars and boxes, one a row: names of any length are readable, and so is the picture on a phone.

use fieldwalk::metrics::quantile;

use crate::plot::axis::Scale;
use crate::plot::style;
use crate::plot::svg::{Anchor, Px, Svg, text_width};

const WIDTH: f64 = 480.0;
const ROW_HEIGHT: f64 = 26.0;
const TOP: f64 = 34.0;
const BELOW: f64 = 44.0;
/// Room for a bar's own number.
const RIGHT: f64 = 52.0;
const N_TICKS: usize = 5;

/// What stands on a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A bar from zero, with its number.
    Bar(f64),
    /// The quantiles 5, 25, 50, 75 and 95 %: a whisker, a box with its middle, a whisker.
    Quantiles([f64; 5]),
}

/// A named row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// What stands on it; nothing is drawn of numbers that are not finite.
    pub shape: Shape,
    /// Which of the palette's colours it has.
    pub colour: usize,
}

/// Rows under each other, on one axis from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    title: String,
    label: String,
    rows: Vec<Row>,
}

impl Shape {
    /// The box of `values`; those that are not finite are left out.
    pub fn of(values: &[f64]) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        Self::Quantiles([0.05, 0.25, 0.5, 0.75, 0.95].map(|p| quantile(&sorted, p)))
    }

    fn extent(&self) -> [f64; 2] {
        match *self {
            Self::Bar(value) => [value.min(0.0), value.max(0.0)],
            Self::Quantiles([low, .., high]) => [low.min(0.0), high.max(0.0)],
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::Bar(value) => value.is_finite(),
            Self::Quantiles(values) => values.iter().all(|value| value.is_finite()),
        }
    }
}

impl Rows {
    /// No rows yet; the label names quantity and unit.
    pub fn new(title: impl Into<String>, label: impl Into<String>) -> Self {
        Self { title: title.into(), label: label.into(), rows: Vec::new() }
    }

    /// With one more row, below the others, in the first colour.
    #[must_use]
    pub fn with(self, name: impl Into<String>, shape: Shape) -> Self {
        self.with_colour(name, shape, 0)
    }

    /// With one more row in a colour of the palette.
    #[must_use]
    pub fn with_colour(mut self, name: impl Into<String>, shape: Shape, colour: usize) -> Self {
        self.rows.push(Row { name: name.into(), shape, colour });
        self
    }

    /// The rows as an SVG document.
    pub fn to_svg(&self) -> String {
        let height = TOP + ROW_HEIGHT * self.rows.len() as f64 + BELOW;
        let mut svg = Svg::new(WIDTH, height, &self.title, &style::chart_sheet());
        svg.rectangle("fw-ground", (0.0, 0.0), (WIDTH, height), "#ffffff");
        svg.text("fw-title", (12.0, 20.0), Anchor::Start, &self.title);
        let names = self.rows.iter().map(|row| text_width(&row.name, 12.0)).fold(0.0, f64::max);
        let left = (names + 22.0).clamp(60.0, 0.5 * WIDTH);
        let extents = || self.rows.iter().filter(|row| row.shape.is_finite()).map(|row| row.shape.extent());
        let low = extents().map(|[low, _]| low).fold(0.0, f64::min);
        let high = extents().map(|[_, high]| high).fold(low, f64::max);
        let x = Scale::rounded(low, high, N_TICKS, left, WIDTH - RIGHT);
        let base = height - BELOW;
        for (value, text) in x.ticks(N_TICKS) {
            svg.line("fw-grid", (x.at(value), TOP), (x.at(value), base));
            svg.text("fw-small", (x.at(value), base + 15.0), Anchor::Middle, &text);
        }
        svg.text("fw-label", (0.5 * (left + WIDTH - RIGHT), height - 10.0), Anchor::Middle, &self.label);
        for (k, row) in self.rows.iter().enumerate() {
            let middle = TOP + ROW_HEIGHT * (k as f64 + 0.5);
            svg.text("fw-label", (left - 8.0, middle + 4.0), Anchor::End, &row.name);
            if row.shape.is_finite() {
                draw(&mut svg, row, &x, middle);
            }
        }
        svg.line("fw-axis", (x.at(0.0), TOP), (x.at(0.0), base));
        svg.finish()
    }
}

fn draw(svg: &mut Svg, row: &Row, x: &Scale, middle: f64) {
    let colour = style::colour(row.colour);
    match row.shape {
        Shape::Bar(value) => {
            let (from, to) = (x.at(value.min(0.0)), x.at(value.max(0.0)));
            svg.rectangle("fw-bar", (from, middle - 8.0), (to - from, 16.0), colour);
            svg.text("fw-small", (to + 5.0, middle + 4.0), Anchor::Start, &short(value));
        }
        Shape::Quantiles(values) => {
            let [low, lower, median, upper, high] = values.map(|value| x.at(value));
            svg.open("g", &[("stroke", &colour), ("stroke-width", &"1.5")]);
            svg.line("fw-whisker", (low, middle), (lower, middle));
            svg.line("fw-whisker", (upper, middle), (high, middle));
            svg.rectangle("fw-box", (lower, middle - 8.0), (upper - lower, 16.0), colour);
            svg.element(
                "line",
                &[
                    ("x1", &Px(median)),
                    ("x2", &Px(median)),
                    ("y1", &Px(middle - 8.0)),
                    ("y2", &Px(middle + 8.0)),
                    ("stroke-width", &"3"),
                ],
            );
            svg.close();
            svg.text("fw-small", (high + 5.0, middle + 4.0), Anchor::Start, &short(values[2]));
        }
    }
}

/// About three figures.
fn short(value: f64) -> String {
    let decimals = if value.abs() >= 100.0 {
        0
    } else if value.abs() >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_the_quantiles() {
        let values: Vec<f64> = (0..=100).rev().map(f64::from).chain([f64::NAN]).collect();
        assert_eq!(Shape::of(&values), Shape::Quantiles([5.0, 25.0, 50.0, 75.0, 95.0]));
        assert!(!Shape::of(&[]).is_finite());
    }

    #[test]
    fn bars_are_as_long_as_their_values() {
        let rows = Rows::new("t", "m").with("a <b>", Shape::Bar(5.0)).with("c", Shape::Bar(2.5));
        let svg = rows.with("none", Shape::Bar(f64::NAN)).with("box", Shape::of(&[1.0, 2.0, 3.0])).to_svg();
        let document = roxmltree::Document::parse(&svg).unwrap();
        let widths: Vec<f64> = document
            .descendants()
            .filter(|node| node.attribute("class") == Some("fw-bar"))
            .map(|node| node.attribute("width").unwrap().parse().unwrap())
            .collect();
        assert!(widths.len() == 2 && (widths[0] - 2.0 * widths[1]).abs() < 0.02, "{widths:?}");
        assert!(svg.contains("a &lt;b&gt;") && !svg.contains("NaN"));
        assert!(roxmltree::Document::parse(&Rows::new("t", "m").to_svg()).is_ok());
    }
}
