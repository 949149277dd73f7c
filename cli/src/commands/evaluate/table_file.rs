//! A table of feature events in a file.

use std::path::Path;

use fieldwalk::attitude::EventTable;
use fieldwalk_formats::FormatError;

/// A table is below a kilobyte.
const MAX_BYTES: u64 = 64 * 1024;
const REMEDY: &str = "write one with `fieldwalk train attitude`";

/// Reads the table in `path`.
pub fn read(path: &Path) -> Result<EventTable, FormatError> {
    let metadata = path.metadata().map_err(|error| FormatError::io("open the table", path, error))?;
    if metadata.len() > MAX_BYTES {
        return Err(FormatError::malformed("larger than any table of events", REMEDY).at_path(path));
    }
    let text =
        std::fs::read_to_string(path).map_err(|error| FormatError::io("read the table", path, error))?;
    let table: EventTable = serde_json::from_str(&text).map_err(|error| {
        FormatError::malformed(format!("not a table of events: {error}"), REMEDY).at_path(path)
    })?;
    if table.is_valid() {
        Ok(table)
    } else {
        Err(FormatError::malformed("a column or the prior is no distribution", REMEDY).at_path(path))
    }
}
