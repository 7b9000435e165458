//! Data as a stream of bytes, whatever blocks hold it.

mod load;
mod unpack;

pub(crate) use load::{Loader, View};
pub(crate) use unpack::zstandard_size;

/// Data in the order of the records, in pieces of the file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stream {
    pub fragments: Vec<Fragment>,
    /// Bytes after decompression.
    pub length: u64,
}

/// A piece of a stream.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fragment {
    /// Where it begins in the stream.
    pub start: u64,
    /// Where its bytes begin in the file.
    pub offset: u64,
    /// Bytes in the file.
    pub stored: u64,
    /// Bytes in the stream.
    pub length: u64,
    pub packing: Packing,
}

/// How the bytes of a fragment are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    Plain,
    /// Compressed; where `columns` is not 0, records of so many bytes were transposed before: first byte of all, second
    /// byte of all, ….
    Packed {
        codec: Codec,
        columns: u32,
    },
}

/// How bytes are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Codec {
    Deflate,
    Zstandard,
    Lz4,
    Unknown(u8),
}

impl Codec {
    /// Bytes that one compressed byte can become at most.
    pub(crate) fn most_expansion(self) -> u64 {
        match self {
            Self::Deflate => 1032,
            // A block of one repeated byte: four bytes for 128 KiB.
            Self::Zstandard | Self::Unknown(_) => 1 << 15,
            Self::Lz4 => 255,
        }
    }
}

impl Stream {
    pub(crate) fn push(&mut self, offset: u64, stored: u64, length: u64, packing: Packing) {
        self.fragments.push(Fragment { start: self.length, offset, stored, length, packing });
        self.length = self.length.saturating_add(length);
    }

    /// Index of the fragment that holds the byte at `place`.
    pub(crate) fn at(&self, place: u64) -> Option<usize> {
        if place >= self.length {
            return None;
        }
        self.fragments.partition_point(|f| f.start <= place).checked_sub(1)
    }
}

impl Fragment {
    pub(crate) fn end(&self) -> u64 {
        self.start.saturating_add(self.length)
    }
}
