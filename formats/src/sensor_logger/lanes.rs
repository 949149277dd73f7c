//! An export's sensors side by side, merged by time.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::io::{self, BufReader};
use std::sync::Arc;

use fieldwalk::time::Timestamp;

use super::convention::Metadata;
use super::csv_rows::CsvRows;
use super::entry::{Entry, Sensor};
use super::files::{Files, Onwards};
use super::json_elements::{self, Elements, Found};
use crate::error::FormatError;
use crate::ilc::LineFault;

/// The most files of a folder, or groups of a JSON file, that are merged.
const MAX_LANES: usize = 1_024;

/// The name of the entry that describes the recording.
const METADATA: &str = "Metadata";

/// All sensors, each in the order of its file.
#[derive(Debug)]
pub(super) struct Lanes {
    lanes: Vec<Lane>,
    /// The next row of each lane: its time, its sensor, its lane.
    heads: BinaryHeap<Reverse<(Timestamp, Sensor, usize)>>,
    /// The lanes whose next row is not known yet.
    unread: Vec<usize>,
    sensors: BTreeSet<Sensor>,
    n_refused: u64,
    was_cut: bool,
}

type Row = (u64, Result<Entry, LineFault>);

/// One file's rows, or one group of entries.
#[derive(Debug)]
struct Lane {
    rows: Rows,
    file: usize,
    files: Arc<dyn Files>,
    head: Option<(u64, Entry)>,
}

#[derive(Debug)]
enum Rows {
    Csv { sensor: Sensor, rows: Box<CsvRows<BufReader<Onwards>>> },
    Json { elements: Elements<BufReader<Onwards>>, n_read: u64, end: u64 },
}

/// Entries of one sensor one after the other in a JSON file.
#[derive(Clone, Copy, Debug)]
struct Group {
    begin: u64,
    first: u64,
    end: u64,
}

impl Lanes {
    /// The CSV files of a folder.
    pub(super) fn of_folder(files: &Arc<dyn Files>) -> Result<(Self, Metadata), FormatError> {
        let mut metadata = Metadata::default();
        let mut lanes = Vec::new();
        let mut sensors = BTreeSet::new();
        for file in 0..files.len() {
            let name = files.name(file);
            let stem = name.rsplit_once('.').map_or(name.as_str(), |(stem, _)| stem);
            let open = || CsvRows::new(Onwards::from(files, file, 0));
            let failed = |error| read_error(&**files, file, error);
            if stem.eq_ignore_ascii_case(METADATA) {
                let row = open().and_then(|mut rows| rows.next_named()).map_err(failed)?;
                metadata.0.extend(row.unwrap_or_default());
            } else if let Some(sensor) = Sensor::named(stem) {
                if lanes.len() == MAX_LANES {
                    let message = format!("more than {MAX_LANES} files of sensors");
                    return Err(FormatError::malformed(message, "export as JSON"));
                }
                let rows = Rows::Csv { sensor, rows: Box::new(open().map_err(failed)?) };
                sensors.insert(sensor);
                lanes.push(Lane { rows, file, files: Arc::clone(files), head: None });
            }
        }
        Ok((Self::new(lanes, sensors, 0, false), metadata))
    }

    /// The entries of a JSON file, which the app writes sensor after sensor: read once to find where each begins.
    pub(super) fn of_json(files: &Arc<dyn Files>) -> Result<(Self, Metadata), FormatError> {
        let mut metadata = Metadata::default();
        let mut elements = Elements::new(Onwards::from(files, 0, 0), 0);
        let mut groups: Vec<Group> = Vec::new();
        let (mut sensors, mut current) = (BTreeSet::new(), None);
        let (mut n_read, mut n_refused, mut was_cut) = (0, 0, false);
        loop {
            let found = elements.next().map_err(|error| read_error(&**files, 0, error))?;
            n_read += 1;
            let sensor = match found {
                Found::End => break,
                Found::Torn => {
                    was_cut = true;
                    break;
                }
                Found::Foreign(position) => {
                    let message =
                        format!("not an export of Sensor Logger: byte {position} is between no two objects");
                    return Err(FormatError::malformed(message, "export as JSON or as CSV again")
                        .at_path(files.path(0)));
                }
                // Its sensor cannot be told.
                Found::TooLong(_) => {
                    n_refused += 1;
                    continue;
                }
                Found::Object(_) => match json_elements::sensor_name(elements.element()) {
                    Err(_) => {
                        n_refused += 1;
                        continue;
                    }
                    Ok(Some(name)) if name.eq_ignore_ascii_case(METADATA) => {
                        metadata.0.extend(json_elements::texts(elements.element()));
                        None
                    }
                    Ok(name) => name.and_then(|name| Sensor::named(&name)),
                },
            };
            let Found::Object(begin) = found else { continue };
            sensors.extend(sensor);
            if sensor != current {
                if let Some(last) = groups.last_mut().filter(|group| group.end == u64::MAX) {
                    last.end = begin;
                }
                if sensor.is_some() && groups.len() <= MAX_LANES {
                    groups.push(Group { begin, first: n_read - 1, end: u64::MAX });
                }
                current = sensor;
            }
        }
        if groups.len() > MAX_LANES {
            // Mixed by time already, or nearly: taken as it comes.
            groups.truncate(1);
            if let Some(all) = groups.first_mut() {
                all.end = u64::MAX;
            }
        }
        let lane = |group: Group| Lane {
            rows: Rows::Json {
                elements: Elements::new(Onwards::from(files, 0, group.begin), group.begin),
                n_read: group.first,
                end: group.end,
            },
            file: 0,
            files: Arc::clone(files),
            head: None,
        };
        let lanes = groups.into_iter().map(lane).collect();
        Ok((Self::new(lanes, sensors, n_refused, was_cut), metadata))
    }

    fn new(lanes: Vec<Lane>, sensors: BTreeSet<Sensor>, n_refused: u64, was_cut: bool) -> Self {
        let unread = (0..lanes.len()).collect();
        Self { lanes, heads: BinaryHeap::new(), unread, sensors, n_refused, was_cut }
    }

    /// Whether there is a file or an entry of `sensor`.
    pub(super) fn has(&self, sensor: Sensor) -> bool {
        self.sensors.contains(&sensor)
    }

    /// Entries that could not be told apart at all.
    pub(super) fn n_refused(&self) -> u64 {
        self.n_refused
    }

    /// Whether the file ends within an entry.
    pub(super) fn was_cut(&self) -> bool {
        self.was_cut
    }

    /// The earliest row of all lanes, with its number in its file; a row that cannot be read comes as it is met.
    pub(super) fn next(&mut self) -> Result<Option<Row>, FormatError> {
        while let Some(&index) = self.unread.last() {
            let lane = &mut self.lanes[index];
            match lane.rows.next().map_err(|error| read_error(&*lane.files, lane.file, error))? {
                Some((number, Err(fault))) => return Ok(Some((number, Err(fault)))),
                Some((number, Ok(entry))) => {
                    self.heads.push(Reverse((entry.time, entry.sensor, index)));
                    lane.head = Some((number, entry));
                }
                None => {}
            }
            self.unread.pop();
        }
        let Some(Reverse((_, _, index))) = self.heads.pop() else { return Ok(None) };
        self.unread.push(index);
        Ok(self.lanes[index].head.take().map(|(number, entry)| (number, Ok(entry))))
    }
}

impl Rows {
    fn next(&mut self) -> io::Result<Option<Row>> {
        match self {
            Self::Csv { sensor, rows } => rows.next_entry(*sensor),
            Self::Json { elements, n_read, end } => loop {
                let (position, is_too_long) = match elements.next()? {
                    Found::Object(position) => (position, false),
                    Found::TooLong(position) => (position, true),
                    Found::End | Found::Torn | Found::Foreign(_) => return Ok(None),
                };
                if position >= *end {
                    return Ok(None);
                }
                *n_read += 1;
                if is_too_long {
                    // Counted as the file was read first.
                    continue;
                }
                let object = elements.element();
                // Torn and unnamed ones were counted as the file was read first.
                let Ok(Some(name)) = json_elements::sensor_name(object) else { continue };
                let Some(sensor) = Sensor::named(&name) else { continue };
                let entry = json_elements::fields(object).and_then(|fields| fields.entry(sensor));
                return Ok(Some((*n_read, entry)));
            },
        }
    }
}

fn read_error(files: &dyn Files, file: usize, error: io::Error) -> FormatError {
    FormatError::io("read the export", &files.path(file), error)
}
