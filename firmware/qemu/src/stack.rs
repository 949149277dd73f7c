//! How deep the stack was: it is painted at the start, and what has lost its paint at the end was used.

use core::ptr::addr_of;

const PAINT: u32 = 0x5AFE_57AC;
/// What is not painted below the stack pointer, in bytes: the painter's own frame.
const MARGIN: usize = 512;

unsafe extern "C" {
    static _stack_start: u32;
    static __sheap: u32;
}

fn bounds() -> (usize, usize) {
    // Only the addresses of the linker's symbols mean something.
    (addr_of!(__sheap) as usize, addr_of!(_stack_start) as usize)
}

/// Paints all RAM between the statics and the stack.
pub fn paint() {
    let (bottom, _) = bounds();
    let top = cortex_m::register::msp::read() as usize - MARGIN;
    for address in (bottom..top).step_by(4) {
        // SAFETY: nothing owns the words between the last static and the stack; both ends are aligned by the linker's script.
        unsafe { core::ptr::write_volatile(address as *mut u32, PAINT) };
    }
}

/// Bytes between the stack's beginning and the deepest word without paint.
pub fn high_water() -> usize {
    let (bottom, top) = bounds();
    // SAFETY: as above; the words are RAM, whatever they hold.
    let is_painted = |address: &usize| unsafe { core::ptr::read_volatile(*address as *const u32) == PAINT };
    (bottom..top).step_by(4).find(|address| !is_painted(address)).map_or(0, |deepest| top - deepest)
}
