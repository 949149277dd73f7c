//! Where transmitters hang: along corridors, in clusters, in corners.

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::TransmitterId;

use crate::building::Building;
use crate::noise::Noise;
use crate::radio::{RadioScene, Shadowing, Transmitter};

/// Mean power of a beacon at 1 m, in dBm, and of an access point.
const BEACON_DBM: f64 = -62.0;
const ACCESS_POINT_DBM: f64 = -38.0;
/// Time between a beacon's packets, in seconds.
const BEACON_S: f64 = 0.3;
/// The UUID of all iBeacons of the simulator.
const UUID: [u8; 16] = *b"fieldwalk beacon";

impl RadioScene {
    /// Beacons along the corridors of `building` about `spacing_m` apart, and one access point in about every
    /// 200 m².
    ///
    /// # Source
    /// Log-distance loss with log-normal shadowing: Rappaport 2002, *Wireless Communications*, §4.9; spatial correlation
    /// of the shadowing: Gudmundson 1991, *Correlation model for shadow fading in mobile radio systems*. The exponent of
    /// beacons in sight, 1.7, is Rappaport's for lines of sight in buildings (1.6 to 1.8); the Position-Annotated BLE
    /// RSSI Dataset shows 1.5 and a spread of 6 dB. 4.5 dB, 4 m and 2 dB a light partition are ours.
    pub fn of_building(building: &Building, spacing_m: f64, seed: u64) -> Self {
        let mut scene = Self::without_transmitters(building);
        scene.hang(building, spacing_m, 0.0, &mut Noise::new(seed, "transmitters", 0));
        scene
    }

    /// Clusters of three iBeacons, 4 m apart in a triangle under the ceiling, one at either end of `building`.
    ///
    /// # Source
    /// iBILL 2017: clusters of beacons 4 m apart, 50 m from each other.
    pub fn clusters(building: &Building, seed: u64) -> Self {
        let mut noise = Noise::new(seed, "transmitters", 0);
        let mut scene = Self::without_transmitters(building);
        let middle_m = 0.5 * building.plan.height_m;
        for (major, x_m) in (1u16..).zip([5.0, building.plan.width_m - 5.0]) {
            for (minor, (east_m, north_m)) in (1u16..).zip([(-2.0, -1.15), (2.0, -1.15), (0.0, 2.31)]) {
                let id = TransmitterId::Ibeacon { uuid: UUID, major, minor };
                scene.add_beacon(
                    &mut noise,
                    id,
                    [x_m + east_m, middle_m + north_m, building.ceiling_m - 0.3],
                );
            }
        }
        scene
    }

    /// One beacon in each corner of `building`, at a height of 2.2 m.
    ///
    /// # Source
    /// Kwak 2018: four access points in the corners.
    pub fn corners(building: &Building, seed: u64) -> Self {
        let mut noise = Noise::new(seed, "transmitters", 0);
        let mut scene = Self::without_transmitters(building);
        let (width_m, height_m) = (building.plan.width_m, building.plan.height_m);
        for (k, (x, y)) in (0u8..).zip([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]) {
            let id = TransmitterId::BleAddress([0xC4, 0x7A, 0x10, 0, 1, k]);
            let place_m = [0.5 + x * (width_m - 1.0), 0.5 + y * (height_m - 1.0), 2.2];
            scene.add_beacon(&mut noise, id, place_m);
        }
        scene
    }

    /// Leaves out every beacon.
    pub fn keep_access_points(&mut self) {
        self.transmitters.retain(Transmitter::is_access_point);
    }

    /// Adds the transmitters of a storey above, laid out as the first; slabs are 0.3 m thick and cost 15 dB.
    ///
    /// # Source
    /// 13 to 19 dB through the first floor of office buildings: Seidel and Rappaport 1992, *914 MHz path loss
    /// prediction models for indoor wireless communications in multifloored buildings*.
    pub fn add_storey(&mut self, building: &Building, height_m: f64, seed: u64) {
        self.slabs_m.push(height_m - 0.15);
        self.slab_loss_db = 15.0;
        self.hang(building, 12.0, height_m, &mut Noise::new(seed, "transmitters", height_m.to_bits()));
    }

    fn without_transmitters(building: &Building) -> Self {
        Self {
            walls: building.plan.barriers().collect(),
            wall_loss_db: 2.0,
            most_wall_loss_db: 14.0,
            ..Self::default()
        }
    }

    fn hang(&mut self, building: &Building, spacing_m: f64, floor_m: f64, noise: &mut Noise) {
        let mut address = self.transmitters.iter().filter(|t| !t.is_access_point()).count() as u16;
        for corridor in &building.corridors {
            let length_m = corridor.line.a.distance_m(corridor.line.b);
            let n = (length_m / spacing_m).floor().max(1.0) as usize;
            for k in 0..n {
                let p = corridor.line.a.lerp(corridor.line.b, (k as f64 + 0.5) / n as f64);
                let [high, low] = address.to_be_bytes();
                let id = TransmitterId::BleAddress([0xC4, 0x7A, 0x10, 0, high, low]);
                self.add_beacon(noise, id, [p.x_m, p.y_m, floor_m + building.ceiling_m - 0.3]);
                address += 1;
            }
        }
        let n_known = self.transmitters.iter().filter(|t| t.is_access_point()).count();
        let n_points = (building.plan.width_m * building.plan.height_m / 200.0).round() as usize;
        for k in n_known..n_known + n_points.min(125) {
            let x_m = noise.within(1.0, building.plan.width_m - 1.0);
            let place = Point2::new(x_m, noise.within(1.0, building.plan.height_m - 1.0));
            let id = TransmitterId::WifiBssid([0x02, 0x1B, 0x77, 0, 0, k as u8]);
            let place_m = [place.x_m, place.y_m, floor_m + building.ceiling_m - 0.1];
            self.add(noise, id, place_m, ACCESS_POINT_DBM, 2.2, f64::INFINITY);
        }
    }

    fn add_beacon(&mut self, noise: &mut Noise, id: TransmitterId, place_m: [f64; 3]) {
        self.add(noise, id, place_m, BEACON_DBM, 1.7, BEACON_S);
    }

    fn add(
        &mut self,
        noise: &mut Noise,
        id: TransmitterId,
        place_m: [f64; 3],
        power_dbm: f64,
        exponent: f64,
        interval_s: f64,
    ) {
        let shadowing = Shadowing::new(4.5, 4.0, noise.bits());
        self.transmitters.push(Transmitter {
            id,
            place_m,
            power_at_1m_dbm: power_dbm + noise.normal(1.5),
            path_loss_exponent: noise.typical(exponent, 0.15),
            interval_s,
            shadowing,
        });
    }
}
