//! Recordings read as survey walks.

use std::path::{Path, PathBuf};

use fieldwalk::floor_plan::Georeference;
use fieldwalk::survey::{SurveyWalk, Waypoint};
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ilc::{LineRejections, floor_ordinal};
use fieldwalk_formats::recording::{InOrder, Losses, Record, RecordSource, open_recording_on};

/// A walk, condensed, and what its file had that is no record.
#[derive(Clone, Debug)]
pub struct ReadWalk {
    /// The file.
    pub path: PathBuf,
    /// What the walk says.
    pub walk: SurveyWalk,
    /// The floor that the log says it was taken on.
    pub floor_name: Option<String>,
    /// What the log did not give.
    pub losses: Losses,
    /// Of a text log, the lines that were not understood.
    pub lines: LineRejections,
}

impl ReadWalk {
    /// Reads the log at `path`, of any format, as a stream, in order of time. Waypoints in degrees are placed on the
    /// floor at `georeference`.
    ///
    /// # Errors
    /// When the file cannot be read or is no log, and when it has waypoints in degrees and there is no georeference.
    pub fn open(path: &Path, georeference: Option<Georeference>) -> Result<Self, FormatError> {
        Self::open_with(path, georeference, |_| ())
    }

    /// As [`ReadWalk::open`], showing every record to `inspect` as well, in order of time.
    ///
    /// # Errors
    /// As [`ReadWalk::open`].
    pub fn open_with(
        path: &Path,
        georeference: Option<Georeference>,
        mut inspect: impl FnMut(&Record),
    ) -> Result<Self, FormatError> {
        let mut walk = SurveyWalk::new(path.display().to_string());
        let mut log = InOrder::new(open_recording_on(path, georeference)?);
        while let Some(record) = log.next() {
            let record = record?;
            inspect(&record);
            match record {
                Record::Sample(sample) => walk.push(&sample),
                Record::Waypoint { time, point } => {
                    check_frame(&**log.source(), path)?;
                    walk.push_waypoint(Waypoint { time, point });
                }
            }
        }
        walk.finish();
        let source = log.source();
        Ok(Self {
            path: path.into(),
            walk,
            floor_name: source.floor_name().map(String::from),
            losses: source.losses(),
            lines: source.line_rejections().cloned().unwrap_or_default(),
        })
    }

    /// The floor that the log says it was taken on, where that is another than the one called `floor`.
    ///
    /// Floors of a building share one frame, so its places would look plausible and be wrong.
    pub fn other_floor(&self, floor: &str) -> Option<&str> {
        self.floor_name.as_deref().filter(|name| floor_ordinal(name) != floor_ordinal(floor))
    }
}

/// Refuses waypoints that cannot be placed on the floor: they would look plausible and be wrong.
pub fn check_frame(log: &dyn RecordSource, path: &Path) -> Result<(), FormatError> {
    if log.is_in_floor_frame() {
        return Ok(());
    }
    Err(FormatError::malformed(
        "its waypoints are in degrees, and the floor's plan has no georeference",
        "draw the plan in longitude and latitude, or give it a `georeference`",
    )
    .at_path(path))
}
