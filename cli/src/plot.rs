//! Pictures as self-contained SVG: lines, distributions, scatter, bars and boxes in one light style.
//!
//! The SVG is written by hand rather than by a plotting crate, since it has to follow the reader's light or dark
//! setting, keep its text as text, and stand inside an HTML page: that takes classes and a style sheet, which those
//! crates do not write. Drawing is deterministic: the same numbers give the same bytes. Values that are not finite are
//! left out, and names are escaped.
//!
//! ```
//! use fieldwalk_cli::plot::{Chart, Series, cdf};
//! let errors_m = [0.4, 0.9, 1.3, 2.8];
//! let distribution: String = cdf("Errors of four fixes", "error (m)", &[("fused", &errors_m)]).to_svg();
//! let walk = Series::line("error", vec![(0.0, 0.4), (1.0, 0.9), (2.0, 1.3)]);
//! let line: String = Chart::new("Error over time", "time (s)", "error (m)").with(walk).to_svg();
//! # assert!(distribution.starts_with("<svg") && line.contains("Error over time"));
//! ```

pub mod axis;
pub mod chart;
pub mod floor;
pub mod rows;
pub mod style;
pub mod svg;

pub use axis::Scale;
pub use chart::{Chart, Mark, Series, cdf};
pub use floor::FloorFrame;
pub use rows::{Row, Rows, Shape};
pub use svg::Svg;
