//! What is read of ELF files: what a phone's loader asks of a shared library, and what an image takes of a chip's memory.

/// The parts of an ELF file that decide whether a phone loads it.
#[derive(Debug, Default, PartialEq)]
pub struct SharedLibrary {
    /// The smallest alignment of a segment that is loaded.
    pub load_align: u64,
    pub soname: Option<String>,
    pub needed: Vec<String>,
    /// Whether code would have to be changed while it is loaded, which Android refuses.
    pub has_text_relocations: bool,
    /// Symbols that others can call.
    pub exports: Vec<String>,
    /// Symbols that the libraries needed must have.
    pub imports: Vec<String>,
}

const PT_LOAD: u64 = 1;
const PT_DYNAMIC: u64 = 2;
const SHT_DYNSYM: u64 = 11;
const DT_NEEDED: u64 = 1;
const DT_SONAME: u64 = 14;
const DT_TEXTREL: u64 = 22;
const DT_FLAGS: u64 = 30;
const DF_TEXTREL: u64 = 4;

impl SharedLibrary {
    /// Reads a little-endian ELF file of either width.
    ///
    /// # Errors
    /// When the bytes are no such file, or not all of one.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        Elf::open(bytes)?.library().ok_or_else(|| "the file ends before what it promises".to_owned())
    }
}

/// Where Cortex-M has its RAM.
const RAM: u64 = 0x2000_0000;

/// What a chip's image takes.
#[derive(Debug, Default, PartialEq)]
pub struct Footprint {
    /// Code, constants, and what statics begin with.
    pub flash_bytes: u64,
    /// Statics; the stack takes what it takes besides.
    pub ram_bytes: u64,
}

impl Footprint {
    /// The footprint of a little-endian ELF file of either width.
    ///
    /// # Errors
    /// When the bytes are no such file, or not all of one.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let segments = Elf::open(bytes)?.segments().ok_or("the file ends before what it promises")?;
        let mut footprint = Self::default();
        for segment in segments.iter().filter(|segment| segment.kind == PT_LOAD) {
            // Whatever is in the file goes into flash, that of statics too.
            footprint.flash_bytes += segment.size;
            if segment.address >= RAM {
                footprint.ram_bytes += segment.size_in_memory;
            }
        }
        Ok(footprint)
    }
}

struct Elf<'a> {
    bytes: &'a [u8],
    is_64: bool,
}

/// A range of the file.
#[derive(Clone, Copy)]
struct Part {
    kind: u64,
    offset: u64,
    size: u64,
    /// A segment's address and size in memory; nothing of a section.
    address: u64,
    size_in_memory: u64,
    /// A segment's alignment, a section's link.
    extra: u64,
}

impl<'a> Elf<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, String> {
        let is_64 = match bytes.get(..6) {
            Some([0x7f, b'E', b'L', b'F', 1, 1]) => false,
            Some([0x7f, b'E', b'L', b'F', 2, 1]) => true,
            _ => return Err("not a little-endian ELF file".into()),
        };
        Ok(Self { bytes, is_64 })
    }

    fn library(&self) -> Option<SharedLibrary> {
        let mut library = SharedLibrary { load_align: u64::MAX, ..SharedLibrary::default() };
        let sections = self.sections()?;
        let segments = self.segments()?;
        for segment in segments.iter().filter(|segment| segment.kind == PT_LOAD) {
            library.load_align = library.load_align.min(segment.extra);
        }
        let symbols = sections.iter().find(|section| section.kind == SHT_DYNSYM)?;
        let names = sections.get(usize::try_from(symbols.extra).ok()?)?;
        let dynamic = segments.iter().find(|segment| segment.kind == PT_DYNAMIC)?;
        for (tag, value) in self.dynamic(dynamic)? {
            match tag {
                DT_NEEDED => library.needed.push(self.name(names, value)?),
                DT_SONAME => library.soname = Some(self.name(names, value)?),
                DT_TEXTREL => library.has_text_relocations = true,
                DT_FLAGS if value & DF_TEXTREL != 0 => library.has_text_relocations = true,
                _ => {}
            }
        }
        let (entry, section_at) = if self.is_64 { (24, 6) } else { (16, 14) };
        // The first symbol is none.
        for at in (symbols.offset..symbols.offset.checked_add(symbols.size)?).step_by(entry).skip(1) {
            let name = self.name(names, self.number(at, 4)?)?;
            let is_import = self.number(at + section_at, 2)? == 0;
            if is_import { library.imports.push(name) } else { library.exports.push(name) }
        }
        library.exports.sort();
        library.imports.sort();
        Some(library)
    }

    fn segments(&self) -> Option<Vec<Part>> {
        let (table, size, count) =
            if self.is_64 { ((32, 8), (54, 2), (56, 2)) } else { ((28, 4), (42, 2), (44, 2)) };
        self.table(table, size, count, |at| {
            Some(if self.is_64 {
                Part {
                    kind: self.number(at, 4)?,
                    offset: self.number(at + 8, 8)?,
                    size: self.number(at + 32, 8)?,
                    address: self.number(at + 16, 8)?,
                    size_in_memory: self.number(at + 40, 8)?,
                    extra: self.number(at + 48, 8)?,
                }
            } else {
                Part {
                    kind: self.number(at, 4)?,
                    offset: self.number(at + 4, 4)?,
                    size: self.number(at + 16, 4)?,
                    address: self.number(at + 8, 4)?,
                    size_in_memory: self.number(at + 20, 4)?,
                    extra: self.number(at + 28, 4)?,
                }
            })
        })
    }

    fn sections(&self) -> Option<Vec<Part>> {
        let (table, size, count) =
            if self.is_64 { ((40, 8), (58, 2), (60, 2)) } else { ((32, 4), (46, 2), (48, 2)) };
        self.table(table, size, count, |at| {
            let (offset, size, link) = if self.is_64 { (24, 32, 40) } else { (16, 20, 24) };
            Some(Part {
                kind: self.number(at + 4, 4)?,
                offset: self.number(at + offset, self.word())?,
                size: self.number(at + size, self.word())?,
                address: 0,
                size_in_memory: 0,
                extra: self.number(at + link, 4)?,
            })
        })
    }

    /// The entries of a table whose place, size of an entry and count stand in the file's header.
    fn table(
        &self,
        place: (u64, u64),
        size: (u64, u64),
        count: (u64, u64),
        read: impl Fn(u64) -> Option<Part>,
    ) -> Option<Vec<Part>> {
        let [start, size, count] = [place, size, count].map(|(at, width)| self.number(at, width));
        let (start, size) = (start?, size?);
        (0..count?).map(|k| read(start.checked_add(k * size)?)).collect()
    }

    fn dynamic(&self, part: &Part) -> Option<Vec<(u64, u64)>> {
        let word = self.word();
        let end = part.offset.checked_add(part.size)?;
        let mut entries = Vec::new();
        for at in (part.offset..end).step_by(2 * word as usize) {
            match self.number(at, word)? {
                0 => break,
                tag => entries.push((tag, self.number(at + word, word)?)),
            }
        }
        Some(entries)
    }

    /// The text at `at` of the table `names`.
    fn name(&self, names: &Part, at: u64) -> Option<String> {
        let start = usize::try_from(names.offset.checked_add(at)?).ok()?;
        let text = self.bytes.get(start..)?.split(|&byte| byte == 0).next()?;
        Some(String::from_utf8_lossy(text).into_owned())
    }

    fn word(&self) -> u64 {
        if self.is_64 { 8 } else { 4 }
    }

    fn number(&self, at: u64, width: u64) -> Option<u64> {
        let at = usize::try_from(at).ok()?;
        let bytes = self.bytes.get(at..at.checked_add(width as usize)?)?;
        Some(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(bytes: &mut [u8], at: usize, width: usize, value: u64) {
        bytes[at..at + width].copy_from_slice(&value.to_le_bytes()[..width]);
    }

    /// A file of 64-bit words with one loaded segment, a dynamic segment, and a symbol each way.
    fn small_library() -> Vec<u8> {
        let mut bytes = vec![0; 0x400];
        bytes[..6].copy_from_slice(&[0x7f, b'E', b'L', b'F', 2, 1]);
        for (at, width, value) in [
            (32, 8, 0x40),  // segments
            (40, 8, 0x100), // sections
            (54, 2, 56),
            (56, 2, 2),
            (58, 2, 64),
            (60, 2, 3),
            (0x40, 4, PT_LOAD),
            (0x40 + 48, 8, 0x4000),
            (0x78, 4, PT_DYNAMIC),
            (0x78 + 8, 8, 0x300),
            (0x78 + 32, 8, 64),
            (0x140 + 4, 4, SHT_DYNSYM),
            (0x140 + 24, 8, 0x200),
            (0x140 + 32, 8, 72),
            (0x140 + 40, 4, 2),
            (0x180 + 4, 4, 3),
            (0x180 + 24, 8, 0x280),
            (0x180 + 32, 8, 0x40),
            (0x200 + 24, 4, 1),
            (0x200 + 48, 4, 8),
            (0x200 + 48 + 6, 2, 7),
            (0x300, 8, DT_NEEDED),
            (0x308, 8, 15),
            (0x310, 8, DT_SONAME),
            (0x318, 8, 23),
            (0x320, 8, DT_FLAGS),
            (0x328, 8, DF_TEXTREL),
        ] {
            put(&mut bytes, at, width, value);
        }
        bytes[0x280..0x280 + 30].copy_from_slice(b"\0malloc\0locate\0libc.so\0libx.so");
        bytes
    }

    #[test]
    fn a_library_is_read() {
        let library = SharedLibrary::read(&small_library()).unwrap();
        let expected = SharedLibrary {
            load_align: 0x4000,
            soname: Some("libx.so".into()),
            needed: vec!["libc.so".into()],
            has_text_relocations: true,
            exports: vec!["locate".into()],
            imports: vec!["malloc".into()],
        };
        assert_eq!(library, expected);
    }

    #[test]
    fn what_is_cut_or_no_library_is_refused() {
        let whole = small_library();
        assert!((0..0x330).step_by(3).all(|end| SharedLibrary::read(&whole[..end]).is_err()));
        assert!(SharedLibrary::read(b"MZ").is_err());
    }

    #[test]
    #[cfg(all(target_os = "linux", target_endian = "little"))]
    fn this_very_program_needs_libc() {
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let library = SharedLibrary::read(&own).unwrap();
        assert!(library.needed.iter().any(|name| name.starts_with("libc.so")), "{library:?}");
        assert!(!library.has_text_relocations);
    }

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
        segment(1, 0x2000_0000, 24, 24);
        segment(2, 0x2000_0018, 0, 500);
        assert_eq!(Footprint::read(&bytes), Ok(Footprint { flash_bytes: 1_024, ram_bytes: 524 }));
        assert!(Footprint::read(&bytes[..100]).is_err());
        assert!(Footprint::read(b"MZ").is_err());
    }
}
