//! Floors from above: the plan, shaded cells, a scale bar and north.

use std::fmt::Write as _;

use fieldwalk::floor_plan::{FloorPlan, Polygon};
use fieldwalk::geometry::Point2;

use crate::plot::svg::{Anchor, Attribute, Px, Svg, points};

/// Styles of what is drawn on floors, on white: their colours are made for it and for paper.
pub const SHEET: &str = "\
.fw-floor{fill:#f6f8fa;stroke:none}\
.fw-closed{fill:#c9d1d9;stroke:#8c959f;stroke-width:.6;fill-rule:evenodd}\
.fw-room{fill:none;stroke:#b8c0c8;stroke-width:.6}\
.fw-wall{fill:none;stroke:#57606a;stroke-width:1}\
.fw-outline{fill:none;stroke:#24292f;stroke-width:1.4;stroke-linejoin:round}\
.fw-cells{shape-rendering:crispEdges}\
.fw-scale{stroke:#24292f;stroke-width:2;fill:none}";

/// Where a floor stands in a picture: y is up on the floor and down in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorFrame {
    left: f64,
    top: f64,
    per_m: f64,
    width_m: f64,
    height_m: f64,
}

impl FloorFrame {
    /// The floor of `plan` at the corner `(left, top)`, as large as fits into `(width, height)`.
    pub fn fitted(plan: &FloorPlan, (left, top): (f64, f64), (width, height): (f64, f64)) -> Self {
        let extent = |m: f64| if m.is_finite() && m > 0.0 { m } else { 1.0 };
        let (width_m, height_m) = (extent(plan.width_m), extent(plan.height_m));
        Self { left, top, per_m: (width / width_m).min(height / height_m), width_m, height_m }
    }

    /// Where a place is in the picture.
    pub fn at(&self, place: Point2) -> (f64, f64) {
        (self.left + self.per_m * place.x_m, self.top + self.per_m * (self.height_m - place.y_m))
    }

    /// The size in the picture.
    pub fn size(&self) -> (f64, f64) {
        (self.per_m * self.width_m, self.per_m * self.height_m)
    }

    /// A length in the picture.
    pub fn length(&self, length_m: f64) -> f64 {
        self.per_m * length_m
    }

    /// The ground of the floor: goes below shading.
    pub fn draw_ground(&self, svg: &mut Svg, plan: &FloorPlan) {
        if plan.outline.is_empty() {
            svg.rectangle("fw-floor", (self.left, self.top), self.size(), "#f6f8fa");
        }
        self.draw_polygons(svg, "fw-floor", plan.outline.iter());
    }

    /// Closed units, rooms, walls and the outline: goes above shading.
    pub fn draw_plan(&self, svg: &mut Svg, plan: &FloorPlan) {
        let units = |walkable: bool| plan.units.iter().filter(move |unit| unit.walkable == walkable);
        self.draw_polygons(svg, "fw-closed", units(false).map(|unit| &unit.polygon));
        self.draw_polygons(svg, "fw-room", units(true).map(|unit| &unit.polygon));
        let mut walls = String::new();
        for wall in plan.walls.iter().filter(|wall| wall.a.is_finite() && wall.b.is_finite()) {
            let ((x1, y1), (x2, y2)) = (self.at(wall.a), self.at(wall.b));
            let _ = write!(walls, "M{},{}L{},{}", Px(x1), Px(y1), Px(x2), Px(y2));
        }
        draw_path(svg, "fw-wall", &walls);
        self.draw_polygons(svg, "fw-outline", plan.outline.iter());
    }

    /// A line through places, of the style `class`.
    pub fn draw_line(&self, svg: &mut Svg, class: &str, places: &[Point2]) {
        let text = points(places.iter().map(|&place| self.at(place)));
        svg.element("polyline", &[("class", &class), ("points", &text)]);
    }

    /// Shades cells of `cell_m`: those whose middle has a class, in that class's colour.
    ///
    /// Neighbours in a row become one piece, and a class one path: a floor has thousands of cells.
    pub fn draw_cells(
        &self,
        svg: &mut Svg,
        cell_m: f64,
        colours: &[&str],
        class_at: impl Fn(Point2) -> Option<usize>,
    ) {
        let count = |extent_m: f64| (extent_m / cell_m).ceil().clamp(1.0, 2_000.0) as usize;
        let (nx, ny) = (count(self.width_m), count(self.height_m));
        let mut paths = vec![String::new(); colours.len()];
        for j in 0..ny {
            let class_of =
                |i: usize| class_at(Point2::new((i as f64 + 0.5) * cell_m, (j as f64 + 0.5) * cell_m));
            let mut from = 0;
            let mut running = class_of(0);
            for i in 1..=nx {
                let next = if i < nx { class_of(i) } else { None };
                if next == running && i < nx {
                    continue;
                }
                if let Some(path) = running.and_then(|class| paths.get_mut(class)) {
                    let (x, y) = self.at(Point2::new(from as f64 * cell_m, (j as f64 + 1.0) * cell_m));
                    let (width, height) = (self.per_m * (i - from) as f64 * cell_m, self.per_m * cell_m);
                    let _ = write!(path, "M{},{}h{}v{}h{}z", Px(x), Px(y), Px(width), Px(height), Px(-width));
                }
                (from, running) = (i, next);
            }
        }
        for (path, colour) in paths.iter().zip(colours).filter(|(path, _)| !path.is_empty()) {
            svg.element("path", &[("class", &"fw-cells"), ("fill", colour), ("d", path)]);
        }
    }

    /// A bar of a round length with its number, from `(x, y)` to the right.
    pub fn draw_scale_bar(&self, svg: &mut Svg, (x, y): (f64, f64)) {
        let longest_m = 0.22 * self.width_m;
        let power = 10f64.powf(longest_m.log10().floor());
        let length_m = [5.0, 2.0].into_iter().map(|m| m * power).find(|&m| m <= longest_m).unwrap_or(power);
        let (end, tick) = (x + self.length(length_m), 5.0);
        let bar = [(x, y - tick), (x, y), (end, y), (end, y - tick)];
        svg.element("polyline", &[("class", &"fw-scale"), ("points", &points(bar))]);
        svg.text("fw-label", (end + 6.0, y), Anchor::Start, &format!("{length_m} m"));
    }

    /// An arrow to the north, its foot at `(x, y)`; only where the floor's place on the Earth is known.
    pub fn draw_north(&self, svg: &mut Svg, plan: &FloorPlan, (x, y): (f64, f64)) {
        let Some(heading) = plan.georeference.and_then(north) else { return };
        let place = format!("translate({} {}) rotate({})", Px(x), Px(y), Px(heading.to_degrees()));
        svg.open("g", &[("transform", &place), ("class", &"fw-north")]);
        svg.element("path", &[("d", &"M0,-20L6,4L0,0L-6,4z"), ("fill", &"#24292f")]);
        svg.close();
        svg.text("fw-label", (x, y + 17.0), Anchor::Middle, "N");
    }

    fn draw_polygons<'a>(&self, svg: &mut Svg, class: &str, polygons: impl Iterator<Item = &'a Polygon>) {
        let mut path = String::new();
        for ring in polygons.flat_map(|polygon| &polygon.rings) {
            let corners = points(ring.iter().filter(|p| p.is_finite()).map(|&p| self.at(p)));
            if !corners.is_empty() {
                let _ = write!(path, "M{corners}z");
            }
        }
        draw_path(svg, class, &path);
    }
}

/// The heading of north on the plan, clockwise from up: plans are north-up or upside down.
fn north(georeference: fieldwalk::floor_plan::Georeference) -> Option<f64> {
    let per_m = georeference.latitude_deg_per_m;
    (per_m != 0.0 && per_m.is_finite()).then_some(if per_m > 0.0 { 0.0 } else { std::f64::consts::PI })
}

fn draw_path(svg: &mut Svg, class: &str, path: &str) {
    if !path.is_empty() {
        let attributes: [Attribute<'_>; 2] = [("class", &class), ("d", &path)];
        svg.element("path", &attributes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> FloorPlan {
        FloorPlan { width_m: 20.0, height_m: 10.0, ..FloorPlan::default() }
    }

    #[test]
    fn up_on_the_floor_is_up_in_the_picture() {
        let frame = FloorFrame::fitted(&plan(), (5.0, 7.0), (200.0, 200.0));
        assert_eq!(frame.size(), (200.0, 100.0));
        assert_eq!(frame.at(Point2::new(0.0, 10.0)), (5.0, 7.0));
        assert_eq!(frame.at(Point2::new(20.0, 0.0)), (205.0, 107.0));
    }

    #[test]
    fn cells_of_a_row_become_one_piece() {
        let frame = FloorFrame::fitted(&plan(), (0.0, 0.0), (20.0, 10.0));
        let mut svg = Svg::new(20.0, 10.0, "t", "");
        frame.draw_cells(&mut svg, 5.0, &["#111111", "#222222"], |p| {
            if p.y_m > 5.0 { None } else { Some(usize::from(p.x_m > 10.0)) }
        });
        let text = svg.finish();
        assert!(text.contains(r##"fill="#111111" d="M0,5h10v5h-10z""##), "{text}");
        assert!(text.contains(r##"fill="#222222" d="M10,5h10v5h-10z""##), "{text}");
    }

    #[test]
    fn the_scale_bar_is_round_and_north_needs_the_earth() {
        let frame = FloorFrame::fitted(&plan(), (0.0, 0.0), (200.0, 100.0));
        let mut svg = Svg::new(20.0, 10.0, "t", "");
        frame.draw_scale_bar(&mut svg, (0.0, 50.0));
        frame.draw_north(&mut svg, &plan(), (0.0, 0.0));
        let text = svg.finish();
        // 22 % of 20 m are 4.4 m: a bar of 2 m, 20 units long.
        assert!(text.contains(">2 m<") && text.contains("0,45 0,50 20,50 20,45"), "{text}");
        assert!(!text.contains("fw-north"));
    }
}
