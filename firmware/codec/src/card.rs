//! The card frame: a view over its 31 bytes and the plain struct that they stand for.
//!
//! The byte budget is the paper's (Kwak 2018, Fig. 6); layout, scales and byte order are ours, since the paper gives none.

use crate::advertisement::{FLAGS, FLAGS_LENGTH, expect_ad_type, expect_length};
use crate::{Error, ad_type};

/// The company identifier of card frames: 0xFFFF, which the Bluetooth SIG sets aside for tests.
///
/// Whoever ships cards with a company identifier of their own changes it here.
pub const CARD_COMPANY_ID: u16 = 0xFFFF;
/// The version of the card frame that this crate reads and writes.
pub const CARD_VERSION: u8 = 1;

/// Length byte of the manufacturer structure: its type and everything after.
const MANUFACTURER_LENGTH: u8 = 0x1B;

mod field {
    use core::ops::Range;

    pub const FLAGS_LENGTH: usize = 0;
    pub const FLAGS_TYPE: usize = 1;
    pub const FLAGS: usize = 2;
    pub const MANUFACTURER_LENGTH: usize = 3;
    pub const MANUFACTURER_TYPE: usize = 4;
    pub const COMPANY_ID: usize = 5;
    pub const STATUS: usize = 7;
    pub const BATTERY: usize = 8;
    pub const SEQUENCE: usize = 9;
    pub const CARD_ID: usize = 10;
    pub const B_V: usize = 12;
    pub const B_H: usize = 18;
    pub const PREVIOUS_B: usize = 24;
    pub const ACCELERATION: usize = 27;
    pub const ORIENTATION: usize = 30;
    pub const END: usize = 31;

    /// What follows the company identifier.
    pub const MANUFACTURER_PAYLOAD: Range<usize> = STATUS..END;
}

/// A view of a card frame over bytes.
///
/// The wire layout is drawn in the [crate documentation](crate). Bytes after the 31st are ignored: some platforms
/// hand out a zero-padded buffer.
///
/// # Panics
///
/// Getters and setters panic when the buffer holds fewer than 31 bytes, which [`CardFrame::new_checked`] and
/// [`CardFrame::check_len`] rule out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CardFrame<T: AsRef<[u8]>> {
    buffer: T,
}

impl<T: AsRef<[u8]>> CardFrame<T> {
    /// A view that trusts `buffer` to be long enough.
    pub const fn new_unchecked(buffer: T) -> Self {
        Self { buffer }
    }

    /// A view over a buffer that is long enough.
    ///
    /// # Errors
    ///
    /// [`Error::Truncated`] for fewer than 31 bytes.
    pub fn new_checked(buffer: T) -> Result<Self, Error> {
        let frame = Self::new_unchecked(buffer);
        frame.check_len()?;
        Ok(frame)
    }

    /// Makes sure that no getter or setter panics.
    ///
    /// # Errors
    ///
    /// [`Error::Truncated`] for fewer than 31 bytes.
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
        self.u16_at(field::COMPANY_ID)
    }

    /// The version: the high nibble of the status.
    pub fn version(&self) -> u8 {
        self.u8_at(field::STATUS) >> 4
    }

    /// The flags: the low nibble of the status.
    pub fn flags(&self) -> CardFlags {
        CardFlags::from_bits(self.u8_at(field::STATUS))
    }

    /// The battery voltage in steps of 20 mV; 0 where not measured. See [`battery_mv`](crate::battery_mv).
    pub fn battery(&self) -> u8 {
        self.u8_at(field::BATTERY)
    }

    /// The sequence number of the round. See [`sequence_gap`](crate::sequence_gap).
    pub fn sequence(&self) -> u8 {
        self.u8_at(field::SEQUENCE)
    }

    /// The card's identifier.
    pub fn card_id(&self) -> u16 {
        self.u16_at(field::CARD_ID)
    }

    /// The vertical field of each third, in steps of 0.04 µT.
    pub fn b_v(&self) -> [i16; 3] {
        [0, 2, 4].map(|offset| self.u16_at(field::B_V + offset).cast_signed())
    }

    /// The horizontal field of each third, in steps of 0.04 µT.
    pub fn b_h(&self) -> [u16; 3] {
        [0, 2, 4].map(|offset| self.u16_at(field::B_H + offset))
    }

    /// The magnitude of the field in each third of the round before, in µT.
    pub fn previous_b(&self) -> [u8; 3] {
        [0, 1, 2].map(|offset| self.u8_at(field::PREVIOUS_B + offset))
    }

    /// The largest magnitude of the acceleration in each third, in m/s²: the low nibbles.
    pub fn acceleration_max(&self) -> [u8; 3] {
        [0, 1, 2].map(|offset| self.u8_at(field::ACCELERATION + offset) & 0x0F)
    }

    /// The smallest magnitude of the acceleration in each third, in m/s²: the high nibbles.
    pub fn acceleration_min(&self) -> [u8; 3] {
        [0, 1, 2].map(|offset| self.u8_at(field::ACCELERATION + offset) >> 4)
    }

    /// The orientation in 256 steps a turn.
    pub fn orientation(&self) -> u8 {
        self.u8_at(field::ORIENTATION)
    }

    fn u8_at(&self, offset: usize) -> u8 {
        self.buffer.as_ref()[offset]
    }

    fn u16_at(&self, offset: usize) -> u16 {
        u16::from_le_bytes([self.u8_at(offset), self.u8_at(offset + 1)])
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> CardFrame<T> {
    /// Writes what is the same in every card frame: the flags structure, the manufacturer header and the company.
    pub fn fill_preamble(&mut self) {
        self.set_u8_at(field::FLAGS_LENGTH, FLAGS_LENGTH);
        self.set_u8_at(field::FLAGS_TYPE, ad_type::FLAGS);
        self.set_u8_at(field::FLAGS, FLAGS);
        self.set_u8_at(field::MANUFACTURER_LENGTH, MANUFACTURER_LENGTH);
        self.set_u8_at(field::MANUFACTURER_TYPE, ad_type::MANUFACTURER_DATA);
        self.set_u16_at(field::COMPANY_ID, CARD_COMPANY_ID);
    }

    /// Sets the status: [`CARD_VERSION`] and the flags.
    pub fn set_status(&mut self, flags: CardFlags) {
        self.set_u8_at(field::STATUS, CARD_VERSION << 4 | flags.bits());
    }

    /// Sets the battery voltage in steps of 20 mV. See [`battery_from_mv`](crate::battery_from_mv).
    pub fn set_battery(&mut self, battery: u8) {
        self.set_u8_at(field::BATTERY, battery);
    }

    /// Sets the sequence number.
    pub fn set_sequence(&mut self, sequence: u8) {
        self.set_u8_at(field::SEQUENCE, sequence);
    }

    /// Sets the card's identifier.
    pub fn set_card_id(&mut self, card_id: u16) {
        self.set_u16_at(field::CARD_ID, card_id);
    }

    /// Sets the vertical field, in steps of 0.04 µT.
    pub fn set_b_v(&mut self, b_v: [i16; 3]) {
        for (third, value) in b_v.into_iter().enumerate() {
            self.set_u16_at(field::B_V + 2 * third, value.cast_unsigned());
        }
    }

    /// Sets the horizontal field, in steps of 0.04 µT.
    pub fn set_b_h(&mut self, b_h: [u16; 3]) {
        for (third, value) in b_h.into_iter().enumerate() {
            self.set_u16_at(field::B_H + 2 * third, value);
        }
    }

    /// Sets the magnitude of the field in the round before, in µT.
    pub fn set_previous_b(&mut self, previous_b: [u8; 3]) {
        for (third, value) in previous_b.into_iter().enumerate() {
            self.set_u8_at(field::PREVIOUS_B + third, value);
        }
    }

    /// Sets the acceleration extremes of each third, in m/s²; values above 15 saturate.
    pub fn set_acceleration(&mut self, max: [u8; 3], min: [u8; 3]) {
        for (third, (max, min)) in max.into_iter().zip(min).enumerate() {
            self.set_u8_at(field::ACCELERATION + third, max.min(0x0F) | min.min(0x0F) << 4);
        }
    }

    /// Sets the orientation in 256 steps a turn.
    pub fn set_orientation(&mut self, orientation: u8) {
        self.set_u8_at(field::ORIENTATION, orientation);
    }

    fn set_u8_at(&mut self, offset: usize, value: u8) {
        self.buffer.as_mut()[offset] = value;
    }

    fn set_u16_at(&mut self, offset: usize, value: u16) {
        self.buffer.as_mut()[offset..offset + 2].copy_from_slice(&value.to_le_bytes());
    }
}

/// What a card says of itself: the low nibble of the status byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CardFlags {
    /// Bit 0: the magnetometer's calibration holds.
    pub calibrated: bool,
    /// Bit 1: this is the first round after sleep; filters have not settled.
    pub just_woke: bool,
    /// Bit 2: the battery should be changed.
    pub low_battery: bool,
    /// Bit 3: acceleration and orientation were not measured in this round; their bytes mean nothing.
    pub motion_missing: bool,
}

impl CardFlags {
    /// The flags of the low nibble of `bits`; the high nibble is ignored.
    pub const fn from_bits(bits: u8) -> Self {
        Self {
            calibrated: bits & 0b0001 != 0,
            just_woke: bits & 0b0010 != 0,
            low_battery: bits & 0b0100 != 0,
            motion_missing: bits & 0b1000 != 0,
        }
    }

    /// The low nibble of the status byte; the high nibble is 0.
    pub const fn bits(self) -> u8 {
        self.calibrated as u8
            | (self.just_woke as u8) << 1
            | (self.low_battery as u8) << 2
            | (self.motion_missing as u8) << 3
    }
}

/// Who sends a card frame, when in its sequence, and in what state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CardHeader {
    /// The state of the card.
    pub flags: CardFlags,
    /// Battery voltage in steps of 20 mV; 0 where not measured. See [`battery_mv`](crate::battery_mv).
    pub battery: u8,
    /// Sequence number of the round, one up every round, wrapping.
    pub sequence: u8,
    /// The card's identifier.
    pub card_id: u16,
}

/// A card frame as a plain struct, in the frame's own steps.
///
/// [`CardRepr::from_physical`] and [`CardRepr::to_physical`] convert to and from physical units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CardRepr {
    /// Who sends it, when and in what state.
    pub header: CardHeader,
    /// Vertical field of each third, up positive, in steps of 0.04 µT; [`B_V_MISSING`](crate::B_V_MISSING).
    pub b_v: [i16; 3],
    /// Horizontal field of each third, in steps of 0.04 µT; [`B_H_MISSING`](crate::B_H_MISSING).
    pub b_h: [u16; 3],
    /// Field magnitude in each third of the round before, µT; [`PREVIOUS_B_MISSING`](crate::PREVIOUS_B_MISSING).
    pub previous_b: [u8; 3],
    /// Largest acceleration magnitude of each third, in m/s², 0 to 15.
    pub acceleration_max: [u8; 3],
    /// Smallest acceleration magnitude of each third, in m/s², 0 to 15.
    pub acceleration_min: [u8; 3],
    /// Orientation in 256 steps a turn, clockwise from magnetic north.
    pub orientation: u8,
}

impl CardRepr {
    /// Bytes of a card frame.
    pub const BUFFER_LEN: usize = field::END;
    /// Bytes of a card frame after the company identifier.
    pub const MANUFACTURER_PAYLOAD_LEN: usize = field::END - field::STATUS;

    /// Reads a frame.
    ///
    /// Every value of a measurement is accepted: the radio's own checksum guards them.
    ///
    /// # Errors
    ///
    /// [`Error::Truncated`], or for bytes that are not a card frame, in the order of the bytes:
    /// [`Error::WrongLength`], [`Error::WrongAdType`], [`Error::WrongFlags`], [`Error::ForeignCompany`],
    /// [`Error::UnknownVersion`].
    pub fn parse<T: AsRef<[u8]>>(frame: &CardFrame<T>) -> Result<Self, Error> {
        frame.check_len()?;
        expect_length(FLAGS_LENGTH.into(), frame.u8_at(field::FLAGS_LENGTH).into())?;
        expect_ad_type(ad_type::FLAGS, frame.u8_at(field::FLAGS_TYPE))?;
        match frame.u8_at(field::FLAGS) {
            FLAGS => {}
            other => return Err(Error::WrongFlags(other)),
        }
        expect_length(MANUFACTURER_LENGTH.into(), frame.u8_at(field::MANUFACTURER_LENGTH).into())?;
        expect_ad_type(ad_type::MANUFACTURER_DATA, frame.u8_at(field::MANUFACTURER_TYPE))?;
        match frame.company_id() {
            CARD_COMPANY_ID => {}
            other => return Err(Error::ForeignCompany(other)),
        }
        match frame.version() {
            CARD_VERSION => {}
            other => return Err(Error::UnknownVersion(other)),
        }
        Ok(Self {
            header: CardHeader {
                flags: frame.flags(),
                battery: frame.battery(),
                sequence: frame.sequence(),
                card_id: frame.card_id(),
            },
            b_v: frame.b_v(),
            b_h: frame.b_h(),
            previous_b: frame.previous_b(),
            acceleration_max: frame.acceleration_max(),
            acceleration_min: frame.acceleration_min(),
            orientation: frame.orientation(),
        })
    }

    /// Reads what a platform's scanner hands out in place of the whole advertisement: the company identifier and
    /// the bytes after it.
    ///
    /// # Errors
    ///
    /// [`Error::ForeignCompany`], [`Error::WrongLength`] for other than 24 bytes, [`Error::UnknownVersion`].
    pub fn parse_manufacturer_data(company_id: u16, payload: &[u8]) -> Result<Self, Error> {
        if company_id != CARD_COMPANY_ID {
            return Err(Error::ForeignCompany(company_id));
        }
        expect_length(Self::MANUFACTURER_PAYLOAD_LEN, payload.len())?;
        let mut frame = CardFrame::new_unchecked([0; Self::BUFFER_LEN]);
        frame.fill_preamble();
        frame.buffer[field::MANUFACTURER_PAYLOAD].copy_from_slice(payload);
        Self::parse(&frame)
    }

    /// Bytes that [`CardRepr::emit`] writes.
    pub const fn buffer_len(&self) -> usize {
        Self::BUFFER_LEN
    }

    /// Writes all 31 bytes of the frame; accelerations above 15 saturate.
    ///
    /// # Panics
    ///
    /// When the frame's buffer is shorter than [`CardRepr::buffer_len`].
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, frame: &mut CardFrame<T>) {
        frame.fill_preamble();
        frame.set_status(self.header.flags);
        frame.set_battery(self.header.battery);
        frame.set_sequence(self.header.sequence);
        frame.set_card_id(self.header.card_id);
        frame.set_b_v(self.b_v);
        frame.set_b_h(self.b_h);
        frame.set_previous_b(self.previous_b);
        frame.set_acceleration(self.acceleration_max, self.acceleration_min);
        frame.set_orientation(self.orientation);
    }
}
