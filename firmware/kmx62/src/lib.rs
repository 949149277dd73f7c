//! Driver of the KMX62, an accelerometer and a magnetometer in one part, over asynchronous I²C.
//!
//! ```
//! use embedded_hal_async::{delay::DelayNs, i2c::I2c};
//! use fieldwalk_kmx62::{BufferEntry, Config, Error, Kmx62, SlaveAddress};
//!
//! /// Both sensors at 12.5 Hz into the buffer; what it holds after a second.
//! async fn second<I: I2c>(i2c: I, delay: &mut impl DelayNs) -> Result<usize, Error<I::Error>> {
//!     let config = Config::default();
//!     let mut sensor = Kmx62::new(i2c, SlaveAddress::Primary);
//!     sensor.reset(delay).await?;
//!     sensor.identify().await?;
//!     sensor.start(&config).await?;
//!     sensor.start_buffer::<BufferEntry>().await?;
//!     delay.delay_ms(1_000).await;
//!     let mut entries = [BufferEntry::default(); 32];
//!     let n = sensor.read_buffer(&mut entries).await?;
//!     for entry in &entries[..n] {
//!         let _field_ut = entry.field_ut();
//!         let _force_m_s2 = entry.acceleration_m_s2(config.range);
//!     }
//!     Ok(n)
//! }
//! ```
//!
//! The driver keeps no state but the bus and the address: what the part holds is what was written last. Decoding of
//! what it says is apart from the bus ([`Sample::from_bytes`], [`BufferEntry::from_bytes`], [`BufferStatus::from_bytes`],
//! [`Interrupts::from_bytes`]) and takes any bytes.
//!
//! # Source
//! Registers and their fields: `kmx62_registers.h` of RohmSemiconductor/RegisterDefinitions (MIT), and the maker's
//! examples. The complete data sheet was not at hand: what is not known, such as the unit of the wake-up threshold, is
//! said where it matters. No part has been measured with this driver yet.

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod buffer;
mod config;
mod driver;
mod interrupt;
mod register;
mod sample;

pub use buffer::{AccelerationEntry, BUFFER_LEN, BufferEntry, BufferStatus, Entry};
pub use config::{Config, Rate, Resolution, Sensor, WakeUp, WakeUpRate};
pub use driver::{Error, Kmx62, SlaveAddress, WHO_AM_I};
pub use interrupt::{Interrupts, MotionAxes};
pub use register::Register;
pub use sample::{AccelerationRange, FIELD_UT_PER_LSB, STANDARD_GRAVITY_M_S2, Sample};
