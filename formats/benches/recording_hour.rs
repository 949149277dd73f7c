//! An hour of four sensors at 200 Hz, written and read: size, time and memory.
//!
//! `cargo bench -p fieldwalk-formats --bench recording_hour`

use std::fs;
use std::io::{self, Write as _};
use std::path::Path;
use std::time::Instant;

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::recording::{Record, RecordingInfo, RecordingReader, RecordingWriter};

const TICKS: i64 = 3_600 * 200;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if !std::env::args().any(|argument| argument == "--bench") {
        return Ok(());
    }
    let path = std::env::temp_dir().join(format!("fieldwalk-hour-{}.mcap", std::process::id()));
    let measured = measure(&path);
    fs::remove_file(&path)?;
    measured.map_err(Into::into)
}

fn measure(path: &Path) -> Result<(), FormatError> {
    say(&format!("memory before: {}", peak_memory()));
    let begin = Instant::now();
    let mut writer = RecordingWriter::create(path, &RecordingInfo::default())?;
    let mut most_buffered = 0;
    for_each_record(|record| {
        writer.write(&record)?;
        most_buffered = most_buffered.max(writer.n_buffered_bytes());
        Ok(())
    })?;
    let n_written = writer.n_written();
    writer.finish()?;
    let size = fs::metadata(path).map(|metadata| metadata.len()).unwrap_or(0);
    say(&format!(
        "written: {n_written} records in {:.2} s; {:.1} MB, {:.1} B a record; at most {} KB wait; peak memory {}",
        begin.elapsed().as_secs_f64(),
        size as f64 * 1e-6,
        size as f64 / n_written as f64,
        most_buffered / 1024,
        peak_memory(),
    ));

    let begin = Instant::now();
    let mut reader = RecordingReader::open(path)?;
    let mut n_read = 0_u64;
    for record in reader.by_ref() {
        record?;
        n_read += 1;
    }
    say(&format!(
        "read: {n_read} records in {:.2} s, {}; peak memory {}",
        begin.elapsed().as_secs_f64(),
        reader.losses(),
        peak_memory(),
    ));

    #[cfg(feature = "compression")]
    {
        let begin = Instant::now();
        let mut size = Counting(0);
        let mut writer = RecordingWriter::new_compressed(&mut size, "hour.mcap", &RecordingInfo::default())?;
        for_each_record(|record| writer.write(&record))?;
        writer.finish()?;
        let seconds = begin.elapsed().as_secs_f64();
        say(&format!("written with zstd in {seconds:.2} s; {:.1} MB", size.0 as f64 * 1e-6));
    }
    Ok(())
}

/// Numbers with all the digits that sensors have: multiples of their resolution, which no short decimal hits.
fn for_each_record(mut take: impl FnMut(Record) -> Result<(), FormatError>) -> Result<(), FormatError> {
    let mut noise = 1_u32;
    let mut vector = |resolution: f32| {
        [(); 3].map(|()| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (noise >> 20) as f32 * resolution - 2_048.0 * resolution
        })
    };
    for tick in 0..TICKS {
        let time = Timestamp::from_nanos(86_400_000_000_000 + tick * 5_000_000);
        let readings = [
            Reading::SpecificForce(vector(0.004_788)),
            Reading::AngularRate(vector(0.001_065_264)),
            Reading::MagneticField(vector(0.059_509)),
            Reading::UncalibratedMagneticField {
                field_ut: vector(0.059_509),
                bias_ut: [-12.25, 31.5, 7.0625],
            },
        ];
        for reading in readings {
            take(Record::Sample(Sample { time, reading }))?;
        }
    }
    Ok(())
}

/// The most memory that the process has held, where the system tells.
fn peak_memory() -> String {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.map_or_else(|| "unknown".to_owned(), |line| line.trim().to_owned())
}

fn say(line: &str) {
    let _ = writeln!(io::stdout(), "{line}");
}

#[cfg(feature = "compression")]
struct Counting(u64);

#[cfg(feature = "compression")]
impl io::Write for &mut Counting {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
