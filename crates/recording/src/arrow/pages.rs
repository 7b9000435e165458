//! A source as the reader of Parquet takes it.

use std::io::BufReader;

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};

use super::Reader;
use crate::source::{Shared, Stretch};

/// The pages of a file.
pub(super) struct Pages {
    source: Shared,
    size: u64,
}

impl Pages {
    pub(super) fn of(reader: &Reader<'_>) -> Self {
        Self { source: reader.source.clone(), size: reader.size }
    }
}

impl Length for Pages {
    fn len(&self) -> u64 {
        self.size
    }
}

impl ChunkReader for Pages {
    type T = BufReader<Stretch>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        // Headers of pages are short.
        Ok(BufReader::with_capacity(1 << 10, Stretch::new(&self.source, start, self.size)))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let left = self.size.saturating_sub(start);
        if length as u64 > left {
            return Err(std::io::Error::from(std::io::ErrorKind::UnexpectedEof).into());
        }
        let mut bytes = vec![0; length];
        self.source.read_at(start, &mut bytes)?;
        Ok(bytes.into())
    }
}
