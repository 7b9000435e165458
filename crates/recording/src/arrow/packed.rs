//! A check of Arrow before it is decoded: a file says how large its batches are, and compressed buffers how large they
//! become, and neither is believed.

use arrow_ipc::reader::read_footer_length;
use arrow_ipc::{Block, CompressionType, Message, RecordBatch, root_as_footer, root_as_message};

/// Bytes of a message's mark and the length of its description.
const PREFIX: usize = 8;

/// Whether a file has the bytes that its footer says of every batch, and every buffer becomes at most `most` bytes; content
/// that is no such file is left to its decoder.
pub(super) fn is_plausible_file(bytes: &[u8], most: i64) -> bool {
    blocks(bytes).unwrap_or_default().iter().all(|block| {
        let Some((offset, body)) = place(block, bytes.len()) else { return false };
        let message = message(bytes, offset).map(|(message, _)| message);
        // The decoder looks for the buffers where the footer says.
        message.zip(bytes.get(body..)).is_none_or(|(message, body)| fits(&message, body, most))
    })
}

/// As [`is_plausible_file`], of a stream.
pub(super) fn is_plausible_stream(bytes: &[u8], most: i64) -> bool {
    let mut at = 0;
    while let Some((message, body)) = message(bytes, at) {
        if !fits(&message, body, most) {
            return false;
        }
        let Ok(length) = usize::try_from(message.bodyLength()) else { return true };
        at = (bytes.len() - body.len()).saturating_add(length);
    }
    true
}

/// Where the batches of a file are.
fn blocks(bytes: &[u8]) -> Option<Vec<Block>> {
    let trailer: [u8; 10] = *bytes.last_chunk()?;
    let end = bytes.len() - trailer.len();
    let footer = bytes.get(end.checked_sub(read_footer_length(trailer).ok()?)?..end)?;
    let footer = root_as_footer(footer).ok()?;
    let blocks = footer.recordBatches().into_iter().flatten().chain(footer.dictionaries().into_iter().flatten());
    Some(blocks.copied().collect())
}

/// Where a batch and its buffers begin; `None` where they reach beyond the `length` of the file, as the decoder would only
/// find out after taking memory for them.
fn place(block: &Block, length: usize) -> Option<(usize, usize)> {
    let offset = usize::try_from(block.offset()).ok()?;
    let buffers = offset.checked_add(usize::try_from(block.metaDataLength()).ok()?)?;
    let end = buffers.checked_add(usize::try_from(block.bodyLength()).ok()?)?;
    (end <= length).then_some((offset, buffers))
}

/// The message at `at`, and what follows its description, as long as that says it is. Old files leave the mark out.
fn message(bytes: &[u8], at: usize) -> Option<(Message<'_>, &[u8])> {
    let prefix = bytes.get(at..)?;
    let (length, start) = match prefix.get(..4)? {
        [0xFF, 0xFF, 0xFF, 0xFF] => (prefix.get(4..PREFIX)?, PREFIX),
        length => (length, 4),
    };
    let length = usize::try_from(i32::from_le_bytes(length.try_into().ok()?)).unwrap_or(usize::MAX);
    let rest = prefix.get(start..)?;
    // The decoder of files does not look at the length.
    Some((root_as_message(rest).ok()?, rest.get(length..).unwrap_or_default()))
}

fn fits(message: &Message<'_>, body: &[u8], most: i64) -> bool {
    let batch: Option<RecordBatch<'_>> = message
        .header_as_record_batch()
        .or_else(|| message.header_as_dictionary_batch().and_then(|dictionary| dictionary.data()));
    let Some((batch, compression)) = batch.and_then(|batch| Some((batch, batch.compression()?))) else { return true };
    // What a byte can become at most: in LZ4, and in a block of Zstandard that repeats one byte.
    let expansion = if compression.codec() == CompressionType::LZ4_FRAME { 1 << 8 } else { 1 << 15 };
    // One without bytes, as where no value is missing, does not even say its size.
    let mut buffers = batch.buffers().into_iter().flatten().filter(|buffer| buffer.length() != 0);
    buffers.all(|buffer| {
        let most = most.min(buffer.length().saturating_mul(expansion));
        let start = usize::try_from(buffer.offset()).ok();
        let size = start.and_then(|start| body.get(start..)?.first_chunk().copied());
        size.is_none_or(|size| i64::from_le_bytes(size) <= most)
    })
}
