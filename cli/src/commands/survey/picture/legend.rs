//! What the colours and marks of a floor's picture stand for.

use fieldwalk::geometry::Point2;

use crate::commands::survey::picture::BESIDE;
use crate::plot::floor::FloorFrame;
use crate::plot::svg::{Anchor, Svg, text_width};

/// Room at the right end of a panel's legend, for the arrow to the north.
const NORTH: f64 = 30.0;

/// Entries in rows under a floor, beside the scale bar's row.
pub struct Legend {
    left: f64,
    right: f64,
    x: f64,
    y: f64,
}

impl Legend {
    /// An empty legend under the floor of `frame`.
    pub fn below(frame: &FloorFrame) -> Self {
        let (left, top) = frame.at(Point2::default());
        Self { left, right: right_of(frame) - NORTH, x: left, y: top + 38.0 }
    }

    /// A `mark` with its `text`, in a new row where this one is full.
    pub fn entry(&mut self, svg: &mut Svg, text: &str, mark: impl FnOnce(&mut Svg, f64, f64)) {
        let width = 44.0 + text_width(text, 12.0);
        if self.x > self.left && self.x + width - 14.0 > self.right {
            (self.x, self.y) = (self.left, self.y + 17.0);
        }
        mark(svg, self.x, self.y);
        svg.text("fw-label", (self.x + 28.0, self.y), Anchor::Start, text);
        self.x += width;
    }

    /// A patch of `fill` with its `text`.
    pub fn swatch(&mut self, svg: &mut Svg, fill: &str, text: &str) {
        self.entry(svg, text, |svg, x, y| {
            svg.rectangle("fw-swatch", (x, y - 11.0), (22.0, 12.0), fill);
        });
    }

    /// A line of small text under the rows.
    pub fn note(&mut self, svg: &mut Svg, text: &str) {
        svg.text("fw-small", (self.left, self.y + 17.0), Anchor::Start, text);
    }
}

/// Where a panel ends, which is wider than a narrow floor.
pub fn right_of(frame: &FloorFrame) -> f64 {
    frame.at(Point2::default()).0 + frame.size().0.max(BESIDE.0)
}
