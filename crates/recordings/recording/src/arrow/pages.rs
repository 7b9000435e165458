//! A source as the reader of Parquet takes it.

use std::io::{self, BufReader, Read};

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};

use super::reader::Reader;
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

/// The bytes of a page's header and what follows, of which the end of the file is no part.
///
/// The reader of headers skips a list of as many numbers as the list announces, and takes an end of the file in a
/// number for a number: an error there keeps it from counting to 2³¹.
pub(super) struct Header(Stretch);

impl Read for Header {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer)? {
            0 if !buffer.is_empty() => Err(io::ErrorKind::UnexpectedEof.into()),
            count => Ok(count),
        }
    }
}

impl ChunkReader for Pages {
    type T = BufReader<Header>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        // Headers of pages are short.
        Ok(BufReader::with_capacity(1 << 10, Header(Stretch::new(&self.source, start, self.size))))
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// A list in a header, announced as long as can be, ends with the file.
    #[test]
    fn regress_a_header_does_not_go_on_after_the_end() {
        let pages = Pages { source: Arc::new(vec![7_u8; 10]), size: 10 };
        let mut header = pages.get_read(6).unwrap();
        let mut bytes = [0; 4];
        header.read_exact(&mut bytes).unwrap();
        assert_eq!(bytes, [7; 4]);
        let end = io::copy(&mut header.by_ref().take(8), &mut io::sink()).unwrap_err();
        assert_eq!(end.kind(), io::ErrorKind::UnexpectedEof);
    }
}
