//! Recordings read as a stream.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use mcap::records::{self, op};

use super::chunk::{self, ChunkFault};
use super::declared::Declared;
use super::framing::{Frame, Frames, split_record};
use super::info::{FIELDWALK, RecordingInfo};
use super::{Losses, Record};
use crate::error::FormatError;

/// Streams the records of an MCAP recording, in the order in which they were written.
///
/// A file cut anywhere is read up to its last whole chunk; [`losses`](Self::losses) says so afterwards. A chunk whose
/// checksum does not match is left out whole and counted. Topics of other programs are passed over. Memory is one
/// chunk, of 16 MiB at most.
///
/// # Errors
/// An item is an error, and the last one, when reading fails, when the file is not MCAP or has no channel of
/// Fieldwalk's, when it needs a newer version or a decompressor that this build lacks, and when the length of a record
/// is damaged so that what follows cannot be found.
#[derive(Debug)]
pub struct RecordingReader<R> {
    frames: Frames<R>,
    name: PathBuf,
    /// The record read last.
    body: Vec<u8>,
    /// The current chunk's records; those before `cursor` have been handed out.
    chunk: Vec<u8>,
    cursor: usize,
    declared: Declared,
    is_own_profile: bool,
    info: Option<RecordingInfo>,
    losses: Losses,
    is_done: bool,
}

impl RecordingReader<BufReader<File>> {
    /// Opens the recording at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the recording", path, error))?;
        Ok(Self::new(BufReader::with_capacity(64 * 1024, file), path))
    }
}

impl<R: Read> RecordingReader<R> {
    /// Reads the recording that `reader` gives; `name` stands for it in errors.
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Self {
        Self {
            frames: Frames::new(reader),
            name: name.into(),
            body: Vec::new(),
            chunk: Vec::new(),
            cursor: 0,
            declared: Declared::default(),
            is_own_profile: false,
            info: None,
            losses: Losses::default(),
            is_done: false,
        }
    }

    /// What the recording says about itself; known once the first record has been read.
    pub fn info(&self) -> Option<&RecordingInfo> {
        self.info.as_ref()
    }

    /// What was not handed out so far.
    pub fn losses(&self) -> &Losses {
        &self.losses
    }

    /// Whether the file ended before its end; known once the last record has been read.
    pub fn was_cut(&self) -> bool {
        self.losses.was_cut
    }

    /// Bytes held in memory.
    pub fn n_buffered_bytes(&self) -> usize {
        self.body.capacity() + self.chunk.capacity()
    }

    /// The next record of the current chunk.
    fn next_of_chunk(&mut self) -> Option<Record> {
        while self.cursor < self.chunk.len() {
            let unread = &self.chunk[self.cursor..];
            let Some((opcode, body, rest)) = split_record(unread) else {
                self.losses.n_malformed += 1;
                self.cursor = self.chunk.len();
                break;
            };
            self.cursor = self.chunk.len() - rest.len();
            let record = self.declared.take_in(opcode, body, &mut self.losses);
            if record.is_some() {
                return record;
            }
        }
        None
    }

    /// Reads on until there is something in `chunk` or a record; false at the end of the file.
    fn read_frame(&mut self) -> Result<bool, FormatError> {
        let frame = self
            .frames
            .next(&mut self.body)
            .map_err(|error| FormatError::io("read the recording", &self.name, error))?;
        match frame {
            Frame::Record(opcode) => self.take_in(opcode).map_err(|error| error.at_path(&self.name))?,
            Frame::Cut => {
                self.losses.was_cut = true;
                return Ok(false);
            }
            Frame::End if self.is_foreign() => return Err(self.foreign()),
            Frame::End => return Ok(false),
            Frame::NotMcap => return Err(self.not_mcap()),
            Frame::TooLong { len, .. } if self.is_foreign() => {
                let message = format!("not a recording of Fieldwalk's: a record of {len} bytes");
                return Err(FormatError::malformed(message, FOREIGN_REMEDY).at_path(&self.name));
            }
            Frame::TooLong { position, len } => {
                let message = format!("damaged at byte {position}: a record of {len} bytes");
                let remedy = "what comes before it can be used; copy the file again for the rest";
                return Err(FormatError::corrupt(message, remedy).at_path(&self.name));
            }
        }
        Ok(true)
    }

    fn take_in(&mut self, opcode: u8) -> Result<(), FormatError> {
        match opcode {
            op::CHUNK => match chunk::unpack(&self.body, &mut self.chunk) {
                Ok(()) => self.cursor = 0,
                Err(ChunkFault::Corrupt) => {
                    self.losses.n_corrupt_chunks += 1;
                    self.chunk.clear();
                }
                Err(ChunkFault::Compression(kind)) => {
                    return Err(FormatError::malformed(
                        format!("compressed with {kind}, which this build does not read"),
                        "build with the feature `compression`, or decompress it: mcap compress --compression none",
                    ));
                }
            },
            op::HEADER | op::METADATA => match mcap::parse_record(opcode, &self.body) {
                Ok(records::Record::Header(header)) if header.profile == FIELDWALK => {
                    self.is_own_profile = true;
                    self.declared.assume_own();
                }
                Ok(records::Record::Metadata(metadata)) if self.info.is_none() => {
                    self.info = RecordingInfo::from_metadata(metadata)?;
                }
                _ => {}
            },
            _ => {
                // Outside of any chunk: a chunk of one.
                self.chunk.clear();
                self.cursor = 0;
                self.chunk.push(opcode);
                self.chunk.extend_from_slice(&(self.body.len() as u64).to_le_bytes());
                self.chunk.extend_from_slice(&self.body);
            }
        }
        Ok(())
    }

    /// Whether nothing in the file so far is Fieldwalk's.
    fn is_foreign(&self) -> bool {
        !self.is_own_profile && self.info.is_none() && self.declared.is_empty()
    }

    fn foreign(&self) -> FormatError {
        let message = "not a recording of Fieldwalk's: an MCAP file without a channel of ours";
        FormatError::malformed(message, FOREIGN_REMEDY).at_path(&self.name)
    }

    fn not_mcap(&self) -> FormatError {
        FormatError::malformed("not an MCAP file", "give a recording, as Fieldwalk writes them")
            .at_path(&self.name)
    }
}

const FOREIGN_REMEDY: &str =
    "give a recording with topics such as /specific_force and schemas named fieldwalk.*";

impl<R: Read> Iterator for RecordingReader<R> {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_done {
            if let Some(record) = self.next_of_chunk() {
                return Some(Ok(record));
            }
            let read = match self.losses.n_foreign_messages {
                // The first chunk with messages has none of ours.
                1.. if self.is_foreign() => Err(self.foreign()),
                _ => self.read_frame(),
            };
            match read {
                Ok(is_more) => self.is_done = !is_more,
                Err(error) => {
                    self.is_done = true;
                    return Some(Err(error));
                }
            }
        }
        None
    }
}
