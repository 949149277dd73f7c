//! The card frame: bytes worked by hand, hostile bytes, and properties of the quantisation.

use fieldwalk_codec::{
    B_H_MISSING, B_V_MISSING, CARD_COMPANY_ID, CardFlags, CardFrame, CardHeader, CardRepr, CardRound, Error,
    MAGNETIC_LSB_UT, SEQUENCE_REPEATED, battery_from_mv, battery_mv, sequence_gap,
};
use proptest::prelude::*;

/// Every byte by hand from [`golden_header`] and [`golden_round`].
const GOLDEN: [u8; 31] = [
    0x02, 0x01, 0x06, // flags: 2 bytes, type 1, general discoverable without BR/EDR
    0x1B, 0xFF, // 27 bytes of manufacturer data
    0xFF, 0xFF, // company
    0x15, // version 1; calibrated (1) and low battery (4)
    0x7D, // 2500 mV / 20 = 125
    0xFE, // sequence 254
    0x34, 0x12, // card 0x1234
    0x18, 0xFC, // -40.00 µT = -1000 steps = 0xFC18
    0x01, 0x00, // 0.04 µT = 1 step
    0x30, 0x75, // 1200 µT = 30000 steps = 0x7530
    0xF4, 0x01, // 20.00 µT = 500 steps = 0x01F4
    0x00, 0x00, // 0
    0xFF, 0xFF, // missing
    0x2D, // 45.4 µT -> 45
    0xFF, // 300 µT saturates
    0x00, // missing
    0x7D, // max 12.6 -> 13 = D, min 7.4 -> 7
    0x9A, // max 10.0 = A, min 9.0 = 9
    0x0F, // max 31 saturates = F, min 0.2 -> 0
    0x40, // a quarter turn = 64
];

fn golden_header() -> CardHeader {
    CardHeader {
        flags: CardFlags { calibrated: true, low_battery: true, ..CardFlags::default() },
        battery: battery_from_mv(2500),
        sequence: 254,
        card_id: 0x1234,
    }
}

fn golden_round() -> CardRound {
    CardRound {
        b_v_ut: [-40.0, 0.04, 1200.0],
        b_h_ut: [20.0, 0.0, f32::NAN],
        previous_b_ut: [45.4, 300.0, f32::NAN],
        acceleration_max_m_s2: [12.6, 10.0, 31.0],
        acceleration_min_m_s2: [7.4, 9.0, 0.2],
        orientation_rad: core::f32::consts::FRAC_PI_2,
    }
}

fn emitted(repr: &CardRepr) -> [u8; 31] {
    // Not zeros, so that a byte left out shows.
    let mut bytes = [0xA5; 31];
    repr.emit(&mut CardFrame::new_unchecked(&mut bytes));
    bytes
}

fn parsed(bytes: &[u8]) -> Result<CardRepr, Error> {
    CardRepr::parse(&CardFrame::new_checked(bytes)?)
}

#[test]
fn metadata_and_measurements_fill_31_bytes() {
    let metadata = 3 + 2 + 2 + 1 + 1 + 1 + 2;
    let measurements = 3 * 2 + 3 * 2 + 3 + 6 / 2 + 1;
    assert_eq!((metadata, metadata + measurements), (12, CardRepr::BUFFER_LEN));
    assert_eq!(CardRepr::BUFFER_LEN, 31);
    assert_eq!(CardRepr::default().buffer_len(), 31);
    assert_eq!(CardRepr::MANUFACTURER_PAYLOAD_LEN, 24);
}

#[test]
fn golden_frame_is_emitted() {
    assert_eq!(emitted(&CardRepr::from_physical(golden_header(), &golden_round())), GOLDEN);
}

#[test]
fn golden_frame_is_read_field_by_field() {
    let repr = parsed(&GOLDEN).unwrap();
    assert_eq!(repr.header, golden_header());
    assert_eq!(battery_mv(repr.header.battery), Some(2500));
    assert_eq!(repr.b_v, [-1000, 1, 30_000]);
    assert_eq!(repr.b_h, [500, 0, B_H_MISSING]);
    assert_eq!(repr.previous_b, [45, 255, 0]);
    assert_eq!(repr.acceleration_max, [13, 10, 15]);
    assert_eq!(repr.acceleration_min, [7, 9, 0]);
    assert_eq!(repr.orientation, 64);
    assert_eq!(CardFrame::new_unchecked(&GOLDEN).company_id(), CARD_COMPANY_ID);

    let round = repr.to_physical();
    assert_eq!(round.b_v_ut, [-40.0, 0.04, 1200.0]);
    assert_eq!(round.b_h_ut[..2], [20.0, 0.0]);
    assert!(round.b_h_ut[2].is_nan() && round.previous_b_ut[2].is_nan());
    assert_eq!(round.orientation_rad, core::f32::consts::FRAC_PI_2);
}

#[test]
fn manufacturer_data_alone_reads_the_same() {
    assert_eq!(CardRepr::parse_manufacturer_data(0xFFFF, &GOLDEN[7..]), parsed(&GOLDEN));
    assert_eq!(CardRepr::parse_manufacturer_data(0x004C, &GOLDEN[7..]), Err(Error::ForeignCompany(0x004C)));
    for length in (0..40).filter(|&length| length != 24) {
        assert_eq!(
            CardRepr::parse_manufacturer_data(0xFFFF, &[0x10; 40][..length]),
            Err(Error::WrongLength { expected: 24, actual: length })
        );
    }
}

#[test]
fn missing_motion_zeroes_its_bytes_and_sets_the_flag() {
    for spoil in [
        |round: &mut CardRound| round.acceleration_max_m_s2[1] = f32::NAN,
        |round: &mut CardRound| round.acceleration_min_m_s2[2] = f32::NAN,
        |round: &mut CardRound| round.orientation_rad = f32::NEG_INFINITY,
    ] {
        let mut round = golden_round();
        spoil(&mut round);
        let bytes = emitted(&CardRepr::from_physical(golden_header(), &round));
        assert_eq!(bytes[7], 0x1D);
        assert_eq!(bytes[8..27], GOLDEN[8..27]);
        assert_eq!(bytes[27..], [0; 4]);
        let back = parsed(&bytes).unwrap().to_physical();
        assert!(back.orientation_rad.is_nan());
        assert!(back.acceleration_max_m_s2.iter().chain(&back.acceleration_min_m_s2).all(|a| a.is_nan()));
    }
}

#[test]
fn measured_motion_clears_the_flag() {
    let mut header = golden_header();
    header.flags.motion_missing = true;
    assert_eq!(emitted(&CardRepr::from_physical(header, &golden_round())), GOLDEN);
}

#[test]
fn every_truncation_is_refused_and_padding_is_not() {
    for length in 0..31 {
        assert_eq!(parsed(&GOLDEN[..length]), Err(Error::Truncated { needed: 31, actual: length }));
        let unchecked = CardFrame::new_unchecked(&GOLDEN[..length]);
        assert_eq!(CardRepr::parse(&unchecked), Err(Error::Truncated { needed: 31, actual: length }));
    }
    let mut padded = [0; 62];
    padded[..31].copy_from_slice(&GOLDEN);
    assert_eq!(parsed(&padded), parsed(&GOLDEN));
}

#[test]
fn every_corruption_of_a_byte_is_refused_or_shown() {
    let golden = parsed(&GOLDEN).unwrap();
    for position in 0..GOLDEN.len() {
        for value in (0..=u8::MAX).filter(|&value| value != GOLDEN[position]) {
            let mut bytes = GOLDEN;
            bytes[position] = value;
            let expected = match position {
                0 => Err(Error::WrongLength { expected: 2, actual: value.into() }),
                1 => Err(Error::WrongAdType { expected: 1, actual: value }),
                2 => Err(Error::WrongFlags(value)),
                3 => Err(Error::WrongLength { expected: 27, actual: value.into() }),
                4 => Err(Error::WrongAdType { expected: 0xFF, actual: value }),
                5 => Err(Error::ForeignCompany(0xFF00 | u16::from(value))),
                6 => Err(Error::ForeignCompany(u16::from(value) << 8 | 0xFF)),
                7 if value >> 4 != 1 => Err(Error::UnknownVersion(value >> 4)),
                _ => {
                    let repr = parsed(&bytes).unwrap();
                    assert_ne!(repr, golden, "byte {position} is not read");
                    assert_eq!(emitted(&repr), bytes);
                    let _ = repr.to_physical();
                    continue;
                }
            };
            assert_eq!(parsed(&bytes), expected);
        }
    }
}

#[test]
fn a_gap_counts_the_frames_lost() {
    assert_eq!(sequence_gap(7, 8), 0);
    assert_eq!(sequence_gap(7, 9), 1);
    assert_eq!(sequence_gap(255, 0), 0);
    assert_eq!(sequence_gap(254, 1), 2);
    assert_eq!(sequence_gap(7, 7), SEQUENCE_REPEATED);
}

fn any_repr() -> impl Strategy<Value = CardRepr> {
    let nibbles = || prop::array::uniform3(0..=15_u8);
    (
        (0..16_u8, any::<u8>(), any::<u8>(), any::<u16>()),
        (any::<[i16; 3]>(), any::<[u16; 3]>(), any::<[u8; 3]>()),
        (nibbles(), nibbles(), any::<u8>()),
    )
        .prop_map(
            |((flags, battery, sequence, card_id), (b_v, b_h, previous_b), (max, min, orientation))| {
                CardRepr {
                    header: CardHeader { flags: CardFlags::from_bits(flags), battery, sequence, card_id },
                    b_v,
                    b_h,
                    previous_b,
                    acceleration_max: max,
                    acceleration_min: min,
                    orientation,
                }
            },
        )
}

/// Half a magnetic step, and the rounding of `f32` at 1200 µT.
const HALF_STEP_UT: f32 = MAGNETIC_LSB_UT / 2.0 + 2e-4;

proptest! {
    #[test]
    fn a_repr_survives_the_wire(repr in any_repr()) {
        prop_assert_eq!(parsed(&emitted(&repr)), Ok(repr));
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
        if let Ok(repr) = parsed(&bytes) {
            prop_assert_eq!(&emitted(&repr)[..], &bytes[..31]);
        }
    }

    #[test]
    fn quantisation_errs_by_half_a_step_at_most(
        b_v_ut in prop::array::uniform3(-1200.0..=1200.0_f32),
        b_h_ut in prop::array::uniform3(0.0..=1200.0_f32),
        previous_b_ut in prop::array::uniform3(0.5..255.5_f32),
        acceleration_max_m_s2 in prop::array::uniform3(0.0..15.5_f32),
        acceleration_min_m_s2 in prop::array::uniform3(0.0..15.5_f32),
        orientation_rad in -20.0..20.0_f32,
    ) {
        let round = CardRound {
            b_v_ut, b_h_ut, previous_b_ut, acceleration_max_m_s2, acceleration_min_m_s2, orientation_rad,
        };
        let repr = CardRepr::from_physical(golden_header(), &round);
        let back = repr.to_physical();
        for third in 0..3 {
            prop_assert!((back.b_v_ut[third] - b_v_ut[third]).abs() <= HALF_STEP_UT);
            prop_assert!((back.b_h_ut[third] - b_h_ut[third]).abs() <= HALF_STEP_UT);
            prop_assert!((back.previous_b_ut[third] - previous_b_ut[third]).abs() <= 0.5);
            prop_assert!((back.acceleration_max_m_s2[third] - acceleration_max_m_s2[third]).abs() <= 0.5);
            prop_assert!((back.acceleration_min_m_s2[third] - acceleration_min_m_s2[third]).abs() <= 0.5);
        }
        let turn = core::f32::consts::TAU;
        let error_rad = (back.orientation_rad - orientation_rad).rem_euclid(turn);
        prop_assert!(error_rad.min(turn - error_rad) <= turn / 512.0 + 1e-5);
        // What was quantised once is exact from then on.
        prop_assert_eq!(CardRepr::from_physical(golden_header(), &back), repr);
    }

    #[test]
    fn any_floats_give_values_in_range(
        fields in prop::array::uniform16(any::<f32>()),
        orientation_rad in any::<f32>(),
    ) {
        let thirds = |start: usize| [fields[start], fields[start + 1], fields[start + 2]];
        let round = CardRound {
            b_v_ut: thirds(0),
            b_h_ut: thirds(3),
            previous_b_ut: thirds(6),
            acceleration_max_m_s2: thirds(9),
            acceleration_min_m_s2: thirds(12),
            orientation_rad,
        };
        let repr = CardRepr::from_physical(golden_header(), &round);
        prop_assert_eq!(parsed(&emitted(&repr)), Ok(repr));
        for third in 0..3 {
            let (b_v, b_h) = (repr.b_v[third], repr.b_h[third]);
            prop_assert!(b_v == B_V_MISSING || (-30_000..=30_000).contains(&b_v));
            prop_assert!(b_h == B_H_MISSING || b_h <= 30_000);
            prop_assert_eq!(b_v == B_V_MISSING, round.b_v_ut[third].is_nan());
            prop_assert_eq!(b_h == B_H_MISSING, round.b_h_ut[third].is_nan());
            prop_assert_eq!(repr.previous_b[third] == 0, round.previous_b_ut[third].is_nan());
            prop_assert!(repr.acceleration_max[third] <= 15 && repr.acceleration_min[third] <= 15);
            if round.b_v_ut[third].abs() >= 1200.0 {
                prop_assert_eq!(b_v, if round.b_v_ut[third] > 0.0 { 30_000 } else { -30_000 });
            }
        }
    }
}
