//! Walks from above: where somebody went, and where systems put them.

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;

use crate::plot::floor::{self, FloorFrame};
use crate::plot::style;
use crate::plot::svg::{Anchor, Attribute, Svg, points};

const WIDTH: f64 = 480.0;
/// A tall floor is drawn no higher than this.
const MAX_HEIGHT: f64 = 480.0;
const MARGIN: f64 = 12.0;
/// Room for title and legend.
const TOP: f64 = 52.0;

/// The floor of `plan` with a line for each name.
pub fn traces(title: &str, plan: &FloorPlan, lines: &[(&str, &[Point2])]) -> String {
    let frame = FloorFrame::fitted(plan, (MARGIN, TOP), (WIDTH - 2.0 * MARGIN, MAX_HEIGHT));
    let height = TOP + frame.size().1 + MARGIN;
    let mut svg = Svg::new(WIDTH, height, title, &format!("{}{}", style::chart_sheet(), floor::SHEET));
    svg.rectangle("fw-ground", (0.0, 0.0), (WIDTH, height), "#ffffff");
    svg.text("fw-title", (MARGIN, 20.0), Anchor::Start, title);
    frame.draw_ground(&mut svg, plan);
    frame.draw_plan(&mut svg, plan);
    let mut left = MARGIN;
    for (k, (name, places)) in lines.iter().enumerate() {
        let finite = places.iter().filter(|place| place.is_finite());
        let line = |along: &str| -> [(&'static str, String); 4] {
            [
                ("class", "fw-line".into()),
                ("stroke", style::colour(k).into()),
                ("stroke-dasharray", style::dash(k).into()),
                ("points", along.into()),
            ]
        };
        let mut draw = |along: String| {
            let line = line(&along);
            let attributes: Vec<Attribute<'_>> =
                line.iter().map(|(name, value)| (*name, value as _)).collect();
            svg.element("polyline", &attributes);
        };
        draw(points(finite.map(|&place| frame.at(place))));
        draw(points([(left, 38.0), (left + 22.0, 38.0)]));
        svg.text("fw-label", (left + 27.0, 42.0), Anchor::Start, name);
        left += 48.0 + crate::plot::svg::text_width(name, 12.0);
    }
    svg.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lie_on_their_floor() {
        let plan = FloorPlan { width_m: 45.6, height_m: 20.0, ..FloorPlan::default() };
        let walked = [Point2::new(0.0, 20.0), Point2::new(f64::NAN, 1.0), Point2::new(45.6, 0.0)];
        let svg = traces("a & b", &plan, &[("truth", &walked), ("fixes", &[])]);
        // 456 units for 45.6 m: from the upper left corner to the lower right one.
        assert!(svg.contains("points=\"12,52 468,252\""), "{svg}");
        assert!(roxmltree::Document::parse(&svg).is_ok() && svg.contains("a &amp; b"));
    }
}
