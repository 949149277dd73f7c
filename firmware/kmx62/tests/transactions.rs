//! Every exchange on the bus, byte by byte.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

use embedded_hal::i2c::ErrorKind;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use fieldwalk_kmx62::{
    AccelerationEntry, AccelerationRange, BufferEntry, Config, Error, Kmx62, MotionAxes, Rate, Resolution,
    SlaveAddress, WakeUp, WakeUpRate,
};

fn wait<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => unreachable!("the mock waits"),
    }
}

fn write(bytes: &[u8]) -> Transaction {
    Transaction::write(0x0E, bytes.to_vec())
}

fn read(register: u8, bytes: &[u8]) -> Transaction {
    Transaction::write_read(0x0E, vec![register], bytes.to_vec())
}

/// Runs `exchange` on a part that expects `transactions`, all of which must come.
fn on_part<T>(transactions: &[Transaction], exchange: impl AsyncFnOnce(&mut Kmx62<Mock>) -> T) -> T {
    let mut driver = Kmx62::new(Mock::new(transactions), SlaveAddress::Primary);
    let result = wait(exchange(&mut driver));
    driver.into_inner().done();
    result
}

#[test]
fn known_parts_are_accepted_and_others_named() {
    for id in [0x18, 0x19] {
        assert_eq!(on_part(&[read(0x00, &[id])], async |part| part.identify().await), Ok(id));
    }
    let other = on_part(&[read(0x00, &[0x14])], async |part| part.identify().await);
    assert_eq!(other, Err(Error::WrongPart(0x14)));
    assert!(other.unwrap_err().to_string().contains("0x14"));
}

#[test]
fn the_other_address_is_used() {
    let mut driver =
        Kmx62::new(Mock::new(&[Transaction::write_read(0x0F, vec![0], vec![0x18])]), SlaveAddress::Secondary);
    assert_eq!(wait(driver.identify()), Ok(0x18));
    driver.into_inner().done();
}

#[test]
fn a_reset_bears_that_the_part_is_gone_at_once() {
    let gone = write(&[0x39, 0x80]).with_error(ErrorKind::Other);
    for reset in [write(&[0x39, 0x80]), gone] {
        let transactions = [write(&[0x3A, 0x00]), reset];
        assert_eq!(on_part(&transactions, async |part| part.reset(&mut NoopDelay).await), Ok(()));
    }
}

#[test]
fn the_command_test_turns_the_bits() {
    let test = |turned| {
        let transactions = [read(0x3C, &[0x55]), write(&[0x39, 0x08]), read(0x3C, &[turned])];
        on_part(&transactions, async |part| part.command_test().await)
    };
    assert_eq!(test(0xAA), Ok(()));
    assert_eq!(test(0x55), Err(Error::TestFailed([0x55, 0x55])));
}

#[test]
fn settings_are_changed_in_standby() {
    let config = Config {
        acceleration_rate: Rate::Hz25,
        field_rate: Rate::Hz3_125,
        range: AccelerationRange::G8,
        resolution: Resolution::Maximum,
        reads_temperature: true,
    };
    let transactions = [
        write(&[0x3A, 0b0010_1100]),
        write(&[0x31, 0x00]),
        write(&[0x2A, 0x00]),
        write(&[0x38, 0xA1]),
        write(&[0x3A, 0b0110_1111]),
    ];
    assert_eq!(on_part(&transactions, async |part| part.start(&config).await), Ok(()));
    let transactions = [write(&[0x3A, 0x00]), write(&[0x7A, 0x00])];
    assert_eq!(on_part(&transactions, async |part| part.standby().await), Ok(()));
}

#[test]
fn a_sample_is_fourteen_bytes() {
    let bytes = [0x00, 0x20, 0xFF, 0xFF, 0x00, 0xE0, 0x64, 0x00, 0x9C, 0xFF, 0x00, 0x80, 0x00, 0x15];
    let sample = on_part(&[read(0x0A, &bytes)], async |part| part.sample().await).unwrap();
    assert_eq!((sample.acceleration, sample.field), ([8_192, -1, -8_192], [100, -100, -32_768]));
    assert_eq!(sample.temperature, 21 * 256);
    // 8192 steps are 1 g at ±4 g; 100 steps 3.66 µT.
    assert!((sample.acceleration_m_s2(AccelerationRange::G4)[0] - 9.806_65).abs() < 1e-5);
    assert!((sample.acceleration_m_s2(AccelerationRange::G16)[0] - 39.226_6).abs() < 1e-4);
    assert_eq!(sample.field_ut(), [3.662_109_4, -3.662_109_4, -1_200.0]);
}

fn entry(k: i16) -> BufferEntry {
    BufferEntry { acceleration: [k, -k, 8_000], field: [2 * k, 0, -k] }
}

fn bytes_of(entries: impl Iterator<Item = i16>) -> Vec<u8> {
    entries.flat_map(|k| entry(k).to_bytes()).collect()
}

#[test]
fn the_buffer_streams_all_axes() {
    let transactions = [write(&[0x77, 0x00, 0x02, 0x7E]), write(&[0x7A, 0x00])];
    assert_eq!(on_part(&transactions, async |part| part.start_buffer::<BufferEntry>().await), Ok(()));
}

#[test]
fn the_buffer_is_read_in_bursts_of_eight() {
    let mut entries = [BufferEntry::default(); 32];
    // 13 entries and a half: 162 bytes.
    let transactions = [read(0x7B, &[162, 0, 0]), read(0x7E, &bytes_of(0..8)), read(0x7E, &bytes_of(8..13))];
    assert_eq!(on_part(&transactions, async |part| part.read_buffer(&mut entries).await), Ok(13));
    assert!((0..13).all(|k| entries[k as usize] == entry(k)));
}

#[test]
fn the_buffer_gives_no_more_than_asked_for_and_no_filler() {
    let mut entries = [BufferEntry::default(); 3];
    let transactions = [read(0x7B, &[0x80, 0x01, 0]), read(0x7E, &bytes_of(0..3))];
    assert_eq!(on_part(&transactions, async |part| part.read_buffer(&mut entries).await), Ok(3));
    let filler: Vec<u8> = bytes_of(0..1).into_iter().chain([0xFF, 0x7F].repeat(12)).collect();
    let transactions = [read(0x7B, &[36, 0, 0]), read(0x7E, &filler)];
    assert_eq!(on_part(&transactions, async |part| part.read_buffer(&mut entries).await), Ok(1));
    assert_eq!(on_part(&[read(0x7B, &[11, 0, 0])], async |part| part.read_buffer(&mut entries).await), Ok(0));
}

#[test]
fn a_level_beyond_the_buffer_is_cut() {
    // 511 bytes cannot be; 384 are 32 entries.
    let mut entries = [BufferEntry::default(); 40];
    let mut transactions = vec![read(0x7B, &[0xFF, 0x03, 0x01])];
    transactions.extend((0..4).map(|burst| read(0x7E, &bytes_of(8 * burst..8 * burst + 8))));
    assert_eq!(on_part(&transactions, async |part| part.read_buffer(&mut entries).await), Ok(32));
    let status =
        on_part(&[read(0x7B, &[0xFF, 0x07, 0x01])], async |part| part.buffer_status().await).unwrap();
    assert_eq!(
        (status.level, status.is_triggered, status.n_lost, status.n_entries::<BufferEntry>()),
        (511, true, 65, 32)
    );
}

#[test]
fn the_motion_engine_watches_with_the_accelerometer_alone() {
    let wake_up = WakeUp { rate: WakeUpRate::Hz3_125, threshold: 3, n_looks: 5, axes: MotionAxes::ALL };
    let transactions = [
        write(&[0x3A, 0b0001_0000]),
        write(&[0x38, 0xAA]),
        write(&[0x2C, 0x04]),
        write(&[0x2A, 0x02]),
        write(&[0x2D, 0x3F]),
        write(&[0x2F, 3, 5, 0x82]),
        write(&[0x3A, 0b0001_0001]),
        read(0x05, &[0]),
    ];
    assert_eq!(on_part(&transactions, async |part| part.watch(&wake_up).await), Ok(()));
}

#[test]
fn interrupts_are_told_and_released() {
    let transactions = [read(0x01, &[0b1000_0010, 0b0010_0001, 0xFF]), read(0x05, &[0])];
    let interrupts = on_part(&transactions, async |part| part.interrupts().await).unwrap();
    let axes = interrupts.acceleration_motion.unwrap();
    assert_eq!((axes.negative, axes.positive), ([true, false, false], [false, false, true]));
    assert!(interrupts.any && interrupts.field_motion.is_none() && !interrupts.watermark);
}

#[test]
fn a_bus_that_fails_is_told() {
    let broken = read(0x7B, &[0, 0, 0]).with_error(ErrorKind::ArbitrationLoss);
    let mut entries = [BufferEntry::default(); 4];
    let result = on_part(&[broken], async |part| part.read_buffer(&mut entries).await);
    assert_eq!(result, Err(Error::Bus(ErrorKind::ArbitrationLoss)));
    let broken = write(&[0x3A, 0]).with_error(ErrorKind::Bus);
    assert!(on_part(&[broken], async |part| part.standby().await).is_err());
}

#[test]
fn the_acceleration_alone_is_half_an_entry() {
    let transactions = [write(&[0x77, 0x00, 0x02, 0x70]), write(&[0x7A, 0x00])];
    assert_eq!(on_part(&transactions, async |part| part.start_buffer::<AccelerationEntry>().await), Ok(()));
    let bytes: Vec<u8> = (0..25_i16).flat_map(|k| [k, -k, 8_192].map(i16::to_le_bytes).concat()).collect();
    let mut entries = [AccelerationEntry::default(); 64];
    let transactions = [read(0x7B, &[150, 0, 0]), read(0x7E, &bytes[..96]), read(0x7E, &bytes[96..])];
    assert_eq!(on_part(&transactions, async |part| part.read_buffer(&mut entries).await), Ok(25));
    assert!((0..25).all(|k| entries[k as usize] == AccelerationEntry([k, -k, 8_192])));
    assert!((entries[0].acceleration_m_s2(AccelerationRange::G4)[2] - 9.806_65).abs() < 1e-5);
    let filler = [read(0x7B, &[6, 0, 0]), read(0x7E, &[0xFF, 0x7F].repeat(3))];
    assert_eq!(on_part(&filler, async |part| part.read_buffer(&mut entries).await), Ok(0));
}

#[test]
fn the_field_alone_is_six_bytes() {
    let transactions = [read(0x10, &[100, 0, 0x9C, 0xFF, 0x00, 0x80])];
    let field_ut = on_part(&transactions, async |part| part.field_ut().await);
    assert_eq!(field_ut, Ok([3.662_109_4, -3.662_109_4, -1_200.0]));
}
