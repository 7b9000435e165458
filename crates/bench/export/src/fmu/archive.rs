//! A ZIP archive, the same bytes from the same files: without times, stored or deflated.

use std::io::Write;

use flate2::{Compression, Crc, write::DeflateEncoder};

/// Version 2.0 of the format, which has deflate.
const NEEDED: u16 = 20;
/// Names are in UTF-8.
const FLAGS: u16 = 1 << 11;
/// The first day that the format knows.
const DATE: u16 = 1 << 5 | 1;
const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// An archive in the making.
#[derive(Default)]
pub(super) struct Archive {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    count: u16,
}

impl Archive {
    /// Adds a file under a path with `/`.
    pub(super) fn add(&mut self, path: &str, content: &[u8]) {
        let packed = deflated(content).filter(|packed| packed.len() < content.len());
        let (method, data) = packed.as_deref().map_or((STORED, content), |packed| (DEFLATED, packed));
        self.entry(path, content, method, data);
    }

    /// Adds a file as it is, so that its text can be found in the archive.
    pub(super) fn store(&mut self, path: &str, content: &[u8]) {
        self.entry(path, content, STORED, content);
    }

    fn entry(&mut self, path: &str, content: &[u8], method: u16, data: &[u8]) {
        let mut crc = Crc::new();
        crc.update(content);
        let offset = self.bytes.len() as u32;
        let mut common = Vec::new();
        for number in [NEEDED, FLAGS, method, 0, DATE] {
            common.extend(number.to_le_bytes());
        }
        for number in [crc.sum(), data.len() as u32, content.len() as u32] {
            common.extend(number.to_le_bytes());
        }
        common.extend((path.len() as u16).to_le_bytes());
        common.extend(0u16.to_le_bytes());
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(path.as_bytes());
        self.bytes.extend(data);
        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(NEEDED.to_le_bytes());
        self.directory.extend(&common);
        // No comment, disk 0, no attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(path.as_bytes());
        self.count += 1;
    }

    /// The whole archive.
    pub(super) fn into_bytes(mut self) -> Vec<u8> {
        let start = self.bytes.len() as u32;
        self.bytes.append(&mut self.directory);
        let length = self.bytes.len() as u32 - start;
        self.bytes.extend(b"PK\x05\x06");
        self.bytes.extend([0; 4]);
        self.bytes.extend(self.count.to_le_bytes());
        self.bytes.extend(self.count.to_le_bytes());
        self.bytes.extend(length.to_le_bytes());
        self.bytes.extend(start.to_le_bytes());
        self.bytes.extend([0; 2]);
        self.bytes
    }
}

fn deflated(content: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(content).ok()?;
    encoder.finish().ok()
}
