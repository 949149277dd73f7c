//! Chunks: checked whole before anything in them is believed.

use mcap::McapError;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::framing::{MAX_RECORD_BYTES, RECORD_HEAD_BYTES};

/// Why a chunk cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ChunkFault {
    /// The chunk has changed since it was written.
    Corrupt,
    /// This build does not know the compression.
    Compression(String),
}

/// Puts the records of the chunk `body` into `records`, one after another, replacing what was there.
pub(super) fn unpack(body: &[u8], records: &mut Vec<u8>) -> Result<(), ChunkFault> {
    records.clear();
    let Ok(Record::Chunk { header, data }) = mcap::parse_record(op::CHUNK, body) else {
        return Err(ChunkFault::Corrupt);
    };
    if header.uncompressed_size > MAX_RECORD_BYTES as u64 {
        return Err(ChunkFault::Corrupt);
    }
    if header.compression.is_empty() {
        records.extend_from_slice(&data);
    } else {
        decompress(&header, body, records)?;
    }
    let is_whole = records.len() as u64 == header.uncompressed_size;
    // A CRC of zero says that none was computed.
    let is_as_written = header.uncompressed_crc == 0 || crc32fast::hash(records) == header.uncompressed_crc;
    if is_whole && is_as_written { Ok(()) } else { Err(ChunkFault::Corrupt) }
}

/// Reads the chunk as if it were a file's only record.
fn decompress(header: &ChunkHeader, body: &[u8], records: &mut Vec<u8>) -> Result<(), ChunkFault> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_record_length_limit(MAX_RECORD_BYTES);
    let mut reader = LinearReader::new_with_options(options);
    let mut head = [op::CHUNK; RECORD_HEAD_BYTES];
    head[1..].copy_from_slice(&(body.len() as u64).to_le_bytes());
    let (mut head, mut body) = (&head[..], body);
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(n_wanted)) => {
                let source = if head.is_empty() { &mut body } else { &mut head };
                let (now, later) = source.split_at(n_wanted.min(source.len()));
                *source = later;
                reader.insert(n_wanted)[..now.len()].copy_from_slice(now);
                reader.notify_read(now.len());
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                if records.len() + RECORD_HEAD_BYTES + data.len() > MAX_RECORD_BYTES {
                    return Err(ChunkFault::Corrupt);
                }
                records.push(opcode);
                records.extend_from_slice(&(data.len() as u64).to_le_bytes());
                records.extend_from_slice(data);
            }
            Err(McapError::UnsupportedCompression(_)) if matches!(&*header.compression, "lz4" | "zstd") => {
                return Err(ChunkFault::Compression(header.compression.clone()));
            }
            Err(_) => return Err(ChunkFault::Corrupt),
        }
    }
    Ok(())
}
