//! The public layout of the indoor-location-competition-20 collection: floors and their walks.
//!
//! A floor is a folder with `floor_info.json` (extent in metres), `geojson_map.json` (outline and shops) and a folder
//! of text traces, one per walk. [`Floor`] opens the folder, [`TraceReader`] streams one walk.

mod floor;
mod line;
mod rejections;
mod trace;

pub use floor::{Floor, floor_ordinal, is_floor_name};
pub use rejections::{LineFault, LineRejections};
pub use trace::TraceReader;
