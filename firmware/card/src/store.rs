//! The calibration in flash.

use embedded_storage::nor_flash::NorFlash;

use crate::calibration::Calibration;

/// What a record begins with: a mark, and the version of its layout.
const MAGIC: u32 = 0x4643_0001;
/// Mark, count, ten numbers, checksum, and words left free.
const WORDS: usize = 16;
const LEN: usize = 4 * WORDS;

/// What went wrong with the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError<E> {
    /// It has fewer than two pages, or its words do not divide a record.
    Unfit,
    /// It failed.
    Flash(E),
}

impl<E> From<E> for StoreError<E> {
    fn from(error: E) -> Self {
        Self::Flash(error)
    }
}

/// Keeps the calibration in the first two pages of a flash, in turns: a record that power cut short leaves the one before.
///
/// A record is the mark, the number of records so far, the calibration, and a checksum over these, little-endian, at the
/// beginning of a page.
#[derive(Debug)]
pub struct CalibrationStore<F> {
    flash: F,
}

impl<F: NorFlash> CalibrationStore<F> {
    /// A store in `flash`.
    pub fn new(flash: F) -> Self {
        Self { flash }
    }

    /// The flash back.
    pub fn into_inner(self) -> F {
        self.flash
    }

    /// The calibration that was stored last; nothing where none was, or where both records are damaged.
    ///
    /// # Errors
    /// When the flash cannot be read or does not fit.
    pub fn load(&mut self) -> Result<Option<Calibration>, StoreError<F::Error>> {
        Ok(self.newest()?.map(|stored| stored.calibration))
    }

    /// Stores a calibration in the page that does not hold the last.
    ///
    /// # Errors
    /// When the flash cannot be written or does not fit.
    pub fn save(&mut self, calibration: &Calibration) -> Result<(), StoreError<F::Error>> {
        let (page, count) = self.newest()?.map_or((0, 0), |last| (1 - last.page, last.count.wrapping_add(1)));
        let from = page * F::ERASE_SIZE as u32;
        self.flash.erase(from, from + F::ERASE_SIZE as u32)?;
        self.flash.write(from, &encode(count, calibration))?;
        Ok(())
    }

    /// The newest whole record.
    fn newest(&mut self) -> Result<Option<Stored>, StoreError<F::Error>> {
        let divides = LEN.is_multiple_of(F::READ_SIZE) && LEN.is_multiple_of(F::WRITE_SIZE);
        if !divides || F::ERASE_SIZE < LEN || self.flash.capacity() < 2 * F::ERASE_SIZE {
            return Err(StoreError::Unfit);
        }
        let mut newest: Option<Stored> = None;
        for page in 0..2 {
            let mut record = [0; LEN];
            self.flash.read(page * F::ERASE_SIZE as u32, &mut record)?;
            // Counts wrap: of two in turns, the later is the one that is a little ahead.
            if let Some((count, calibration)) = decode(&record)
                && newest.is_none_or(|other| count.wrapping_sub(other.count) < u32::MAX / 2)
            {
                newest = Some(Stored { page, count, calibration });
            }
        }
        Ok(newest)
    }
}

/// A record: in which page it is, how many there were before, what it says.
#[derive(Clone, Copy)]
struct Stored {
    page: u32,
    count: u32,
    calibration: Calibration,
}

fn encode(count: u32, calibration: &Calibration) -> [u8; LEN] {
    let mut words = [u32::MAX; WORDS];
    (words[0], words[1]) = (MAGIC, count);
    for (word, number) in words[2..].iter_mut().zip(calibration.to_array()) {
        *word = number.to_bits();
    }
    let mut record = [0; LEN];
    for (bytes, word) in record.chunks_exact_mut(4).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    let checksum = crc32(&record[..LEN - 4]);
    record[LEN - 4..].copy_from_slice(&checksum.to_le_bytes());
    record
}

fn decode(record: &[u8; LEN]) -> Option<(u32, Calibration)> {
    let word = |k: usize| u32::from_le_bytes([0, 1, 2, 3].map(|b| record[4 * k + b]));
    if word(0) != MAGIC || word(WORDS - 1) != crc32(&record[..LEN - 4]) {
        return None;
    }
    let numbers = core::array::from_fn(|k| f32::from_bits(word(2 + k)));
    Some((word(1), Calibration::from_array(numbers)?))
}

/// CRC-32 as Ethernet has it, bit by bit: a table would weigh more than all else here.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| crc >> 1 ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_usual_one() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn a_record_with_any_bit_changed_is_none() {
        let calibration = Calibration {
            offset_ut: [1.0, 2.0, 3.0],
            matrix: [1.0, 1.1, 0.9, 0.0, 0.1, 0.0],
            strength_ut: 48.0,
        };
        let record = encode(7, &calibration);
        assert_eq!(decode(&record), Some((7, calibration)));
        for bit in 0..8 * LEN {
            let mut damaged = record;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(decode(&damaged), None, "bit {bit}");
        }
        assert_eq!(decode(&[0xFF; LEN]), None);
    }
}
