//! Captures of the emitter, cut into rounds of a second.

use std::io::BufRead;

use fieldwalk::geometry::Point2;
use fieldwalk::radio::MeanPower;
use fieldwalk::time::Timestamp;
use fieldwalk_formats::FormatError;
use fieldwalk_formats::ble_annotated::{Area, FixedPoint, SightingReader, Track};

use super::shown;

/// More rounds than this no capture has: a time far off would ask for any memory.
const MAX_ROUNDS: usize = 100_000;
/// Length of a round, in nanoseconds.
const ROUND_NS: i64 = 1_000_000_000;

/// What was heard of the emitter, round by round.
#[derive(Debug)]
pub struct Capture {
    /// The rounds, from the first sighting on.
    pub rounds: Vec<Round>,
    /// What was left out of it.
    pub warnings: Vec<String>,
}

/// A second.
#[derive(Clone, Debug)]
pub struct Round {
    /// Where the emitter was at its end, by the last sighting in it; nothing where no receiver heard it.
    pub truth: Option<Point2>,
    /// What each receiver of the area heard.
    pub heard: Vec<Heard>,
}

/// What one receiver heard in a round.
#[derive(Clone, Copy, Debug, Default)]
pub struct Heard {
    power: MeanPower,
    sum_dbm: f64,
}

impl Heard {
    fn push(&mut self, rssi_dbm: f64) {
        self.power.push(rssi_dbm);
        self.sum_dbm += rssi_dbm;
    }

    /// The mean in dBm, as the systems' rounds have it.
    pub fn mean_of_dbm(&self) -> Option<f64> {
        (self.power.n() > 0).then(|| self.sum_dbm / f64::from(self.power.n()))
    }
}

impl Capture {
    /// The capture of a fixed point.
    ///
    /// It ends when the first receiver's file does: a file that is cut after so many lines is no silence.
    pub fn of_point(area: &Area, point: &FixedPoint) -> Result<Self, FormatError> {
        let mut heard = Sightings::of(area);
        let mut ends = Vec::new();
        for file in &point.files {
            let n = heard.sightings.len();
            heard.read(SightingReader::open(file)?, &shown(file), Some(point.place))?;
            ends.extend(heard.sightings[n..].iter().map(|sighting| sighting.time).max());
        }
        Ok(heard.into_rounds(ends.into_iter().min()))
    }

    /// The capture of a track.
    pub fn of_track(area: &Area, track: &Track) -> Result<Self, FormatError> {
        let mut heard = Sightings::of(area);
        heard.read(SightingReader::open(&track.file)?, &track.name, None)?;
        Ok(heard.into_rounds(None))
    }

    /// What each receiver heard over the last `n_rounds` rounds, their powers averaged, in dBm, with the truth at their
    /// end; nothing for the first rounds.
    pub fn windows(&self, n_rounds: usize) -> impl Iterator<Item = (Point2, Vec<Option<f64>>)> {
        self.rounds.windows(n_rounds).filter_map(|rounds| {
            let last = rounds.last()?;
            let mean = |receiver: usize| {
                let mut mean = MeanPower::default();
                rounds.iter().for_each(|round| mean.add(&round.heard[receiver].power));
                mean.dbm()
            };
            Some((last.truth?, (0..last.heard.len()).map(mean).collect()))
        })
    }
}

/// Sightings of one capture on their way into rounds.
struct Sightings<'a> {
    area: &'a Area,
    sightings: Vec<Sighting>,
    warnings: Vec<String>,
}

struct Sighting {
    time: Timestamp,
    receiver: usize,
    rssi_dbm: f64,
    truth: Point2,
}

impl<'a> Sightings<'a> {
    fn of(area: &'a Area) -> Self {
        Self { area, sightings: Vec::new(), warnings: Vec::new() }
    }

    /// Takes in a file's sightings: those by receivers of the area whose truth is known.
    fn read<R: BufRead>(
        &mut self,
        mut reader: SightingReader<R>,
        name: &str,
        place: Option<Point2>,
    ) -> Result<(), FormatError> {
        let mut n_foreign = 0;
        for sighting in reader.by_ref() {
            let sighting = sighting?;
            let receiver =
                self.area.receivers.iter().position(|receiver| receiver.address == sighting.receiver);
            match receiver.zip(place.or(sighting.truth.map(|(place, _height_m)| place))) {
                Some((receiver, truth)) => self.sightings.push(Sighting {
                    time: sighting.time,
                    receiver,
                    rssi_dbm: f64::from(sighting.rssi_dbm),
                    truth,
                }),
                None => n_foreign += 1,
            }
        }
        let n_rejected = reader.rejections().total();
        if n_rejected > 0 {
            self.warnings.push(format!("{name}: {n_rejected} lines are not of the format and left out"));
        }
        if n_foreign > 0 {
            self.warnings.push(format!("{name}: {n_foreign} lines tell no place or no known receiver"));
        }
        Ok(())
    }

    /// The rounds that are over by `end`.
    fn into_rounds(mut self, end: Option<Timestamp>) -> Capture {
        self.sightings.sort_by_key(|sighting| sighting.time);
        let mut rounds: Vec<Round> = Vec::new();
        let Some(first) = self.sightings.first().map(|sighting| sighting.time) else {
            return Capture { rounds, warnings: self.warnings };
        };
        let round_of = |time: Timestamp| ((time - first).as_nanos() / ROUND_NS).max(0) as usize;
        let last = self.sightings.last().map_or(first, |sighting| sighting.time);
        // The round in which the capture ends is not a whole one.
        let n_rounds = round_of(end.unwrap_or(last)).min(MAX_ROUNDS);
        rounds.resize(
            n_rounds,
            Round { truth: None, heard: vec![Heard::default(); self.area.receivers.len()] },
        );
        for sighting in &self.sightings {
            if let Some(round) = rounds.get_mut(round_of(sighting.time)) {
                round.heard[sighting.receiver].push(sighting.rssi_dbm);
                round.truth = Some(sighting.truth);
            }
        }
        Capture { rounds, warnings: self.warnings }
    }
}
