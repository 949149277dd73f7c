//! A card's receiver: any bytes at any times are borne, and rounds come out in order, with numbers that are numbers.
#![no_main]

use fieldwalk::card::CardReceiver;
use fieldwalk::time::Timestamp;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut receiver = CardReceiver::default();
    let mut now = Timestamp::from_millis(0);
    // Four bytes of a time in milliseconds, then a frame, whose first twelve bytes are mostly right.
    for chunk in bytes.chunks(4 + 31) {
        let Some((wait, frame)) = chunk.split_first_chunk::<4>() else { return };
        now = Timestamp::from_millis(
            now.as_nanos() / 1_000_000 + i64::from(i32::from_le_bytes(*wait)) % 400_000,
        );
        let mut frame = frame.to_vec();
        if frame.len() == 31 && frame[0] & 1 == 0 {
            frame[..7].copy_from_slice(&[2, 1, 6, 27, 255, 255, 255]);
            frame[7] = 0x10 | frame[7] & 0x0F;
            frame[10..12].fill(0);
        }
        receiver.push(now, &frame);
        while let Some(round) = receiver.pop() {
            assert!(round.cycle.start < round.cycle.end && round.n_steps <= 3);
            assert!(round.level_heading_rad.is_finite());
            assert!(round.reads.iter().flatten().all(|read| read.strength_ut.is_finite()));
        }
    }
});
