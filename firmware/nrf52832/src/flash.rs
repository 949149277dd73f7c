//! The last two pages of the flash, as if there were no others.

use embassy_nrf::nvmc::{self, Nvmc, PAGE_SIZE};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// Where they begin: what memory.x leaves.
const BASE: u32 = 504 * 1_024;
const LEN: u32 = 2 * PAGE_SIZE as u32;

/// Two pages.
pub struct CalibrationPages(Nvmc<'static>);

impl CalibrationPages {
    pub fn new(flash: Nvmc<'static>) -> Self {
        Self(flash)
    }
}

/// `offset` in the whole flash; an end beyond the pages is one beyond the flash, which the flash refuses.
fn in_flash(offset: u32) -> u32 {
    if offset <= LEN { BASE + offset } else { u32::MAX - u32::MAX % PAGE_SIZE as u32 }
}

impl ErrorType for CalibrationPages {
    type Error = nvmc::Error;
}

impl ReadNorFlash for CalibrationPages {
    const READ_SIZE: usize = Nvmc::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), nvmc::Error> {
        self.0.read(in_flash(offset), bytes)
    }

    fn capacity(&self) -> usize {
        LEN as usize
    }
}

impl NorFlash for CalibrationPages {
    const WRITE_SIZE: usize = Nvmc::WRITE_SIZE;
    const ERASE_SIZE: usize = Nvmc::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), nvmc::Error> {
        self.0.erase(in_flash(from), in_flash(to))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), nvmc::Error> {
        self.0.write(in_flash(offset), bytes)
    }
}
