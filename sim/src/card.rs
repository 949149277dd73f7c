//! ID cards: what their sensors say, what they make of it, and which access points hear it.

mod readings;
mod resolution;

pub use readings::{CardReadings, FIELD_READINGS, RANGE, READINGS, SentFrame};
pub use resolution::{CardNoise, SensorNoise, conversions, conversions_hz};

use fieldwalk::card::{CardRoundBuilder, CardSensingParams};
use fieldwalk::sensor::{RadioSighting, Reading, Sample};
use fieldwalk::time::{Duration, Timestamp};

use crate::magnetic_field::FieldOfDay;
use crate::noise::Noise;
use crate::phone::{Carried, Sensor, SensorModel};
use crate::radio::{RadioScene, Transmitter, shadow_of_body};
use crate::vector::rotate_back;

/// The accelerometer is read this often, in Hz.
const READINGS_HZ: f64 = 15.0;
/// Where beacons send at 0 dBm and cards at −20 dBm: what a card's signal is weaker by at one metre, in dB. Antennas of
/// access points take half of it back.
const WEAKER_DB: f64 = 10.0;

/// A card and the access points that listen to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardModel {
    /// Height over the floor at which it hangs, in centimetres.
    pub height_cm: u16,
    /// Specific force, in m/s²; its rate counts nothing.
    pub accelerometer: SensorModel,
    /// Magnetic field, in µT; its bias is what calibration leaves of the hard iron. Its rate counts nothing.
    pub magnetometer: SensorModel,
    /// Standard deviation of fading from frame to frame and receiver to receiver, in dB; default 2.8, as phones'.
    pub fading_db: f64,
    /// Loss through the wearer's body, in dB; default 7, as phones'.
    pub body_db: f64,
    /// Whether the access points pass on its frames; else they tell how strong they are, as in a survey by phone.
    pub sends_frames: bool,
}

impl Default for CardModel {
    /// A card with a KMX62 at its finer resolution.
    ///
    /// # Source
    /// Steps are the KMX62's, 0.0366 µT and 0.00024 g; its noise is not published: 0.4 µT and 2 mg are ours, those of
    /// phones. Ellipsoid fitting (Kwak 2018, §3.2) leaves 2 µT a component and 1 % of scale, as a swing's residuals say.
    fn default() -> Self {
        let accelerometer = SensorModel {
            rate_hz: READINGS_HZ,
            noise_sd: 0.02,
            bias_sd: 0.15,
            drift_sd: 0.01,
            drift_tau_s: 200.0,
            scale_sd: 0.005,
            quantum: 0.002_4,
        };
        let magnetometer = SensorModel {
            rate_hz: 3.0,
            noise_sd: 0.4,
            bias_sd: 2.0,
            drift_sd: 0.3,
            drift_tau_s: 90.0,
            scale_sd: 0.01,
            quantum: 0.036_6,
        };
        let (fading_db, body_db) = (2.8, 7.0);
        Self { height_cm: 110, accelerometer, magnetometer, fading_db, body_db, sends_frames: true }
    }
}

/// How often an access point receives a card's frame at −20 dBm, by the distance in metres.
///
/// Between the distances of the table it is interpolated. Beyond 15 m it falls to a half at 30 m, which is ours.
///
/// # Source
/// Kwak 2018, Table 1.
pub fn observation_probability(distance_m: f64) -> f64 {
    const TABLE: [(f64, f64); 5] = [(0.0, 1.0), (7.0, 1.0), (10.0, 0.88), (15.0, 0.86), (30.0, 0.5)];
    for pair in TABLE.windows(2) {
        let ((near_m, often), (far_m, seldom)) = (pair[0], pair[1]);
        if distance_m < far_m {
            return often + (seldom - often) * ((distance_m - near_m) / (far_m - near_m)).max(0.0);
        }
    }
    0.5
}

impl CardModel {
    /// What the access points among `scene`'s beacons report of the card from `origin` on; `seeds` decide about this copy
    /// of it, and about this walk.
    ///
    /// They stamp a frame when they receive it, which is at one instant for all that do; how strong it was goes before it.
    pub fn record(
        &self,
        carried: &Carried,
        field: &FieldOfDay<'_>,
        scene: &RadioScene,
        origin: Timestamp,
        [device, seed]: [u64; 2],
    ) -> Vec<Sample> {
        let mut acceleration = Sensor::new(&self.accelerometer, "card accelerometer", device, seed);
        let mut magnetometer = Sensor::new(&self.magnetometer, "card magnetometer", device, seed);
        let mut noise = Noise::new(seed, "card", 0);
        let mut builder = CardRoundBuilder::new(CardSensingParams::default(), device as u16);
        let begun_s = noise.unit();
        let mut samples = Vec::new();
        for k in 0.. {
            let time_s = begun_s + f64::from(k) / READINGS_HZ;
            if time_s >= carried.gait().duration_s() {
                return samples;
            }
            acceleration.drift(1.0 / READINGS_HZ);
            let frame = builder.push_force(acceleration.read(carried.specific_force_m_s2(time_s)));
            if builder.wants_field() {
                let pose = carried.pose(time_s);
                let field_ut = field.field_ut(pose.place_m, time_s);
                magnetometer.drift(1.0 / 3.0);
                builder.push_field(magnetometer.read(rotate_back(pose.floor_from_device, field_ut)));
            }
            if let Some(frame) = frame {
                // Bluetooth sends up to 10 ms late, by chance.
                let sent_s = time_s + noise.within(0.0, 0.01);
                let time = origin + Duration::from_secs_f64(sent_s);
                let heard = self.sightings(carried, scene, sent_s, &mut noise);
                let n_heard = heard.len();
                samples.extend(
                    heard.into_iter().map(|sighting| Sample { time, reading: Reading::Radio(sighting) }),
                );
                let n_frames = if self.sends_frames { n_heard } else { 0 };
                samples.extend((0..n_frames).map(|_| Sample { time, reading: Reading::CardFrame(frame) }));
            }
        }
        samples
    }

    /// Which access points hear a frame that is sent at `sent_s`, and how strongly.
    fn sightings(
        &self,
        carried: &Carried,
        scene: &RadioScene,
        sent_s: f64,
        noise: &mut Noise,
    ) -> Vec<RadioSighting> {
        let points = scene.transmitters.iter().filter(|t| !t.is_access_point());
        points
            .filter_map(|point| {
                let rssi_dbm = self.heard_dbm(carried, scene, point, sent_s, noise)?;
                Some(RadioSighting { transmitter: point.id, rssi_dbm })
            })
            .collect()
    }

    /// How strongly the access point at `point`'s place receives a frame, in whole dBm; nothing when it does not.
    fn heard_dbm(
        &self,
        carried: &Carried,
        scene: &RadioScene,
        point: &Transmitter,
        time_s: f64,
        noise: &mut Noise,
    ) -> Option<f32> {
        let place_m = carried.pose(time_s).place_m;
        let square: f64 =
            (0..3).map(|c| (place_m[c] - point.place_m[c]) * (place_m[c] - point.place_m[c])).sum();
        let (is_heard, fading_db) =
            (noise.chance(observation_probability(square.sqrt())), noise.normal(self.fading_db));
        let blocked_db = self.body_db * shadow_of_body(carried, point, time_s);
        // What is lost on the way is lost in either direction.
        let power_dbm = scene.mean_dbm(point, place_m) - WEAKER_DB - blocked_db + fading_db;
        is_heard.then(|| power_dbm.round().clamp(-120.0, 20.0) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Scenario, Walk};
    use fieldwalk::card::CardReceiver;
    use fieldwalk::geometry::wrap_rad;

    #[test]
    fn table_1_is_met() {
        for (distance_m, probability) in
            [(1.0, 1.0), (3.0, 1.0), (5.0, 1.0), (7.0, 1.0), (10.0, 0.88), (15.0, 0.86)]
        {
            assert!((observation_probability(distance_m) - probability).abs() < 1e-12);
        }
        assert!(observation_probability(22.0) < 0.86 && observation_probability(1e3) == 0.5);
    }

    #[test]
    fn access_points_pass_on_what_the_card_says() {
        let scenario = Scenario::named("card-office", 1).unwrap();
        let usual = scenario.test_walks(1, 60.0).remove(0);
        let walk = Walk { card: Some(CardModel::default()), ..usual };
        let recorded = scenario.simulate(&walk);
        let n_of = |is: fn(&Reading) -> bool| recorded.samples.iter().filter(|s| is(&s.reading)).count();
        let (n_frames, n_sightings) =
            (n_of(|r| matches!(r, Reading::CardFrame(_))), n_of(|r| matches!(r, Reading::Radio(_))));
        assert_eq!((n_frames, n_sightings), (n_sightings, recorded.samples.len() - n_frames));
        let mut receiver = CardReceiver::default();
        let (mut n_rounds, mut n_steps, mut off_rad) = (0, 0, 0.0);
        for sample in &recorded.samples {
            let Reading::CardFrame(frame) = sample.reading else { continue };
            receiver.push(sample.time, &frame);
            while let Some(round) = receiver.pop() {
                n_rounds += 1;
                n_steps += usize::from(round.n_steps);
                let truth = recorded.truth_at(round.cycle.start.midpoint(round.cycle.end)).unwrap();
                let azimuth_rad = f64::from(round.azimuth_rad().unwrap());
                off_rad += wrap_rad(azimuth_rad - truth.heading_rad).abs();
            }
        }
        // Nearly every frame is heard by one of four at least, and seldom by less than three.
        let duration_s = recorded.truth.len() as f64 / 10.0;
        assert!((f64::from(n_rounds) - duration_s).abs() < 4.0, "{n_rounds} rounds of {duration_s} s");
        assert!(n_frames as f64 > 3.2 * duration_s, "{n_frames}");
        // The card hangs with its back ahead: its compass is the walker's, but for steel, iron and declination.
        assert!(off_rad / f64::from(n_rounds) < 0.5, "{}", off_rad / f64::from(n_rounds));
        let share = n_steps as f64 / recorded.steps.len() as f64;
        assert!((0.6..1.3).contains(&share), "{n_steps} of {} steps", recorded.steps.len());
    }

    #[test]
    fn a_survey_beside_a_card_hears_its_strength_alone() {
        let scenario = Scenario::named("card-office", 1).unwrap();
        let card = CardModel { sends_frames: false, ..CardModel::default() };
        let walk = Walk { card: Some(card), ..scenario.survey_walks().remove(0) };
        let recorded = scenario.simulate(&walk);
        assert!(recorded.samples.iter().all(|s| !matches!(s.reading, Reading::CardFrame(_))));
        let n_forces =
            recorded.samples.iter().filter(|s| matches!(s.reading, Reading::SpecificForce(_))).count();
        // The first line is a short lane: a few seconds at 50 Hz.
        assert!(n_forces > 150, "the phone's own sensors: {n_forces}");
    }
}
