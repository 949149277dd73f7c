//! How much flash and RAM an image takes, from its program headers.

use std::fs;
use std::path::Path;

/// Where Cortex-M has its RAM.
const RAM: u32 = 0x2000_0000;
const PT_LOAD: u32 = 1;

/// What an image takes.
#[derive(Debug, Default, PartialEq)]
pub struct Footprint {
    /// Code, constants, and what statics begin with.
    pub flash_bytes: u64,
    /// Statics; the stack takes what it takes besides.
    pub ram_bytes: u64,
}

impl Footprint {
    /// The footprint of an ELF file.
    ///
    /// # Errors
    /// When it is none for a 32-bit little-endian machine, or is torn.
    pub fn of(path: &Path) -> Result<Self, String> {
        let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::of_bytes(&bytes).ok_or(format!("{}: no whole 32-bit ELF file", path.display()))
    }

    fn of_bytes(bytes: &[u8]) -> Option<Self> {
        if !bytes.starts_with(b"\x7FELF\x01\x01") {
            return None;
        }
        let half = |at: usize| Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
        let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
        let (from, size, n) = (word(28)? as usize, usize::from(half(42)?), usize::from(half(44)?));
        let mut footprint = Self::default();
        for header in (0..n).map(|k| from + k * size) {
            if word(header)? != PT_LOAD {
                continue;
            }
            let (address, in_file, in_memory) = (word(header + 8)?, word(header + 16)?, word(header + 20)?);
            // Whatever is in the file goes into flash, that of statics too.
            footprint.flash_bytes += u64::from(in_file);
            if address >= RAM {
                footprint.ram_bytes += u64::from(in_memory);
            }
        }
        Some(footprint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_added_up() {
        let mut bytes = vec![0; 52 + 3 * 32];
        bytes[..6].copy_from_slice(b"\x7FELF\x01\x01");
        bytes[28] = 52;
        (bytes[42], bytes[44]) = (32, 3);
        let mut segment = |k: usize, address: u32, in_file: u32, in_memory: u32| {
            for (at, word) in [(0, 1), (8, address), (16, in_file), (20, in_memory)] {
                bytes[52 + 32 * k + at..][..4].copy_from_slice(&u32::to_le_bytes(word));
            }
        };
        segment(0, 0, 1_000, 1_000);
        segment(1, RAM, 24, 24);
        segment(2, RAM + 24, 0, 500);
        assert_eq!(Footprint::of_bytes(&bytes), Some(Footprint { flash_bytes: 1_024, ram_bytes: 524 }));
        assert_eq!(Footprint::of_bytes(&bytes[..100]), None);
        assert_eq!(Footprint::of_bytes(b"\x7FELF\x02\x01"), None);
    }
}
