//! Bringing parts of a stream into memory.

use std::ops::Range;

use super::unpack::unpack;
use super::{Fragment, Packing, Stream};
use crate::error::damaged;
use crate::pages::read;
use crate::{MdfError, Source};

/// Reads parts of a stream into buffers that are used over and over.
pub(crate) struct Loader<'a, S: ?Sized> {
    source: &'a S,
    stream: &'a Stream,
    packed: Vec<u8>,
    /// The fragment that `unpacked` holds whole, in the order it was stored.
    unpacked_is: Option<usize>,
    unpacked: Vec<u8>,
    rows: Vec<u8>,
}

/// Bytes of a stream in memory.
#[derive(Debug, Clone, Copy)]
pub(crate) enum View<'a> {
    /// In their order.
    Rows(&'a [u8]),
    /// Whole records, still transposed: the first byte of all `rows`, their second byte, ….
    Columns { bytes: &'a [u8], rows: usize },
}

impl<'a, S: Source + ?Sized> Loader<'a, S> {
    pub(crate) fn new(source: &'a S, stream: &'a Stream) -> Self {
        Self { source, stream, packed: vec![], unpacked_is: None, unpacked: vec![], rows: vec![] }
    }

    /// The bytes of `range`; transposed ones as they are stored, where the range is one fragment of records of `stride`
    /// bytes.
    pub(crate) fn view(&mut self, range: Range<u64>, stride: usize) -> Result<View<'_>, MdfError> {
        let whole = self.stream.at(range.start).filter(|&i| {
            let fragment = &self.stream.fragments[i];
            fragment.start == range.start && fragment.end() == range.end
        });
        if let Some(index) = whole {
            let fragment = self.stream.fragments[index];
            match fragment.packing {
                Packing::Packed { columns: 0, .. } => {
                    self.unpack(index)?;
                    return Ok(View::Rows(&self.unpacked));
                }
                Packing::Packed { columns, .. }
                    if columns as usize == stride && fragment.length.is_multiple_of(stride as u64) =>
                {
                    let rows = fragment.length / stride as u64;
                    self.unpack(index)?;
                    return Ok(View::Columns { bytes: &self.unpacked, rows: rows as usize });
                }
                _ => {}
            }
        }
        let mut rows = std::mem::take(&mut self.rows);
        rows.clear();
        let result = self.append(range, &mut rows);
        self.rows = rows;
        result.map(|()| View::Rows(&self.rows))
    }

    /// Appends the bytes of `range` to `out`.
    pub(crate) fn append(&mut self, range: Range<u64>, out: &mut Vec<u8>) -> Result<(), MdfError> {
        let mut place = range.start;
        while place < range.end {
            let index = self.stream.at(place).ok_or_else(|| damaged(place, "data end before they should"))?;
            let fragment = self.stream.fragments[index];
            let end = fragment.end().min(range.end);
            let (from, to) = (place - fragment.start, end - fragment.start);
            if fragment.packing == Packing::Plain {
                let begin = out.len();
                out.resize(begin + (to - from) as usize, 0);
                read(self.source, fragment.offset + from, &mut out[begin..])?;
            } else {
                self.unpack(index)?;
                self.copy(&fragment, from as usize..to as usize, out);
            }
            place = end;
        }
        Ok(())
    }

    /// Copies a part of the fragment that is unpacked, in the order of the stream.
    fn copy(&self, fragment: &Fragment, part: Range<usize>, out: &mut Vec<u8>) {
        match fragment.packing {
            Packing::Packed { columns, .. } if columns > 0 => {
                let columns = columns as usize;
                let rows = self.unpacked.len() / columns;
                let transposed = rows * columns;
                for place in part.start..part.end.min(transposed) {
                    out.push(self.unpacked[place % columns * rows + place / columns]);
                }
                out.extend_from_slice(&self.unpacked[part.start.max(transposed).min(part.end)..part.end]);
            }
            _ => out.extend_from_slice(&self.unpacked[part]),
        }
    }

    /// Unpacks a fragment.
    fn unpack(&mut self, index: usize) -> Result<(), MdfError> {
        if self.unpacked_is == Some(index) {
            return Ok(());
        }
        self.unpacked_is = None;
        let fragment = self.stream.fragments[index];
        let too_large = |_| MdfError::TooLarge { numbers: fragment.length };
        self.packed.resize(usize::try_from(fragment.stored).map_err(too_large)?, 0);
        read(self.source, fragment.offset, &mut self.packed)?;
        match fragment.packing {
            Packing::Packed { codec, .. } => unpack(codec, &self.packed, &fragment, &mut self.unpacked)?,
            Packing::Plain => std::mem::swap(&mut self.packed, &mut self.unpacked),
        }
        self.unpacked_is = Some(index);
        Ok(())
    }
}
