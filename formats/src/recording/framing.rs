//! MCAP's outermost layer: records one after another, each with its length before it.

use std::io::{self, Read};

use mcap::MAGIC;
use mcap::records::op;

/// Longest record that is taken into memory; a chunk of a second has some 100 KB.
pub(super) const MAX_RECORD_BYTES: usize = 16 * 1024 * 1024;

/// Opcode and length.
pub(super) const RECORD_HEAD_BYTES: usize = 1 + 8;

/// What comes next in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Frame {
    /// A record; its body is in the buffer.
    Record(u8),
    /// The file ended as it should.
    End,
    /// The file ended before its footer, or within it.
    Cut,
    /// The file does not begin as MCAP does.
    NotMcap,
    /// A record of a kind that must be read whole says to be longer than any.
    TooLong {
        /// Where in the file the record begins.
        position: u64,
        len: u64,
    },
}

/// Takes a stream apart into records.
#[derive(Debug)]
pub(super) struct Frames<R> {
    reader: R,
    position: u64,
}

impl<R: Read> Frames<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, position: 0 }
    }

    /// Brings the next record's body into `body`.
    ///
    /// Memory follows the bytes that are there, not those that a length promises.
    pub(super) fn next(&mut self, body: &mut Vec<u8>) -> io::Result<Frame> {
        body.clear();
        if self.position == 0 {
            self.read_up_to(MAGIC.len() as u64, body)?;
            if !MAGIC.starts_with(body) {
                return Ok(Frame::NotMcap);
            }
            if body.len() < MAGIC.len() {
                return Ok(Frame::Cut);
            }
        }
        loop {
            body.clear();
            let position = self.position;
            self.read_up_to(RECORD_HEAD_BYTES as u64, body)?;
            let Some((opcode, len)) = head(body) else { return Ok(Frame::Cut) };
            if !is_read(opcode) {
                // Indices and attachments: passed over, however long.
                if self.skip(len)? < len {
                    return Ok(Frame::Cut);
                }
                continue;
            }
            if len > MAX_RECORD_BYTES as u64 {
                return Ok(Frame::TooLong { position, len });
            }
            body.clear();
            if self.read_up_to(len, body)? < len {
                return Ok(Frame::Cut);
            }
            if opcode == op::FOOTER {
                body.clear();
                self.read_up_to(MAGIC.len() as u64, body)?;
                return Ok(if body == MAGIC { Frame::End } else { Frame::Cut });
            }
            return Ok(Frame::Record(opcode));
        }
    }

    fn read_up_to(&mut self, len: u64, body: &mut Vec<u8>) -> io::Result<u64> {
        let n_read = self.reader.by_ref().take(len).read_to_end(body)? as u64;
        self.position += n_read;
        Ok(n_read)
    }

    fn skip(&mut self, len: u64) -> io::Result<u64> {
        let n_skipped = io::copy(&mut self.reader.by_ref().take(len), &mut io::sink())?;
        self.position += n_skipped;
        Ok(n_skipped)
    }
}

/// The first record of `bytes`: its opcode and body, and what follows it; `None` when the bytes end within it.
pub(super) fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (opcode, len) = head(bytes)?;
    let body = &bytes[RECORD_HEAD_BYTES..];
    let (body, rest) = body.split_at_checked(usize::try_from(len).ok()?)?;
    Some((opcode, body, rest))
}

fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let (&opcode, rest) = bytes.split_first()?;
    Some((opcode, u64::from_le_bytes(*rest.first_chunk()?)))
}

fn is_read(opcode: u8) -> bool {
    matches!(
        opcode,
        op::HEADER | op::FOOTER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::METADATA
    )
}
