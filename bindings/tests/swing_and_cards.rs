//! The calibrator and the decoders against what is known beforehand.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use fieldwalk::rotation::Quaternion;
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;
use fieldwalk_batch::SampleBatchWriter;
use fieldwalk_codec::{
    CardFlags, CardFrame, CardHeader, CardRepr, CardRound, IbeaconFrame, IbeaconRepr, battery_from_mv,
};
use fieldwalk_ffi::{
    ApiError, CardDecoder, MagnetometerCalibrator, SwingFault, SwingVerdict, decode_ibeacon,
    decode_ibeacon_manufacturer_data,
};

/// A swing about all axes at 50 Hz with 40 µT of hard iron along x.
fn swing(seconds: f64) -> Vec<u8> {
    let mut writer = SampleBatchWriter::new();
    let mut earth_from_device = Quaternion::IDENTITY;
    for k in 0..(seconds * 50.0) as i64 {
        let t = k as f64 * 0.02;
        let rate = [3.0 * (1.1 * t).sin(), 2.5 * (0.7 * t).cos(), 2.0 * (0.4 * t).sin()];
        earth_from_device = earth_from_device.turned(rate.map(|c| c * 0.02));
        let mut field = earth_from_device.rotate_back([0.0, 22.0, -42.0]);
        field[0] += 40.0;
        let field_ut = field.map(|c| c as f32);
        for reading in [
            Reading::AngularRate(rate.map(|c| c as f32)),
            Reading::UncalibratedMagneticField { field_ut, bias_ut: [0.0; 3] },
        ] {
            assert!(writer.push(&Sample { time: Timestamp::from_millis(20 * k), reading }));
        }
    }
    writer.finish()
}

#[test]
fn a_swing_finds_hard_iron_and_a_short_one_says_what_to_do() {
    let calibrator = MagnetometerCalibrator::new();
    calibrator.push_samples(&swing(0.4)).unwrap();
    let SwingVerdict::SwingAgain { fault, remedy } = calibrator.verdict().unwrap() else {
        panic!("calibrated by a twitch");
    };
    assert_eq!(fault, SwingFault::TooShort);
    assert!(remedy.contains("longer"), "{remedy}");
    let calibrator = MagnetometerCalibrator::new();
    calibrator.push_samples(&swing(30.0)).unwrap();
    let SwingVerdict::Calibrated { calibration } = calibrator.verdict().unwrap() else {
        panic!("{:?}", calibrator.verdict());
    };
    assert!((calibration.offset_ut.x - 40.0).abs() < 0.2, "{calibration:?}");
    assert!((calibration.matrix_row_x.x - 1.0).abs() < 0.02 && calibration.matrix_row_x.y.abs() < 0.02);
    assert!((calibration.quality.strength_ut - 47.41).abs() < 0.2, "{calibration:?}");
    assert!(calibrator.n_readings().unwrap() >= 30);
}

fn card_frame(card_id: u16, sequence: u8, round: &CardRound) -> [u8; CardRepr::BUFFER_LEN] {
    let flags = CardFlags { calibrated: true, ..CardFlags::default() };
    let header = CardHeader { flags, battery: battery_from_mv(2_950), sequence, card_id };
    let mut bytes = [0; CardRepr::BUFFER_LEN];
    CardRepr::from_physical(header, round).emit(&mut CardFrame::new_unchecked(&mut bytes));
    bytes
}

const ROUND: CardRound = CardRound {
    b_v_ut: [-41.0, f32::NAN, -39.68],
    b_h_ut: [21.0, 22.52, 22.88],
    previous_b_ut: [46.0, f32::NAN, 255.0],
    acceleration_max_m_s2: [12.0, 13.0, 15.0],
    acceleration_min_m_s2: [7.0, 7.0, 8.0],
    orientation_rad: std::f32::consts::FRAC_PI_2,
};

#[test]
fn a_card_s_round_comes_out_as_it_was_measured() {
    let round = CardDecoder::new().decode_advertisement(&card_frame(42, 7, &ROUND)).unwrap();
    assert_eq!((round.card_id, round.sequence, round.battery_mv), (42, 7, Some(2_960)));
    assert!(round.is_calibrated && !round.just_woke && !round.is_battery_low);
    assert_eq!(round.vertical_field_ut, [Some(-41.0), None, Some(-39.68)]);
    assert_eq!(round.horizontal_field_ut, [Some(21.0), Some(22.52), Some(22.88)]);
    assert_eq!(round.previous_strength_ut, [Some(46.0), None, Some(255.0)]);
    assert_eq!(round.acceleration_max_m_s2, [Some(12.0), Some(13.0), Some(15.0)]);
    assert_eq!(round.acceleration_min_m_s2, [Some(7.0), Some(7.0), Some(8.0)]);
    assert_eq!(round.orientation_rad, Some(std::f32::consts::FRAC_PI_2));
    let still = CardRound { orientation_rad: f32::NAN, ..ROUND };
    let round = CardDecoder::new().decode_advertisement(&card_frame(42, 7, &still)).unwrap();
    assert_eq!((round.orientation_rad, round.acceleration_max_m_s2), (None, vec![None; 3]));
}

#[test]
fn lost_and_repeated_rounds_are_told_per_card() {
    let decoder = CardDecoder::new();
    let heard = |card_id, sequence| {
        let frame = card_frame(card_id, sequence, &ROUND);
        // As iOS gives it: the company's identifier apart.
        let round = decoder.decode_manufacturer_data(0xffff, &frame[7..]).unwrap();
        (round.n_lost, round.is_repeated)
    };
    assert_eq!(heard(1, 254), (None, false));
    assert_eq!(heard(1, 255), (Some(0), false));
    assert_eq!(heard(2, 9), (None, false));
    assert_eq!(heard(1, 255), (Some(0), true));
    assert_eq!(heard(1, 2), (Some(2), false));
    assert_eq!(heard(2, 10), (Some(0), false));
}

#[test]
fn other_senders_newer_cards_and_torn_frames_are_told_apart() {
    let decoder = CardDecoder::new();
    let frame = card_frame(1, 1, &ROUND);
    let torn = decoder.decode_advertisement(&frame[..30]);
    assert!(matches!(torn, Err(ApiError::AdvertisementMalformed { .. })), "{torn:?}");
    let mut newer = frame;
    newer[7] = 0x21;
    let newer = decoder.decode_advertisement(&newer);
    assert!(matches!(newer, Err(ApiError::AdvertisementTooNew { .. })), "{newer:?}");
    let foreign = decoder.decode_manufacturer_data(0x0059, &frame[7..]);
    assert!(matches!(foreign, Err(ApiError::AdvertisementForeign { .. })), "{foreign:?}");
    // None of these was a round.
    assert_eq!(decoder.decode_advertisement(&frame).unwrap().n_lost, None);
}

#[test]
fn an_ibeacon_names_itself() {
    let repr = IbeaconRepr { uuid: *b"0123456789abcdef", major: 513, minor: 7, measured_power_dbm: -59 };
    let mut bytes = [0; IbeaconRepr::BUFFER_LEN];
    repr.emit(&mut IbeaconFrame::new_unchecked(&mut bytes));
    let beacon = decode_ibeacon(&bytes).unwrap();
    assert_eq!((beacon.uuid.as_slice(), beacon.major), (&b"0123456789abcdef"[..], 513));
    assert_eq!((beacon.minor, beacon.measured_power_dbm), (7, -59));
    assert_eq!(decode_ibeacon_manufacturer_data(0x004c, &bytes[7..]).unwrap(), beacon);
    let card = decode_ibeacon(&card_frame(1, 1, &ROUND));
    assert!(matches!(card, Err(ApiError::AdvertisementForeign { .. })), "{card:?}");
}

/// A round as a line of `walk-01.rounds.txt`, which `firmware/golden/README.md` describes.
fn line(round: &fieldwalk_ffi::CardRound) -> String {
    let bit = |is: bool| if is { "1" } else { "0" }.to_owned();
    let bits = |value: &Option<f32>| value.map_or("-".to_owned(), |value| format!("{:08x}", value.to_bits()));
    let mut words = vec![round.card_id.to_string(), round.sequence.to_string()];
    words.push(round.n_lost.map_or("-".to_owned(), |n| n.to_string()));
    words.extend([round.is_repeated, round.is_calibrated, round.just_woke, round.is_battery_low].map(bit));
    words.push(round.battery_mv.map_or("-".to_owned(), |mv| mv.to_string()));
    let thirds = [
        &round.vertical_field_ut,
        &round.horizontal_field_ut,
        &round.previous_strength_ut,
        &round.acceleration_max_m_s2,
        &round.acceleration_min_m_s2,
    ];
    words.extend(thirds.into_iter().flatten().map(bits));
    words.push(bits(&round.orientation_rad));
    words.join(" ")
}

#[test]
fn the_golden_frames_of_the_firmware_are_read_as_they_were_sent() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/golden");
    let decoder = CardDecoder::new();
    let text = std::fs::read_to_string(folder.join("walk-01.frames.txt")).unwrap();
    let mut rounds = String::new();
    for (k, sent) in text.lines().enumerate() {
        let (_, digits) = sent.split_once(' ').unwrap();
        let bytes: Vec<u8> =
            (0..31).map(|i| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).unwrap()).collect();
        let round = decoder.decode_advertisement(&bytes).unwrap();
        assert_eq!((round.card_id, usize::from(round.sequence)), (1, k));
        assert_eq!((round.n_lost, round.just_woke), ((k > 0).then_some(0), k == 0));
        // Byte by byte, as the layout has them.
        let vertical = i16::from_le_bytes([bytes[12], bytes[13]]);
        assert_eq!(round.vertical_field_ut[0], Some(f32::from(vertical) / 25.0));
        assert_eq!(round.acceleration_max_m_s2[0], Some(f32::from(bytes[27] & 0x0F)));
        assert_eq!(round.battery_mv, Some(u16::from(bytes[8]) * 20));
        rounds += &(line(&round) + "\n");
    }
    assert_eq!(text.lines().count(), 59);
    // What Kotlin, Swift and Python find too.
    let golden = folder.join("walk-01.rounds.txt");
    if std::env::var_os("FIELDWALK_UPDATE_GOLDEN").is_some() {
        std::fs::write(&golden, &rounds).unwrap();
    }
    assert_eq!(rounds, std::fs::read_to_string(&golden).unwrap());
}
