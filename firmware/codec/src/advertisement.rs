//! The structures that an advertising payload consists of.

use core::iter::FusedIterator;

use crate::Error;

/// Types of advertising structures, from the Bluetooth SIG's assigned numbers.
pub mod ad_type {
    /// Discoverability and the transports supported.
    pub const FLAGS: u8 = 0x01;
    /// A company identifier and bytes of that company's own.
    pub const MANUFACTURER_DATA: u8 = 0xFF;
}

/// One advertising structure: a type and its payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AdStructure<'a> {
    /// The type, one of [`ad_type`] or another of the assigned numbers.
    pub ad_type: u8,
    /// The bytes after the type.
    pub payload: &'a [u8],
}

impl<'a> AdStructure<'a> {
    /// The company identifier and the bytes after it, where this is manufacturer data that holds one.
    pub fn manufacturer_data(&self) -> Option<(u16, &'a [u8])> {
        match (self.ad_type, self.payload) {
            (ad_type::MANUFACTURER_DATA, [low, high, rest @ ..]) => {
                Some((u16::from_le_bytes([*low, *high]), rest))
            }
            _ => None,
        }
    }
}

/// Walks the structures of an advertising payload.
///
/// A zero length ends the payload: what follows is padding, as the Core Specification says (Vol 3, Part C, 11).
/// A length that runs past the end gives one [`Error::Overrun`] and ends the walk. Whatever the bytes, a walk
/// gives at most one item for every two bytes, rounded up.
#[derive(Clone, Debug)]
pub struct AdStructures<'a> {
    remaining: &'a [u8],
}

impl<'a> AdStructures<'a> {
    /// Walks `payload` from its start.
    pub const fn new(payload: &'a [u8]) -> Self {
        Self { remaining: payload }
    }
}

impl<'a> Iterator for AdStructures<'a> {
    type Item = Result<AdStructure<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let (&length, rest) = core::mem::take(&mut self.remaining).split_first()?;
        if length == 0 {
            return None;
        }
        let Some((structure, after)) = rest.split_at_checked(usize::from(length)) else {
            return Some(Err(Error::Overrun { length, remaining: rest.len() }));
        };
        self.remaining = after;
        structure.split_first().map(|(&ad_type, payload)| Ok(AdStructure { ad_type, payload }))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (0, Some(self.remaining.len().div_ceil(2)))
    }
}

impl FusedIterator for AdStructures<'_> {}

/// Length byte of the flags structure.
pub(crate) const FLAGS_LENGTH: u8 = 0x02;
/// The flags that this crate writes: LE general discoverable, no BR/EDR.
pub(crate) const FLAGS: u8 = 0x06;

pub(crate) fn expect_length(expected: usize, actual: usize) -> Result<(), Error> {
    if actual == expected { Ok(()) } else { Err(Error::WrongLength { expected, actual }) }
}

pub(crate) fn expect_ad_type(expected: u8, actual: u8) -> Result<(), Error> {
    if actual == expected { Ok(()) } else { Err(Error::WrongAdType { expected, actual }) }
}
