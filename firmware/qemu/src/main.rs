//! The ID card's application on an emulated Cortex-M4F (`mps2-an386`).
//!
//! Reads `walk-01.readings` and so on from the working folder by semihosting: what the sensor's registers hold every 40 ms,
//! 12 bytes as the KMX62 gives them, acceleration before field. Writes `walk-01.frames` and so on: for each round the time in µs (8 bytes, little-endian), the frame of
//! 31 bytes, and the instructions that the round took (4 bytes). At the end it says how deep the stack was.
//!
//! Run with `-icount shift=6`: an instruction then takes 64 ns of the board's time, and SysTick counts 40 ns, so that its
//! ticks times 40/64 are instructions. They are not cycles: a real core waits for its flash, and divides for longer than it
//! adds.

#![no_std]
#![no_main]

mod stack;
mod walk_file;

use core::cell::Cell;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use fieldwalk_card::replay::{ReplayCard, SensorReading, finish, lasts_another_round};
use fieldwalk_card::{CardParams, RoundOutcome};
use fieldwalk_kmx62::{AccelerationRange, BufferEntry, Entry as _};
use semihosting::{io, println, process};

/// Longest walk: five minutes and a half.
const MAX_READINGS: usize = 8_192;
const MAX_ROUNDS: usize = 340;
/// Time in µs, frame, instructions.
const RECORD: usize = 8 + 31 + 4;

/// As the simulator's: `fieldwalk_sim::card::RANGE`.
const RANGE: AccelerationRange = AccelerationRange::G4;

#[entry]
fn main() -> ! {
    stack::paint();
    let Some(mut core) = cortex_m::Peripherals::take() else { process::exit(2) };
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(0x00FF_FFFF);
    core.SYST.clear_current();
    core.SYST.enable_counter();
    let (Some(bytes), Some(records)) = (
        cortex_m::singleton!(: [u8; MAX_READINGS * BufferEntry::LEN] = [0; MAX_READINGS * BufferEntry::LEN]),
        cortex_m::singleton!(: [u8; MAX_ROUNDS * RECORD] = [0; MAX_ROUNDS * RECORD]),
    ) else {
        process::exit(2)
    };
    let mut n_walks = 0;
    while let Ok(file) = walk_file::open(n_walks + 1) {
        n_walks += 1;
        if let Err(error) = run(file, n_walks, bytes, records) {
            println!("walk {n_walks}: {error:?}");
            process::exit(1);
        }
    }
    println!("walks {n_walks} stack_bytes {}", stack::high_water());
    process::exit(if n_walks > 0 { 0 } else { 1 })
}

/// One walk: all of its readings in, all of its frames out.
fn run(file: semihosting::fs::File, n_walk: u8, bytes: &mut [u8], records: &mut [u8]) -> io::Result<()> {
    let n_bytes = walk_file::read(file, bytes)?;
    let (entries, _) = bytes[..n_bytes].as_chunks::<{ BufferEntry::LEN }>();
    let n_entries = entries.len();
    let readings = entries.iter().filter_map(|bytes| BufferEntry::from_bytes(*bytes)).map(|entry| {
        SensorReading { force_m_s2: entry.acceleration_m_s2(RANGE), field_ut: entry.field_ut() }
    });
    let now_us = Cell::new(0);
    let mut card = ReplayCard::switched_on(&now_us, readings, CardParams::of_card(u16::from(n_walk)));
    let mut n_rounds = 0;
    for record in records.chunks_exact_mut(RECORD) {
        if !lasts_another_round(n_entries, now_us.get()) {
            break;
        }
        let before = SYST::get_current();
        let outcome = finish(card.round());
        // SysTick counts down.
        let ticks = before.wrapping_sub(SYST::get_current()) & 0x00FF_FFFF;
        let RoundOutcome::Sent(frame) = outcome else { continue };
        record[..8].copy_from_slice(&now_us.get().to_le_bytes());
        record[8..39].copy_from_slice(&frame);
        record[39..].copy_from_slice(&(ticks * 40 / 64).to_le_bytes());
        n_rounds += 1;
    }
    walk_file::write(n_walk, &records[..n_rounds * RECORD])
}
