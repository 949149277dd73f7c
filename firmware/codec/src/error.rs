//! Why bytes were refused.

use core::fmt;

/// Why bytes are not the advertisement that they were parsed as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error {
    /// Fewer bytes than the wire type needs.
    Truncated {
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        actual: usize,
    },
    /// An advertising structure's length runs past the end of the payload.
    Overrun {
        /// The structure's length byte.
        length: u8,
        /// Bytes left after the length byte.
        remaining: usize,
    },
    /// A length is not the one that the wire type has.
    WrongLength {
        /// The length of the wire type.
        expected: usize,
        /// The length found.
        actual: usize,
    },
    /// An advertising structure is of another type than the one in this place.
    WrongAdType {
        /// The type of the wire format.
        expected: u8,
        /// The type found.
        actual: u8,
    },
    /// The flags of a card frame are not those that a card sends.
    WrongFlags(u8),
    /// Manufacturer data of another company.
    ForeignCompany(u16),
    /// A card frame of a version that this crate does not read.
    UnknownVersion(u8),
    /// Apple's manufacturer data, but not a beacon: the type byte found.
    NotIbeacon(u8),
    /// The payload holds no manufacturer data.
    NoManufacturerData,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Truncated { needed, actual } => write!(f, "{actual} bytes where {needed} are needed"),
            Self::Overrun { length, remaining } => {
                write!(f, "a structure of {length} bytes with {remaining} bytes left")
            }
            Self::WrongLength { expected, actual } => write!(f, "length {actual} instead of {expected}"),
            Self::WrongAdType { expected, actual } => {
                write!(f, "advertising type {actual:#04x} instead of {expected:#04x}")
            }
            Self::WrongFlags(flags) => write!(f, "advertising flags {flags:#04x} are not a card's"),
            Self::ForeignCompany(company_id) => write!(f, "manufacturer data of company {company_id:#06x}"),
            Self::UnknownVersion(version) => write!(f, "card frame of unknown version {version}"),
            Self::NotIbeacon(kind) => write!(f, "manufacturer data of type {kind:#04x}, not an iBeacon"),
            Self::NoManufacturerData => f.write_str("no manufacturer data"),
        }
    }
}

impl core::error::Error for Error {}
