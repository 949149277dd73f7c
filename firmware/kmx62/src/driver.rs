//! The driver: what goes over the bus.

use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::i2c::I2c;

use crate::buffer::{BufferStatus, Entry};
use crate::config::{Config, Resolution, WakeUp};
use crate::interrupt::Interrupts;
use crate::register::{
    AMI_EN, BUF_MODE_STREAM, CNTL1_COTC, CNTL1_SRST, CNTL2_ACCEL_EN, INC1_AMI1, INC3_ACTIVE_HIGH_LATCHED,
    Register,
};
use crate::sample::{AccelerationRange, FIELD_UT_PER_LSB, Sample};

/// Identities that the part may tell.
///
/// # Source
/// The maker's Linux driver takes 0x18 and 0x19, and real parts were seen to say 0x18; its register header says 0x14, which
/// is another part's.
pub const WHO_AM_I: [u8; 2] = [0x18, 0x19];

/// How long the part takes for a reset at most, in ms. Examples wait from 2 ms to 1 s; the true figure is not known.
const RESET_MS: u32 = 50;
/// Bytes that are read in one go, at most: 2.2 ms at 400 kHz, during which the buffer takes nothing in.
const BURST_LEN: usize = 96;

/// By the level of a pin, the part's address on the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum SlaveAddress {
    /// 0x0E.
    #[default]
    Primary = 0x0E,
    /// 0x0F.
    Secondary = 0x0F,
}

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// Another part is at this address: what it says that it is.
    WrongPart(u8),
    /// The part does not do what it is told: what the command test gave, where 0x55 and 0xAA were expected.
    TestFailed([u8; 2]),
}

impl<E> From<E> for Error<E> {
    fn from(error: E) -> Self {
        Self::Bus(error)
    }
}

impl<E: core::fmt::Debug> core::fmt::Display for Error<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "the bus failed: {error:?}"),
            Self::WrongPart(id) => write!(f, "no KMX62: the part says that it is {id:#04x}"),
            Self::TestFailed(read) => write!(f, "the command test gave {read:02x?}"),
        }
    }
}

impl<E: core::fmt::Debug> core::error::Error for Error<E> {}

/// A KMX62 on a bus.
#[derive(Debug)]
pub struct Kmx62<I> {
    i2c: I,
    address: u8,
}

impl<I: I2c> Kmx62<I> {
    /// The part at `address`; nothing is written yet.
    pub fn new(i2c: I, address: SlaveAddress) -> Self {
        Self { i2c, address: address as u8 }
    }

    /// The bus back.
    pub fn into_inner(self) -> I {
        self.i2c
    }

    /// Makes sure that the part is one of [`WHO_AM_I`].
    ///
    /// # Errors
    /// [`Error::WrongPart`], or when the bus fails.
    pub async fn identify(&mut self) -> Result<u8, Error<I::Error>> {
        let [id] = self.read(Register::WhoAmI).await?;
        if WHO_AM_I.contains(&id) { Ok(id) } else { Err(Error::WrongPart(id)) }
    }

    /// Resets the part, and waits until it is ready.
    ///
    /// # Errors
    /// When the bus fails. That the part does not acknowledge its own reset is none.
    pub async fn reset(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<I::Error>> {
        self.write(Register::Cntl2, 0).await?;
        let _ = self.write(Register::Cntl1, CNTL1_SRST).await; // some parts are gone before the acknowledge
        delay.delay_ms(RESET_MS).await;
        Ok(())
    }

    /// Asks the part to turn the bits of a register round, once.
    ///
    /// # Errors
    /// [`Error::TestFailed`], or when the bus fails.
    pub async fn command_test(&mut self) -> Result<(), Error<I::Error>> {
        let [before] = self.read(Register::Cotr).await?;
        self.write(Register::Cntl1, CNTL1_COTC).await?;
        let [turned] = self.read(Register::Cotr).await?;
        if [before, turned] == [0x55, 0xAA] { Ok(()) } else { Err(Error::TestFailed([before, turned])) }
    }

    /// Sets rates, range and resolution in standby, and lets both sensors read. The motion engine is off.
    ///
    /// The first readings come after a period and a half, at most 0.1 s later.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn start(&mut self, config: &Config) -> Result<(), Error<I::Error>> {
        self.write(Register::Cntl2, config.standby()).await?;
        self.write(Register::AmiCntl3, 0).await?;
        self.write(Register::Inc1, 0).await?;
        self.write(Register::OdCntl, config.odcntl()).await?;
        self.write(Register::Cntl2, config.cntl2()).await
    }

    /// Stops both sensors, and empties the buffer.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn standby(&mut self) -> Result<(), Error<I::Error>> {
        self.write(Register::Cntl2, 0).await?;
        self.clear_buffer().await
    }

    /// The latest reading of both sensors and the temperature.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn sample(&mut self) -> Result<Sample, Error<I::Error>> {
        Ok(Sample::from_bytes(self.read(Register::AccelXL).await?))
    }

    /// The latest reading of the field, in µT.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn field_ut(&mut self) -> Result<[f32; 3], Error<I::Error>> {
        let bytes: [u8; 6] = self.read(Register::MagXL).await?;
        Ok([0, 1, 2]
            .map(|k| f32::from(i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]])) * FIELD_UT_PER_LSB))
    }

    /// Lets readings go into the buffer as entries `E`, in which the oldest make room for the newest. For entries of both
    /// sensors these must read at one rate.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn start_buffer<E: Entry>(&mut self) -> Result<(), Error<I::Error>> {
        let address = Register::BufCtrl1 as u8;
        self.i2c.write(self.address, &[address, 0, BUF_MODE_STREAM, E::AXES]).await?;
        self.clear_buffer().await
    }

    /// Empties the buffer.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn clear_buffer(&mut self) -> Result<(), Error<I::Error>> {
        self.write(Register::BufClear, 0).await
    }

    /// How full the buffer is.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn buffer_status(&mut self) -> Result<BufferStatus, Error<I::Error>> {
        Ok(BufferStatus::from_bytes(self.read(Register::BufStatus1).await?))
    }

    /// Takes the oldest readings from the buffer, as many as fit into `entries`, and says how many those were. `E` is what
    /// the buffer was started with.
    ///
    /// # Errors
    /// When the bus fails; readings that were taken before are lost.
    pub async fn read_buffer<E: Entry>(&mut self, entries: &mut [E]) -> Result<usize, Error<I::Error>> {
        let n_held = self.buffer_status().await?.n_entries::<E>().min(entries.len());
        let mut n = 0;
        while n < n_held {
            let mut bytes = [0; BURST_LEN];
            let n_burst = (n_held - n).min(BURST_LEN / E::LEN);
            let burst = &mut bytes[..n_burst * E::LEN];
            self.i2c.write_read(self.address, &[Register::BufRead as u8], burst).await?;
            for chunk in burst.chunks_exact(E::LEN) {
                // A filler in the middle says that the buffer held less than it said.
                let Some(entry) = E::from_slice(chunk) else { return Ok(n) };
                entries[n] = entry;
                n += 1;
            }
        }
        Ok(n)
    }

    /// Lets the accelerometer alone watch for motion, which pulls GPIO1 high until [`Kmx62::interrupts`] is called.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn watch(&mut self, wake_up: &WakeUp) -> Result<(), Error<I::Error>> {
        let config = Config {
            acceleration_rate: wake_up.rate.acceleration_rate(),
            field_rate: wake_up.rate.acceleration_rate(),
            range: AccelerationRange::G4,
            resolution: Resolution::Averages4And2,
            reads_temperature: false,
        };
        self.write(Register::Cntl2, config.standby()).await?;
        self.write(Register::OdCntl, config.odcntl()).await?;
        self.write(Register::Inc3, INC3_ACTIVE_HIGH_LATCHED).await?;
        self.write(Register::Inc1, INC1_AMI1).await?;
        self.write(Register::Inc4, wake_up.axes.bits()).await?;
        let engine =
            [Register::AmiCntl1 as u8, wake_up.threshold, wake_up.n_looks, AMI_EN | wake_up.rate as u8];
        self.i2c.write(self.address, &engine).await?;
        self.write(Register::Cntl2, config.standby() | CNTL2_ACCEL_EN).await?;
        let [_released] = self.read(Register::Inl).await?;
        Ok(())
    }

    /// What interrupts are pending; they and the pin are released.
    ///
    /// # Errors
    /// When the bus fails.
    pub async fn interrupts(&mut self) -> Result<Interrupts, Error<I::Error>> {
        let interrupts = Interrupts::from_bytes(self.read(Register::Ins1).await?);
        let [_released] = self.read(Register::Inl).await?;
        Ok(interrupts)
    }

    async fn write(&mut self, register: Register, value: u8) -> Result<(), Error<I::Error>> {
        Ok(self.i2c.write(self.address, &[register as u8, value]).await?)
    }

    async fn read<const N: usize>(&mut self, register: Register) -> Result<[u8; N], Error<I::Error>> {
        let mut bytes = [0; N];
        self.i2c.write_read(self.address, &[register as u8], &mut bytes).await?;
        Ok(bytes)
    }
}
