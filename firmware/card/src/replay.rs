//! A card on recorded readings: no chip, no waiting, the same frames on every machine.
//!
//! ```
//! use fieldwalk_card::replay::{ReplayCard, SensorReading, finish};
//! use fieldwalk_card::{CardParams, RoundOutcome};
//!
//! let still = SensorReading { force_m_s2: [0.0, 9.81, 0.0], field_ut: [0.0, -42.0, -20.0] };
//! let now_us = core::cell::Cell::new(0);
//! let mut card = ReplayCard::switched_on(&now_us, std::iter::repeat(still), CardParams::of_card(7));
//! let RoundOutcome::Sent(frame) = finish(card.round()) else { panic!("a frame") };
//! // Card 7, its first round: 20 µT horizontally is 500 steps.
//! assert_eq!((frame[10], frame[9], u16::from_le_bytes([frame[18], frame[19]])), (7, 0, 500));
//! ```

use core::cell::Cell;
use core::convert::Infallible;
use core::marker::PhantomData;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

use crate::application::{Card, CardParams};
use crate::hardware::{Advertiser, Board, Clock, Hardware, MotionSensor, Retained, Supply, Watchdog};
use crate::pace::{MAX_DELAY_US, ROUND_US};

/// Microseconds between two readings: 25 a second.
pub const READING_US: u64 = 40_000;
/// Most readings that wait for the card.
const MAX_WAITING: usize = 64;

/// An acceleration, and the magnetic field that the sensor's register holds at its time, in the device frame of phones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorReading {
    /// Specific force, in m/s².
    pub force_m_s2: [f32; 3],
    /// Magnetic field, uncalibrated, in µT.
    pub field_ut: [f32; 3],
}

/// A card whose sensor says what an iterator does.
pub type ReplayCard<'a, I> = Card<Replay<'a, I>>;

/// Parts that stand for a card's.
#[derive(Clone, Copy, Debug)]
pub struct Replay<'a, I>(PhantomData<(&'a (), I)>);

impl<'a, I: Iterator<Item = SensorReading>> Hardware for Replay<'a, I> {
    type Sensor = ReplaySensor<'a, I>;
    type Advertiser = Silent;
    type Clock = ReplayClock<'a>;
    type Supply = Silent;
    type Watchdog = Silent;
    type Retained = Silent;
    type Flash = Blank;
}

impl<'a, I: Iterator<Item = SensorReading>> ReplayCard<'a, I> {
    /// A card that was just switched on, whose time is `now_us` and whose sensor gives a reading each [`READING_US`]; where
    /// there are no more, the sensor says nothing.
    pub fn switched_on(now_us: &'a Cell<u64>, readings: I, params: CardParams) -> Self {
        let sensor = ReplaySensor {
            now_us,
            next_us: now_us.get() + READING_US,
            readings,
            waiting_m_s2: [[0.0; 3]; MAX_WAITING],
            n_waiting: 0,
            field_ut: None,
        };
        let board = Board {
            sensor,
            advertiser: Silent,
            clock: ReplayClock(now_us),
            supply: Silent,
            watchdog: Silent,
            retained: Silent,
            flash: Blank,
        };
        finish(Self::new(board, params))
    }
}

/// Runs what never waits to its end.
///
/// # Panics
/// When it waits: parts on replay do not.
pub fn finish<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => unreachable!("a replayed part waits"),
    }
}

/// A sensor that says what it is told.
#[derive(Debug)]
pub struct ReplaySensor<'a, I> {
    now_us: &'a Cell<u64>,
    next_us: u64,
    readings: I,
    waiting_m_s2: [[f32; 3]; MAX_WAITING],
    n_waiting: usize,
    field_ut: Option<[f32; 3]>,
}

impl<I: Iterator<Item = SensorReading>> ReplaySensor<'_, I> {
    /// Reads what there was to read until now.
    fn catch_up(&mut self) {
        while self.next_us <= self.now_us.get() {
            let Some(reading) = self.readings.next() else { break };
            self.next_us += READING_US;
            self.field_ut = Some(reading.field_ut);
            if let Some(slot) = self.waiting_m_s2.get_mut(self.n_waiting) {
                *slot = reading.force_m_s2;
                self.n_waiting += 1;
            }
        }
    }
}

impl<I: Iterator<Item = SensorReading>> MotionSensor for ReplaySensor<'_, I> {
    type Error = Infallible;

    async fn start(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    /// NaN before the first reading.
    async fn field_ut(&mut self) -> Result<[f32; 3], Infallible> {
        self.catch_up();
        Ok(self.field_ut.unwrap_or([f32::NAN; 3]))
    }

    async fn drain(&mut self, forces_m_s2: &mut [[f32; 3]]) -> Result<usize, Infallible> {
        self.catch_up();
        let n = core::mem::take(&mut self.n_waiting).min(forces_m_s2.len());
        forces_m_s2[..n].copy_from_slice(&self.waiting_m_s2[..n]);
        Ok(n)
    }

    async fn arm(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    /// It is moved at once: who replays a walk does not want it to sleep.
    async fn wait_for_motion(&mut self, _at_most_s: u32) -> Result<bool, Infallible> {
        Ok(true)
    }
}

/// A clock that jumps to where it is to wait for.
#[derive(Clone, Copy, Debug)]
pub struct ReplayClock<'a>(&'a Cell<u64>);

impl Clock for ReplayClock<'_> {
    fn now_us(&self) -> u64 {
        self.0.get()
    }

    async fn wait_until_us(&mut self, time_us: u64) {
        self.0.set(self.0.get().max(time_us));
    }
}

/// A radio that sends nothing, a full battery, a watchdog that sleeps, memory that forgets.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Advertiser for Silent {
    async fn advertise(&mut self, _frame: &[u8; 31]) {}
}

impl Supply for Silent {
    async fn voltage_mv(&mut self) -> u16 {
        3_000
    }
}

impl Watchdog for Silent {
    fn feed(&mut self) {}
}

impl Retained for Silent {
    fn load(&self) -> u32 {
        0
    }

    fn store(&mut self, _word: u32) {}
}

/// Flash that keeps nothing.
#[derive(Clone, Copy, Debug)]
pub struct Blank;

impl ErrorType for Blank {
    type Error = Infallible;
}

impl ReadNorFlash for Blank {
    const READ_SIZE: usize = 4;

    fn read(&mut self, _offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.fill(0xFF);
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * Self::ERASE_SIZE
    }
}

impl NorFlash for Blank {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4_096;

    fn erase(&mut self, _from: u32, _to: u32) -> Result<(), Infallible> {
        Ok(())
    }

    fn write(&mut self, _offset: u32, _bytes: &[u8]) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Whether `n_readings`, the first of which comes [`READING_US`] after the card was switched on at 0, last for another
/// whole round at `now_us`.
pub fn lasts_another_round(n_readings: usize, now_us: u64) -> bool {
    now_us + ROUND_US + MAX_DELAY_US <= n_readings as u64 * READING_US
}
