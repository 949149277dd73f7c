//! The iBeacon advertisement: a view over its 30 bytes and the plain struct that they stand for.

use crate::advertisement::{FLAGS, FLAGS_LENGTH, expect_ad_type, expect_length};
use crate::{AdStructures, Error, ad_type};

/// Apple's company identifier.
pub const APPLE_COMPANY_ID: u16 = 0x004C;

/// Length byte of the manufacturer structure: its type and everything after.
const MANUFACTURER_LENGTH: u8 = 0x1A;
/// Apple's type for a proximity beacon.
const BEACON_TYPE: u8 = 0x02;
/// Bytes after the beacon's length byte.
const BEACON_LENGTH: u8 = 0x15;

mod field {
    use core::ops::Range;

    pub const FLAGS: Range<usize> = 0..3;
    pub const MANUFACTURER_HEADER: Range<usize> = 3..5;
    pub const COMPANY_ID: Range<usize> = 5..7;
    pub const BEACON_TYPE: usize = 7;
    pub const BEACON_LENGTH: usize = 8;
    pub const UUID: Range<usize> = 9..25;
    pub const MAJOR: Range<usize> = 25..27;
    pub const MINOR: Range<usize> = 27..29;
    pub const MEASURED_POWER: usize = 29;
    pub const END: usize = 30;
}

/// A view of an iBeacon advertisement over bytes, its flags structure first.
///
/// The wire layout is drawn in the [crate documentation](crate). Bytes after the 30th are ignored.
/// [`IbeaconRepr::parse_advertisement`] reads advertisements in which other structures come first.
///
/// # Panics
///
/// Getters and setters panic when the buffer holds fewer than 30 bytes, which [`IbeaconFrame::new_checked`] and
/// [`IbeaconFrame::check_len`] rule out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IbeaconFrame<T: AsRef<[u8]>> {
    buffer: T,
}

impl<T: AsRef<[u8]>> IbeaconFrame<T> {
    /// A view that trusts `buffer` to be long enough.
    pub const fn new_unchecked(buffer: T) -> Self {
        Self { buffer }
    }

    /// A view over a buffer that is long enough.
    ///
    /// # Errors
    ///
    /// [`Error::Truncated`] for fewer than 30 bytes.
    pub fn new_checked(buffer: T) -> Result<Self, Error> {
        let frame = Self::new_unchecked(buffer);
        frame.check_len()?;
        Ok(frame)
    }

    /// Makes sure that no getter or setter panics.
    ///
    /// # Errors
    ///
    /// [`Error::Truncated`] for fewer than 30 bytes.
    pub fn check_len(&self) -> Result<(), Error> {
        let actual = self.buffer.as_ref().len();
        if actual < field::END { Err(Error::Truncated { needed: field::END, actual }) } else { Ok(()) }
    }

    /// The buffer back.
    pub fn into_inner(self) -> T {
        self.buffer
    }

    /// The company identifier.
    pub fn company_id(&self) -> u16 {
        u16::from_le_bytes(self.array(field::COMPANY_ID.start))
    }

    /// The proximity UUID, in the order printed.
    pub fn uuid(&self) -> [u8; 16] {
        self.array(field::UUID.start)
    }

    /// The major number.
    pub fn major(&self) -> u16 {
        u16::from_be_bytes(self.array(field::MAJOR.start))
    }

    /// The minor number.
    pub fn minor(&self) -> u16 {
        u16::from_be_bytes(self.array(field::MINOR.start))
    }

    /// The signal strength at 1 m that the beacon's owner measured, in dBm.
    pub fn measured_power_dbm(&self) -> i8 {
        self.buffer.as_ref()[field::MEASURED_POWER].cast_signed()
    }

    fn array<const N: usize>(&self, start: usize) -> [u8; N] {
        let bytes = self.buffer.as_ref();
        core::array::from_fn(|offset| bytes[start + offset])
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> IbeaconFrame<T> {
    /// Writes what is the same in every iBeacon: flags, manufacturer header, company, beacon type and length.
    pub fn fill_preamble(&mut self) {
        self.set(field::FLAGS, &[FLAGS_LENGTH, ad_type::FLAGS, FLAGS]);
        self.set(field::MANUFACTURER_HEADER, &[MANUFACTURER_LENGTH, ad_type::MANUFACTURER_DATA]);
        self.set(field::COMPANY_ID, &APPLE_COMPANY_ID.to_le_bytes());
        self.buffer.as_mut()[field::BEACON_TYPE] = BEACON_TYPE;
        self.buffer.as_mut()[field::BEACON_LENGTH] = BEACON_LENGTH;
    }

    /// Sets the proximity UUID.
    pub fn set_uuid(&mut self, uuid: [u8; 16]) {
        self.set(field::UUID, &uuid);
    }

    /// Sets the major number.
    pub fn set_major(&mut self, major: u16) {
        self.set(field::MAJOR, &major.to_be_bytes());
    }

    /// Sets the minor number.
    pub fn set_minor(&mut self, minor: u16) {
        self.set(field::MINOR, &minor.to_be_bytes());
    }

    /// Sets the signal strength at 1 m, in dBm.
    pub fn set_measured_power_dbm(&mut self, measured_power_dbm: i8) {
        self.buffer.as_mut()[field::MEASURED_POWER] = measured_power_dbm.cast_unsigned();
    }

    fn set(&mut self, range: core::ops::Range<usize>, bytes: &[u8]) {
        self.buffer.as_mut()[range].copy_from_slice(bytes);
    }
}

/// An iBeacon as a plain struct.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct IbeaconRepr {
    /// The proximity UUID, in the order printed.
    pub uuid: [u8; 16],
    /// The major number.
    pub major: u16,
    /// The minor number.
    pub minor: u16,
    /// The signal strength at 1 m that the beacon's owner measured, in dBm.
    pub measured_power_dbm: i8,
}

impl IbeaconRepr {
    /// Bytes of an iBeacon advertisement.
    pub const BUFFER_LEN: usize = field::END;
    /// Bytes of an iBeacon after the company identifier.
    pub const MANUFACTURER_PAYLOAD_LEN: usize = field::END - field::BEACON_TYPE;

    /// Reads an advertisement that begins with flags, of whatever value, and an iBeacon.
    ///
    /// # Errors
    ///
    /// [`Error::Truncated`], or for bytes that are not an iBeacon, in the order of the bytes:
    /// [`Error::WrongLength`], [`Error::WrongAdType`], [`Error::ForeignCompany`], [`Error::NotIbeacon`].
    pub fn parse<T: AsRef<[u8]>>(frame: &IbeaconFrame<T>) -> Result<Self, Error> {
        frame.check_len()?;
        let [flags_length, flags_type] = frame.array(field::FLAGS.start);
        expect_length(FLAGS_LENGTH.into(), flags_length.into())?;
        expect_ad_type(ad_type::FLAGS, flags_type)?;
        let [length, kind] = frame.array(field::MANUFACTURER_HEADER.start);
        expect_length(MANUFACTURER_LENGTH.into(), length.into())?;
        expect_ad_type(ad_type::MANUFACTURER_DATA, kind)?;
        match frame.company_id() {
            APPLE_COMPANY_ID => {}
            other => return Err(Error::ForeignCompany(other)),
        }
        let [beacon_type, beacon_length] = frame.array(field::BEACON_TYPE);
        if beacon_type != BEACON_TYPE {
            return Err(Error::NotIbeacon(beacon_type));
        }
        expect_length(BEACON_LENGTH.into(), beacon_length.into())?;
        Ok(Self {
            uuid: frame.uuid(),
            major: frame.major(),
            minor: frame.minor(),
            measured_power_dbm: frame.measured_power_dbm(),
        })
    }

    /// Reads what a platform's scanner hands out in place of the whole advertisement: the company identifier and
    /// the bytes after it.
    ///
    /// # Errors
    ///
    /// [`Error::ForeignCompany`], [`Error::NotIbeacon`] for another of Apple's types, [`Error::Truncated`] for no
    /// bytes at all, [`Error::WrongLength`] for other than 23.
    pub fn parse_manufacturer_data(company_id: u16, payload: &[u8]) -> Result<Self, Error> {
        if company_id != APPLE_COMPANY_ID {
            return Err(Error::ForeignCompany(company_id));
        }
        match payload.first() {
            Some(&BEACON_TYPE) => {}
            Some(&other) => return Err(Error::NotIbeacon(other)),
            None => return Err(Error::Truncated { needed: Self::MANUFACTURER_PAYLOAD_LEN, actual: 0 }),
        }
        expect_length(Self::MANUFACTURER_PAYLOAD_LEN, payload.len())?;
        let mut frame = IbeaconFrame::new_unchecked([0; Self::BUFFER_LEN]);
        frame.fill_preamble();
        frame.buffer[field::BEACON_TYPE..].copy_from_slice(payload);
        Self::parse(&frame)
    }

    /// Finds the first iBeacon among the structures of an advertising payload.
    ///
    /// # Errors
    ///
    /// [`Error::Overrun`] when the payload is malformed before an iBeacon was found. Otherwise why its first
    /// manufacturer structure was refused, as [`IbeaconRepr::parse_manufacturer_data`] says, or
    /// [`Error::NoManufacturerData`] for a payload without one.
    pub fn parse_advertisement(payload: &[u8]) -> Result<Self, Error> {
        let mut refusal = None;
        for structure in AdStructures::new(payload) {
            let Some((company_id, rest)) = structure?.manufacturer_data() else { continue };
            match Self::parse_manufacturer_data(company_id, rest) {
                Ok(repr) => return Ok(repr),
                Err(error) => refusal = refusal.or(Some(error)),
            }
        }
        Err(refusal.unwrap_or(Error::NoManufacturerData))
    }

    /// Bytes that [`IbeaconRepr::emit`] writes.
    pub const fn buffer_len(&self) -> usize {
        Self::BUFFER_LEN
    }

    /// Writes all 30 bytes of the advertisement.
    ///
    /// # Panics
    ///
    /// When the frame's buffer is shorter than [`IbeaconRepr::buffer_len`].
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, frame: &mut IbeaconFrame<T>) {
        frame.fill_preamble();
        frame.set_uuid(self.uuid);
        frame.set_major(self.major);
        frame.set_minor(self.minor);
        frame.set_measured_power_dbm(self.measured_power_dbm);
    }
}
