//! What a phone hears while it is carried about.

use fieldwalk::geometry::wrap_rad;
use fieldwalk::sensor::{RadioSighting, Reading, Sample};
use fieldwalk::time::{Duration, Timestamp};

use crate::noise::Noise;
use crate::phone::{Carried, CarryMode};
use crate::radio::{RadioScene, Transmitter};

/// A phone's radio, and the body that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadioModel {
    /// Standard deviation of fading from packet to packet, in dB; default 2.8 (three advertising channels fade apart;
    /// measured at fixed places in the Position-Annotated BLE RSSI Dataset).
    pub fading_db: f64,
    /// Loss through the body when it stands between, in dB; default 7.
    ///
    /// # Source
    /// Losses of 5 to 15 dB at 2.4 GHz are usual; the value is ours.
    pub body_db: f64,
    /// Standard deviation of phones' sensitivity to all transmitters, in dB; default 2.
    pub gain_sd_db: f64,
    /// A packet of this power is received every other time, in dBm; default −94.
    pub sensitivity_dbm: f64,
    /// Share of strong packets that is lost all the same; default 0.11, as in that data set.
    pub loss: f64,
    /// A beacon adds up to this to its interval, in seconds; default 0.01 (Bluetooth's advDelay).
    pub delay_s: f64,
    /// Time between WiFi scans, in seconds; default 4.
    pub scan_every_s: f64,
    /// Length of a WiFi scan, in seconds; default 2.
    pub scan_s: f64,
}

impl Default for RadioModel {
    fn default() -> Self {
        Self {
            fading_db: 2.8,
            body_db: 7.0,
            gain_sd_db: 2.0,
            sensitivity_dbm: -94.0,
            loss: 0.11,
            delay_s: 0.01,
            scan_every_s: 4.0,
            scan_s: 2.0,
        }
    }
}

impl RadioModel {
    /// What a phone hears of `scene` from `origin` on; `device` and `seed` decide about this phone and this walk.
    ///
    /// Sightings are in order of time within each transmitter.
    pub fn listen(
        &self,
        carried: &Carried,
        scene: &RadioScene,
        origin: Timestamp,
        device: u64,
        seed: u64,
    ) -> Vec<Sample> {
        let end_s = carried.gait().duration_s();
        let gain_db = Noise::new(device, "radio gain", 0).normal(self.gain_sd_db);
        let scan_phase = Noise::new(seed, "scans", 0).unit();
        let mut samples = Vec::new();
        for (transmitter, index) in scene.transmitters.iter().zip(0u64..) {
            let mut noise = Noise::new(seed, "packets", index);
            let mut due_s = noise.unit() * transmitter.interval_s.min(self.scan_every_s);
            let mut scan = 0.0;
            loop {
                let time_s = if transmitter.is_access_point() {
                    // Each scan sweeps the channels: every access point is heard at its own moment of it.
                    (scan + scan_phase) * self.scan_every_s.max(0.1)
                        + self.scan_s * (index % 13) as f64 / 13.0
                } else {
                    due_s
                };
                scan += 1.0;
                due_s += transmitter.interval_s.max(0.02) + noise.within(0.0, self.delay_s);
                if time_s >= end_s {
                    break;
                }
                if let Some(rssi_dbm) =
                    self.received_dbm(carried, scene, transmitter, time_s, gain_db, &mut noise)
                {
                    let sighting = RadioSighting { transmitter: transmitter.id, rssi_dbm };
                    let time = origin + Duration::from_secs_f64(time_s);
                    samples.push(Sample { time, reading: Reading::Radio(sighting) });
                }
            }
        }
        samples
    }

    /// One packet: its power as the phone states it, in whole dBm; nothing when it is lost.
    fn received_dbm(
        &self,
        carried: &Carried,
        scene: &RadioScene,
        transmitter: &Transmitter,
        time_s: f64,
        gain_db: f64,
        noise: &mut Noise,
    ) -> Option<f32> {
        let place_m = carried.pose(time_s).place_m;
        let blocked_db = self.body_db * shadow_of_body(carried, transmitter, time_s);
        let fading_db = noise.normal(self.fading_db);
        let power_dbm = scene.mean_dbm(transmitter, place_m) + gain_db - blocked_db + fading_db;
        let heard = 1.0 / (1.0 + libm::exp(-(power_dbm - self.sensitivity_dbm)));
        noise.chance((1.0 - self.loss) * heard).then(|| power_dbm.round().clamp(-120.0, 20.0) as f32)
    }
}

/// How far the body stands between: 0 when it faces the transmitter, 1 when its back is turned.
pub(crate) fn shadow_of_body(carried: &Carried, transmitter: &Transmitter, time_s: f64) -> f64 {
    if carried.mode(time_s) == CarryMode::OnTable {
        return 0.0;
    }
    let body = carried.gait().body(time_s);
    let [x_m, y_m, _] = transmitter.place_m;
    let to = fieldwalk::geometry::Point2::new(x_m, y_m) - body.position;
    0.5 * (1.0 - libm::cos(wrap_rad(to.heading_rad() - body.heading_rad)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::Building;
    use crate::phone::Grip;
    use crate::radio::Shadowing;
    use crate::walker::{Course, Gait, WalkerProfile};
    use fieldwalk::geometry::Point2;
    use fieldwalk::sensor::TransmitterId;

    fn standing(heading_rad: f64) -> Carried {
        let start = Point2::new(20.0, 6.0);
        let line = [start, start + Point2::from_polar(0.5, heading_rad)];
        let gait = Gait::new(&WalkerProfile::default(), Course::new(&line), &[], 60.0, 1);
        Carried::new(gait, Grip::drawn(1.7, 1), &[])
    }

    fn rssi_dbm(samples: &[Sample], is_wifi: bool) -> Vec<f64> {
        let of = |s: &Sample| match s.reading {
            Reading::Radio(r) if matches!(r.transmitter, TransmitterId::WifiBssid(_)) == is_wifi => {
                Some(f64::from(r.rssi_dbm))
            }
            _ => None,
        };
        samples.iter().filter_map(of).collect()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn a_beacon_is_heard_at_its_interval_and_less_through_the_body() {
        let beacon = Transmitter {
            id: TransmitterId::BleAddress([1; 6]),
            place_m: [20.0, 16.0, 2.5],
            power_at_1m_dbm: -60.0,
            path_loss_exponent: 2.0,
            interval_s: 0.3,
            shadowing: Shadowing::new(0.0, 4.0, 1),
        };
        let scene = RadioScene { transmitters: vec![beacon], ..RadioScene::default() };
        let model = RadioModel { gain_sd_db: 0.0, ..RadioModel::default() };
        let listen = |heading_rad| {
            rssi_dbm(&model.listen(&standing(heading_rad), &scene, Timestamp::default(), 1, 1), false)
        };
        let (facing, turned) = (listen(0.0), listen(std::f64::consts::PI));
        // 121 s, a packet in 0.305 s, 89 % heard; −60 − 20·log10(10) less a little.
        assert!((330..375).contains(&facing.len()), "{}", facing.len());
        assert!((mean(&facing) + 80.0).abs() < 1.0, "{}", mean(&facing));
        assert!((mean(&facing) - mean(&turned) - 7.0).abs() < 1.0);
        let sd = mean(&facing.iter().map(|r| (r - mean(&facing)) * (r - mean(&facing))).collect::<Vec<_>>())
            .sqrt();
        assert!((2.3..3.5).contains(&sd), "{sd}");
    }

    #[test]
    fn in_the_office_near_beacons_are_strong_and_scans_come_in_turn() {
        let scene = RadioScene::of_building(&Building::office(), 8.0, 1);
        let samples = RadioModel::default().listen(&standing(0.0), &scene, Timestamp::default(), 1, 1);
        let (beacons, wifi) = (rssi_dbm(&samples, false), rssi_dbm(&samples, true));
        let strongest = beacons.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        println!("{} beacon packets, strongest {strongest} dBm; {} WiFi rows", beacons.len(), wifi.len());
        assert!((-85.0..-55.0).contains(&strongest));
        assert!(wifi.len() > 30 * 3 && samples.iter().all(Sample::is_plausible));
        assert!(scene.transmitters.iter().any(|t| scene.mean_dbm(t, [20.0, 6.0, 1.1]) < -95.0));
    }
}
