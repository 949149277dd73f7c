//! Maps, opened.

use std::path::Path;
use std::sync::Arc;

use fieldwalk::map::{FloorIndex, FloorMap};
use fieldwalk_formats::{decode_floor, open_building};

use crate::error::{ApiError, api_error};

/// A surveyed building, ready for positioning; shared by any number of positioners.
#[derive(Debug, uniffi::Object)]
pub struct BuildingMap {
    name: String,
    floors: Vec<Arc<FloorIndex>>,
}

/// What a list of floors shows.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct FloorInfo {
    /// The floor's name, such as `F1`.
    pub name: String,
    /// The floor's number: 0 is the ground floor.
    pub ordinal: i32,
    /// The plan's extent along x, in metres.
    pub width_m: f64,
    /// The plan's extent along y, in metres.
    pub height_m: f64,
}

#[uniffi::export]
impl BuildingMap {
    /// Opens the building in the folder at `path`, as the survey exported it.
    ///
    /// # Errors
    /// When a file is missing, cannot be read, is no map, has changed since it was written, or is too new.
    #[uniffi::constructor]
    pub fn open(path: &str) -> Result<Arc<Self>, ApiError> {
        let building = open_building(Path::new(path))?;
        Ok(Self::indexed(building.name, building.floors))
    }

    /// Opens the building called `name` from the content of its floors' files, for apps that keep maps in an archive
    /// or fetch them.
    ///
    /// # Errors
    /// When a file is no floor's map, has changed since it was written, or is too new.
    #[uniffi::constructor]
    pub fn from_floor_files(name: String, files: Vec<Vec<u8>>) -> Result<Arc<Self>, ApiError> {
        let mut floors = files.iter().map(|file| decode_floor(file)).collect::<Result<Vec<_>, _>>()?;
        floors.sort_by_key(|floor| floor.ordinal);
        Ok(Self::indexed(name, floors))
    }

    /// The building's name.
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// The floors, from the lowest to the highest.
    pub fn floors(&self) -> Vec<FloorInfo> {
        let info = |floor: &Arc<FloorIndex>| {
            let FloorMap { name, ordinal, plan, .. } = floor.map();
            FloorInfo {
                name: name.clone(),
                ordinal: *ordinal,
                width_m: plan.width_m,
                height_m: plan.height_m,
            }
        };
        self.floors.iter().map(info).collect()
    }
}

impl BuildingMap {
    /// The maps of all floors.
    pub(crate) fn floor_maps(&self) -> impl Iterator<Item = &FloorMap> {
        self.floors.iter().map(|floor| floor.map())
    }

    /// The floor of that ordinal.
    pub(crate) fn floor(&self, ordinal: i32) -> Result<Arc<FloorIndex>, ApiError> {
        let floor = self.floors.iter().find(|floor| floor.map().ordinal == ordinal);
        floor.cloned().ok_or_else(|| {
            api_error!(
                UnknownFloor,
                "the building has no floor of that ordinal",
                "give one of those that the map lists"
            )
        })
    }

    fn indexed(name: String, floors: Vec<FloorMap>) -> Arc<Self> {
        let floors = floors.into_iter().map(|floor| Arc::new(FloorIndex::new(floor))).collect();
        Arc::new(Self { name, floors })
    }
}
