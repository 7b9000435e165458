//! A check of Arrow before it is decoded: a file says how large its batches are, and compressed buffers how large they
//! become, and neither is believed.

use arrow_ipc::reader::read_footer_length;
use arrow_ipc::{Block, CompressionType, Message, RecordBatch, root_as_footer, root_as_message};

use crate::Source;

/// The mark of a message, which old files leave out.
const MARK: [u8; 4] = [0xFF; 4];
/// Bytes at the end of a file: the length of the footer, and what the file began with.
const TRAILER: u64 = 10;

/// Whether a file has the bytes that its footer says of every batch, and every buffer becomes at most `most` bytes; content
/// that is no such file is left to its decoder.
pub(super) fn is_plausible_file(source: &dyn Source, most: i64) -> bool {
    let size = source.size().unwrap_or(0);
    blocks(source).unwrap_or_default().iter().all(|block| {
        let Some((offset, length)) = place(block, size) else { return false };
        // The decoder looks for the buffers where the footer says.
        let Some(block) = bytes(source, offset, length) else { return true };
        message(&block).is_some_and(|message| fits(&message, source, offset.saturating_add(length), most))
    })
}

/// As [`is_plausible_file`], of a stream.
pub(super) fn is_plausible_stream(source: &dyn Source, most: i64) -> bool {
    let mut at = 0;
    while let Some((block, body)) = next(source, at) {
        let Some(message) = message(&block) else { return true };
        if !fits(&message, source, body, most) {
            return false;
        }
        let Ok(length) = u64::try_from(message.bodyLength()) else { return true };
        at = body.saturating_add(length);
    }
    true
}

/// So many bytes, if they are there.
fn bytes(source: &dyn Source, at: u64, length: u64) -> Option<Vec<u8>> {
    if at.checked_add(length)? > source.size().ok()? {
        return None;
    }
    let mut bytes = vec![0; usize::try_from(length).ok()?];
    source.read_at(at, &mut bytes).ok()?;
    Some(bytes)
}

/// Where the batches of a file are.
fn blocks(source: &dyn Source) -> Option<Vec<Block>> {
    let end = source.size().ok()?.checked_sub(TRAILER)?;
    let trailer: [u8; 10] = bytes(source, end, TRAILER)?.try_into().ok()?;
    let length = read_footer_length(trailer).ok()? as u64;
    let footer = bytes(source, end.checked_sub(length)?, length)?;
    let footer = root_as_footer(&footer).ok()?;
    let blocks = footer.recordBatches().into_iter().flatten().chain(footer.dictionaries().into_iter().flatten());
    Some(blocks.copied().collect())
}

/// Where a batch begins, and how long its description is; `None` where it reaches beyond the `size` of the file, as the
/// decoder would only find out after taking memory for it.
fn place(block: &Block, size: u64) -> Option<(u64, u64)> {
    let offset = u64::try_from(block.offset()).ok()?;
    let length = u64::try_from(block.metaDataLength()).ok()?;
    let end = offset.checked_add(length)?.checked_add(u64::try_from(block.bodyLength()).ok()?)?;
    (end <= size).then_some((offset, length))
}

/// The description at a place of a stream with what stands before it, and where its buffers begin.
fn next(source: &dyn Source, at: u64) -> Option<(Vec<u8>, u64)> {
    let first = bytes(source, at, 4)?;
    let before = if first == MARK { 8 } else { 4 };
    let length: [u8; 4] = bytes(source, at.checked_add(before - 4)?, 4)?.try_into().ok()?;
    let whole = before.checked_add(u64::try_from(i32::from_le_bytes(length)).ok()?)?;
    Some((bytes(source, at, whole)?, at.checked_add(whole)?))
}

/// The message in a block.
fn message(block: &[u8]) -> Option<Message<'_>> {
    let before = if block.starts_with(&MARK) { 8 } else { 4 };
    root_as_message(block.get(before..)?).ok()
}

fn fits(message: &Message<'_>, source: &dyn Source, body: u64, most: i64) -> bool {
    let batch: Option<RecordBatch<'_>> = message
        .header_as_record_batch()
        .or_else(|| message.header_as_dictionary_batch().and_then(|dictionary| dictionary.data()));
    let Some((batch, compression)) = batch.and_then(|batch| Some((batch, batch.compression()?))) else { return true };
    // What a byte can become at most: in LZ4, and in a block of Zstandard that repeats one byte.
    let expansion = if compression.codec() == CompressionType::LZ4_FRAME { 1 << 8 } else { 1 << 15 };
    // One without bytes, as where no value is missing, does not even say its size.
    let mut buffers = batch.buffers().into_iter().flatten().filter(|buffer| buffer.length() != 0);
    let mut together = 0_i64;
    buffers.all(|buffer| {
        let most_of_it = buffer.length().saturating_mul(expansion);
        let start = u64::try_from(buffer.offset()).ok().and_then(|start| body.checked_add(start));
        let size: Option<[u8; 8]> = start.and_then(|start| bytes(source, start, 8)?.try_into().ok());
        size.map(i64::from_le_bytes).is_none_or(|size| {
            together = together.saturating_add(size.max(0));
            size <= most_of_it && together <= most
        })
    })
}
