//! The ID card's firmware: wiring alone. What a card does is in `fieldwalk-card`.
//!
//! | part | is wired to |
//! |---|---|
//! | KMX62 | TWISPI0: SDA P0.26, SCL P0.27, with pull-ups; GPIO1 to P0.25 |
//! | radio | channels 37, 38 and 39 at −20 dBm, without a controller: [`advertiser`] |
//! | clock | RTC1 on the 32 kHz crystal |
//! | battery | VDD, measured by the SAADC |
//! | watchdog | 60 s, which runs on while the chip sleeps |
//! | calibration | the last two pages of the flash |
//!
//! The DC/DC converter runs. Bus, converter and crystal are off but for the moments in which they are used: each kept on
//! would draw more than all else. This image has been linked, and measured in size; it has not run on a card yet.

#![no_std]
#![no_main]

mod advertiser;
mod board;
mod flash;
mod retained;
mod sensor;

use embassy_executor::Spawner;
use embassy_nrf::gpio::{Input, Pull};
use embassy_nrf::nvmc::Nvmc;
use embassy_nrf::{bind_interrupts, config, pac, peripherals, saadc, twim, wdt};
use fieldwalk_card::{Board, Card, CardParams};
use panic_reset as _;

bind_interrupts!(struct Irqs {
    TWISPI0 => twim::InterruptHandler<peripherals::TWISPI0>;
    SAADC => saadc::InterruptHandler;
    RADIO => advertiser::SentInterrupt;
});

/// Ticks of 32768 Hz.
const WATCHDOG_TICKS: u32 = 60 * 32_768;

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let mut chip = config::Config::default();
    chip.lfclk_source = config::LfclkSource::ExternalXtal;
    chip.dcdc.reg1 = true;
    let parts = embassy_nrf::init(chip);
    let mut watching = wdt::Config::default();
    watching.timeout_ticks = WATCHDOG_TICKS;
    // A watchdog that runs with other settings cannot be had: a reset gives it back.
    let Ok((_watchdog, [watchdog])) = wdt::Watchdog::try_new(parts.WDT, watching) else {
        cortex_m::peripheral::SCB::sys_reset()
    };
    let board = Board::<board::Nrf52832> {
        sensor: sensor::Sensor::new(
            parts.TWISPI0,
            parts.P0_26,
            parts.P0_27,
            Input::new(parts.P0_25, Pull::None),
        ),
        advertiser: advertiser::RadioAdvertiser::new(parts.RADIO),
        clock: board::RtcClock,
        supply: board::VddSupply::new(parts.SAADC),
        watchdog: board::PettedWatchdog(watchdog),
        retained: retained::RetainedWord,
        flash: flash::CalibrationPages::new(Nvmc::new(parts.NVMC)),
    };
    // Two bytes of the chip's own number: whoever hands out cards writes down which has which.
    let card_id = pac::FICR.deviceid(0).read() as u16;
    Card::new(board, CardParams::of_card(card_id)).await.run().await;
}
