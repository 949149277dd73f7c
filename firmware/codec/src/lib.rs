//! The bytes on the air: the card frame and iBeacon advertisements.
//!
//! No allocation, no `std`, no dependency: the same code runs on the card, in the gateway and on the phone.
//! Each wire type has a *view* over bytes ([`CardFrame`], [`IbeaconFrame`]), whose getters and setters know
//! where a field lies, and a *repr* ([`CardRepr`], [`IbeaconRepr`]), a plain struct that is parsed from a view
//! and emitted into one. [`CardRound`] is what a card frame says in physical units.
//!
//! # The card frame, version 1: 31 bytes, a whole legacy advertisement
//!
//! ```text
//! offset  bytes  field
//!      0      3  flags structure           02 01 06
//!      3      2  manufacturer structure    1B FF: 27 bytes follow, type 0xFF
//!      5      2  company identifier        u16 LE, 0xFFFF
//!      7      1  status                    version 1 in the high nibble, flags in the low
//!      8      1  battery                   20 mV a step from 0 V; 0: not measured
//!      9      1  sequence                  one up every round, wraps
//!     10      2  card identifier           u16 LE
//!    --------------------------------------------------------------- 12 metadata bytes
//!     12      6  B_v, 3 samples            i16 LE, 0.04 µT, up positive; -32768: missing
//!     18      6  B_h, 3 samples            u16 LE, 0.04 µT;               65535: missing
//!     24      3  |B| of the last round     u8, 1 µT, saturates at 255;        0: missing
//!     27      3  acceleration, 3 pairs     low nibble maximum, high nibble minimum of |a|, m/s²
//!     30      1  orientation               256 steps a turn, clockwise from magnetic north
//! ```
//!
//! A round lasts one second. Its three magnetic samples, and the three acceleration pairs, belong to its first,
//! second and last third, in this order.
//!
//! Status flags: bit 0 calibrated, bit 1 just woke, bit 2 low battery, bit 3 motion missing ([`CardFlags`]).
//!
//! # The iBeacon advertisement: 30 bytes
//!
//! ```text
//! offset  bytes  field
//!      0      3  flags structure           02 01 06 (any flags are read)
//!      3      2  manufacturer structure    1A FF: 26 bytes follow, type 0xFF
//!      5      2  company identifier        4C 00, Apple
//!      7      2  beacon type and length    02 15
//!      9     16  proximity UUID            in the order printed
//!     25      2  major                     u16 BE
//!     27      2  minor                     u16 BE
//!     29      1  measured power            i8, dBm at 1 m
//! ```
//!
//! # Examples
//!
//! ## A card's round, out and back
//!
//! ```
//! use fieldwalk_codec::{CardFlags, CardFrame, CardHeader, CardRepr, CardRound, battery_from_mv};
//!
//! let header = CardHeader {
//!     flags: CardFlags { calibrated: true, ..CardFlags::default() },
//!     battery: battery_from_mv(2950),
//!     sequence: 7,
//!     card_id: 42,
//! };
//! let round = CardRound {
//!     b_v_ut: [-41.0, -40.2, -39.7],
//!     b_h_ut: [21.0, 22.5, 22.9],
//!     previous_b_ut: [46.0, 46.3, 46.1],
//!     acceleration_max_m_s2: [12.6, 13.1, 12.2],
//!     acceleration_min_m_s2: [7.8, 7.1, 8.0],
//!     orientation_rad: 1.57,
//! };
//!
//! let mut bytes = [0; CardRepr::BUFFER_LEN];
//! CardRepr::from_physical(header, &round).emit(&mut CardFrame::new_unchecked(&mut bytes));
//!
//! let received = CardRepr::parse(&CardFrame::new_checked(&bytes)?)?;
//! assert_eq!(received.header, header);
//! assert!((received.to_physical().b_v_ut[0] + 41.0).abs() <= 0.021);
//! # Ok::<(), fieldwalk_codec::Error>(())
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod advertisement;
mod card;
mod error;
mod ibeacon;
mod quantisation;
mod round;

pub use advertisement::{AdStructure, AdStructures, ad_type};
pub use card::{CARD_COMPANY_ID, CARD_VERSION, CardFlags, CardFrame, CardHeader, CardRepr};
pub use error::Error;
pub use ibeacon::{APPLE_COMPANY_ID, IbeaconFrame, IbeaconRepr};
pub use quantisation::{
    ACCELERATION_LSB_M_S2, ACCELERATION_MAX_M_S2, B_H_MISSING, B_V_MISSING, BATTERY_LSB_MV, MAGNETIC_LSB_UT,
    MAGNETIC_RANGE_UT, ORIENTATION_STEPS, PREVIOUS_B_LSB_UT, PREVIOUS_B_MISSING, battery_from_mv, battery_mv,
};
pub use round::{CardRound, SEQUENCE_REPEATED, sequence_gap};
