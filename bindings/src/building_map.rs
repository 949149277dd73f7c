//! Maps, opened.

use std::path::Path;
use std::sync::Arc;

use fieldwalk::map::{self, FloorIndex, FloorMap};
use fieldwalk_formats::{decode_floor, open_building, pack_building, unpack_building, write_building};

use crate::error::{ApiError, api_error};
use crate::floor_drawing::FloorDrawing;
use crate::surveyed_floor::SurveyedFloor;

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
    /// Opens the building at `path`: the folder that a survey exported, or the same as one file.
    ///
    /// # Errors
    /// When a file is missing, cannot be read, is no map, has changed since it was written, or is too new.
    #[uniffi::constructor]
    pub fn open(path: &str) -> Result<Arc<Self>, ApiError> {
        let building = open_building(Path::new(path))?;
        Ok(Self::indexed(building.name, building.floors))
    }

    /// Opens the building in `file`, the content of a map as one file: what `export` gives, or an uncompressed tar
    /// archive of the map's folder (`tar -cf mall.tar mall.map`).
    ///
    /// # Errors
    /// When it is no such archive or not all of one, lacks a file, and as `open`.
    #[uniffi::constructor]
    pub fn from_file(file: &[u8]) -> Result<Arc<Self>, ApiError> {
        let building = unpack_building(file)?;
        Ok(Self::indexed(building.name, building.floors))
    }

    /// Puts surveyed floors together to a building called `name`.
    ///
    /// # Errors
    /// When two floors have one ordinal or one name, and without any floor.
    #[uniffi::constructor]
    pub fn of_survey(name: String, floors: Vec<Arc<SurveyedFloor>>) -> Result<Arc<Self>, ApiError> {
        let mut maps: Vec<FloorMap> = floors.iter().map(|floor| floor.map().clone()).collect();
        maps.sort_by_key(|map| map.ordinal);
        let mut names: Vec<&str> = maps.iter().map(|map| map.name.as_str()).collect();
        names.sort_unstable();
        let is_double = maps.windows(2).any(|pair| pair[0].ordinal == pair[1].ordinal)
            || names.windows(2).any(|pair| pair[0] == pair[1]);
        if maps.is_empty() || is_double {
            return Err(api_error!(
                SurveyIncomplete,
                "a building has at least one floor, and each has a name and an ordinal of its own",
                "survey each floor under its own name and ordinal"
            ));
        }
        // Layers lose their last bits on disk: fixes are the same before the map is exported and after.
        let building = unpack_building(&pack_building(&map::BuildingMap { name, floors: maps })?)?;
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

    /// The map as one file, to share or to keep; the same map gives the same bytes.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn export(&self) -> Result<Vec<u8>, ApiError> {
        Ok(pack_building(&self.to_core())?)
    }

    /// Writes the map as a folder, which is made if need be; files of a map that is there are replaced, each whole or
    /// not at all.
    ///
    /// # Errors
    /// When the operating system refuses, and when there is no room.
    pub fn save(&self, path: &str) -> Result<(), ApiError> {
        write_building(Path::new(path), &self.to_core()).map_err(|error| ApiError::of_writing(&error))
    }

    /// What to draw of the plan of the floor with that ordinal.
    ///
    /// # Errors
    /// When the map has no such floor.
    pub fn drawing(&self, floor: i32) -> Result<FloorDrawing, ApiError> {
        Ok(FloorDrawing::from(&self.floor(floor)?.map().plan))
    }

    /// The building's name.
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// The floors, from the lowest to the highest.
    pub fn floors(&self) -> Vec<FloorInfo> {
        self.floors.iter().map(|floor| FloorInfo::from(floor.map())).collect()
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

    fn to_core(&self) -> map::BuildingMap {
        let floors = self.floors.iter().map(|floor| floor.map().clone()).collect();
        map::BuildingMap { name: self.name.clone(), floors }
    }

    fn indexed(name: String, floors: Vec<FloorMap>) -> Arc<Self> {
        let floors = floors.into_iter().map(|floor| Arc::new(FloorIndex::new(floor))).collect();
        Arc::new(Self { name, floors })
    }
}

impl From<&FloorMap> for FloorInfo {
    fn from(map: &FloorMap) -> Self {
        let FloorMap { name, ordinal, plan, .. } = map;
        Self { name: name.clone(), ordinal: *ordinal, width_m: plan.width_m, height_m: plan.height_m }
    }
}
