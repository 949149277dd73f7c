//! The KMX62 on its bus.

use embassy_nrf::gpio::Input;
use embassy_nrf::twim::{self, Twim};
use embassy_nrf::{Peri, peripherals};
use embassy_time::{Delay, Duration, with_timeout};
use fieldwalk_card::MotionSensor;
use fieldwalk_kmx62::{AccelerationEntry, Config, Error, Kmx62, Rate, SlaveAddress, WakeUp};

use crate::Irqs;

/// Most entries of the buffer.
const MAX_ENTRIES: usize = 64;

/// The sensor, its bus and the pin by which it tells of motion.
pub struct Sensor {
    bus: Peri<'static, peripherals::TWISPI0>,
    sda: Peri<'static, peripherals::P0_26>,
    scl: Peri<'static, peripherals::P0_27>,
    moved: Input<'static>,
    config: Config,
    /// What is written from flash passes through here.
    ram: [u8; 8],
}

impl Sensor {
    pub fn new(
        bus: Peri<'static, peripherals::TWISPI0>,
        sda: Peri<'static, peripherals::P0_26>,
        scl: Peri<'static, peripherals::P0_27>,
        moved: Input<'static>,
    ) -> Self {
        // The accelerometer as often as the application takes it to; the magnetometer twice as often as it is read, so that
        // what it says is 80 ms old on average.
        let config = Config { acceleration_rate: Rate::Hz25, field_rate: Rate::Hz6_25, ..Config::default() };
        Self { bus, sda, scl, moved, config, ram: [0; 8] }
    }

    /// The part, its bus switched on until it is dropped.
    fn part(&mut self) -> Kmx62<Twim<'_>> {
        let mut config = twim::Config::default();
        config.frequency = twim::Frequency::K400;
        let (sda, scl) = (self.sda.reborrow(), self.scl.reborrow());
        Kmx62::new(
            Twim::new(self.bus.reborrow(), Irqs, sda, scl, config, &mut self.ram),
            SlaveAddress::Primary,
        )
    }
}

impl MotionSensor for Sensor {
    type Error = Error<twim::Error>;

    async fn start(&mut self) -> Result<(), Self::Error> {
        let config = self.config;
        let mut part = self.part();
        part.reset(&mut Delay).await?;
        part.identify().await?;
        part.start(&config).await?;
        part.start_buffer::<AccelerationEntry>().await
    }

    async fn field_ut(&mut self) -> Result<[f32; 3], Self::Error> {
        self.part().field_ut().await
    }

    async fn drain(&mut self, forces_m_s2: &mut [[f32; 3]]) -> Result<usize, Self::Error> {
        let range = self.config.range;
        let mut entries = [AccelerationEntry::default(); MAX_ENTRIES];
        let n_asked = forces_m_s2.len().min(MAX_ENTRIES);
        let n = self.part().read_buffer(&mut entries[..n_asked]).await?;
        // The part is mounted so that its axes are those of a phone.
        for (force_m_s2, entry) in forces_m_s2.iter_mut().zip(&entries[..n]) {
            *force_m_s2 = entry.acceleration_m_s2(range);
        }
        Ok(n)
    }

    async fn arm(&mut self) -> Result<(), Self::Error> {
        self.part().watch(&WakeUp::default()).await
    }

    async fn wait_for_motion(&mut self, at_most_s: u32) -> Result<bool, Self::Error> {
        let at_most = Duration::from_secs(u64::from(at_most_s));
        let is_moved = with_timeout(at_most, self.moved.wait_for_high()).await.is_ok();
        if is_moved {
            self.part().interrupts().await?;
        }
        Ok(is_moved)
    }
}
