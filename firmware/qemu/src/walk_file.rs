//! A walk's files on the machine that emulates.

use core::ffi::CStr;

use semihosting::fs::File;
use semihosting::io::{self, Read as _, Write as _};

/// `walk-NN` with an ending, and a zero.
struct Name([u8; 17]);

impl Name {
    fn of(n: u8, ending: &[u8; 9]) -> Self {
        let mut name = *b"walk-00.readings\0";
        (name[5], name[6]) = (b'0' + n / 10 % 10, b'0' + n % 10);
        name[8..].copy_from_slice(ending);
        Self(name)
    }

    fn as_c_str(&self) -> &CStr {
        CStr::from_bytes_until_nul(&self.0).unwrap_or_default()
    }
}

/// Opens the readings of walk `n`, 1 to 99.
pub fn open(n: u8) -> io::Result<File> {
    File::open(Name::of(n, b"readings\0").as_c_str())
}

/// Reads all of `file`, as far as it fits, and says how many bytes that were.
pub fn read(mut file: File, bytes: &mut [u8]) -> io::Result<usize> {
    let mut n = 0;
    while n < bytes.len() {
        match file.read(&mut bytes[n..])? {
            0 => break,
            n_read => n += n_read,
        }
    }
    Ok(n)
}

/// Writes the frames of walk `n`.
pub fn write(n: u8, records: &[u8]) -> io::Result<()> {
    File::create(Name::of(n, b"frames\0\0\0").as_c_str())?.write_all(records)
}
