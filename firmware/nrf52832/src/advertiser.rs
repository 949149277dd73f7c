//! A non-connectable advertiser on the bare radio.
//!
//! # Source
//! Bluetooth Core 5.4, Vol 6, Part B: 1.4.1 channels, 2.1.2 access address, 2.3.1.3 ADV_NONCONN_IND, 3.1.1 CRC, 3.2
//! whitening, 1.3.2.1 static addresses; registers by the nRF52832's product specification, chapter RADIO.

use core::future::poll_fn;
use core::sync::atomic::{Ordering, compiler_fence};
use core::task::Poll;

use embassy_nrf::interrupt::typelevel::Handler;
use embassy_nrf::interrupt::{self, InterruptExt as _};
use embassy_nrf::pac::radio::vals;
use embassy_nrf::{Peri, pac, peripherals};
use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::Timer;
use fieldwalk_card::Advertiser;

/// Frequency over 2400 MHz, and number, of each advertising channel.
const CHANNELS: [(u8, u8); 3] = [(2, 37), (26, 38), (80, 39)];
/// The access address of all advertisements, 0x8E89BED6: its lower bytes, shifted, and its upper one.
const ACCESS_BASE: u32 = 0x89BE_D600;
const ACCESS_PREFIX: u8 = 0x8E;
/// x²⁴ + x¹⁰ + x⁹ + x⁶ + x⁴ + x³ + x + 1, without its highest power.
const CRC_POLYNOMIAL: u32 = 0x00_065B;
const CRC_INITIAL: u32 = 0x55_5555;
/// ADV_NONCONN_IND from a random address.
const HEADER: u8 = 0x42;
const ADDRESS_LEN: usize = 6;
const FRAME_LEN: usize = 31;
const PAYLOAD_LEN: usize = ADDRESS_LEN + FRAME_LEN;
/// What the crystal takes to start typically, in µs; what is left is waited for awake.
const CRYSTAL_US: u64 = 360;

static SENT: AtomicWaker = AtomicWaker::new();

/// The radio has sent a packet and is off.
pub struct SentInterrupt;

impl Handler<interrupt::typelevel::RADIO> for SentInterrupt {
    unsafe fn on_interrupt() {
        pac::RADIO.intenclr().write(|w| w.set_disabled(true));
        SENT.wake();
    }
}

/// The radio.
pub struct RadioAdvertiser {
    _radio: Peri<'static, peripherals::RADIO>,
    /// Header, length, address, frame; the radio reads it from RAM.
    packet: [u8; 2 + PAYLOAD_LEN],
}

impl RadioAdvertiser {
    pub fn new(radio: Peri<'static, peripherals::RADIO>) -> Self {
        let mut packet = [0; 2 + PAYLOAD_LEN];
        (packet[0], packet[1]) = (HEADER, PAYLOAD_LEN as u8);
        let [low, high] = [0, 1].map(|k| pac::FICR.deviceaddr(k).read().to_le_bytes());
        packet[2..6].copy_from_slice(&low);
        // The two highest bits of a static random address are ones.
        (packet[6], packet[7]) = (high[0], high[1] | 0xC0);
        interrupt::RADIO.unpend();
        // SAFETY: its handler is bound, and touches the radio's own registers alone.
        unsafe { interrupt::RADIO.enable() };
        Self { _radio: radio, packet }
    }

    /// Sets what does not differ from channel to channel. The radio forgets nothing, but this costs little, and undoes
    /// whatever a dip of the supply has done.
    fn set_up(&self) {
        let radio = pac::RADIO;
        radio.mode().write(|w| w.set_mode(vals::Mode::Ble1mbit));
        radio.modecnf0().write(|w| {
            w.set_ru(vals::Ru::Fast);
            w.set_dtx(vals::Dtx::Center);
        });
        radio.txpower().write(|w| w.set_txpower(vals::Txpower::Neg20dBm));
        radio.pcnf0().write(|w| {
            w.set_s0len(true);
            w.set_lflen(8);
            w.set_s1len(0);
        });
        radio.pcnf1().write(|w| {
            w.set_maxlen(PAYLOAD_LEN as u8);
            w.set_statlen(0);
            w.set_balen(3);
            w.set_endian(vals::Endian::Little);
            w.set_whiteen(true);
        });
        radio.base0().write_value(ACCESS_BASE);
        radio.prefix0().write(|w| w.set_ap0(ACCESS_PREFIX));
        radio.txaddress().write(|w| w.set_txaddress(0));
        radio.crccnf().write(|w| {
            w.set_len(vals::Len::Three);
            w.set_skipaddr(vals::Skipaddr::Skip);
        });
        radio.crcpoly().write(|w| w.set_crcpoly(CRC_POLYNOMIAL));
        radio.crcinit().write(|w| w.set_crcinit(CRC_INITIAL));
        radio.shorts().write(|w| {
            w.set_ready_start(true);
            w.set_end_disable(true);
        });
        radio.packetptr().write_value(self.packet.as_ptr() as u32);
    }

    async fn send(&mut self, frequency: u8, channel: u8) {
        let radio = pac::RADIO;
        radio.frequency().write(|w| w.set_frequency(frequency));
        radio.datawhiteiv().write(|w| w.set_datawhiteiv(channel));
        radio.events_disabled().write_value(0);
        // The packet is in memory before the radio reads it.
        compiler_fence(Ordering::SeqCst);
        radio.tasks_txen().write_value(1);
        poll_fn(|context| {
            SENT.register(context.waker());
            if pac::RADIO.events_disabled().read() != 0 {
                return Poll::Ready(());
            }
            pac::RADIO.intenset().write(|w| w.set_disabled(true));
            Poll::Pending
        })
        .await;
        compiler_fence(Ordering::SeqCst);
    }
}

impl Advertiser for RadioAdvertiser {
    async fn advertise(&mut self, frame: &[u8; FRAME_LEN]) {
        self.packet[2 + ADDRESS_LEN..].copy_from_slice(frame);
        let clock = pac::CLOCK;
        clock.events_hfclkstarted().write_value(0);
        clock.tasks_hfclkstart().write_value(1);
        Timer::after_micros(CRYSTAL_US).await;
        // A crystal that does not start hangs the card here, and the watchdog resets it.
        while clock.events_hfclkstarted().read() == 0 {}
        self.set_up();
        for (frequency, channel) in CHANNELS {
            self.send(frequency, channel).await;
        }
        clock.tasks_hfclkstop().write_value(1);
    }
}
