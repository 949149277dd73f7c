//! Radio: beacons and access points, what becomes of their signals on the way, and what a phone hears.

mod hearing;
mod layout;
mod shadowing;

pub use hearing::RadioModel;
pub(crate) use hearing::shadow_of_body;
pub use shadowing::Shadowing;

use fieldwalk::geometry::{Point2, Segment};
use fieldwalk::sensor::TransmitterId;

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
    /// Heights of the slabs between storeys, in metres over the ground floor.
    pub slabs_m: Vec<f64>,
    /// Loss through each slab, in dB; default 0.
    pub slab_loss_db: f64,
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
    /// Mean power at `place_m` of a transmitter, without the body of whoever hears it, in dBm.
    pub fn mean_dbm(&self, transmitter: &Transmitter, place_m: [f64; 3]) -> f64 {
        let from = transmitter.place_m;
        let square: f64 = (0..3).map(|c| (place_m[c] - from[c]) * (place_m[c] - from[c])).sum();
        let distance_m = square.sqrt().max(0.3);
        let ray = Segment { a: Point2::new(from[0], from[1]), b: Point2::new(place_m[0], place_m[1]) };
        let n_walls = self.walls.iter().filter(|wall| wall.crosses(&ray)).count();
        let wall_db = (self.wall_loss_db * n_walls as f64).min(self.most_wall_loss_db);
        let (low_m, high_m) = (from[2].min(place_m[2]), from[2].max(place_m[2]));
        let n_slabs = self.slabs_m.iter().filter(|&&slab_m| low_m < slab_m && slab_m < high_m).count();
        let slab_db = self.slab_loss_db * n_slabs as f64;
        let spread_db = 10.0 * transmitter.path_loss_exponent * libm::log10(distance_m);
        transmitter.power_at_1m_dbm - spread_db - wall_db - slab_db + transmitter.shadowing.at_db(ray.b)
    }
}
