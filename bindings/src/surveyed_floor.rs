//! A floor's map as its survey made it, with what it is worth.

use std::sync::Arc;

use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk::metrics::ErrorSummary;
use fieldwalk::survey::{Coverage, LeaveOneOut, SurveyParams, SurveyWalk, build_floor};
use fieldwalk::system::Recipe;

use crate::building_map::FloorInfo;
use crate::error::ApiError;
use crate::fix::Point2;

/// The seed of the runs that tell the expected accuracy; another one changes it by a few centimetres.
const SEED: u64 = 1;

/// A surveyed floor: its map, its coverage, and the accuracy to expect there.
#[derive(Debug, uniffi::Object)]
pub struct SurveyedFloor {
    map: FloorMap,
    walks: Vec<SurveyWalk>,
}

/// What a survey covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, uniffi::Record)]
pub struct CoverageTotals {
    /// Area where one may stand by the plan, in m².
    pub open_m2: f64,
    /// Part of it within 3 m of a surveyed line, in m².
    pub covered_m2: f64,
    /// Total length of the surveyed lines, in metres.
    pub route_m: f64,
    /// Transmitters in the map; none are known before it is built.
    pub n_transmitters: u32,
}

/// The errors to expect, from walks positioned on the map of all others.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct ExpectedAccuracy {
    /// Median error, in metres.
    pub median_m: f64,
    /// Mean error, in metres.
    pub mean_m: f64,
    /// 80 of 100 errors are within this, in metres.
    pub p80_m: f64,
    /// 90 of 100 errors are within this, in metres.
    pub p90_m: f64,
    /// Share of errors within the 68 % radius that the fix states, 0 to 1.
    pub inside_68: f64,
    /// Share of errors within the 95 % radius that the fix states, 0 to 1.
    pub inside_95: f64,
    /// The waypoints at which walks were scored.
    pub places: Vec<ScoredPlace>,
}

/// The error at one waypoint.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct ScoredPlace {
    /// The waypoint.
    pub point: Point2,
    /// How far off the fix was, in metres.
    pub error_m: f64,
    /// The 68 % radius that it stated, in metres.
    pub radius_68_m: f64,
}

#[uniffi::export]
impl SurveyedFloor {
    /// The floor's name, ordinal and extent.
    pub fn info(&self) -> FloorInfo {
        FloorInfo::from(&self.map)
    }

    /// What the survey covers, in the map's own grid.
    pub fn coverage(&self) -> CoverageTotals {
        Coverage::of(&FloorIndex::new(self.map.clone())).into()
    }

    /// What errors to expect of the system `fused`: each walk is positioned on the map of all others. Nothing when no
    /// walk could be left out, such as with a single one.
    ///
    /// This takes from a second for a small office to minutes for a mall: call it on a thread that nobody waits for.
    pub fn expected_accuracy(&self) -> Option<ExpectedAccuracy> {
        let (recipe, params) = (Recipe::fused(), SurveyParams::default());
        let survey = LeaveOneOut::new(&self.map, &self.walks, &params);
        let scored: Vec<_> =
            (0..self.walks.len()).flat_map(|walk| survey.score(walk, &recipe, SEED)).collect();
        let fixes: Vec<_> = scored.iter().map(|(_, fix)| *fix).collect();
        let ErrorSummary {
            n_points: _,
            median_m,
            mean_m,
            p80_m,
            p90_m,
            inside_68,
            inside_95,
            radius_68_median_m: _,
        } = ErrorSummary::of(&fixes)?;
        let places = scored.into_iter().map(|(point, fix)| ScoredPlace {
            point: point.into(),
            error_m: fix.error_m,
            radius_68_m: fix.radius_68_m,
        });
        let places = places.collect();
        Some(ExpectedAccuracy { median_m, mean_m, p80_m, p90_m, inside_68, inside_95, places })
    }
}

impl SurveyedFloor {
    /// The map of `walks` on `plan`.
    ///
    /// # Errors
    /// When they give none.
    pub(crate) fn build(
        name: &str,
        ordinal: i32,
        plan: &fieldwalk::floor_plan::FloorPlan,
        walks: Vec<SurveyWalk>,
    ) -> Result<Arc<Self>, ApiError> {
        let map = build_floor(name, ordinal, plan, &walks, &SurveyParams::default())?;
        Ok(Arc::new(Self { map, walks }))
    }

    /// The map.
    pub(crate) fn map(&self) -> &FloorMap {
        &self.map
    }
}

impl From<Coverage> for CoverageTotals {
    fn from(coverage: Coverage) -> Self {
        let Coverage { open_m2, covered_m2, route_m, n_transmitters } = coverage;
        Self { open_m2, covered_m2, route_m, n_transmitters: n_transmitters as u32 }
    }
}
