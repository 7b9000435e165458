//! Where the batches of an Arrow file or stream are, and what they say of themselves: no number in it is believed
//! before it is compared with the file.

use std::ops::Range;
use std::sync::OnceLock;

use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::read_footer_length;
use arrow_ipc::{Endianness, Message, MessageHeader, root_as_footer, root_as_message};
use arrow_schema::Schema;

use crate::Source;

/// The mark of a message, which old files leave out.
const MARK: [u8; 4] = [0xFF; 4];
/// Bytes at the end of a file: the length of the footer, and what the file began with.
const TRAILER: u64 = 10;

/// A batch of rows, or a part of a dictionary.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    at: u64,
    /// Bytes of its description, with what stands before that.
    length: u64,
    body_length: u64,
    pub(super) is_dictionary: bool,
}

/// The messages of a file or stream.
pub(super) struct Messages {
    pub(super) schema: Schema,
    /// In their order.
    pub(super) places: Vec<Place>,
    /// The rows of the table in each of them, once they were asked for.
    rows: OnceLock<Vec<Range<usize>>>,
    /// True if the end is marked.
    pub(super) is_ended: bool,
}

impl Messages {
    /// The messages that the footer of a file lists.
    pub(super) fn of_file(source: &dyn Source) -> Result<Self, String> {
        let size = source.size().map_err(|e| e.to_string())?;
        let end = size.checked_sub(TRAILER).ok_or("it ends before its footer")?;
        let trailer: [u8; 10] = bytes(source, end, TRAILER)?.try_into().unwrap_or_default();
        let length = read_footer_length(trailer).map_err(|e| e.to_string())? as u64;
        let footer = bytes(source, end.checked_sub(length).ok_or("it is shorter than its footer")?, length)?;
        let footer = root_as_footer(&footer).map_err(|e| format!("its footer cannot be read: {e}"))?;
        let schema = schema(footer.schema())?;
        let place = |block: &arrow_ipc::Block, is_dictionary| {
            let number = |number: i64| u64::try_from(number).ok();
            let (at, length) = (number(block.offset())?, number(block.metaDataLength().into())?);
            let place = Place { at, length, body_length: number(block.bodyLength())?, is_dictionary };
            (at.checked_add(length)?.checked_add(place.body_length)? <= size).then_some(place)
        };
        let dictionaries = footer.dictionaries().into_iter().flatten().map(|block| place(block, true));
        let batches = footer.recordBatches().into_iter().flatten().map(|block| place(block, false));
        let places: Option<Vec<Place>> = dictionaries.chain(batches).collect();
        let places = places.ok_or("its footer announces a batch of more bytes than its size makes plausible")?;
        Ok(Self { schema, places, rows: OnceLock::new(), is_ended: true })
    }

    /// The messages of a stream, one after the other. The end may be left out.
    pub(super) fn of_stream(source: &dyn Source) -> Result<Self, String> {
        let size = source.size().map_err(|e| e.to_string())?;
        let (block, mut at) = next(source, 0)?.ok_or("it holds nothing")?;
        let first = message(&block)?;
        let schema = schema(first.header_as_schema())?;
        let mut messages = Self { schema, places: Vec::new(), rows: OnceLock::new(), is_ended: false };
        while at < size {
            let Some((block, body)) = next(source, at)? else {
                messages.is_ended = true;
                break;
            };
            let message = message(&block)?;
            let is_dictionary = match message.header_type() {
                MessageHeader::RecordBatch => false,
                MessageHeader::DictionaryBatch => true,
                other => return Err(format!("a message {other:?} at byte {at}")),
            };
            let body_length = u64::try_from(message.bodyLength()).unwrap_or(u64::MAX);
            messages.places.push(Place { at, length: body - at, body_length, is_dictionary });
            at = body.saturating_add(body_length);
            if at > size {
                return Err(format!("it ends within the batch at byte {body}"));
            }
        }
        Ok(messages)
    }

    /// The rows of the table in each message, which are none in dictionaries.
    pub(super) fn rows(&self, source: &dyn Source) -> Result<&[Range<usize>], String> {
        if let Some(rows) = self.rows.get() {
            return Ok(rows);
        }
        let (mut all, mut begin) = (Vec::new(), 0_usize);
        for place in &self.places {
            let block = if place.is_dictionary { None } else { Some(place.block(source)?) };
            let batch = block.as_deref().map(message).transpose()?.and_then(|message| message.header_as_record_batch());
            let count = batch.and_then(|batch| usize::try_from(batch.length()).ok()).unwrap_or(0);
            all.push(begin..begin.saturating_add(count));
            begin = begin.saturating_add(count);
        }
        Ok(self.rows.get_or_init(|| all))
    }
}

impl Place {
    /// The description, with what stands before it.
    pub(super) fn block(&self, source: &dyn Source) -> Result<Vec<u8>, String> {
        bytes(source, self.at, self.length)
    }

    /// The bytes of the file that a part of the body is, if they are in it.
    pub(super) fn part(&self, offset: u64, length: u64) -> Result<u64, String> {
        let end = offset.checked_add(length).filter(|end| *end <= self.body_length);
        end.ok_or("a buffer reaches beyond its batch")?;
        Ok(self.at + self.length + offset)
    }

    /// Where it ends.
    pub(super) fn end(&self) -> u64 {
        self.at.saturating_add(self.length).saturating_add(self.body_length)
    }

    /// All of the body.
    pub(super) fn body(&self, source: &dyn Source) -> Result<Vec<u8>, String> {
        bytes(source, self.at + self.length, self.body_length)
    }
}

fn schema(schema: Option<arrow_ipc::Schema<'_>>) -> Result<Schema, String> {
    let schema = schema.ok_or("it does not begin with a schema")?;
    if schema.endianness() != Endianness::Little {
        return Err("its numbers begin with the high byte".into());
    }
    try_fb_to_schema(schema).map_err(|e| e.to_string())
}

/// So many bytes, if they are there.
pub(super) fn bytes(source: &dyn Source, at: u64, length: u64) -> Result<Vec<u8>, String> {
    let size = source.size().map_err(|e| e.to_string())?;
    if at.checked_add(length).is_none_or(|end| end > size) {
        return Err(format!("it ends too early: {length} bytes should be at byte {at}"));
    }
    let mut bytes = vec![0; usize::try_from(length).map_err(|e| e.to_string())?];
    source.read_at(at, &mut bytes).map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// The description at a place of a stream with what stands before it, and where its body begins; none at the end.
fn next(source: &dyn Source, at: u64) -> Result<Option<(Vec<u8>, u64)>, String> {
    let before = if bytes(source, at, 4)? == MARK { 8 } else { 4 };
    let length: [u8; 4] = bytes(source, at + before - 4, 4)?.try_into().unwrap_or_default();
    let length = u64::try_from(i32::from_le_bytes(length)).map_err(|_| format!("no message is at byte {at}"))?;
    if length == 0 {
        return Ok(None);
    }
    Ok(Some((bytes(source, at, before + length)?, at + before + length)))
}

/// The message in a block.
pub(super) fn message(block: &[u8]) -> Result<Message<'_>, String> {
    let before = if block.starts_with(&MARK) { 8 } else { 4 };
    let block = block.get(before..).ok_or("a message is too short")?;
    root_as_message(block).map_err(|e| format!("a message cannot be read: {e}"))
}
