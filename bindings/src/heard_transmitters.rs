//! What a phone is to listen for.

use std::collections::BTreeSet;

use fieldwalk::sensor::TransmitterId;

use crate::building_map::BuildingMap;

#[uniffi::export]
impl BuildingMap {
    /// The UUIDs of the map's iBeacons, sixteen bytes each, every one once: iOS hears no iBeacon whose UUID it is not told.
    pub fn ibeacon_uuids(&self) -> Vec<Vec<u8>> {
        let transmitters = self.floor_maps().flat_map(|floor| &floor.transmitters);
        let uuids: BTreeSet<[u8; 16]> = transmitters
            .filter_map(|transmitter| match transmitter.id {
                TransmitterId::Ibeacon { uuid, .. } => Some(uuid),
                _ => None,
            })
            .collect();
        uuids.into_iter().map(Vec::from).collect()
    }

    /// Whether any floor has WiFi access points: where there are none it is all the same whether WiFi is switched on.
    pub fn has_access_points(&self) -> bool {
        let mut transmitters = self.floor_maps().flat_map(|floor| &floor.transmitters);
        transmitters.any(|transmitter| matches!(transmitter.id, TransmitterId::WifiBssid(_)))
    }
}

#[cfg(test)]
mod tests {
    use fieldwalk::floor_plan::FloorPlan;
    use fieldwalk::map::{FloorMap, Transmitter};

    use super::*;

    fn heard(id: TransmitterId) -> Transmitter {
        Transmitter {
            id,
            position: Default::default(),
            power_at_1m_dbm: -59.0,
            path_loss_exponent: 2.0,
            sigma_db: 5.0,
            n_sightings: 40,
        }
    }

    fn file(ordinal: i32, transmitters: Vec<Transmitter>) -> Vec<u8> {
        let plan = FloorPlan { width_m: 20.0, height_m: 10.0, ..Default::default() };
        let name = format!("F{ordinal}");
        let floor = FloorMap { name, ordinal, plan, transmitters, ..Default::default() };
        fieldwalk_formats::encode_floor(&floor).unwrap()
    }

    #[test]
    fn every_uuid_of_any_floor_is_told_once() {
        let beacon = |first, minor| heard(TransmitterId::Ibeacon { uuid: [first; 16], major: 1, minor });
        let files = vec![
            file(1, vec![beacon(7, 1), beacon(7, 2), heard(TransmitterId::BleAddress([1; 6]))]),
            file(2, vec![beacon(3, 1), beacon(7, 3)]),
        ];
        let map = BuildingMap::from_floor_files("Hall".into(), files).unwrap();
        assert_eq!(map.ibeacon_uuids(), [vec![3; 16], vec![7; 16]]);
        assert!(!map.has_access_points());
    }

    #[test]
    fn an_access_point_on_any_floor_is_one_to_listen_for() {
        let wifi = heard(TransmitterId::WifiBssid([1; 6]));
        let files = vec![file(1, vec![heard(TransmitterId::BleAddress([1; 6]))]), file(2, vec![wifi])];
        assert!(BuildingMap::from_floor_files("Hall".into(), files).unwrap().has_access_points());
    }
}
