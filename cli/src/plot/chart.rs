//! Charts on two axes: lines, distributions, scatter.

use fieldwalk::metrics::quantile;

use crate::plot::axis::Scale;
use crate::plot::style;
use crate::plot::svg::{Anchor, Attribute, Px, Svg, points, text_width};

/// A chart's size in its own units: as wide as a phone, where its text is then as large as intended.
const SIZE: (f64, f64) = (480.0, 320.0);
/// Room for the labels on the left, right and below.
const MARGINS: (f64, f64, f64) = (54.0, 14.0, 44.0);
const TITLE_HEIGHT: f64 = 26.0;
const LEGEND_HEIGHT: f64 = 18.0;
/// About so many ticks along x and y.
const TICKS: (usize, usize) = (6, 5);
/// A distribution has at most this many steps: more are not seen.
const MAX_STEPS: usize = 400;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line from point to point.
    Line,
    /// Dots.
    Dots,
}

/// Points under one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// The points; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub mark: Mark,
}

impl Series {
    /// A line through `points`.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, mark: Mark::Line }
    }

    /// A dot at each of `points`.
    pub fn dots(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, mark: Mark::Dots }
    }
}

/// Series on two linear axes; both begin at zero unless a value is negative.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    title: String,
    x_label: String,
    y_label: String,
    series: Vec<Series>,
    /// The end of the x axis, where it is not that of the points.
    x_max: Option<f64>,
    y_max: Option<f64>,
}

impl Chart {
    /// An empty chart; labels name quantity and unit, such as `error (m)`.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            series: Vec::new(),
            x_max: None,
            y_max: None,
        }
    }

    /// With one more series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// With an x axis that ends at `max`; points beyond are not drawn.
    #[must_use]
    pub fn x_up_to(mut self, max: f64) -> Self {
        self.x_max = Some(max).filter(|max| max.is_finite());
        self
    }

    /// With a y axis that ends at `max`; points beyond are not drawn.
    #[must_use]
    pub fn y_up_to(mut self, max: f64) -> Self {
        self.y_max = Some(max).filter(|max| max.is_finite());
        self
    }

    /// The chart as an SVG document.
    pub fn to_svg(&self) -> String {
        let (width, height) = SIZE;
        let (left, right, below) = MARGINS;
        let mut svg = Svg::new(width, height, &self.title, &style::chart_sheet());
        svg.rectangle("fw-ground", (0.0, 0.0), SIZE, "#ffffff");
        svg.text("fw-title", (12.0, 20.0), Anchor::Start, &self.title);
        let top = self.legend(&mut svg, TITLE_HEIGHT + 12.0) + 10.0;
        let x = self.scale(|point| point.0, self.x_max, TICKS.0, (left, width - right));
        let y = self.scale(|point| point.1, self.y_max, TICKS.1, (height - below, top));
        for (value, text) in x.ticks(TICKS.0) {
            svg.line("fw-grid", (x.at(value), top), (x.at(value), height - below));
            svg.text("fw-small", (x.at(value), height - below + 15.0), Anchor::Middle, &text);
        }
        for (value, text) in y.ticks(TICKS.1) {
            svg.line("fw-grid", (left, y.at(value)), (width - right, y.at(value)));
            svg.text("fw-small", (left - 6.0, y.at(value) + 4.0), Anchor::End, &text);
        }
        svg.line("fw-axis", (left, height - below), (width - right, height - below));
        svg.line("fw-axis", (left, top), (left, height - below));
        let middle_x = 0.5 * (left + width - right);
        svg.text("fw-label", (middle_x, height - 10.0), Anchor::Middle, &self.x_label);
        let turned = format!("translate(14 {}) rotate(-90)", Px(0.5 * (top + height - below)));
        svg.open("g", &[("transform", &turned)]);
        svg.text("fw-label", (0.0, 0.0), Anchor::Middle, &self.y_label);
        svg.close();
        for (k, series) in self.series.iter().enumerate() {
            self.draw(&mut svg, k, series, &x, &y);
        }
        svg.finish()
    }

    fn draw(&self, svg: &mut Svg, k: usize, series: &Series, x: &Scale, y: &Scale) {
        let shown = self.shown(series).map(|(px, py)| (x.at(px), y.at(py)));
        match series.mark {
            Mark::Line => {
                let attributes: [Attribute<'_>; 4] = [
                    ("class", &"fw-line"),
                    ("stroke", &style::colour(k)),
                    ("stroke-dasharray", &style::dash(k)),
                    ("points", &points(shown)),
                ];
                svg.element("polyline", &attributes);
            }
            Mark::Dots => {
                svg.open("g", &[("class", &"fw-dot"), ("fill", &style::colour(k))]);
                for (cx, cy) in shown {
                    svg.element("circle", &[("cx", &Px(cx)), ("cy", &Px(cy)), ("r", &"2.5")]);
                }
                svg.close();
            }
        }
    }

    /// The points that are drawn.
    fn shown<'a>(&self, series: &'a Series) -> impl Iterator<Item = (f64, f64)> + use<'a> {
        let (x_max, y_max) = (self.x_max, self.y_max);
        let is_within =
            move |value: f64, max: Option<f64>| value.is_finite() && max.is_none_or(|max| value <= max);
        let points = series.points.iter().copied();
        points.filter(move |&(x, y)| is_within(x, x_max) && is_within(y, y_max))
    }

    fn scale(
        &self,
        value: fn((f64, f64)) -> f64,
        max: Option<f64>,
        n_ticks: usize,
        (from, to): (f64, f64),
    ) -> Scale {
        let values = || self.series.iter().flat_map(|series| self.shown(series)).map(value);
        let low = values().fold(0.0, f64::min);
        match max {
            Some(max) => Scale::new(low, max, from, to),
            None => Scale::rounded(low, values().fold(low, f64::max), n_ticks, from, to),
        }
    }

    /// Writes the legend from `top` and gives where it ends; one series needs none.
    fn legend(&self, svg: &mut Svg, top: f64) -> f64 {
        if self.series.len() < 2 {
            return top - LEGEND_HEIGHT;
        }
        let (mut x, mut y) = (12.0, top);
        for (k, series) in self.series.iter().enumerate() {
            let width = 38.0 + text_width(&series.name, 12.0);
            if x > 12.0 && x + width > SIZE.0 {
                (x, y) = (12.0, y + LEGEND_HEIGHT);
            }
            let colour: Attribute<'_> = ("stroke", &style::colour(k));
            match series.mark {
                Mark::Line => {
                    let dash: Attribute<'_> = ("stroke-dasharray", &style::dash(k));
                    let ends = points([(x, y - 4.0), (x + 22.0, y - 4.0)]);
                    svg.element("path", &[("class", &"fw-line"), colour, dash, ("d", &format!("M{ends}"))]);
                }
                Mark::Dots => {
                    let place: [Attribute<'_>; 3] =
                        [("cx", &Px(x + 12.0)), ("cy", &Px(y - 4.0)), ("fill", &style::colour(k))];
                    svg.element("circle", &[place[0], place[1], place[2], ("r", &"3.5")]);
                }
            }
            svg.text("fw-label", (x + 27.0, y), Anchor::Start, &series.name);
            x += width;
        }
        y
    }
}

/// The share of values up to a value, one line a name; the axis ends where 98 of 100 of every name's values lie.
pub fn cdf(title: &str, x_label: &str, samples: &[(&str, &[f64])]) -> Chart {
    let mut chart = Chart::new(title, x_label, "share of all (%)").y_up_to(100.0);
    let mut x_max = 0.0f64;
    for (name, values) in samples {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        if n > 0 {
            x_max = x_max.max(quantile(&sorted, 0.98));
        }
        let first = sorted.first().map(|&value| (value.min(0.0), 0.0));
        let steps = n.min(MAX_STEPS);
        let rest = (1..=steps).map(|k| {
            let rank = (k * n).div_ceil(steps);
            (sorted[rank - 1], 100.0 * rank as f64 / n as f64)
        });
        chart = chart.with(Series::line(*name, first.into_iter().chain(rest).collect()));
    }
    if x_max > 0.0 { chart.x_up_to(x_max) } else { chart }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polylines(svg: &str) -> Vec<String> {
        let document = roxmltree::Document::parse(svg).unwrap();
        let lines = document.descendants().filter(|node| node.has_tag_name("polyline"));
        lines.filter_map(|node| node.attribute("points").map(String::from)).collect()
    }

    #[test]
    fn points_land_where_the_axes_say() {
        let line = Series::line("a", vec![(0.0, 0.0), (5.0, f64::NAN), (10.0, 4.0)]);
        let svg = Chart::new("t", "x", "y").with(line.clone()).to_svg();
        // Alone, without a legend: the axes run from (54, 276) to (466, 30).
        assert_eq!(polylines(&svg), ["54,276 466,30"]);
        let both =
            Chart::new("t", "x", "y").with(line).with(Series::dots("b & c", vec![(20.0, 1.0)])).to_svg();
        assert_eq!(polylines(&both), ["54,276 260,48"]);
        assert!(both.contains("b &amp; c") && both.matches("<circle").count() == 2);
    }

    #[test]
    fn a_distribution_by_hand() {
        let values = [4.0, 1.0, f64::NAN, 2.0, 3.0];
        let chart = cdf("t", "x", &[("four", &values), ("none", &[])]);
        let points = &chart.series[0].points;
        assert_eq!(points[..], [(0.0, 0.0), (1.0, 25.0), (2.0, 50.0), (3.0, 75.0), (4.0, 100.0)]);
        assert!((chart.x_max.unwrap() - 3.94).abs() < 1e-12);
        assert!(chart.series[1].points.is_empty());
        let many: Vec<f64> = (0..100_000).map(f64::from).collect();
        assert_eq!(cdf("t", "x", &[("many", &many)]).series[0].points.len(), MAX_STEPS + 1);
    }

    #[test]
    fn nothing_to_draw_is_an_empty_chart() {
        for chart in [
            Chart::new("t", "x", "y"),
            Chart::new("t", "x", "y").with(Series::line("none", vec![(f64::NAN, f64::INFINITY)])),
            cdf("t", "x", &[]),
        ] {
            let svg = chart.to_svg();
            assert!(
                roxmltree::Document::parse(&svg).is_ok() && !svg.contains("NaN") && !svg.contains("inf"),
                "{svg}"
            );
        }
    }
}
