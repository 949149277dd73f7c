//! `fieldwalk train`: parameters estimated from recordings.

use std::fs;
use std::io::Write;
use std::path::Path;

use fieldwalk::attitude::{EventCounts, Pointing};
use fieldwalk_formats::recording::InOrder;
use fieldwalk_formats::sensor_logger::is_export;
use fieldwalk_formats::tyrex::{Motion, find_trials};
use fieldwalk_formats::{FormatError, Record, open_recording};

use crate::arguments::TrainAttitudeArguments;
use crate::stop::{Stop, note};
use crate::walker_evaluation::tyrex::training::{StrideCounter, count_strides, table_of};

/// Fewer strides than this in a table are a note to walk more.
const FEW_STRIDES: u32 = 200;

/// Estimates the table of feature events and prints or writes it.
pub fn attitude(arguments: &TrainAttitudeArguments, out: &mut impl Write) -> Result<(), Stop> {
    let mut counts = EventCounts::default();
    for path in &arguments.recordings {
        if path.is_dir() && !is_export(path) {
            for trial in find_trials(path)?.trials {
                if trial.motion == Motion::Texting {
                    counts.merge(&count_strides(&trial.samples()?.samples));
                }
            }
        } else {
            counts.merge(&of_recording(path)?);
        }
    }
    let n_strides = counts.n_strides(Pointing::Forward);
    if n_strides == 0 {
        return Err(Stop::Failed(
            "no stride in these recordings: give walks with the phone held level before the chest, top edge ahead"
                .into(),
        ));
    }
    if n_strides < FEW_STRIDES {
        note("warning", &format!("{n_strides} strides make a rough table: walk {FEW_STRIDES} or more"));
    }
    let table = serde_json::to_string_pretty(&table_of(&counts)).map_err(std::io::Error::from)?;
    match &arguments.out {
        Some(path) => fs::write(path, table + "\n")
            .map_err(|error| Stop::from(FormatError::io("write the table", path, error)))?,
        None => writeln!(out, "{table}")?,
    }
    note("trained", &format!("on {n_strides} strides"));
    Ok(())
}

fn of_recording(path: &Path) -> Result<EventCounts, FormatError> {
    let mut counter = StrideCounter::default();
    for record in InOrder::new(open_recording(path)?) {
        if let Record::Sample(sample) = record? {
            counter.push(&sample);
        }
    }
    Ok(*counter.counts())
}
