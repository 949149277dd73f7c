//! What a design draws.

use fieldwalk_card::LOOKS;
use fieldwalk_kmx62::{AccelerationEntry, Entry as _, Rate, Resolution, Sensor, WakeUp};
use fieldwalk_sim::card::{conversions, conversions_hz};

use super::Figures;

/// How the sensor's readings come to the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// The acceleration from the sensor's buffer, once a round; the field by [`LOOKS`].
    Buffered,
    /// One by one: the acceleration fifteen times, the field three times a second.
    Polled,
}

/// What the card sends at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransmitPower {
    /// −40 dBm, which leaves hardly any range.
    Minus40Dbm,
    /// −20 dBm, the paper's.
    Minus20Dbm,
    /// 0 dBm.
    Zero,
}

/// What can be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Readings of the acceleration a second.
    pub acceleration_rate: Rate,
    /// Readings of the field a second.
    pub field_rate: Rate,
    /// Conversions that a reading averages; the same parameter decides the simulator's noise.
    pub resolution: Resolution,
    /// How readings come to the processor.
    pub sampling: Sampling,
    /// What is sent at.
    pub power: TransmitPower,
    /// Rounds, and frames, a second.
    pub rounds_hz: f64,
    /// Whether the chip's DC/DC converter runs; without it radio and processor draw about twice as much.
    pub has_dc_dc: bool,
}

impl Design {
    /// This firmware's.
    pub const OURS: Self = Self {
        acceleration_rate: Rate::Hz25,
        field_rate: Rate::Hz6_25,
        resolution: Resolution::Averages32And16,
        sampling: Sampling::Buffered,
        power: TransmitPower::Minus20Dbm,
        rounds_hz: 1.0 / 1.005,
        has_dc_dc: true,
    };
}

/// What a card draws while it is worn, in µA.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The sensor.
    pub sensor_ua: f64,
    /// The processor's chip asleep.
    pub floor_ua: f64,
    /// Radio, its crystal's start.
    pub advertising_ua: f64,
    /// The bus and its pull-ups.
    pub bus_ua: f64,
    /// The processor, active.
    pub cpu_ua: f64,
    /// The battery by itself, and leaks.
    pub loss_ua: f64,
    /// Share of time that the processor is active, 0 to 1.
    pub cpu_share: f64,
}

/// Bytes on air of a frame of 31 bytes: preamble, access address, header, device address, payload, checksum; 8 µs each.
const BYTES_ON_AIR: f64 = 1.0 + 4.0 + 2.0 + 6.0 + 31.0 + 3.0;
/// Current during the transmitter's ramp-up and the crystal's start, in mA.
const RAMP_UP_MA: f64 = 3.5;
const CRYSTAL_MA: f64 = 0.6;
/// Bits of a byte on the bus, and the bus's clock.
const BITS_A_BYTE: f64 = 9.0;
const BUS_HZ: f64 = 400_000.0;
/// Bytes of addresses and registers that a read of the bus takes beside what it reads.
const READ_OVERHEAD: f64 = 3.0;
/// Polling costs a wake-up each time: instructions.
const WAKE_INSTRUCTIONS: f64 = 2_000.0;
const LDO_FACTOR: f64 = 2.0;
const CLOCK_HZ: f64 = 64e6;
const HOURS_A_YEAR: f64 = 8_766.0;
const CAPACITY_MAH: f64 = 620.0;

impl Budget {
    /// What `design` draws under `figures`.
    pub fn of(design: &Design, figures: &Figures) -> Self {
        let supply = if design.has_dc_dc { 1.0 } else { LDO_FACTOR };
        let rounds_hz = design.rounds_hz;
        let sends_ma = match design.power {
            TransmitPower::Minus40Dbm => figures.transmit_20_dbm_ma - 0.5,
            TransmitPower::Minus20Dbm => figures.transmit_20_dbm_ma,
            // 7.1 mA against 4.6, by the product specification.
            TransmitPower::Zero => figures.transmit_20_dbm_ma + 2.5,
        };
        let channel_uc = BYTES_ON_AIR * 8.0 * sends_ma * 1e-3 + figures.ramp_up_us * RAMP_UP_MA * 1e-3;
        let event_uc = 3.0 * channel_uc + figures.crystal_ms * CRYSTAL_MA;
        let [bus_s, wakes_hz] = match design.sampling {
            Sampling::Buffered => {
                let bytes = design.acceleration_rate.hz() * AccelerationEntry::LEN as f64;
                // The buffer's status once, bursts of sixteen entries, and the looks at the field.
                let looks = LOOKS as f64;
                let n_reads = rounds_hz * (1.0 + looks) + design.acceleration_rate.hz() / 16.0;
                [bus_s(bytes + (3.0 + looks * 6.0) * rounds_hz, n_reads), looks]
            }
            Sampling::Polled => [bus_s(15.0 * 6.0 + 3.0 * 6.0, 18.0), 15.0],
        };
        let instructions = rounds_hz * (figures.round_instructions + figures.driver_instructions)
            + wakes_hz * WAKE_INSTRUCTIONS;
        let cpu_share = instructions * figures.cycles_an_instruction / CLOCK_HZ;
        Self {
            sensor_ua: sensor_ua(design, figures),
            floor_ua: figures.system_on_ua,
            advertising_ua: supply * event_uc * rounds_hz,
            bus_ua: 1e3 * bus_s * (supply * figures.bus_ma + figures.pull_up_ma),
            cpu_ua: supply * 1e3 * cpu_share * figures.cpu_ma,
            loss_ua: loss_ua(figures),
            cpu_share,
        }
    }

    /// All of it.
    pub fn active_ua(&self) -> f64 {
        self.items().iter().map(|(_, ua)| ua).sum()
    }

    /// Its parts by name.
    pub fn items(&self) -> [(&'static str, f64); 6] {
        [
            ("sensor", self.sensor_ua),
            ("chip asleep", self.floor_ua),
            ("advertising", self.advertising_ua),
            ("bus", self.bus_ua),
            ("processor", self.cpu_ua),
            ("self-discharge and leaks", self.loss_ua),
        ]
    }
}

/// What a card draws while it sleeps, in µA: the accelerometer alone looks for motion, at its least resolution.
pub fn asleep_ua(figures: &Figures) -> f64 {
    asleep_at_ua(WakeUp::default().rate.hz(), figures)
}

/// As [`asleep_ua`], where the engine looks so often.
pub(crate) fn asleep_at_ua(looks_hz: f64, figures: &Figures) -> f64 {
    let on_s = on_s(Sensor::Accelerometer, f64::from(4_u8), figures);
    let watch_ua = (figures.accelerometer_ua - figures.sensor_standby_ua) * (looks_hz * on_s).min(1.0);
    figures.system_on_ua + figures.sensor_standby_ua + watch_ua + loss_ua(figures)
}

/// A sensor is on for its start-up and its conversions, at most always: at full resolution always.
fn sensor_ua(design: &Design, figures: &Figures) -> f64 {
    let one = |sensor: Sensor, rate: Rate, on_ua: f64| {
        let n = conversions(design.resolution, rate, sensor);
        let share = (rate.hz() * on_s(sensor, n, figures)).min(1.0);
        (on_ua - figures.sensor_standby_ua) * share
    };
    figures.sensor_standby_ua
        + one(Sensor::Accelerometer, design.acceleration_rate, figures.accelerometer_ua)
        + one(Sensor::Magnetometer, design.field_rate, figures.magnetometer_ua)
}

fn on_s(sensor: Sensor, n_conversions: f64, figures: &Figures) -> f64 {
    1e-3 * figures.start_up_ms + n_conversions * figures.conversion_slowness / conversions_hz(sensor)
}

fn loss_ua(figures: &Figures) -> f64 {
    let self_discharge_ua = 1e3 * CAPACITY_MAH * 0.01 * figures.self_discharge_percent / HOURS_A_YEAR;
    self_discharge_ua + figures.leak_ua
}

fn bus_s(bytes: f64, n_reads: f64) -> f64 {
    (bytes + n_reads * READ_OVERHEAD) * BITS_A_BYTE / BUS_HZ
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_by_hand() {
        let figures = Figures::ALL[1];
        let budget = Budget::of(&Design::OURS, &figures);
        // 1 + (25 · 149 + 6.25 · 294) · (2 ms + 1.25 ms)
        assert!((budget.sensor_ua - 19.078).abs() < 0.01, "{budget:?}");
        // 3 · (376 µs · 4.7 mA + 40 µs · 3.5 mA) + 0.6 ms · 0.6 mA = 6.08 µC, 0.995 times a second
        assert!((budget.advertising_ua - 6.051).abs() < 0.01, "{budget:?}");
        // 150 + 38.8 bytes and 8.53 reads of 3 more: 214.4 · 9 / 400 kHz = 4.82 ms at 0.8 mA
        assert!((budget.bus_ua - 3.859).abs() < 0.01, "{budget:?}");
        // 6.2 mAh a year are 0.707 µA.
        assert!((budget.loss_ua - 1.207).abs() < 0.01, "{budget:?}");
        let sum: f64 = budget.items().iter().map(|(_, ua)| ua).sum();
        assert_eq!(budget.active_ua(), sum);
    }

    #[test]
    fn every_choice_counts_in_its_direction() {
        let figures = Figures::ALL[1];
        let active_ua = |design: Design| Budget::of(&design, &figures).active_ua();
        let ours_ua = active_ua(Design::OURS);
        let ours = Design::OURS;
        assert!(active_ua(Design { resolution: Resolution::Maximum, ..ours }) > ours_ua + 400.0);
        assert!(active_ua(Design { resolution: Resolution::Averages4And2, ..ours }) < ours_ua);
        assert!(active_ua(Design { sampling: Sampling::Polled, ..ours }) > ours_ua);
        assert!(active_ua(Design { power: TransmitPower::Minus40Dbm, ..ours }) < ours_ua);
        assert!(active_ua(Design { power: TransmitPower::Zero, ..ours }) > ours_ua);
        assert!(active_ua(Design { has_dc_dc: false, ..ours }) > ours_ua);
        assert!(active_ua(Design { field_rate: Rate::Hz3_125, ..ours }) < ours_ua);
    }

    #[test]
    fn asleep_the_accelerometer_looks_alone() {
        // 2.2 + 1 + 149 · 3.125 · (2 ms + 4/25.6 kHz) + 1.207
        assert!((asleep_ua(&Figures::ALL[1]) - 5.411).abs() < 0.01);
    }
}
