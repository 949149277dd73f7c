//! A floor's survey as a picture: what was walked and how well the field is known; what errors to expect, where.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::geometry::{Point2, Segment};
use fieldwalk::map::FloorIndex;
use fieldwalk::metrics::{ErrorSummary, ScoredFix};
use fieldwalk::survey::Coverage;
use fieldwalk_formats::FormatError;

use crate::plot::floor::{self, FloorFrame};
use crate::plot::style;
use crate::plot::svg::{Anchor, Px, Svg, points, text_width};

/// The picture's margin, and the room above a panel's floor and below it.
const MARGIN: f64 = 16.0;
const ABOVE: f64 = 44.0;
const BELOW: f64 = 79.0;
/// The room for a panel's floor where two stand one above the other, and where they stand side by side: the picture is
/// about as wide in both, so that its text can be read on a phone.
const STACKED: (f64, f64) = (620.0, 620.0);
const BESIDE: (f64, f64) = (320.0, 700.0);
/// Room at the right end of a panel's legend, for the arrow to the north.
const NORTH: f64 = 30.0;
const HEADER: f64 = 70.0;

/// Bounds of the field's standard deviation between classes, in µT: the prior is 5.7.
const FIELD_UT: [f32; 3] = [2.0, 3.0, 4.0];
/// From well known to hardly known; then what no walk came near.
const FIELD_COLOURS: [&str; 5] = ["#6baed6", "#9ecae1", "#c6dbef", "#e6eff8", "url(#fw-gap)"];
const NOT_COVERED: usize = FIELD_COLOURS.len() - 1;
/// Bounds of errors between classes, in metres.
const ERROR_M: [f64; 4] = [1.0, 2.0, 3.0, 5.0];
/// Viridis from its light end: what is worse is darker, in grey as well.
const ERROR_COLOURS: [&str; 5] = ["#fde725", "#5ec962", "#21918c", "#3b528b", "#440154"];
/// A dot's radius by class, for print without colour.
const ERROR_RADII: [f64; 5] = [1.9, 2.3, 2.8, 3.4, 4.2];

/// Errors count for a place by a Gaussian of this standard deviation, in metres.
const ERROR_WIDTH_M: f64 = 3.0;
/// No error is expected where the nearest scored points count less than this together.
const MIN_ERROR_WEIGHT: f64 = 0.3;
/// An arrow is considered every so many metres of a line.
const ARROW_EVERY_M: f64 = 6.0;
/// No arrow stands nearer to another one than this, in the picture's units.
const ARROWS_APART: f64 = 9.0;
/// A line is walked both ways where another one leads back within this distance, in metres.
const BACK_WITHIN_M: f64 = 2.5;

const SHEET: &str = "\
.fw-walk{fill:none;stroke:#08306b;stroke-width:.9;stroke-linejoin:round;stroke-opacity:.75}\
.fw-faint{fill:none;stroke:#8c959f;stroke-width:.6}\
.fw-arrow{fill:none;stroke:#08306b;stroke-width:1.2;stroke-linecap:round;stroke-linejoin:round}\
.fw-score{stroke:#24292f;stroke-width:.6}\
.fw-swatch{stroke:#8c959f;stroke-width:.6}\
.fw-expected{opacity:.55}";

/// What a floor's picture shows.
#[derive(Debug)]
pub struct Picture<'a> {
    pub building: &'a str,
    pub floor: &'a FloorIndex,
    pub coverage: Coverage,
    /// Errors of walks left out, with their places.
    pub scores: &'a [(Point2, ScoredFix)],
}

/// The picture's file: `mall-F1-survey.svg` in `dir`, or else beside the map `mall.map`; `stem` is the floor's file's.
pub fn path(map: &Path, dir: Option<&Path>, floor_file: &str) -> PathBuf {
    let name = map.file_name().map_or("map".into(), |name| name.to_string_lossy());
    let name = name.strip_suffix(".map").filter(|stem| !stem.is_empty()).unwrap_or(&name);
    let stem = floor_file.strip_suffix(".safetensors").unwrap_or(floor_file);
    let file = format!("{name}-{stem}-survey.svg");
    dir.unwrap_or_else(|| map.parent().unwrap_or(Path::new(""))).join(file)
}

impl Picture<'_> {
    /// Writes the picture, and its folder if need be.
    pub fn write(&self, path: &Path) -> Result<(), FormatError> {
        if let Some(dir) = path.parent().filter(|dir| !dir.as_os_str().is_empty()) {
            fs::create_dir_all(dir).map_err(|error| FormatError::io("make the folder", dir, error))?;
        }
        fs::write(path, self.to_svg()).map_err(|error| FormatError::io("write the picture", path, error))
    }

    /// The picture as an SVG document.
    pub fn to_svg(&self) -> String {
        let map = self.floor.map();
        let plan = &map.plan;
        let is_stacked = plan.width_m >= 0.8 * plan.height_m || self.scores.is_empty();
        let room = if is_stacked { STACKED } else { BESIDE };
        let panel_width = room.0;
        let fitted = |left: f64, top: f64| FloorFrame::fitted(plan, (left, top), room);
        let panel_height = ABOVE + fitted(0.0, 0.0).size().1 + BELOW;
        let n_panels = if self.scores.is_empty() { 1.0 } else { 2.0 };
        let (across, down) = if is_stacked { (1.0, n_panels) } else { (n_panels, 1.0) };
        let width = MARGIN + across * (panel_width + MARGIN);
        let height = HEADER + down * panel_height;
        let title = format!("Survey of {}, floor {}", self.building, map.name);
        let sheet = format!("{}{}{SHEET}", style::SHEET, floor::SHEET);
        let mut svg = Svg::new(width, height, &title, &sheet);
        svg.rectangle("fw-ground", (0.0, 0.0), (width, height), "#ffffff");
        draw_gap_pattern(&mut svg);
        svg.text("fw-title", (MARGIN, 26.0), Anchor::Start, &title);
        for (k, line) in self.totals().iter().enumerate() {
            svg.text("fw-label", (MARGIN, 45.0 + 16.0 * k as f64), Anchor::Start, line);
        }
        self.draw_coverage(&mut svg, &fitted(MARGIN, HEADER + ABOVE));
        if !self.scores.is_empty() {
            let (right, below) = if is_stacked { (0.0, panel_height) } else { (panel_width + MARGIN, 0.0) };
            self.draw_expected(&mut svg, &fitted(MARGIN + right, HEADER + ABOVE + below));
        }
        svg.finish()
    }

    fn totals(&self) -> [String; 2] {
        let Coverage { open_m2, covered_m2, route_m, .. } = self.coverage;
        let share = if open_m2 > 0.0 { 100.0 * covered_m2 / open_m2 } else { 0.0 };
        let walked = format!(
            "{} walks, {:.2} km; a line within {} m of {share:.0} % of {open_m2:.0} m² of open floor",
            self.floor.map().routes.len(),
            route_m / 1e3,
            Coverage::REACH_M,
        );
        let fixes = self.scores.iter().map(|(_, fix)| *fix).filter(|fix| fix.error_m.is_finite());
        let expected = match ErrorSummary::of(&fixes.collect::<Vec<_>>()) {
            Some(ErrorSummary { median_m, p80_m, n_points, .. }) => {
                format!(
                    "expected error: median {median_m:.1} m, 80 % within {p80_m:.1} m ({n_points} waypoints)"
                )
            }
            None => "expected error: not worked out".into(),
        };
        [walked, expected]
    }

    fn draw_coverage(&self, svg: &mut Svg, frame: &FloorFrame) {
        let map = self.floor.map();
        self.begin_panel(svg, frame, "coverage", ["Coverage", "how well the field is known"]);
        frame.draw_cells(svg, self.cell_m(), &FIELD_COLOURS, |place| self.field_class(place));
        frame.draw_plan(svg, &map.plan);
        for route in &map.routes {
            frame.draw_line(svg, "fw-walk", route);
        }
        let arrows = one_way_arrows(&map.routes, frame);
        svg.element("path", &[("class", &"fw-arrow"), ("d", &arrows)]);
        let mut legend = Legend::below(frame);
        for (colour, text) in FIELD_COLOURS.iter().zip(class_names(&FIELD_UT, "µT")) {
            legend.swatch(svg, colour, &text);
        }
        legend.swatch(svg, FIELD_COLOURS[NOT_COVERED], "no line within 3 m");
        if !arrows.is_empty() {
            let arrow = |x: f64, y: f64| format!("M{},{}l4,-5l4,5", Px(x + 7.0), Px(y - 2.0));
            legend.entry(svg, "walked one way only", |svg, x, y| {
                svg.element("path", &[("class", &"fw-arrow"), ("d", &arrow(x, y))]);
            });
        }
        svg.close();
    }

    fn draw_expected(&self, svg: &mut Svg, frame: &FloorFrame) {
        let map = self.floor.map();
        self.begin_panel(svg, frame, "expected", ["Expected error", "each walk on the map of the others"]);
        svg.open("g", &[("class", &"fw-expected")]);
        frame.draw_cells(svg, self.cell_m(), &ERROR_COLOURS, |place| self.error_class(place));
        svg.close();
        frame.draw_plan(svg, &map.plan);
        for route in &map.routes {
            frame.draw_line(svg, "fw-faint", route);
        }
        // The worst on top.
        let mut scores: Vec<_> = self.scores.iter().filter(|(_, fix)| fix.error_m.is_finite()).collect();
        scores.sort_by(|a, b| a.1.error_m.total_cmp(&b.1.error_m));
        for (place, fix) in scores {
            let (class, (x, y)) = (class_of(&ERROR_M, fix.error_m), frame.at(*place));
            draw_score(svg, class, x, y);
        }
        let mut legend = Legend::below(frame);
        for (class, text) in class_names(&ERROR_M, "m").into_iter().enumerate() {
            legend.entry(svg, &text, |svg, x, y| {
                svg.rectangle("fw-swatch", (x, y - 11.0), (14.0, 12.0), ERROR_COLOURS[class]);
                draw_score(svg, class, x + 20.0, y - 5.0);
            });
        }
        legend.note(svg, "dots: at waypoints; shade: the median nearby");
        svg.close();
    }

    fn begin_panel(&self, svg: &mut Svg, frame: &FloorFrame, id: &str, [title, subtitle]: [&str; 2]) {
        let plan = &self.floor.map().plan;
        let (left, top) = frame.at(Point2::new(0.0, plan.height_m));
        let (_, height) = frame.size();
        svg.open("g", &[("id", &id)]);
        svg.text("fw-title", (left, top - 26.0), Anchor::Start, title);
        svg.text("fw-label", (left, top - 9.0), Anchor::Start, subtitle);
        frame.draw_ground(svg, plan);
        frame.draw_scale_bar(svg, (left + 2.0, top + height + 18.0));
        frame.draw_north(svg, plan, (right_of(frame) - 10.0, top + height + 26.0));
    }

    /// Half a metre, so that narrow corridors are shaded; more on large floors.
    fn cell_m(&self) -> f64 {
        let plan = &self.floor.map().plan;
        0.5f64.max(plan.width_m.max(plan.height_m) / 250.0)
    }

    fn field_class(&self, Point2 { x_m, y_m }: Point2) -> Option<usize> {
        let (x_m, y_m) = (x_m as f32, y_m as f32);
        let layers = &self.floor.map().layers;
        if !self.floor.is_open(x_m, y_m) {
            return None;
        }
        let is_covered =
            self.floor.nearest(&layers.route_distance_m, x_m, y_m).is_some_and(|d| d <= Coverage::REACH_M);
        let variance_ut2 = self.floor.nearest(&layers.field_variance_ut2, x_m, y_m).filter(|_| is_covered);
        Some(variance_ut2.map_or(NOT_COVERED, |v| class_of(&FIELD_UT, v.max(0.0).sqrt())))
    }

    fn error_class(&self, place: Point2) -> Option<usize> {
        let (x_m, y_m) = (place.x_m as f32, place.y_m as f32);
        let distances = &self.floor.map().layers.route_distance_m;
        let is_near = self.floor.nearest(distances, x_m, y_m).is_some_and(|d| d <= Coverage::REACH_M);
        if !is_near || !self.floor.is_open(x_m, y_m) {
            return None;
        }
        let mut near: Vec<(f64, f64)> = self
            .scores
            .iter()
            .map(|(at, fix)| (fix.error_m, place.distance_m(*at) / ERROR_WIDTH_M))
            .filter(|(error_m, apart)| error_m.is_finite() && *apart < 3.0)
            .map(|(error_m, apart)| (error_m, (-0.5 * apart * apart).exp()))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = near.iter().map(|(_, weight)| weight).sum();
        let mut sum = 0.0;
        let median = near.iter().find(|(_, weight)| {
            sum += weight;
            sum >= 0.5 * total
        });
        median.filter(|_| total >= MIN_ERROR_WEIGHT).map(|(error_m, _)| class_of(&ERROR_M, *error_m))
    }
}

/// Entries in rows under a floor, beside the scale bar's row.
struct Legend {
    left: f64,
    right: f64,
    x: f64,
    y: f64,
}

impl Legend {
    fn below(frame: &FloorFrame) -> Self {
        let (left, top) = frame.at(Point2::default());
        Self { left, right: right_of(frame) - NORTH, x: left, y: top + 38.0 }
    }

    fn entry(&mut self, svg: &mut Svg, text: &str, mark: impl FnOnce(&mut Svg, f64, f64)) {
        let width = 44.0 + text_width(text, 12.0);
        if self.x > self.left && self.x + width - 14.0 > self.right {
            (self.x, self.y) = (self.left, self.y + 17.0);
        }
        mark(svg, self.x, self.y);
        svg.text("fw-label", (self.x + 28.0, self.y), Anchor::Start, text);
        self.x += width;
    }

    fn swatch(&mut self, svg: &mut Svg, fill: &str, text: &str) {
        self.entry(svg, text, |svg, x, y| {
            svg.rectangle("fw-swatch", (x, y - 11.0), (22.0, 12.0), fill);
        });
    }

    fn note(&mut self, svg: &mut Svg, text: &str) {
        svg.text("fw-small", (self.left, self.y + 17.0), Anchor::Start, text);
    }
}

/// Where a panel ends, which is wider than a narrow floor.
fn right_of(frame: &FloorFrame) -> f64 {
    frame.at(Point2::default()).0 + frame.size().0.max(BESIDE.0)
}

fn draw_score(svg: &mut Svg, class: usize, x: f64, y: f64) {
    let (radius, fill) = (Px(ERROR_RADII[class]), ERROR_COLOURS[class]);
    svg.element(
        "circle",
        &[("class", &"fw-score"), ("cx", &Px(x)), ("cy", &Px(y)), ("r", &radius), ("fill", &fill)],
    );
}

/// Hatching that is seen in print, too.
fn draw_gap_pattern(svg: &mut Svg) {
    svg.open("defs", &[]);
    svg.open(
        "pattern",
        &[
            ("id", &"fw-gap"),
            ("width", &"5"),
            ("height", &"5"),
            ("patternUnits", &"userSpaceOnUse"),
            ("patternTransform", &"rotate(45)"),
        ],
    );
    svg.element("rect", &[("width", &"5"), ("height", &"5"), ("fill", &"#fff3e0")]);
    svg.element("rect", &[("width", &"1.6"), ("height", &"5"), ("fill", &"#e08214")]);
    svg.close();
    svg.close();
}

/// The index of the class that `value` falls into: as many classes as bounds, and one more.
fn class_of<T: PartialOrd>(bounds: &[T], value: T) -> usize {
    bounds.iter().filter(|&bound| value >= *bound).count()
}

fn class_names<T: std::fmt::Display>(bounds: &[T], unit: &str) -> Vec<String> {
    let Some((first, last)) = bounds.first().zip(bounds.last()) else { return Vec::new() };
    let between = bounds.windows(2).map(|pair| format!("{}–{}", pair[0], pair[1]));
    let ends = (format!("below {first} {unit}"), format!("{last} {unit} and more"));
    [ends.0].into_iter().chain(between).chain([ends.1]).collect()
}

/// Arrow heads along the lines where no line leads back nearby; of those that would crowd the first.
fn one_way_arrows(routes: &[Vec<Point2>], frame: &FloorFrame) -> String {
    let lines: Vec<Segment> = routes
        .iter()
        .flat_map(|route| route.windows(2).map(|w| Segment { a: w[0], b: w[1] }))
        .filter(|line| line.a.is_finite() && line.b.is_finite() && line.a != line.b)
        .collect();
    let mut path = String::new();
    let mut drawn: Vec<(f64, f64)> = Vec::new();
    for line in &lines {
        let along = line.b - line.a;
        let n = (along.norm_m() / ARROW_EVERY_M).clamp(1.0, 1_000.0) as usize;
        for k in 0..n {
            let place = line.a.lerp(line.b, (k as f64 + 0.5) / n as f64);
            let (x, y) = frame.at(place);
            let is_crowded = drawn.iter().any(|at| (at.0 - x).hypot(at.1 - y) < ARROWS_APART);
            if !is_crowded && !lines.iter().any(|other| leads_back(other, along, place)) {
                let tip = along * (1.0 / along.norm_m());
                let (dx, dy) = (3.2 * tip.x_m, -3.2 * tip.y_m);
                let left = (x - dx + 0.8 * dy, y - dy - 0.8 * dx);
                let right = (x - dx - 0.8 * dy, y - dy + 0.8 * dx);
                let _ = write!(path, "M{}", points([left, (x, y), right]));
                drawn.push((x, y));
            }
        }
    }
    path
}

/// Whether `other` passes `place` against the direction `along`, within 45°.
fn leads_back(other: &Segment, along: Point2, place: Point2) -> bool {
    let back = other.b - other.a;
    let dot = along.x_m * back.x_m + along.y_m * back.y_m;
    dot < -0.7 * along.norm_m() * back.norm_m() && other.distance_m(place) <= BACK_WITHIN_M
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::floor_plan::{FloorPlan, Georeference, Polygon};
    use fieldwalk::map::{FloorMap, GridFrame, Layers};
    use roxmltree::{Document, Node};

    /// A floor of 20 m × 10 m, known to `sd_ut` along y = 5, walked along `routes`.
    fn surveyed(name: &str, routes: Vec<Vec<Point2>>) -> FloorIndex {
        let frame = GridFrame::covering(20.0, 10.0, 0.5);
        let place = |node: usize| frame.node(node % frame.nx, node / frame.nx);
        let layers = Layers {
            route_distance_m: (0..frame.len()).map(|node| (place(node).y_m - 5.0).abs() as f32).collect(),
            field_variance_ut2: vec![6.25; frame.len()],
            ..Layers::default()
        };
        let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)].map(|(x, y)| Point2::new(x, y));
        let plan = FloorPlan {
            width_m: 20.0,
            height_m: 10.0,
            outline: vec![Polygon { rings: vec![corners.to_vec()] }],
            georeference: Some(Georeference { latitude_deg_per_m: 9e-6, ..Georeference::default() }),
            ..FloorPlan::default()
        };
        FloorIndex::new(FloorMap { name: name.into(), plan, frame, layers, routes, ..FloorMap::default() })
    }

    fn drawn(floor: &FloorIndex, scores: &[(Point2, ScoredFix)]) -> String {
        Picture { building: "a <b> & \"c\"", floor, coverage: Coverage::of(floor), scores }.to_svg()
    }

    fn score(x_m: f64, error_m: f64) -> (Point2, ScoredFix) {
        (Point2::new(x_m, 5.0), ScoredFix { error_m, radius_68_m: 2.0, radius_95_m: 4.0 })
    }

    fn walk(x_from: f64, x_to: f64) -> Vec<Point2> {
        vec![Point2::new(x_from, 5.0), Point2::new(x_to, 5.0)]
    }

    fn of_class<'a>(document: &'a Document<'a>, class: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
        document.descendants().filter(move |node| node.attribute("class") == Some(class))
    }

    #[test]
    fn walks_scores_and_classes_are_those_of_the_survey() {
        let floor = surveyed("<F1>", vec![walk(1.0, 19.0), walk(19.0, 10.0), walk(2.0, 8.0)]);
        let scores = [score(4.0, 0.5), score(10.0, 2.0), score(16.0, 7.0), score(17.0, f64::NAN)];
        let svg = drawn(&floor, &scores);
        let document = Document::parse(&svg).unwrap();
        assert_eq!(of_class(&document, "fw-walk").count(), 3);
        assert_eq!(of_class(&document, "fw-north").count(), 2);
        let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
        for said in
            ["Survey of a <b> & \"c\", floor <F1>", "below 1 m", "3–5", "5 m and more", "no line within 3 m"]
        {
            assert!(texts.contains(&said), "{said}: {texts:?}");
        }
        assert!(texts.iter().any(|text| text.starts_with("3 walks, 0.03 km")), "{texts:?}");
        // Finite scores and one dot a class in the legend, in the class's colour.
        for (colour, n) in ERROR_COLOURS.iter().zip([2, 1, 2, 1, 2]) {
            let dots = of_class(&document, "fw-score").filter(|node| node.attribute("fill") == Some(colour));
            assert_eq!(dots.count(), n, "{colour}");
        }
        // A variance of 6.25 µT² is 2.5 µT: the second class within 3 m of the line, a gap beyond.
        let fills: Vec<_> =
            of_class(&document, "fw-cells").filter_map(|node| node.attribute("fill")).collect();
        assert_eq!(fills[..2], [FIELD_COLOURS[1], FIELD_COLOURS[NOT_COVERED]]);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn arrows_stand_where_no_walk_leads_back() {
        let frame = FloorFrame::fitted(&surveyed("F1", Vec::new()).map().plan, (0.0, 0.0), (200.0, 100.0));
        let heads = |routes: &[Vec<Point2>]| one_way_arrows(routes, &frame).matches('M').count();
        assert_eq!(heads(&[walk(1.0, 19.0)]), 3);
        // Arrows of a second line in the same place would only crowd.
        assert_eq!(heads(&[walk(1.0, 19.0), walk(1.0, 19.0)]), 3);
        assert_eq!(heads(&[walk(1.0, 19.0), walk(19.0, 1.0)]), 0);
        assert_eq!(heads(&[walk(f64::NAN, 19.0), walk(3.0, 3.0)]), 0);
    }

    #[test]
    fn tall_floors_stand_side_by_side_and_narrow_corridors_are_shaded() {
        let mut map = surveyed("F1", vec![walk(1.0, 19.0)]).map().clone();
        (map.plan.width_m, map.plan.height_m) = (12.0, 40.0);
        let svg = drawn(&FloorIndex::new(map), &[score(4.0, 0.5)]);
        let document = Document::parse(&svg).unwrap();
        let root = document.root_element();
        let side = |name| root.attribute(name).unwrap().parse::<f64>().unwrap();
        assert_eq!((side("width"), side("height")), (688.0, HEADER + ABOVE + BESIDE.1 + BELOW));
        let tops: Vec<f64> = of_class(&document, "fw-title")
            .skip(1)
            .map(|title| title.attribute("y").unwrap().parse().unwrap())
            .collect();
        assert!(tops.len() == 2 && tops[0] == tops[1], "{tops:?}");
        // Everything that is written ends inside the picture.
        for text in document.descendants().filter(|node| node.has_tag_name("text")) {
            let x: f64 = text.attribute("x").unwrap().parse().unwrap();
            assert!(x + text_width(text.text().unwrap_or(""), 12.0) <= 688.0 + 8.0, "{:?}", text.text());
        }
    }

    #[test]
    fn an_empty_survey_and_a_single_walk_are_drawn() {
        for routes in [Vec::new(), vec![walk(1.0, 19.0)], vec![Vec::new(), vec![Point2::new(f64::NAN, 1.0)]]]
        {
            let svg = drawn(&surveyed("F1", routes.clone()), &[]);
            let document = Document::parse(&svg).unwrap();
            assert_eq!(of_class(&document, "fw-walk").count(), routes.len());
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.contains("not worked out"), "{svg}");
        }
        let svg = drawn(&FloorIndex::new(FloorMap::default()), &[score(0.0, 1.0)]);
        assert!(Document::parse(&svg).is_ok() && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn the_file_stands_beside_the_map_under_a_tame_name() {
        let at = |map: &str, dir: Option<&str>, file: &str| path(Path::new(map), dir.map(Path::new), file);
        assert_eq!(at("a/mall.map", None, "F1.safetensors"), Path::new("a/mall-F1-survey.svg"));
        assert_eq!(at("mall", Some("p"), "____tage.safetensors"), Path::new("p/mall-____tage-survey.svg"));
        assert_eq!(at(".", None, "F1.safetensors"), Path::new("map-F1-survey.svg"));
    }
}
