//! Recordings read as survey walks.

use std::path::{Path, PathBuf};

use fieldwalk::survey::{SurveyWalk, Waypoint};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::{LineRejections, TraceReader};
use fieldwalk_formats::recording::Record;

use crate::in_order::InOrder;

/// A walk, condensed, and what its file had that is no record.
#[derive(Clone, Debug)]
pub struct ReadWalk {
    /// The file.
    pub path: PathBuf,
    /// What the walk says.
    pub walk: SurveyWalk,
    /// The lines that were not understood.
    pub lines: LineRejections,
}

impl ReadWalk {
    /// Reads the trace at `path` as a stream, in order of time.
    ///
    /// # Errors
    /// When the file cannot be read or is no trace.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        Self::open_with(path, |_| ())
    }

    /// As [`ReadWalk::open`], showing every record to `inspect` as well, in order of time.
    ///
    /// # Errors
    /// When the file cannot be read or is no trace.
    pub fn open_with(path: &Path, mut inspect: impl FnMut(&Record)) -> Result<Self, FormatError> {
        let mut walk = SurveyWalk::new(path.display().to_string());
        let mut reader = TraceReader::open(path)?;
        for record in InOrder::new(reader.by_ref()) {
            let record = record?;
            inspect(&record);
            match record {
                Record::Sample(sample) => walk.push(&sample),
                Record::Waypoint { time, point } => walk.push_waypoint(Waypoint { time, point }),
            }
        }
        walk.finish();
        Ok(Self { path: path.into(), walk, lines: reader.rejections().clone() })
    }
}
