//! The KMX62 on its bus.

use embassy_nrf::gpio::Input;
use embassy_nrf::twim::{self, Twim};
use embassy_nrf::{Peri, peripherals};
use embassy_time::{Delay, Duration, with_timeout};
use fieldwalk_card::{MotionSensor, SensorReading};
use fieldwalk_kmx62::{BufferEntry, Config, Error, Kmx62, SlaveAddress, WakeUp};

use crate::Irqs;

/// Most entries of the buffer.
const MAX_ENTRIES: usize = 32;

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
        Self { bus, sda, scl, moved, config: Config::default(), ram: [0; 8] }
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
        part.start_buffer().await
    }

    async fn drain(&mut self, readings: &mut [SensorReading]) -> Result<usize, Self::Error> {
        let range = self.config.range;
        let mut entries = [BufferEntry::default(); MAX_ENTRIES];
        let n_asked = readings.len().min(MAX_ENTRIES);
        let n = self.part().read_buffer(&mut entries[..n_asked]).await?;
        // The part is mounted so that its axes are those of a phone.
        for (reading, entry) in readings.iter_mut().zip(&entries[..n]) {
            *reading =
                SensorReading { force_m_s2: entry.acceleration_m_s2(range), field_ut: entry.field_ut() };
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
