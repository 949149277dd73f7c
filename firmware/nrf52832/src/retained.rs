//! A word of RAM that the start-up code leaves alone.

use core::mem::MaybeUninit;
use core::ptr::{addr_of, addr_of_mut};

use fieldwalk_card::Retained;

#[unsafe(link_section = ".uninit.RETAINED")]
static mut WORD: MaybeUninit<u32> = MaybeUninit::uninit();

/// That word; there is one.
pub struct RetainedWord;

impl Retained for RetainedWord {
    fn load(&self) -> u32 {
        // SAFETY: RAM holds some word, whatever it is; the application, which alone has the part, runs on one core.
        unsafe { addr_of!(WORD).cast::<u32>().read_volatile() }
    }

    fn store(&mut self, word: u32) {
        // SAFETY: as above.
        unsafe { addr_of_mut!(WORD).cast::<u32>().write_volatile(word) }
    }
}
