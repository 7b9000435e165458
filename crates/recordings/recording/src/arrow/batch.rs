//! Columns of a batch of Arrow, read one by one and, where they are not compressed, some rows at a time.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use arrow_array::ArrayRef;
use arrow_ipc::reader::{read_dictionary, read_record_batch};
use arrow_ipc::{
    BodyCompression, BodyCompressionArgs, Buffer, CompressionType, FieldNode, MetadataVersion, RecordBatch,
    RecordBatchArgs,
};
use arrow_schema::{DataType, Field, Schema, UnionMode};
use flatbuffers::FlatBufferBuilder;

use super::messages::{Place, bytes, message};
use crate::Source;
use crate::error::check_room;

/// Buffers begin at multiples of so many bytes.
const ALIGNMENT: usize = 64;

/// The values that columns of codes refer to.
pub(super) type Dictionaries = HashMap<i64, ArrayRef>;

/// A batch of rows.
pub(super) struct Batch<'a> {
    source: &'a dyn Source,
    place: Place,
    schema: &'a Schema,
    version: MetadataVersion,
    record: RecordBatch<'a>,
    /// Of each column, its places among the nodes and the buffers.
    slots: Vec<(usize, usize)>,
    pub(super) rows: usize,
}

impl<'a> Batch<'a> {
    /// The batch that `block`, the description at `place`, is of.
    pub(super) fn new(
        source: &'a dyn Source,
        schema: &'a Schema,
        place: Place,
        block: &'a [u8],
    ) -> Result<Self, String> {
        let message = message(block)?;
        let record = message.header_as_record_batch().ok_or("a batch is none")?;
        let rows = usize::try_from(record.length()).map_err(|_| "a batch of less than no rows")?;
        let mut next = Next { record, version: message.version(), node: 0, buffer: 0, views: 0 };
        let mut slots = Vec::new();
        for field in schema.fields() {
            slots.push((next.node, next.buffer));
            next.skip(field)?;
        }
        Ok(Self { source, place, schema, version: message.version(), record, slots, rows })
    }

    pub(super) fn is_packed(&self) -> bool {
        self.record.compression().is_some()
    }

    fn node(&self, column: usize) -> Result<FieldNode, String> {
        let nodes = self.record.nodes().ok_or("a batch without columns")?;
        let slot = self.slots.get(column).filter(|slot| slot.0 < nodes.len());
        let node = *nodes.get(slot.ok_or("a batch lacks a column")?.0);
        if usize::try_from(node.length()) != Ok(self.rows) {
            return Err(format!("a column of {} rows in a batch of {}", node.length(), self.rows));
        }
        Ok(node)
    }

    /// How many values of a column are missing.
    pub(super) fn nulls(&self, column: usize) -> Result<usize, String> {
        usize::try_from(self.node(column)?.null_count()).map_err(|_| "a column lacks less than no values".into())
    }

    /// Rows of a column; all of them where the batch is compressed.
    pub(super) fn array(
        &self,
        column: usize,
        rows: Range<usize>,
        dictionaries: &Dictionaries,
        most: i64,
    ) -> Result<ArrayRef, String> {
        let field = self.schema.fields().get(column).ok_or("a batch lacks a column")?;
        let nulls = self.node(column)?.null_count();
        let (body, buffers) = self.buffers(column, field, &rows, most)?;
        let nulls = match (nulls, buffers.first()) {
            (1.., Some(marks)) if !self.is_packed() => missing(&body[..marks.length() as usize], rows.len()),
            (nulls, _) => nulls,
        };
        let mut builder = FlatBufferBuilder::new();
        let nodes = builder.create_vector(&[FieldNode::new(rows.len() as i64, nulls)]);
        let buffers = builder.create_vector(&buffers);
        let compression = self.record.compression().map(|packed| {
            let arguments = BodyCompressionArgs { codec: packed.codec(), method: packed.method() };
            BodyCompression::create(&mut builder, &arguments)
        });
        let arguments = RecordBatchArgs {
            length: rows.len() as i64,
            nodes: Some(nodes),
            buffers: Some(buffers),
            compression,
            variadicBufferCounts: None,
        };
        let record = RecordBatch::create(&mut builder, &arguments);
        builder.finish(record, None);
        let record = flatbuffers::root::<RecordBatch<'_>>(builder.finished_data()).map_err(|e| e.to_string())?;
        let schema = Arc::new(Schema::new(vec![field.clone()]));
        let batch = read_record_batch(&body.into(), record, schema, dictionaries, None, &self.version);
        Ok(batch.map_err(|e| e.to_string())?.column(0).clone())
    }

    /// Which values are missing, and the values: the bytes of these rows, and where they are among them.
    fn buffers(
        &self,
        column: usize,
        field: &Field,
        rows: &Range<usize>,
        most: i64,
    ) -> Result<(Vec<u8>, Vec<Buffer>), String> {
        let first = self.slots.get(column).map_or(0, |slot| slot.1);
        let (mut body, mut placed) = (Vec::new(), Vec::new());
        for (index, bits) in [1, bits(field.data_type())?].into_iter().enumerate() {
            let buffers = self.record.buffers().filter(|buffers| first + index < buffers.len());
            let buffer = *buffers.ok_or("a batch lacks a buffer")?.get(first + index);
            let (offset, length) = (u64::try_from(buffer.offset()), u64::try_from(buffer.length()));
            let (Ok(mut offset), Ok(mut length)) = (offset, length) else { return Err("a buffer of no place".into()) };
            if self.is_packed() {
                self.check_packed(offset, length, most)?;
            } else if length > 0 {
                let from = rows.start as u64 * bits / 8;
                let needed = (rows.end as u64 * bits).div_ceil(8);
                if needed > length {
                    return Err(format!("a buffer of {length} bytes for {needed}"));
                }
                (offset, length) = (offset.saturating_add(from), needed - from);
            }
            let read = bytes(self.source, self.place.part(offset, length)?, length)?;
            placed.push(Buffer::new(body.len() as i64, length as i64));
            body.extend_from_slice(&read);
            body.resize(body.len().next_multiple_of(ALIGNMENT), 0);
        }
        Ok((body, placed))
    }

    /// Fails where a compressed buffer says that it becomes more than its bytes can.
    fn check_packed(&self, offset: u64, length: u64, most: i64) -> Result<(), String> {
        // One without bytes, as where no value is missing, does not even say its size.
        let Some(packed) = self.record.compression().filter(|_| length > 0) else { return Ok(()) };
        // What a byte can become at most: in LZ4, and in a block of Zstandard that repeats one byte.
        let expansion = if packed.codec() == CompressionType::LZ4_FRAME { 1 << 8 } else { 1 << 15 };
        let size: [u8; 8] = bytes(self.source, self.place.part(offset, 8)?, 8)?.try_into().unwrap_or_default();
        let size = i64::from_le_bytes(size);
        match size <= most.min((length as i64).saturating_mul(expansion)) {
            true => check_room(usize::try_from(size).unwrap_or(0)),
            false => Err(format!("{length} compressed bytes announce {size}, more than is plausible")),
        }
    }
}

/// Takes over a part of a dictionary.
pub(super) fn learn(
    source: &dyn Source,
    schema: &Schema,
    place: Place,
    most: i64,
    dictionaries: &mut Dictionaries,
) -> Result<(), String> {
    let block = place.block(source)?;
    let message = message(&block)?;
    let dictionary = message.header_as_dictionary_batch().ok_or("a dictionary is none")?;
    let (version, record) = (message.version(), dictionary.data().ok_or("a dictionary without values")?);
    let whole = Batch { source, place, schema, version, record, slots: Vec::new(), rows: 0 };
    for buffer in record.buffers().into_iter().flatten().filter(|_| whole.is_packed()) {
        let number = |number: i64| u64::try_from(number).map_err(|e| e.to_string());
        whole.check_packed(number(buffer.offset())?, number(buffer.length())?, most)?;
    }
    let body = place.body(source)?.into();
    read_dictionary(&body, dictionary, schema, dictionaries, &version).map_err(|e| e.to_string())
}

/// How many of the first values are missing: their bits are not set.
fn missing(marks: &[u8], values: usize) -> i64 {
    let is_missing = |value: &usize| marks.get(value / 8).is_some_and(|bits| bits >> (value % 8) & 1 == 0);
    (0..values).filter(is_missing).count() as i64
}

/// Bits of a value.
fn bits(kind: &DataType) -> Result<u64, String> {
    let width = match kind {
        DataType::Boolean => return Ok(1),
        DataType::Dictionary(keys, _) => keys.primitive_width(),
        other => other.primitive_width(),
    };
    width.map(|bytes| bytes as u64 * 8).ok_or_else(|| format!("values of type {kind}"))
}

/// The way along the nodes and buffers of a batch, which are those of all columns and of what is within these.
struct Next<'a> {
    record: RecordBatch<'a>,
    version: MetadataVersion,
    node: usize,
    buffer: usize,
    views: usize,
}

impl Next<'_> {
    fn skip(&mut self, field: &Field) -> Result<(), String> {
        use DataType::{
            Binary, BinaryView, FixedSizeList, LargeBinary, LargeList, LargeListView, LargeUtf8, List, ListView, Map,
            Null, RunEndEncoded, Struct, Union, Utf8, Utf8View,
        };
        self.node += 1;
        self.buffer += match field.data_type() {
            Null | RunEndEncoded(..) => 0,
            Struct(_) | FixedSizeList(..) => 1,
            Utf8 | Binary | LargeUtf8 | LargeBinary | ListView(_) | LargeListView(_) => 3,
            Utf8View | BinaryView => 2 + self.view()?,
            Union(_, mode) => {
                1 + usize::from(self.version < MetadataVersion::V5) + usize::from(*mode == UnionMode::Dense)
            }
            _ => 2,
        };
        match field.data_type() {
            List(inner) | LargeList(inner) | ListView(inner) | LargeListView(inner) | Map(inner, _) => self.skip(inner),
            FixedSizeList(inner, _) => self.skip(inner),
            Struct(fields) => fields.iter().try_for_each(|field| self.skip(field)),
            Union(fields, _) => fields.iter().try_for_each(|(_, field)| self.skip(field)),
            RunEndEncoded(ends, values) => self.skip(ends).and_then(|()| self.skip(values)),
            // Of dictionaries the values are in messages of their own.
            _ => Ok(()),
        }
    }

    /// How many buffers of text the next column of views has.
    fn view(&mut self) -> Result<usize, String> {
        let counts = self.record.variadicBufferCounts().filter(|counts| self.views < counts.len());
        let count = counts.ok_or("a batch does not say how many buffers its text has")?.get(self.views);
        self.views += 1;
        let all = self.record.buffers().map_or(0, |buffers| buffers.len());
        usize::try_from(count)
            .ok()
            .filter(|count| *count <= all)
            .ok_or_else(|| "text of more buffers than there are".into())
    }
}
