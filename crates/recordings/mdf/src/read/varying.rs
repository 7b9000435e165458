//! Values of varying length.

use super::cursor::Cursor;
use crate::bytes::u32_at;
use crate::error::damaged;
use crate::model::Encoding;
use crate::stream::Stream;
use crate::text::decoded;
use crate::values::{Blobs, Values};
use crate::{MdfError, Source};

/// Values of varying length in the order of their records.
#[derive(Debug, Default)]
pub(crate) struct Varying {
    bytes: Vec<u8>,
    /// Where each begins in `bytes`; in the file four bytes of length stand before each.
    starts: Vec<usize>,
}

impl Varying {
    pub(crate) fn push(&mut self, value: &[u8]) {
        self.starts.push(self.bytes.len());
        self.bytes.extend_from_slice(value);
    }

    fn get(&self, index: usize) -> Option<&[u8]> {
        let start = *self.starts.get(index)?;
        let end = self.starts.get(index + 1).copied().unwrap_or(self.bytes.len());
        self.bytes.get(start..end)
    }

    /// Index of the value whose length stands at `place`.
    fn index_of(&self, place: u64) -> Option<usize> {
        let at = |index: usize| self.starts[index] as u64 + 4 * index as u64;
        let (mut low, mut high) = (0, self.starts.len());
        while low < high {
            let middle = low.midpoint(high);
            if at(middle) < place { low = middle + 1 } else { high = middle }
        }
        (low < self.starts.len() && at(low) == place).then_some(low)
    }

    /// The value at a place, and that of no place; `None` where there is no such value.
    fn indexed(&self, place: f64) -> Option<Option<usize>> {
        if place.is_nan() { Some(None) } else { self.index_of(place as u64).map(Some) }
    }

    /// The values at `places`; those of the same number where the places were never brought up to date.
    pub(crate) fn gather(&self, places: &[f64], encoding: Option<Encoding>) -> Result<Values, MdfError> {
        let is_stale = places.len() > 1 && places.iter().all(|&p| p == places[0]);
        let by_place: Option<Vec<_>> = places.iter().map(|&p| self.indexed(p)).collect();
        let indices = match by_place {
            Some(indices) if !is_stale => indices,
            // One more was written than was referred to, where the file ends between the two.
            _ if (places.len()..=places.len() + 1).contains(&self.starts.len()) => {
                (0..places.len()).map(Some).collect()
            }
            _ => return Err(damaged(0, "values of varying length are missing")),
        };
        let mut out = Collector::new(encoding);
        for (row, index) in indices.into_iter().enumerate() {
            out.put(row, index.and_then(|i| self.get(i)).unwrap_or_default());
        }
        Ok(out.finish(places.len()))
    }
}

/// The values at `places` of a stream.
pub(crate) fn gather<S: Source + ?Sized>(
    source: &S,
    stream: &Stream,
    places: &[f64],
    encoding: Option<Encoding>,
) -> Result<Values, MdfError> {
    let mut out = Collector::new(encoding);
    let mut order: Vec<usize> = (0..places.len()).collect();
    if !places.is_sorted() {
        order.sort_by(|&a, &b| places[a].total_cmp(&places[b]));
    }
    let mut cursor = Cursor::new(source, stream);
    let (mut total, mut last) = (0_u64, None);
    for row in order {
        let place = places[row];
        if place.is_nan() || stream.length == 0 {
            continue;
        }
        if last == Some(place) {
            out.again(row);
            continue;
        }
        let length = u32_at(cursor.at(place as u64, 4)?, 0) as usize;
        total += 4 + length as u64;
        if total > stream.length {
            return Err(damaged(place as u64, "values of varying length lie upon each other"));
        }
        out.put(row, &cursor.at(place as u64, 4 + length)?[4..]);
        last = Some(place);
    }
    Ok(out.finish(places.len()))
}

/// Text or bytes, put together in any order of rows.
pub(crate) struct Collector {
    encoding: Option<Encoding>,
    blobs: Blobs,
}

impl Collector {
    pub(crate) fn new(encoding: Option<Encoding>) -> Self {
        Self { encoding, blobs: Blobs::default() }
    }

    pub(crate) fn put(&mut self, row: usize, value: &[u8]) {
        match self.encoding {
            Some(encoding) => self.blobs.set(row, decoded(value, encoding).as_bytes()),
            None => self.blobs.set(row, value),
        }
    }

    /// The value put last, once more.
    fn again(&mut self, row: usize) {
        self.blobs.set_again(row);
    }

    pub(crate) fn finish(mut self, rows: usize) -> Values {
        self.blobs.extend_to(rows);
        match self.encoding {
            Some(_) => Values::Text(self.blobs.into_texts()),
            None => Values::Bytes(self.blobs),
        }
    }
}
