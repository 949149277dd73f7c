//! The scenarios by name: the papers' test beds, as far as the papers describe them, and a few more.

use crate::building::Building;
use crate::magnetic_field::{MovableParams, SteelParams};
use crate::radio::RadioScene;
use crate::scenario::{Scenario, Storey};

/// From the floor of a storey to the next, in metres: twenty rises of 0.17 m.
const STOREY_M: f64 = 3.4;

/// Where nothing is marked on the floor, surveyors tap on the plan's picture: error along each axis, in metres.
///
/// # Source
/// Half a metre to a metre in the recordings of indoor-location-competition-20, judged by how its steps fit its taps.
const TAPPED_ON_PICTURE_M: f64 = 0.5;

impl Scenario {
    /// The names that [`Self::named`] knows, in the order in which they are explained there.
    pub const NAMES: [&str; 7] = ["office", "corridors", "hall", "card-office", "ring", "mall", "two-floors"];

    /// The scenario of that name with the steel, the transmitters and the walks that `seed` gives it:
    ///
    /// | name | what it is |
    /// |---|---|
    /// | `office` | 60 × 40 m, corridors of 0.7 to 1.6 m, a hall, beacons 12 m apart: [`Building::office`] |
    /// | `corridors` | 60 × 40 m of corridors of 0.7 and 1.6 m, access points only: [`Building::corridors`] |
    /// | `hall` | 1800 m² without walls, two clusters of three iBeacons 50 m apart: [`Building::hall`] |
    /// | `card-office` | 20.5 × 16 m, three rooms, four beacons in the corners: [`Building::card_office`] |
    /// | `ring` | a ring of corridors of 67 × 12 m, no radio: [`Building::ring`] |
    /// | `mall` | 120 × 80 m, ways 8 to 12 m wide, weak steel, sparse beacons: [`Building::mall`] |
    /// | `two-floors` | two storeys of 40 × 24 m with stairs between: [`Building::storey_with_stairs`] |
    ///
    /// Nothing when no scenario has that name.
    pub fn named(name: &str, seed: u64) -> Option<Self> {
        let steel = SteelParams::default();
        let scenario = match name {
            "office" => Self::office(seed),
            "corridors" => {
                let mut corridors = Self::of_building(Building::corridors(), &steel, seed);
                corridors.radio.keep_access_points();
                corridors
            }
            "hall" => {
                let mut hall = Self::of_building(Building::hall(), &steel, seed);
                hall.radio = RadioScene::clusters(&hall.building, seed);
                hall
            }
            "card-office" => {
                let mut office = Self::of_building(Building::card_office(), &steel, seed);
                office.radio = RadioScene::corners(&office.building, seed);
                office
            }
            "ring" => {
                let mut ring = Self::of_building(Building::ring(), &steel, seed);
                ring.radio = RadioScene::default();
                ring
            }
            "mall" => {
                let mut mall = Self::of_building(Building::mall(), &SteelParams::concrete_frame(), seed);
                mall.radio = RadioScene::of_building(&mall.building, 25.0, seed);
                mall.movable = MovableParams::busy();
                mall.tap_sd_m = TAPPED_ON_PICTURE_M;
                mall
            }
            "two-floors" => {
                let building = Building::storey_with_stairs();
                let above = Storey { building: building.clone(), ordinal: 1, height_m: STOREY_M };
                let mut floors = Self::of_storeys(building, vec![above], &steel, seed);
                floors.radio.add_storey(&floors.upstairs[0].building, STOREY_M, seed);
                floors
            }
            _ => return None,
        };
        Some(scenario)
    }

    /// The office of 60 × 40 m ([`Building::office`]) with the steel and the transmitters that `seed` gives it.
    pub fn office(seed: u64) -> Self {
        Self::of_building(Building::office(), &SteelParams::default(), seed)
    }
}
