//! The parts of the board that are wired in a line.

use embassy_nrf::saadc::{ChannelConfig, Config, Saadc, VddInput};
use embassy_nrf::wdt::WatchdogHandle;
use embassy_nrf::{Peri, peripherals};
use embassy_time::{Instant, Timer};
use fieldwalk_card::{Clock, Hardware, Supply, Watchdog};

use crate::Irqs;
use crate::advertiser::RadioAdvertiser;
use crate::flash::CalibrationPages;
use crate::retained::RetainedWord;
use crate::sensor::Sensor;

/// This board.
pub struct Nrf52832;

impl Hardware for Nrf52832 {
    type Sensor = Sensor;
    type Advertiser = RadioAdvertiser;
    type Clock = RtcClock;
    type Supply = VddSupply;
    type Watchdog = PettedWatchdog;
    type Retained = RetainedWord;
    type Flash = CalibrationPages;
}

/// Embassy's clock, which is RTC1.
pub struct RtcClock;

impl Clock for RtcClock {
    fn now_us(&self) -> u64 {
        Instant::now().as_micros()
    }

    async fn wait_until_us(&mut self, time_us: u64) {
        Timer::at(Instant::from_micros(time_us)).await;
    }
}

/// The chip's own supply, which is the battery.
pub struct VddSupply(Peri<'static, peripherals::SAADC>);

impl VddSupply {
    pub fn new(saadc: Peri<'static, peripherals::SAADC>) -> Self {
        Self(saadc)
    }
}

/// Full scale of the converter, in mV: 0.6 V at a gain of a sixth.
const FULL_SCALE_MV: u32 = 3_600;
const FULL_SCALE_STEPS: u32 = 4_096;

impl Supply for VddSupply {
    async fn voltage_mv(&mut self) -> u16 {
        // Made anew and dropped, for a converter that stays on draws more than all else.
        let channel = ChannelConfig::single_ended(VddInput);
        let mut converter = Saadc::new(self.0.reborrow(), Irqs, Config::default(), [channel]);
        let mut steps = [0];
        converter.sample(&mut steps).await;
        (steps[0].max(0).unsigned_abs() as u32 * FULL_SCALE_MV / FULL_SCALE_STEPS) as u16
    }
}

/// The watchdog.
pub struct PettedWatchdog(pub WatchdogHandle);

impl Watchdog for PettedWatchdog {
    fn feed(&mut self) {
        self.0.pet();
    }
}
