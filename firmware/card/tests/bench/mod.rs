//! A card whose parts a test can look into and break.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use fieldwalk_card::replay::{READING_US, SensorReading, finish};
use fieldwalk_card::{
    Advertiser, Board, Card, CardParams, Clock, Hardware, MotionSensor, Retained, Supply, Watchdog,
};
use fieldwalk_codec::{CardFrame, CardRepr};

/// What goes on around the card.
pub struct World {
    pub now_us: u64,
    /// Readings of the accelerometer and the magnetometer by time, in seconds.
    pub reading: Box<dyn FnMut(f64) -> SensorReading>,
    pub last_reading_us: u64,
    pub n_starts: u32,
    pub is_sensor_broken: bool,
    pub is_armed: bool,
    /// When somebody moves the card, in seconds.
    pub motions_s: VecDeque<f64>,
    pub sent: Vec<(u64, CardRepr)>,
    pub voltage_mv: u16,
    pub fed_us: u64,
    pub longest_unfed_us: u64,
    pub retained: u32,
    pub flash: Vec<u8>,
    /// Bytes that can still be written until power fails.
    pub writable: usize,
}

pub type SharedWorld = Rc<RefCell<World>>;

/// A world in which the card hangs still, its back to the north, 20 µT north and 42 µT down.
pub fn world() -> SharedWorld {
    let still = SensorReading { force_m_s2: [0.0, 9.81, 0.0], field_ut: [0.0, -42.0, -20.0] };
    Rc::new(RefCell::new(World {
        now_us: 5_000_000,
        reading: Box::new(move |_| still),
        last_reading_us: 5_000_000,
        n_starts: 0,
        is_sensor_broken: false,
        is_armed: false,
        motions_s: VecDeque::new(),
        sent: Vec::new(),
        voltage_mv: 2_950,
        fed_us: 5_000_000,
        longest_unfed_us: 0,
        retained: 0xDEAD_BEEF,
        flash: vec![0xFF; 2 * 4_096],
        writable: usize::MAX,
    }))
}

/// A card that was switched on in `world`.
pub fn switched_on(world: &SharedWorld) -> Card<Bench> {
    let part = || Part(world.clone());
    let board = Board {
        sensor: part(),
        advertiser: part(),
        clock: part(),
        supply: part(),
        watchdog: part(),
        retained: part(),
        flash: part(),
    };
    finish(Card::new(board, CardParams::of_card(0x0102)))
}

/// The frames that the card sends in `n` rounds.
pub fn frames(world: &SharedWorld, card: &mut Card<Bench>, n: usize) -> Vec<CardRepr> {
    let n_before = world.borrow().sent.len();
    (0..n).for_each(|_| {
        finish(card.round());
    });
    world.borrow().sent[n_before..].iter().map(|(_, repr)| *repr).collect()
}

pub struct Part(SharedWorld);

pub struct Bench;

impl Hardware for Bench {
    type Sensor = Part;
    type Advertiser = Part;
    type Clock = Part;
    type Supply = Part;
    type Watchdog = Part;
    type Retained = Part;
    type Flash = Part;
}

impl MotionSensor for Part {
    type Error = &'static str;

    async fn start(&mut self) -> Result<(), Self::Error> {
        let mut world = self.0.borrow_mut();
        world.n_starts += 1;
        world.is_armed = false;
        world.last_reading_us = world.now_us;
        if world.is_sensor_broken { Err("no acknowledge") } else { Ok(()) }
    }

    async fn field_ut(&mut self) -> Result<[f32; 3], Self::Error> {
        let mut world = self.0.borrow_mut();
        let at_s = world.now_us as f64 * 1e-6;
        if world.is_sensor_broken { Err("no acknowledge") } else { Ok((world.reading)(at_s).field_ut) }
    }

    async fn drain(&mut self, forces_m_s2: &mut [[f32; 3]]) -> Result<usize, Self::Error> {
        let mut world = self.0.borrow_mut();
        if world.is_sensor_broken {
            return Err("no acknowledge");
        }
        let mut n = 0;
        while world.last_reading_us + READING_US <= world.now_us {
            world.last_reading_us += READING_US;
            let at_s = world.last_reading_us as f64 * 1e-6;
            if n < forces_m_s2.len() {
                forces_m_s2[n] = (world.reading)(at_s).force_m_s2;
                n += 1;
            }
        }
        Ok(n)
    }

    async fn arm(&mut self) -> Result<(), Self::Error> {
        let mut world = self.0.borrow_mut();
        if world.is_sensor_broken {
            return Err("no acknowledge");
        }
        world.is_armed = true;
        Ok(())
    }

    async fn wait_for_motion(&mut self, at_most_s: u32) -> Result<bool, Self::Error> {
        let mut world = self.0.borrow_mut();
        assert!(world.is_armed, "a sensor that reads does not watch");
        let until_us = world.now_us + 1_000_000 * u64::from(at_most_s);
        let moved_us = world.motions_s.front().map(|at_s| (at_s * 1e6) as u64);
        let Some(moved_us) = moved_us else { unreachable!("the card sleeps for ever") };
        let moved_us = moved_us.max(world.now_us);
        let is_moved = moved_us <= until_us;
        world.now_us = moved_us.min(until_us);
        if is_moved {
            world.motions_s.pop_front();
        }
        Ok(is_moved)
    }
}

impl Advertiser for Part {
    async fn advertise(&mut self, frame: &[u8; 31]) {
        let mut world = self.0.borrow_mut();
        let Ok(repr) = CardRepr::parse(&CardFrame::new_unchecked(frame)) else {
            unreachable!("no card's frame: {frame:02x?}")
        };
        let now_us = world.now_us;
        world.sent.push((now_us, repr));
    }
}

impl Clock for Part {
    fn now_us(&self) -> u64 {
        self.0.borrow().now_us
    }

    async fn wait_until_us(&mut self, time_us: u64) {
        let mut world = self.0.borrow_mut();
        world.now_us = world.now_us.max(time_us);
    }
}

impl Supply for Part {
    async fn voltage_mv(&mut self) -> u16 {
        self.0.borrow().voltage_mv
    }
}

impl Watchdog for Part {
    fn feed(&mut self) {
        let mut world = self.0.borrow_mut();
        let unfed_us = world.now_us - world.fed_us;
        world.longest_unfed_us = world.longest_unfed_us.max(unfed_us);
        world.fed_us = world.now_us;
    }
}

impl Retained for Part {
    fn load(&self) -> u32 {
        self.0.borrow().retained
    }

    fn store(&mut self, word: u32) {
        self.0.borrow_mut().retained = word;
    }
}

#[derive(Debug)]
pub struct PowerFailed;

impl NorFlashError for PowerFailed {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl From<Infallible> for PowerFailed {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

impl ErrorType for Part {
    type Error = PowerFailed;
}

impl ReadNorFlash for Part {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerFailed> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.0.borrow().flash[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.borrow().flash.len()
    }
}

impl NorFlash for Part {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4_096;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerFailed> {
        self.0.borrow_mut().flash[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerFailed> {
        let mut world = self.0.borrow_mut();
        let n = bytes.len().min(world.writable);
        world.writable -= n;
        for (old, new) in world.flash[offset as usize..].iter_mut().zip(&bytes[..n]) {
            assert_eq!(*old, 0xFF, "flash is written once between erasures");
            *old = *new;
        }
        if n < bytes.len() { Err(PowerFailed) } else { Ok(()) }
    }
}
