//! The model's parameters: every figure that is not certain, with its range and its source.

/// A figure of the model.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name, which ends in its unit.
    pub name: &'static str,
    /// What it is at the frugal end, in the middle and at the dear end.
    pub values: [f64; 3],
    /// What it is, and where its values come from.
    pub source: &'static str,
}

macro_rules! parameters {
    ($($name:ident $values:expr, $source:literal;)*) => {
        /// One value for each parameter.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Figures {
            $(#[doc = $source] pub $name: f64,)*
        }

        impl Figures {
            /// All at the frugal end, in the middle, at the dear end.
            pub const ALL: [Self; 3] = [Self::at(0), Self::at(1), Self::at(2)];

            const fn at(k: usize) -> Self {
                Self { $($name: { const VALUES: [f64; 3] = $values; VALUES[k] },)* }
            }
        }

        /// All parameters.
        pub const PARAMETERS: &[Parameter] =
            &[$(Parameter { name: stringify!($name), values: $values, source: $source },)*];
    };
}

parameters! {
    accelerometer_ua [150.0, 150.0, 200.0],
        "KMX62's accelerometer while it converts. 150 is the maker's Linux driver's; that it means full power is a guess";
    magnetometer_ua [295.0, 295.0, 400.0],
        "KMX62's magnetometer while it converts. 295 is the maker's Linux driver's; that it means full power is a guess";
    sensor_standby_ua [0.5, 1.0, 2.0],
        "KMX62 between readings. From memory";
    start_up_ms [0.5, 2.0, 5.0],
        "What a sensor of the KMX62 needs before it converts, each reading. Not published: the guess that matters most";
    conversion_slowness [1.0, 1.0, 2.0],
        "How much longer a conversion takes than a period of the part's debug rates, 25.6 and 12.8 kHz. A guess";
    system_on_ua [1.9, 2.2, 2.8],
        "nRF52832 asleep with its RAM and the clock of the 32 kHz crystal. Product specification 1.1, second-hand";
    transmit_20_dbm_ma [4.4, 4.7, 5.1],
        "nRF52832 sending at −20 dBm with DC/DC, 3 V: 0.5 more than at −40 dBm, 4.1 of the product specification 1.1";
    ramp_up_us [40.0, 40.0, 41.0],
        "Ramp-up of the transmitter for each channel, at 3.5 mA: fast, as this firmware sets it. Zephyr's radio driver";
    crystal_ms [0.36, 0.6, 1.5],
        "Start of the 32 MHz crystal, at 0.6 mA: 0.36 typical from memory, 1.5 what stacks reserve";
    cpu_ma [3.4, 3.7, 4.2],
        "nRF52832's processor at 64 MHz from flash with DC/DC. From memory; a vendor's page says 3.4";
    round_instructions [21_100.0, 21_700.0, 30_400.0],
        "Instructions of the application in a round, in the emulator: the mean, the dearest round, and 40 % more";
    driver_instructions [4_000.0, 10_000.0, 30_000.0],
        "Instructions of the drivers in a round: bus, radio, timers, wake-ups. A guess";
    cycles_an_instruction [1.2, 1.6, 2.5],
        "Cycles an instruction, with the flash's wait states. A guess; the emulator counts instructions alone";
    bus_ma [0.4, 0.5, 0.7],
        "TWIM and the high-frequency clock while the bus is busy: 450 µA seen by others, and 50 from memory";
    pull_up_ma [0.15, 0.3, 0.3],
        "Two pull-ups of 10 kΩ at 3 V, low for half of the time; half of that with 20 kΩ";
    self_discharge_percent [0.5, 1.0, 2.0],
        "CR2450 of 620 mAh, a year. 1 from pages that repeat the maker's table";
    leak_ua [0.3, 0.5, 1.0],
        "Capacitors and the board. A guess";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frugal_end_is_never_dearer() {
        for Parameter { name, values: [low, middle, high], source } in PARAMETERS {
            assert!(low <= middle && middle <= high && *low > 0.0, "{name}");
            assert!(!source.is_empty());
        }
        assert_eq!(Figures::ALL[1].magnetometer_ua, 295.0);
        assert_eq!(PARAMETERS.iter().filter(|p| p.name.ends_with("_ua")).count(), 5);
    }
}
