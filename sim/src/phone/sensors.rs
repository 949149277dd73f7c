//! What a phone's sensors make of the truth: noise, biases that drift, iron, quantisation, clocks and gaps.

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::{Duration, Timestamp};

use crate::air::Air;
use crate::magnetic_field::FieldOfDay;
use crate::noise::Noise;
use crate::phone::Carried;
use crate::phone::iron::Iron;
use crate::vector::{add, rotate_back};

/// One three-axis sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorModel {
    /// Samples a second; 0 when the phone lacks the sensor.
    pub rate_hz: f64,
    /// Standard deviation of white noise on one sample, in the sensor's unit.
    pub noise_sd: f64,
    /// Standard deviation of each axis's constant bias.
    pub bias_sd: f64,
    /// Standard deviation of the bias's drift.
    pub drift_sd: f64,
    /// Time over which the drift forgets, in seconds.
    pub drift_tau_s: f64,
    /// Standard deviation of each axis's scale about 1.
    pub scale_sd: f64,
    /// Smallest step of the output; 0 for none.
    pub quantum: f64,
}

/// Which magnetometer outputs the phone gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Magnetometer {
    /// With the operating system's correction.
    Calibrated,
    /// Without it, with the bias that would be taken off.
    Uncalibrated,
    /// Both, alternately stamped.
    Both,
}

/// A phone's sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhoneModel {
    /// Specific force, in m/s².
    pub accelerometer: SensorModel,
    /// Angular rate, in rad/s.
    pub gyroscope: SensorModel,
    /// Magnetic field, in µT; its bias is the hard iron that moves with the phone.
    pub magnetometer: SensorModel,
    /// Air pressure, in hPa; the first of its axes counts.
    pub barometer: SensorModel,
    /// Which magnetometer outputs there are.
    pub output: Magnetometer,
    /// Standard deviation of each element of the soft-iron matrix about the unit matrix.
    pub soft_iron_sd: f64,
    /// Standard deviation of each axis of the operating system's error about the hard iron, in µT.
    pub os_bias_error_ut: f64,
    /// The operating system calibrates anew about this often, in seconds.
    pub recalibration_s: f64,
    /// The phone's clock runs fast by up to this share, as do its sampling rates.
    pub rate_error: f64,
    /// Standard deviation of the time between samples, in seconds.
    pub jitter_s: f64,
    /// Probability that a sample is lost.
    pub loss: f64,
    /// Time between gaps in which everything is lost, in seconds, on average.
    pub gap_every_s: f64,
    /// Length of such a gap, in seconds, at most.
    pub gap_s: f64,
}

impl Default for PhoneModel {
    /// A middling phone of recent years at 100 Hz, its magnetometer at 50 Hz.
    ///
    /// # Source
    /// Noise from data sheets of the usual parts (Bosch BMI160 and BMP280, AKM AK09918); biases after the operating
    /// system's own calibration, the barometer's as delivered (±1 hPa).
    fn default() -> Self {
        Self {
            accelerometer: SensorModel {
                rate_hz: 100.0,
                noise_sd: 0.02,
                bias_sd: 0.08,
                drift_sd: 0.01,
                drift_tau_s: 200.0,
                scale_sd: 0.003,
                quantum: 0.002_4,
            },
            gyroscope: SensorModel {
                rate_hz: 100.0,
                noise_sd: 0.002,
                bias_sd: 0.002,
                drift_sd: 0.001,
                drift_tau_s: 100.0,
                scale_sd: 0.004,
                quantum: 0.001_065,
            },
            magnetometer: SensorModel {
                rate_hz: 50.0,
                noise_sd: 0.4,
                bias_sd: 30.0,
                drift_sd: 0.5,
                drift_tau_s: 90.0,
                scale_sd: 0.0,
                quantum: 0.15,
            },
            barometer: SensorModel {
                rate_hz: 10.0,
                noise_sd: 0.013,
                bias_sd: 0.5,
                drift_sd: 0.02,
                drift_tau_s: 600.0,
                scale_sd: 0.0,
                quantum: 0.001_6,
            },
            output: Magnetometer::Uncalibrated,
            soft_iron_sd: 0.015,
            os_bias_error_ut: 2.0,
            recalibration_s: 240.0,
            rate_error: 0.01,
            jitter_s: 0.000_3,
            loss: 0.002,
            gap_every_s: 120.0,
            gap_s: 0.2,
        }
    }
}

impl PhoneModel {
    /// The same phone at other sampling rates: `inertial_hz` of accelerometer and gyroscope, `field_hz`.
    #[must_use]
    pub fn at_rates(mut self, inertial_hz: f64, field_hz: f64) -> Self {
        self.accelerometer.rate_hz = inertial_hz;
        self.gyroscope.rate_hz = inertial_hz;
        self.magnetometer.rate_hz = field_hz;
        self
    }

    /// What the phone records from `origin` on; `seeds` decide about this copy of it, and about this walk.
    ///
    /// Samples are in order of time within each sensor.
    pub fn record(
        &self,
        carried: &Carried,
        field: &FieldOfDay<'_>,
        air: &Air,
        origin: Timestamp,
        [device, seed]: [u64; 2],
    ) -> Vec<Sample> {
        let gaps = self.gaps(carried.gait().duration_s(), seed);
        let mut samples = Vec::new();
        let mut push = |time_s: f64, reading: Reading| {
            samples.push(Sample { time: origin + Duration::from_secs_f64(time_s), reading });
        };
        self.sense(&self.accelerometer, "accelerometer", [device, seed], carried, &gaps, |t, sensor| {
            push(t, Reading::SpecificForce(sensor.read(carried.specific_force_m_s2(t))));
        });
        self.sense(&self.gyroscope, "gyroscope", [device, seed], carried, &gaps, |t, sensor| {
            push(t, Reading::AngularRate(sensor.read(carried.angular_rate_rad_s(t))));
        });
        let mut iron = Iron::new(self, device, seed);
        self.sense(&self.magnetometer, "magnetometer", [device, seed], carried, &gaps, |t, sensor| {
            let pose = carried.pose(t);
            let device_ut = rotate_back(pose.floor_from_device, field.field_ut(pose.place_m, t));
            let field_ut = sensor.read(iron.softened(device_ut));
            let bias_ut = iron.os_bias_ut(t, sensor.bias);
            if self.output != Magnetometer::Calibrated {
                push(t, Reading::UncalibratedMagneticField { field_ut, bias_ut });
            }
            if self.output != Magnetometer::Uncalibrated {
                push(t, Reading::MagneticField([0, 1, 2].map(|c| field_ut[c] - bias_ut[c])));
            }
        });
        self.sense(&self.barometer, "barometer", [device, seed], carried, &gaps, |t, sensor| {
            let truth_hpa = air.pressure_hpa(carried.pose(t).place_m[2], t);
            let [pressure_hpa, ..] = sensor.read([truth_hpa; 3]);
            push(t, Reading::Pressure { pressure_hpa });
        });
        samples
    }

    fn sense(
        &self,
        model: &SensorModel,
        name: &str,
        [device, seed]: [u64; 2],
        carried: &Carried,
        gaps: &[[f64; 2]],
        mut take: impl FnMut(f64, &mut Sensor),
    ) {
        if model.rate_hz <= 0.0 {
            return;
        }
        let mut clock = Noise::new(seed, name, 2);
        let rate_hz = model.rate_hz * (1.0 + clock.within(-self.rate_error, self.rate_error));
        let mut sensor = Sensor::new(model, name, device, seed);
        let end_s = carried.gait().duration_s();
        let mut due_s = clock.unit() / rate_hz;
        let mut last_s = 0.0;
        while due_s < end_s {
            let time_s = (due_s + clock.normal(self.jitter_s)).max(last_s + 1e-6);
            last_s = time_s;
            sensor.drift(1.0 / rate_hz);
            let is_lost =
                clock.chance(self.loss) || gaps.iter().any(|gap| gap[0] < time_s && time_s < gap[1]);
            if !is_lost {
                take(time_s, &mut sensor);
            }
            due_s += 1.0 / rate_hz;
        }
    }

    fn gaps(&self, end_s: f64, seed: u64) -> Vec<[f64; 2]> {
        let mut noise = Noise::new(seed, "gaps", 0);
        let mut gaps = Vec::new();
        let mut time_s = 0.0;
        while time_s < end_s && self.gap_every_s > 0.0 {
            time_s -= self.gap_every_s * libm::log(noise.unit());
            gaps.push([time_s, time_s + noise.within(0.0, self.gap_s)]);
        }
        gaps
    }
}

/// One sensor at work.
pub(crate) struct Sensor {
    model: SensorModel,
    scale: [f64; 3],
    bias: [f64; 3],
    drift: [f64; 3],
    noise: Noise,
}

impl Sensor {
    pub(crate) fn new(model: &SensorModel, name: &str, device: u64, seed: u64) -> Self {
        let mut of_device = Noise::new(device, name, 0);
        let mut noise = Noise::new(seed, name, 1);
        Self {
            model: *model,
            scale: of_device.normal3(model.scale_sd).map(|c| 1.0 + c),
            bias: of_device.normal3(model.bias_sd),
            drift: noise.normal3(model.drift_sd),
            noise,
        }
    }

    /// Lets the bias drift for `dt_s`: a first-order Gauss–Markov process.
    pub(crate) fn drift(&mut self, dt_s: f64) {
        let forget = (dt_s / self.model.drift_tau_s).min(1.0);
        let kick = self.noise.normal3(self.model.drift_sd * (2.0 * forget).sqrt());
        self.drift = [0, 1, 2].map(|c| self.drift[c] * (1.0 - forget) + kick[c]);
    }

    pub(crate) fn read(&mut self, truth: [f64; 3]) -> [f32; 3] {
        let noise = self.noise.normal3(self.model.noise_sd);
        let off = add(add(self.bias, self.drift), noise);
        [0, 1, 2].map(|c| {
            let value = truth[c] * self.scale[c] + off[c];
            let quantum = self.model.quantum;
            (if quantum > 0.0 { (value / quantum).round() * quantum } else { value }) as f32
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::magnetic_field::MagneticField;
    use crate::phone::{CarryMode, Grip};
    use crate::walker::{Course, Gait, WalkerProfile};
    use fieldwalk::geometry::{Point2, wrap_rad};
    use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
    use fieldwalk::system::Recipe;

    fn recorded(model: &PhoneModel, mode: CarryMode, seed: u64) -> (Gait, Vec<Sample>) {
        let line = [(6.0, 6.0), (6.0, 34.0), (54.0, 34.0), (54.0, 6.0)].map(|(x, y)| Point2::new(x, y));
        let walker = WalkerProfile::drawn(seed);
        let gait = Gait::new(&walker, Course::new(&line), &[], 2.0, seed);
        let grip = Grip::drawn(walker.height_m, seed);
        let carried = Carried::new(gait.clone(), grip, &[(0.0, mode)]);
        let earth = MagneticField::default();
        let mut samples = model.record(
            &carried,
            &FieldOfDay::of(&earth),
            &Air::default(),
            Timestamp::from_millis(0),
            [seed, seed],
        );
        samples.sort_by_key(|sample| sample.time);
        (gait, samples)
    }

    #[test]
    fn held_level_the_step_detector_counts_the_steps() {
        let (mut counted, mut made) = (0, 0);
        for seed in 0..6 {
            let (gait, samples) = recorded(&PhoneModel::default(), CarryMode::HeldLevel, seed);
            let mut pedestrian = Pedestrian::new(PedestrianParams::default());
            let events: Vec<_> = samples.iter().filter_map(|sample| pedestrian.push(sample)).collect();
            let n = events.len();
            let model = Recipe::fused().length;
            let walked_m: f64 = events.iter().map(|event| f64::from(model.advance_m(&event.cycle))).sum();
            let share = walked_m / gait.walked_m(gait.duration_s());
            println!(
                "seed {seed}: {n} steps counted of {}, length {share:.3} of the truth",
                gait.steps().len()
            );
            assert!((n as f64 / gait.steps().len() as f64 - 1.0).abs() < 0.03);
            (counted, made) = (counted + n, made + gait.steps().len());
        }
        println!("{counted} steps counted of {made}");
    }

    #[test]
    fn the_compass_and_the_gyroscope_follow_the_way() {
        let (gait, samples) = recorded(&PhoneModel::default(), CarryMode::HeldLevel, 4);
        let mut pedestrian = Pedestrian::new(PedestrianParams::default());
        let events: Vec<_> = samples.iter().filter_map(|sample| pedestrian.push(sample)).collect();
        let north_rad = MagneticField::default().earth.north_heading_rad;
        let mut first_rad = None;
        // Up the plan, to the right, down: 28, 48 and 28 m.
        for (leg_m, heading_rad) in [(3.0..25.0, 0.0), (31.0..73.0, FRAC_PI_2), (79.0..101.0, PI)] {
            let on_leg = events.iter().filter(|event| {
                leg_m.contains(&gait.walked_m(event.cycle.end.secs_since(Timestamp::default())))
            });
            for event in on_leg {
                let azimuth_rad = f64::from(event.azimuth_rad().unwrap());
                assert!(wrap_rad(azimuth_rad + north_rad - heading_rad).abs() < 0.35, "{azimuth_rad}");
                let level_rad = f64::from(event.level_heading_rad);
                let turned_rad = level_rad - *first_rad.get_or_insert(level_rad);
                assert!(wrap_rad(turned_rad - heading_rad).abs() < 0.35, "{turned_rad}");
            }
        }
    }

    #[test]
    fn every_way_to_carry_gives_a_plausible_recording_and_the_table_no_step() {
        for mode in CarryMode::ALL {
            let (gait, samples) = recorded(&PhoneModel::default(), mode, 2);
            assert!(samples.iter().all(Sample::is_plausible), "{mode:?}");
            let mut pedestrian = Pedestrian::new(PedestrianParams::default());
            let n = samples.iter().filter_map(|sample| pedestrian.push(sample)).count();
            println!("{mode:?}: {n} steps counted of {}", gait.steps().len());
            assert!(mode != CarryMode::OnTable || n == 0);
        }
    }

    #[test]
    fn rates_gaps_and_outputs_are_as_asked() {
        let model = PhoneModel { output: Magnetometer::Both, ..PhoneModel::default().at_rates(200.0, 100.0) };
        let (gait, samples) = recorded(&model, CarryMode::OnTable, 1);
        let end_s = gait.duration_s();
        let per_s =
            |is: fn(&Reading) -> bool| samples.iter().filter(|s| is(&s.reading)).count() as f64 / end_s;
        let force_hz = per_s(|r| matches!(r, Reading::SpecificForce(_)));
        assert!((193.0..203.0).contains(&force_hz), "{force_hz}");
        let field_hz = per_s(|r| matches!(r, Reading::MagneticField(_)));
        assert!((96.0..102.0).contains(&field_hz), "{field_hz}");
        assert_eq!(field_hz, per_s(|r| matches!(r, Reading::UncalibratedMagneticField { .. })));
        assert!(samples.iter().all(Sample::is_plausible));
    }

    #[test]
    fn a_resting_phone_has_its_noise_and_bias() {
        let (_, samples) = recorded(&PhoneModel::default(), CarryMode::OnTable, 2);
        let up: Vec<f64> = samples
            .iter()
            .filter_map(
                |s| if let Reading::SpecificForce(f) = s.reading { Some(f64::from(f[2])) } else { None },
            )
            .collect();
        let mean = up.iter().sum::<f64>() / up.len() as f64;
        let sd = (up.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / up.len() as f64).sqrt();
        assert!((mean - 9.81).abs() < 0.3 && (0.015..0.04).contains(&sd), "{mean} ± {sd}");
    }
}
