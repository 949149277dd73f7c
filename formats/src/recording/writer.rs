//! Recordings written live.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use fieldwalk::time::{Duration, Timestamp};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions, Writer};

use super::channel::Channel;
use super::info::{FIELDWALK, RecordingInfo};
use super::{Record, message};
use crate::error::FormatError;

/// Writes a recording as MCAP, a chunk at a time.
///
/// A chunk holds less than one second of recording time, or 256 KiB, and is handed on and flushed as a whole: what a
/// crash takes is what came after the last chunk. A record that comes late, stamped more than a second before its
/// chunk's first, closes no chunk, but 64 of them do. [`finish`](Self::finish) adds the summary, and so does dropping
/// the writer, which tells nobody whether that worked; a file without summary is read all the same.
///
/// Memory is one chunk, and some 300 bytes of index for each chunk written: about a megabyte an hour.
///
/// # Example
/// ```
/// use fieldwalk::{geometry::Point2, time::Timestamp};
/// use fieldwalk_formats::recording::{Record, RecordingInfo, RecordingReader, RecordingWriter};
///
/// let mut file = Vec::new();
/// let waypoint = Record::Waypoint { time: Timestamp::from_millis(20), point: Point2::new(4.0, 2.5) };
/// let mut writer = RecordingWriter::new(&mut file, "walk.mcap", &RecordingInfo::default())?;
/// writer.write(&waypoint)?;
/// writer.finish()?;
///
/// let read: Vec<Record> = RecordingReader::new(&file[..], "walk.mcap").collect::<Result<_, _>>()?;
/// assert_eq!(read, [waypoint]);
/// # Ok::<(), fieldwalk_formats::FormatError>(())
/// ```
pub struct RecordingWriter<W: Write> {
    writer: Writer<NoSeek<BufWriter<W>>>,
    name: PathBuf,
    chunk: OpenChunk,
    is_declared: [bool; Channel::ALL.len()],
    n_written: u64,
    json: Vec<u8>,
}

/// The chunk being filled.
#[derive(Debug, Default)]
struct OpenChunk {
    first: Option<Timestamp>,
    n_bytes: usize,
    n_late: u32,
}

/// The longest span of recording time in one chunk.
const CHUNK_SPAN: Duration = Duration::from_millis(1_000);

/// A chunk is closed when it has grown to this.
const CHUNK_BYTES: usize = 256 * 1024;

/// A chunk is closed when it holds this many records from long before its first.
const MAX_LATE_RECORDS: u32 = 64;

/// What a message takes beside its JSON: opcode, length, channel, sequence, two times, and its entry in the index.
const MESSAGE_OVERHEAD_BYTES: usize = 1 + 8 + 2 + 4 + 8 + 8 + 16;

impl RecordingWriter<File> {
    /// Starts the recording at `path`, replacing a file that is there.
    ///
    /// # Errors
    /// When the file cannot be created or written.
    pub fn create(path: &Path, info: &RecordingInfo) -> Result<Self, FormatError> {
        let file =
            File::create(path).map_err(|error| FormatError::io("create the recording", path, error))?;
        Self::new(file, path, info)
    }
}

impl<W: Write> RecordingWriter<W> {
    /// Starts a recording in `sink`; `name` stands for it in errors. Chunks are not compressed.
    ///
    /// # Errors
    /// When `sink` takes no bytes.
    pub fn new(sink: W, name: impl Into<PathBuf>, info: &RecordingInfo) -> Result<Self, FormatError> {
        Self::start(sink, name.into(), info, None)
    }

    /// Starts a recording whose chunks are compressed with zstd.
    ///
    /// Phones do not read it: their build has no decompressor.
    ///
    /// # Errors
    /// When `sink` takes no bytes.
    #[cfg(feature = "compression")]
    pub fn new_compressed(
        sink: W,
        name: impl Into<PathBuf>,
        info: &RecordingInfo,
    ) -> Result<Self, FormatError> {
        Self::start(sink, name.into(), info, Some(Compression::Zstd))
    }

    fn start(
        sink: W,
        name: PathBuf,
        info: &RecordingInfo,
        compression: Option<Compression>,
    ) -> Result<Self, FormatError> {
        let options = WriteOptions::new()
            .compression(compression)
            .profile(FIELDWALK)
            .library(concat!("fieldwalk-formats/", env!("CARGO_PKG_VERSION")))
            // Chunks are closed here, not by the crate: it does not know about time.
            .chunk_size(None)
            .disable_seeking(true);
        #[cfg(feature = "compression")]
        let options = options.compression_threads(0);
        let begin = || {
            let mut writer = options.create(NoSeek::new(BufWriter::new(sink)))?;
            writer.write_metadata(&info.to_metadata())?;
            writer.flush()?;
            Ok(writer)
        };
        let writer = begin().map_err(|error| write_error(&name, error))?;
        Ok(Self {
            writer,
            name,
            chunk: OpenChunk::default(),
            is_declared: [false; Channel::ALL.len()],
            n_written: 0,
            json: Vec::new(),
        })
    }

    /// Adds a record.
    ///
    /// Records are read back in the order in which they were written; every value comes back bit for bit, but for the
    /// payload of a NaN.
    ///
    /// # Errors
    /// When the file cannot be written, and then at every later call, or when the record is of a kind that this
    /// version cannot write.
    pub fn write(&mut self, record: &Record) -> Result<(), FormatError> {
        let (channel, log_time) =
            message::encode(record, &mut self.json).map_err(|error| error.at_path(&self.name))?;
        if self.chunk.is_closed_by(record.time()) {
            self.flush()?;
        }
        self.chunk.add(record.time(), self.json.len() + MESSAGE_OVERHEAD_BYTES);
        let header = MessageHeader {
            channel_id: channel.id(),
            // Wraps after 2^32 records; only a hint for viewers.
            sequence: self.n_written as u32,
            log_time,
            publish_time: log_time,
        };
        self.declare(channel)
            .and_then(|()| self.writer.write_to_known_channel(&header, &self.json))
            .map_err(|error| write_error(&self.name, error))?;
        self.n_written += 1;
        Ok(())
    }

    /// Closes the chunk and hands it on: what was written up to here survives a crash.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn flush(&mut self) -> Result<(), FormatError> {
        self.chunk = OpenChunk::default();
        self.writer.flush().map_err(|error| write_error(&self.name, error))
    }

    /// Writes the last chunk and the summary.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self) -> Result<(), FormatError> {
        let finish = |writer: &mut Writer<NoSeek<BufWriter<W>>>| {
            writer.flush()?;
            writer.finish()
        };
        finish(&mut self.writer).map_err(|error| write_error(&self.name, error))?;
        let Self { writer, name, .. } = self;
        let mut sink = writer.into_inner().into_inner();
        sink.flush().map_err(|error| FormatError::io("write the recording", &name, error))
    }

    /// Records written so far.
    pub fn n_written(&self) -> u64 {
        self.n_written
    }

    /// Bytes that wait for their chunk to be closed, its index included.
    pub fn n_buffered_bytes(&self) -> usize {
        self.chunk.n_bytes
    }

    /// Declares the channel, unless that has been done.
    fn declare(&mut self, channel: Channel) -> Result<(), McapError> {
        let is_declared = &mut self.is_declared[channel as usize];
        if !*is_declared {
            let (id, name) = (channel.id(), channel.schema_name());
            self.writer.add_schema_with_id(id, name, "jsonschema", &channel.json_schema())?;
            self.writer.add_channel_with_id(id, id, channel.topic(), "json", &BTreeMap::new())?;
            *is_declared = true;
        }
        Ok(())
    }
}

impl OpenChunk {
    /// Whether the chunk must be closed before a record of `time` is added.
    fn is_closed_by(&self, time: Timestamp) -> bool {
        let Some(first) = self.first else { return false };
        time - first >= CHUNK_SPAN || self.n_bytes >= CHUNK_BYTES || self.n_late >= MAX_LATE_RECORDS
    }

    fn add(&mut self, time: Timestamp, n_bytes: usize) {
        let first = *self.first.get_or_insert(time);
        self.n_late += u32::from(first - time >= CHUNK_SPAN);
        self.n_bytes += n_bytes;
    }
}

fn write_error(name: &Path, error: McapError) -> FormatError {
    let error = match error {
        McapError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    };
    FormatError::io("write the recording", name, error)
}

impl<W: Write> fmt::Debug for RecordingWriter<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordingWriter")
            .field("name", &self.name)
            .field("chunk", &self.chunk)
            .field("n_written", &self.n_written)
            .finish_non_exhaustive()
    }
}
