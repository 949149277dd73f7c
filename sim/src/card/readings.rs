//! What a card's sensor buffers on a walk, for the card's own application to make frames of.

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_kmx62::{AccelerationRange, BufferEntry, FIELD_UT_PER_LSB, Rate, Resolution};

use crate::card::{CardModel, CardNoise};
use crate::magnetic_field::FieldOfDay;
use crate::noise::Noise;
use crate::phone::{Carried, Sensor, SensorModel};
use crate::radio::RadioScene;
use crate::vector::rotate_back;

/// Readings of the accelerometer a second.
pub const READINGS: Rate = Rate::Hz25;
/// Readings of the magnetometer a second: its register holds each for four of the accelerometer's.
pub const FIELD_READINGS: Rate = Rate::Hz6_25;
const READINGS_A_FIELD: u32 = 4;
/// The range of the accelerometer.
pub const RANGE: AccelerationRange = AccelerationRange::G4;

/// What a card's sensor read on a walk.
#[derive(Clone, Debug, PartialEq)]
pub struct CardReadings {
    /// When the card was switched on, in seconds since the walk's recording began.
    pub switched_on_s: f64,
    /// What its registers hold at each acceleration: each 40 ms after the one before, the first 40 ms after that.
    pub entries: Vec<BufferEntry>,
}

/// A frame that a card sent: when, in microseconds since it was switched on.
pub type SentFrame = (u64, [u8; 31]);

impl CardModel {
    /// This card with a KMX62 at `resolution`, which is as noisy as `noise` says.
    #[must_use]
    pub fn at_resolution(self, resolution: Resolution, noise: &CardNoise) -> Self {
        let [field_ut, acceleration_m_s2] = noise.sd(resolution, [FIELD_READINGS, READINGS]);
        Self {
            magnetometer: SensorModel { noise_sd: field_ut, ..self.magnetometer },
            accelerometer: SensorModel { noise_sd: acceleration_m_s2, ..self.accelerometer },
            ..self
        }
    }

    pub(crate) fn readings(
        &self,
        carried: &Carried,
        field: &FieldOfDay<'_>,
        [device, seed]: [u64; 2],
    ) -> CardReadings {
        // The sensor's own steps are taken below.
        let exact = |model: SensorModel| SensorModel { quantum: 0.0, ..model };
        let mut acceleration = Sensor::new(&exact(self.accelerometer), "card accelerometer", device, seed);
        let mut magnetometer = Sensor::new(&exact(self.magnetometer), "card magnetometer", device, seed);
        let switched_on_s = Noise::new(seed, "card", 0).unit();
        let period_s = 1.0 / READINGS.hz();
        let steps = |value: f32, lsb: f32| (value / lsb).round() as i16;
        let mut held = [0; 3];
        let entries = (1_u32..)
            .map(|k| (k, switched_on_s + f64::from(k) * period_s))
            .take_while(|&(_, time_s)| time_s < carried.gait().duration_s())
            .map(|(k, time_s)| {
                acceleration.drift(period_s);
                if k % READINGS_A_FIELD == 1 {
                    magnetometer.drift(f64::from(READINGS_A_FIELD) * period_s);
                    let pose = carried.pose(time_s);
                    let field_ut = rotate_back(pose.floor_from_device, field.field_ut(pose.place_m, time_s));
                    held = magnetometer.read(field_ut).map(|c| steps(c, FIELD_UT_PER_LSB));
                }
                let force_m_s2 = acceleration.read(carried.specific_force_m_s2(time_s));
                let acceleration = force_m_s2.map(|c| steps(c, RANGE.m_s2_per_lsb()));
                BufferEntry { acceleration, field: held }
            })
            .collect();
        CardReadings { switched_on_s, entries }
    }

    /// What the access points report of `frames`.
    pub(crate) fn hear(
        &self,
        frames: &[SentFrame],
        carried: &Carried,
        scene: &RadioScene,
        origin: Timestamp,
        seed: u64,
    ) -> Vec<Sample> {
        let mut noise = Noise::new(seed, "card", 0);
        let switched_on_s = noise.unit();
        let mut samples = Vec::new();
        for &(sent_us, frame) in frames {
            let sent_s = switched_on_s + sent_us as f64 * 1e-6;
            let time = origin + Duration::from_secs_f64(sent_s);
            let heard = self.sightings(carried, scene, sent_s, &mut noise);
            samples.extend(heard.iter().map(|&sighting| Sample { time, reading: Reading::Radio(sighting) }));
            samples.extend(heard.iter().map(|_| Sample { time, reading: Reading::CardFrame(frame) }));
        }
        samples
    }
}
