//! The report: one page that plays walks on a floor plan, with every system's errors; it needs no network.
//!
//! [`WalkRecorder`] runs systems over a walk and keeps what a page shows, [`Report`] gathers walks, floors and errors,
//! [`page`] writes them into a file.

mod floor;
mod model;
mod packed;
pub mod page;
mod recorder;
mod summary;
mod truth;

pub use model::{Band, Report, Span, Walk};
pub use recorder::WalkRecorder;
pub(crate) use recorder::mode_name;
pub use summary::{ErrorCurve, WalkErrors};
pub use truth::Truth;
