//! Radio: beacons and access points, what becomes of their signals on the way, and what a phone hears.

mod hearing;
mod shadowing;

pub use hearing::RadioModel;
pub use shadowing::Shadowing;

use fieldwalk::geometry::{Point2, Segment};
use fieldwalk::sensor::TransmitterId;

use crate::building::Building;
use crate::noise::Noise;

/// Something that sends.
#[derive(Clone, Debug)]
pub struct Transmitter {
    /// Who it is.
    pub id: TransmitterId,
    /// Where: x, y, height over the floor, in metres.
    pub place_m: [f64; 3],
    /// Mean power received at 1 m in the open, in dBm.
    pub power_at_1m_dbm: f64,
    /// Path-loss exponent of the air between walls.
    pub path_loss_exponent: f64,
    /// Mean time between packets, in seconds; access points are heard when the phone scans.
    pub interval_s: f64,
    /// What furniture does to the signal, by place.
    pub shadowing: Shadowing,
}

/// All transmitters of a floor, and the walls between.
#[derive(Clone, Debug, Default)]
pub struct RadioScene {
    /// The transmitters.
    pub transmitters: Vec<Transmitter>,
    /// What dampens signals.
    pub walls: Vec<Segment>,
    /// Loss through each wall, in dB; default 0.
    pub wall_loss_db: f64,
    /// Loss through all walls together, in dB, at most: signals go round.
    pub most_wall_loss_db: f64,
}

impl Transmitter {
    /// Whether it is an access point.
    pub fn is_access_point(&self) -> bool {
        matches!(self.id, TransmitterId::WifiBssid(_))
    }
}

impl RadioScene {
    /// iBeacons along the corridors of `building` about `spacing_m` apart, and one access point in about every
    /// 200 m².
    ///
    /// # Source
    /// Log-distance loss with log-normal shadowing: Rappaport 2002, *Wireless Communications*, §4.9; spatial correlation
    /// of the shadowing: Gudmundson 1991, *Correlation model for shadow fading in mobile radio systems*. The numbers
    /// (3.5 dB, 4 m, 2 dB a light partition) are ours.
    pub fn of_building(building: &Building, spacing_m: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed, "transmitters", 0);
        let mut transmitters = Vec::new();
        let mut add = |noise: &mut Noise, id, p: Point2, height_m, power_dbm, exponent, interval_s| {
            let shadowing = Shadowing::new(3.5, 4.0, noise.bits());
            transmitters.push(Transmitter {
                id,
                place_m: [p.x_m, p.y_m, height_m],
                power_at_1m_dbm: power_dbm + noise.normal(1.5),
                path_loss_exponent: noise.typical(exponent, 0.15),
                interval_s,
                shadowing,
            });
        };
        let mut address = 0u16;
        for corridor in &building.corridors {
            let length_m = corridor.line.a.distance_m(corridor.line.b);
            let n = (length_m / spacing_m).floor().max(1.0) as usize;
            for k in 0..n {
                let p = corridor.line.a.lerp(corridor.line.b, (k as f64 + 0.5) / n as f64);
                let [high, low] = address.to_be_bytes();
                let id = TransmitterId::BleAddress([0xC4, 0x7A, 0x10, 0, high, low]);
                add(&mut noise, id, p, building.ceiling_m - 0.3, -62.0, 2.0, 0.3);
                address += 1;
            }
        }
        let n_points = (building.plan.width_m * building.plan.height_m / 200.0).round() as usize;
        for k in 0..n_points.min(250) {
            let x_m = noise.within(1.0, building.plan.width_m - 1.0);
            let place = Point2::new(x_m, noise.within(1.0, building.plan.height_m - 1.0));
            let id = TransmitterId::WifiBssid([0x02, 0x1B, 0x77, 0, 0, k as u8]);
            add(&mut noise, id, place, building.ceiling_m - 0.1, -38.0, 2.2, f64::INFINITY);
        }
        Self {
            transmitters,
            walls: building.plan.barriers().collect(),
            wall_loss_db: 2.0,
            most_wall_loss_db: 14.0,
        }
    }

    /// Mean power at `place_m` of a transmitter, without the body of whoever hears it, in dBm.
    pub fn mean_dbm(&self, transmitter: &Transmitter, place_m: [f64; 3]) -> f64 {
        let from = transmitter.place_m;
        let square: f64 = (0..3).map(|c| (place_m[c] - from[c]) * (place_m[c] - from[c])).sum();
        let distance_m = square.sqrt().max(0.3);
        let ray = Segment { a: Point2::new(from[0], from[1]), b: Point2::new(place_m[0], place_m[1]) };
        let n_walls = self.walls.iter().filter(|wall| wall.crosses(&ray)).count();
        let wall_db = (self.wall_loss_db * n_walls as f64).min(self.most_wall_loss_db);
        let spread_db = 10.0 * transmitter.path_loss_exponent * libm::log10(distance_m);
        transmitter.power_at_1m_dbm - spread_db - wall_db + transmitter.shadowing.at_db(ray.b)
    }
}
