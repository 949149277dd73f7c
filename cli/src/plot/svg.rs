//! SVG text: elements, escaped text and rounded coordinates.

use std::fmt::{self, Display, Write as _};

/// A document that is being written.
#[derive(Clone, Debug)]
pub struct Svg {
    text: String,
    open: Vec<&'static str>,
}

/// An attribute's name and value; values are escaped.
pub type Attribute<'a> = (&'static str, &'a dyn Display);

/// A coordinate, rounded to a hundredth; 0 where it is not finite, so that no reader refuses the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Px(pub f64);

/// Where a text stands about its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The text's middle is there.
    Middle,
    /// The text ends there.
    End,
}

impl Svg {
    /// A document of `width` × `height` units that scales with the page, under a title for readers of the screen.
    pub fn new(width: f64, height: f64, title: &str, style: &str) -> Self {
        let mut svg = Self { text: String::new(), open: Vec::new() };
        let view = format!("0 0 {} {}", Px(width), Px(height));
        let attributes: [Attribute<'_>; 6] = [
            ("xmlns", &"http://www.w3.org/2000/svg"),
            ("viewBox", &view),
            ("width", &Px(width)),
            ("height", &Px(height)),
            ("role", &"img"),
            ("style", &"max-width:100%;height:auto"),
        ];
        svg.open("svg", &attributes);
        svg.leaf("title", &[], title);
        svg.leaf("style", &[], style);
        svg
    }

    /// Begins an element that [`Svg::close`] ends.
    pub fn open(&mut self, tag: &'static str, attributes: &[Attribute<'_>]) {
        self.tag(tag, attributes);
        self.text.push_str(">\n");
        self.open.push(tag);
    }

    /// Ends the element begun last.
    pub fn close(&mut self) {
        if let Some(tag) = self.open.pop() {
            self.write(format_args!("</{tag}>\n"));
        }
    }

    /// An element without content.
    pub fn element(&mut self, tag: &'static str, attributes: &[Attribute<'_>]) {
        self.tag(tag, attributes);
        self.text.push_str("/>\n");
    }

    /// An element that holds text.
    pub fn leaf(&mut self, tag: &'static str, attributes: &[Attribute<'_>], content: &str) {
        self.tag(tag, attributes);
        self.write(format_args!(">{}</{tag}>\n", Escaped(&content)));
    }

    /// A line of text of the style `class` at a point.
    pub fn text(&mut self, class: &str, (x, y): (f64, f64), anchor: Anchor, content: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let attributes: [Attribute<'_>; 4] =
            [("class", &class), ("x", &Px(x)), ("y", &Px(y)), ("text-anchor", &anchor)];
        self.leaf("text", &attributes, content);
    }

    /// A straight line of the style `class`.
    pub fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        let attributes: [Attribute<'_>; 5] = [
            ("class", &class),
            ("x1", &Px(from.0)),
            ("y1", &Px(from.1)),
            ("x2", &Px(to.0)),
            ("y2", &Px(to.1)),
        ];
        self.element("line", &attributes);
    }

    /// A rectangle of the style `class`, from its upper left corner.
    pub fn rectangle(&mut self, class: &str, (x, y): (f64, f64), (width, height): (f64, f64), fill: &str) {
        let attributes: [Attribute<'_>; 6] = [
            ("class", &class),
            ("x", &Px(x)),
            ("y", &Px(y)),
            ("width", &Px(width.max(0.0))),
            ("height", &Px(height.max(0.0))),
            ("fill", &fill),
        ];
        self.element("rect", &attributes);
    }

    /// The finished text; elements still open are closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn tag(&mut self, tag: &str, attributes: &[Attribute<'_>]) {
        self.write(format_args!("<{tag}"));
        for (name, value) in attributes {
            self.write(format_args!(" {name}=\"{}\"", Escaped(value)));
        }
    }

    fn write(&mut self, arguments: fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.text.write_fmt(arguments);
    }
}

/// The points of a polyline; those that are not finite are left out.
pub fn points(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut text = String::new();
    for (x, y) in points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()) {
        let gap = if text.is_empty() { "" } else { " " };
        let _ = write!(text, "{gap}{},{}", Px(x), Px(y));
    }
    text
}

/// About how wide `text` is in a sans-serif font of `size`: there is no font to measure.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

impl Display for Px {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = if self.0.is_finite() { (self.0 * 100.0).round() / 100.0 } else { 0.0 };
        // Without the sign of a negative zero.
        write!(f, "{}", rounded + 0.0)
    }
}

struct Escaped<'a>(&'a dyn Display);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Escape(f), "{}", self.0)
    }
}

struct Escape<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl fmt::Write for Escape<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            match c {
                '<' => self.0.write_str("&lt;")?,
                '>' => self.0.write_str("&gt;")?,
                '&' => self.0.write_str("&amp;")?,
                '"' => self.0.write_str("&quot;")?,
                // XML has no way to write these.
                c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {
                    self.0.write_str("\u{fffd}")?
                }
                c => self.0.write_char(c)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_text_stays_text() {
        let hostile = "\"><script>alert('&')</script>\u{0}\u{1b}\u{ffff}\n";
        let mut svg = Svg::new(10.0, 10.0, hostile, "");
        svg.text(hostile, (f64::NAN, 1.0), Anchor::Start, hostile);
        let text = svg.finish();
        let document = roxmltree::Document::parse(&text).unwrap();
        let shown = "\"><script>alert('&')</script>\u{fffd}\u{fffd}\u{fffd}\u{fffd}";
        let node = document.descendants().find(|node| node.has_tag_name("text")).unwrap();
        assert_eq!(
            (node.text(), node.attribute("class"), node.attribute("x")),
            (Some(shown), Some(shown), Some("0"))
        );
        assert!(!document.descendants().any(|node| node.has_tag_name("script")));
    }

    #[test]
    fn coordinates_are_rounded_and_bad_points_left_out() {
        assert_eq!([1.0, 0.126, -0.001, f64::INFINITY].map(|x| Px(x).to_string()), ["1", "0.13", "0", "0"]);
        assert_eq!(points([(0.0, 1.0), (f64::NAN, 2.0), (3.5, 4.0)]), "0,1 3.5,4");
    }
}
