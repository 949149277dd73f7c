//! `fieldwalk card-walks`: readings for the emulated card, and what its frames are worth.

use std::fs;
use std::io::Write;
use std::path::Path;

use fieldwalk_formats::FormatError;
use fieldwalk_sim::card::SentFrame;
use serde::Serialize;

use crate::arguments::CardWalksArguments;
use crate::card_walks::{CardWalks, host_frames};
use crate::reproduce::estimate::quantile_of;
use crate::stop::Stop;

/// Time in microseconds, a frame, and the instructions that the round took.
const RECORD: usize = 8 + 31 + 4;
/// A larger file of frames is none, in bytes: more than a day's.
const MAX_FRAMES_BYTES: u64 = 4_000_000;

/// What the frames are worth.
#[derive(Debug, Serialize)]
struct Worth {
    /// Walks.
    walks: usize,
    /// Rounds.
    rounds: usize,
    /// Whether each walk's frames and their times are those of the build for this machine, to the bit.
    frames_equal: bool,
    /// Mean over rounds.
    instructions_per_round: f64,
    /// Of the dearest round.
    instructions_max: u32,
    /// Median error of the system `card`, in metres.
    median_m: f64,
    /// Moments without a fix, which are not in the median.
    n_without_fix: usize,
}

/// Writes readings, or scores frames.
pub fn run(arguments: &CardWalksArguments, out: &mut impl Write) -> Result<(), Stop> {
    let walks = CardWalks::of(arguments.seed);
    let folder = &arguments.dir;
    if !arguments.score {
        fs::create_dir_all(folder).map_err(|error| FormatError::io("make the folder", folder, error))?;
        for (k, entries) in walks.entries().enumerate() {
            let bytes: Vec<u8> = entries.iter().flat_map(|entry| entry.to_bytes()).collect();
            let path = folder.join(format!("walk-{:02}.readings", k + 1));
            fs::write(&path, bytes).map_err(|error| FormatError::io("write the readings", &path, error))?;
        }
        return Ok(());
    }
    let (mut n_rounds, mut frames_equal, mut instructions, mut errors_m) = (0, true, Vec::new(), Vec::new());
    for (k, entries) in walks.entries().enumerate() {
        let (frames, counts) = read_frames(&folder.join(format!("walk-{:02}.frames", k + 1)))?;
        frames_equal &= frames == host_frames(entries, k as u16 + 1);
        n_rounds += frames.len();
        instructions.extend(counts);
        errors_m.extend(walks.errors_m(k, &frames));
    }
    let n_without_fix = errors_m.iter().filter(|error_m| !error_m.is_finite()).count();
    let worth = Worth {
        walks: walks.entries().count(),
        rounds: n_rounds,
        frames_equal,
        instructions_per_round: instructions.iter().map(|&n| f64::from(n)).sum::<f64>() / n_rounds as f64,
        instructions_max: instructions.iter().copied().max().unwrap_or(0),
        median_m: quantile_of(errors_m.into_iter().filter(|error_m| error_m.is_finite()), 0.5),
        n_without_fix,
    };
    writeln!(out, "{}", serde_json::to_string(&worth)?)?;
    Ok(())
}

/// The frames that the emulator wrote, and each round's instructions.
fn read_frames(path: &Path) -> Result<(Vec<SentFrame>, Vec<u32>), Stop> {
    let failed = |error| FormatError::io("read the frames", path, error);
    let size = fs::metadata(path).map_err(failed)?.len();
    if size > MAX_FRAMES_BYTES || size % RECORD as u64 != 0 {
        return Err(Stop::Failed(format!("{}: not whole records of {RECORD} bytes", path.display())));
    }
    let bytes = fs::read(path).map_err(failed)?;
    let (records, _) = bytes.as_chunks::<RECORD>();
    Ok(records
        .iter()
        .map(|record| {
            let time_us = u64::from_le_bytes(std::array::from_fn(|k| record[k]));
            let instructions = u32::from_le_bytes(std::array::from_fn(|k| record[39 + k]));
            ((time_us, std::array::from_fn(|k| record[8 + k])), instructions)
        })
        .unzip())
}
