//! What the application needs of a card.

use embedded_storage::nor_flash::NorFlash;

/// An accelerometer with a buffer, a magnetometer, and an engine that notices motion; both in the device frame of phones.
#[allow(async_fn_in_trait, reason = "an application is one task on one core")]
pub trait MotionSensor {
    /// What can go wrong on its bus.
    type Error: core::fmt::Debug;

    /// Resets it, and lets it read the acceleration at [`CardParams::reading_hz`](crate::CardParams) into its buffer, and
    /// the field.
    async fn start(&mut self) -> Result<(), Self::Error>;

    /// The latest magnetic field, uncalibrated, in µT.
    async fn field_ut(&mut self) -> Result<[f32; 3], Self::Error>;

    /// Takes the accelerations that were read since the last call, oldest first, as specific forces in m/s², and says how
    /// many those were; what does not fit is dropped.
    async fn drain(&mut self, forces_m_s2: &mut [[f32; 3]]) -> Result<usize, Self::Error>;

    /// Stops reading; from now on the sensor only notices motion.
    async fn arm(&mut self) -> Result<(), Self::Error>;

    /// Waits for motion, `at_most_s` seconds at most; whether there was any.
    async fn wait_for_motion(&mut self, at_most_s: u32) -> Result<bool, Self::Error>;
}

/// Sends advertisements nobody can connect to.
#[allow(async_fn_in_trait, reason = "an application is one task on one core")]
pub trait Advertiser {
    /// Sends one event: the same 31 bytes on channels 37, 38 and 39.
    async fn advertise(&mut self, frame: &[u8; 31]);
}

/// A clock that runs while the card sleeps.
#[allow(async_fn_in_trait, reason = "an application is one task on one core")]
pub trait Clock {
    /// Microseconds since some moment; never back.
    fn now_us(&self) -> u64;

    /// Waits until that time; at once where it has passed.
    async fn wait_until_us(&mut self, time_us: u64);
}

/// The battery's voltage.
#[allow(async_fn_in_trait, reason = "an application is one task on one core")]
pub trait Supply {
    /// In mV.
    async fn voltage_mv(&mut self) -> u16;
}

/// Resets the card unless it is fed in time; its timeout must be longer than 40 s.
pub trait Watchdog {
    /// Everything is well.
    fn feed(&mut self);
}

/// A word of memory that outlives a reset but not the loss of power.
pub trait Retained {
    /// What was stored last; anything after power was lost.
    fn load(&self) -> u32;

    /// Stores a word.
    fn store(&mut self, word: u32);
}

/// The types of a card's parts.
pub trait Hardware {
    /// Its sensor.
    type Sensor: MotionSensor;
    /// Its radio.
    type Advertiser: Advertiser;
    /// Its clock.
    type Clock: Clock;
    /// Its battery.
    type Supply: Supply;
    /// Its watchdog.
    type Watchdog: Watchdog;
    /// Its retained memory.
    type Retained: Retained;
    /// Where the calibration is kept.
    type Flash: NorFlash;
}

/// A card's parts.
#[expect(missing_debug_implementations, reason = "parts are registers, which are not printed")]
pub struct Board<H: Hardware> {
    /// Accelerometer and magnetometer.
    pub sensor: H::Sensor,
    /// The radio.
    pub advertiser: H::Advertiser,
    /// The clock that runs while the card sleeps.
    pub clock: H::Clock,
    /// The battery.
    pub supply: H::Supply,
    /// The watchdog.
    pub watchdog: H::Watchdog,
    /// The word that outlives a reset.
    pub retained: H::Retained,
    /// Two pages of flash or more, of which the first two keep the calibration.
    pub flash: H::Flash,
}
