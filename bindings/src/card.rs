//! Advertisements of cards and iBeacons.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use fieldwalk_codec::{self as codec, CardFrame, CardRepr, IbeaconRepr, SEQUENCE_REPEATED};

use crate::error::{ApiError, locked};

/// One round, a second, of a card's measurements.
///
/// Lists have three values, of the round's first, second and last third; one that the card did not measure is absent.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct CardRound {
    /// The card's identifier.
    pub card_id: u16,
    /// The round's number, one up every round, 0 after 255.
    pub sequence: u8,
    /// Rounds of this card lost since the last one that was decoded; absent for the first.
    pub n_lost: Option<u8>,
    /// Whether this is the last round of this card again, as when several receivers hear one advertisement.
    pub is_repeated: bool,
    /// Whether the calibration of the card's magnetometer holds.
    pub is_calibrated: bool,
    /// Whether this is the first round after sleep, in which filters have not settled.
    pub just_woke: bool,
    /// Whether the battery should be changed.
    pub is_battery_low: bool,
    /// Battery voltage in mV.
    pub battery_mv: Option<u16>,
    /// Vertical part of the field, up positive, in µT.
    pub vertical_field_ut: Vec<Option<f32>>,
    /// Magnitude of the horizontal part of the field, in µT.
    pub horizontal_field_ut: Vec<Option<f32>>,
    /// Strength of the field in the round before, in µT; 255 is "255 or more".
    pub previous_strength_ut: Vec<Option<f32>>,
    /// Largest magnitude of the specific force, in m/s²; 15 is "15 or more".
    pub acceleration_max_m_s2: Vec<Option<f32>>,
    /// Smallest magnitude of the specific force, in m/s²; 15 is "15 or more".
    pub acceleration_min_m_s2: Vec<Option<f32>>,
    /// Mean orientation, clockwise from magnetic north, in radians from 0 to 2π.
    pub orientation_rad: Option<f32>,
}

/// An iBeacon as it names itself.
#[derive(Clone, Debug, PartialEq, Eq, uniffi::Record)]
pub struct Ibeacon {
    /// The proximity UUID: 16 bytes, in the order printed.
    pub uuid: Vec<u8>,
    /// The major number.
    pub major: u16,
    /// The minor number.
    pub minor: u16,
    /// The signal strength at 1 m that the beacon's owner measured, in dBm.
    pub measured_power_dbm: i8,
}

/// Reads cards' advertisements, and tells per card how many rounds were missed.
#[derive(Debug, uniffi::Object)]
pub struct CardDecoder {
    /// Per card, the sequence number of its last round: 65,536 cards at most.
    last: Mutex<BTreeMap<u16, u8>>,
}

#[uniffi::export]
impl CardDecoder {
    /// A decoder that has heard no card.
    #[uniffi::constructor]
    pub fn new() -> Arc<Self> {
        Arc::new(Self { last: Mutex::new(BTreeMap::new()) })
    }

    /// The round in a whole advertisement of 31 bytes; bytes after them are ignored, since some platforms pad.
    ///
    /// # Errors
    /// When it is of another sender, torn, or of a card too new. Nothing has changed then.
    pub fn decode_advertisement(&self, advertisement: &[u8]) -> Result<CardRound, ApiError> {
        let repr = CardFrame::new_checked(advertisement).and_then(|frame| CardRepr::parse(&frame));
        self.round(repr)
    }

    /// The round in what scanners give in place of the whole advertisement: the company's identifier, and the bytes
    /// after it.
    ///
    /// # Errors
    /// As `decode_advertisement`.
    pub fn decode_manufacturer_data(&self, company_id: u16, payload: &[u8]) -> Result<CardRound, ApiError> {
        self.round(CardRepr::parse_manufacturer_data(company_id, payload))
    }
}

/// The first iBeacon in a whole advertisement.
///
/// # Errors
/// When there is none in it, or when it is torn.
#[uniffi::export]
pub fn decode_ibeacon(advertisement: &[u8]) -> Result<Ibeacon, ApiError> {
    IbeaconRepr::parse_advertisement(advertisement).map(Ibeacon::from).map_err(ApiError::of_advertisement)
}

/// The iBeacon in what scanners give in place of the whole advertisement: the company's identifier, and the bytes after
/// it.
///
/// # Errors
/// When it is none.
#[uniffi::export]
pub fn decode_ibeacon_manufacturer_data(company_id: u16, payload: &[u8]) -> Result<Ibeacon, ApiError> {
    let repr = IbeaconRepr::parse_manufacturer_data(company_id, payload);
    repr.map(Ibeacon::from).map_err(ApiError::of_advertisement)
}

impl CardDecoder {
    fn round(&self, repr: Result<CardRepr, codec::Error>) -> Result<CardRound, ApiError> {
        let repr = repr.map_err(ApiError::of_advertisement)?;
        let codec::CardHeader { flags, battery, sequence, card_id } = repr.header;
        // Acceleration and orientation come absent from the physical round where motion is missing.
        let codec::CardFlags { calibrated, just_woke, low_battery, motion_missing: _ } = flags;
        let codec::CardRound {
            b_v_ut,
            b_h_ut,
            previous_b_ut,
            acceleration_max_m_s2,
            acceleration_min_m_s2,
            orientation_rad,
        } = repr.to_physical();
        let last = locked(&self.last)?.insert(card_id, sequence);
        let gap = last.map(|last| codec::sequence_gap(last, sequence));
        let is_repeated = gap == Some(SEQUENCE_REPEATED);
        Ok(CardRound {
            card_id,
            sequence,
            n_lost: if is_repeated { Some(0) } else { gap },
            is_repeated,
            is_calibrated: calibrated,
            just_woke,
            is_battery_low: low_battery,
            battery_mv: codec::battery_mv(battery),
            vertical_field_ut: thirds(b_v_ut),
            horizontal_field_ut: thirds(b_h_ut),
            previous_strength_ut: thirds(previous_b_ut),
            acceleration_max_m_s2: thirds(acceleration_max_m_s2),
            acceleration_min_m_s2: thirds(acceleration_min_m_s2),
            orientation_rad: measured(orientation_rad),
        })
    }
}

fn measured(value: f32) -> Option<f32> {
    (!value.is_nan()).then_some(value)
}

fn thirds(values: [f32; 3]) -> Vec<Option<f32>> {
    values.map(measured).to_vec()
}

impl From<IbeaconRepr> for Ibeacon {
    fn from(repr: IbeaconRepr) -> Self {
        let IbeaconRepr { uuid, major, minor, measured_power_dbm } = repr;
        Self { uuid: uuid.to_vec(), major, minor, measured_power_dbm }
    }
}
