//! What the part says, decoded: any bytes, and every bit in its place.

use fieldwalk_kmx62::{
    AccelerationEntry, AccelerationRange, BufferEntry, BufferStatus, Interrupts, MotionAxes, Rate,
    Resolution, Sample, Sensor, WakeUpRate,
};
use proptest::prelude::*;

#[test]
fn rates_and_ranges_are_those_of_the_part() {
    let rates =
        [Rate::Hz0_781, Rate::Hz1_563, Rate::Hz3_125, Rate::Hz6_25, Rate::Hz12_5, Rate::Hz25, Rate::Hz1600];
    assert_eq!(rates.map(Rate::hz), [0.781_25, 1.562_5, 3.125, 6.25, 12.5, 25.0, 1_600.0]);
    assert_eq!(
        [WakeUpRate::Hz0_781, WakeUpRate::Hz3_125, WakeUpRate::Hz100].map(WakeUpRate::hz),
        [0.781_25, 3.125, 100.0]
    );
    use AccelerationRange::{G2, G4, G8, G16};
    let steps_a_g = [G2, G4, G8, G16].map(|range| (9.806_65 / range.m_s2_per_lsb()).round());
    assert_eq!(steps_a_g, [16_384.0, 8_192.0, 4_096.0, 2_048.0]);
    let averaged = Resolution::ALL.map(|resolution| resolution.n_averaged(Sensor::Magnetometer));
    assert_eq!(averaged, [Some(2), Some(16), None]);
}

#[test]
fn every_bit_of_the_axes_has_its_place() {
    for bit in 0..6 {
        let axes = MotionAxes::from_bits(1 << bit);
        assert_eq!(axes.bits(), 1 << bit);
        let axis = 2 - bit / 2;
        assert_eq!((axes.negative[axis], axes.positive[axis]), (bit % 2 == 1, bit % 2 == 0));
    }
    assert_eq!(MotionAxes::ALL.bits(), 0x3F);
}

#[test]
fn the_filler_of_an_empty_buffer_is_no_reading() {
    let filler = [0xFF, 0x7F].repeat(6);
    assert_eq!(BufferEntry::from_bytes(filler[..].try_into().unwrap()), None);
    // A sensor at the end of its range is one, unless all are.
    let mut bytes: [u8; 12] = filler[..].try_into().unwrap();
    bytes[0] = 0xFE;
    assert!(BufferEntry::from_bytes(bytes).is_some());
}

proptest! {
    #[test]
    fn any_bytes_decode_to_numbers_in_range(bytes in any::<[u8; 14]>(), status in any::<[u8; 3]>()) {
        let sample = Sample::from_bytes(bytes);
        prop_assert!(sample.field_ut().iter().all(|c| c.abs() <= 1_200.0));
        let limit_m_s2 = 16.0 * 9.806_65 * 1.000_001;
        prop_assert!(sample.acceleration_m_s2(AccelerationRange::G16).iter().all(|c| c.abs() <= limit_m_s2));
        if let Some(entry) = BufferEntry::from_bytes(bytes[..12].try_into().unwrap()) {
            prop_assert_eq!((entry.acceleration, entry.field), (sample.acceleration, sample.field));
            prop_assert_eq!(&entry.to_bytes()[..], &bytes[..12]);
        }
        let status = BufferStatus::from_bytes(status);
        prop_assert!(status.n_entries::<AccelerationEntry>() <= 64);
        prop_assert!(status.n_entries::<BufferEntry>() <= 32 && status.level <= 511 && status.n_lost < 1 << 14);
    }

    #[test]
    fn motion_is_told_exactly_when_its_bit_is_set(bytes in any::<[u8; 3]>()) {
        let interrupts = Interrupts::from_bytes(bytes);
        prop_assert_eq!(interrupts.acceleration_motion.is_some(), bytes[0] & 2 != 0);
        prop_assert_eq!(interrupts.field_motion.map(MotionAxes::bits), (bytes[0] & 1 != 0).then_some(bytes[2] & 0x3F));
    }
}
