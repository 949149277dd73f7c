//! What the card's sensor says, any bytes: no panic, numbers within the part's ranges, an entry survives its bytes.
#![no_main]

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use embedded_hal_async::i2c::{ErrorType, Operation};
use fieldwalk_kmx62::{
    AccelerationEntry, AccelerationRange, BufferEntry, BufferStatus, Interrupts, Kmx62, Sample, SlaveAddress,
};
use libfuzzer_sys::fuzz_target;

/// A part that says the input's bytes, whatever it is asked.
struct Babbler<'a>(&'a [u8]);

impl ErrorType for Babbler<'_> {
    type Error = core::convert::Infallible;
}

impl embedded_hal_async::i2c::I2c for Babbler<'_> {
    async fn transaction(
        &mut self,
        _address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), Self::Error> {
        for operation in operations {
            let Operation::Read(into) = operation else { continue };
            for byte in into.iter_mut() {
                let (first, rest) = self.0.split_first().unwrap_or((&0xFF, &[]));
                (*byte, self.0) = (*first, rest);
            }
        }
        Ok(())
    }
}

fn wait<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => unreachable!("nothing here waits"),
    }
}

fuzz_target!(|bytes: &[u8]| {
    if let Some(bytes) = bytes.first_chunk() {
        let sample = Sample::from_bytes(*bytes);
        assert!(sample.field_ut().iter().all(|c| c.abs() <= 1_200.0));
        assert!(sample.acceleration_m_s2(AccelerationRange::G2).iter().all(|c| c.abs() < 19.7));
    }
    if let Some(bytes) = bytes.first_chunk()
        && let Some(entry) = BufferEntry::from_bytes(*bytes)
    {
        assert_eq!(entry.to_bytes(), *bytes);
    }
    if let Some(bytes) = bytes.first_chunk() {
        assert!(BufferStatus::from_bytes(*bytes).n_entries::<AccelerationEntry>() <= 64);
        let _ = Interrupts::from_bytes(*bytes);
    }
    let mut part = Kmx62::new(Babbler(bytes), SlaveAddress::Primary);
    let mut entries = [BufferEntry::default(); 32];
    let mut accelerations = [AccelerationEntry::default(); 64];
    for _ in 0..=bytes.len() / 6 {
        let n = wait(part.read_buffer(&mut entries)).unwrap_or_default();
        assert!(n <= entries.len());
        let n = wait(part.read_buffer(&mut accelerations)).unwrap_or_default();
        assert!(n <= accelerations.len());
    }
});
