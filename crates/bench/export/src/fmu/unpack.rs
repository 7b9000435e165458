//! A file out of a ZIP archive, as far as FMUs need it: found by the archive's directory, stored or deflated.

use std::io::Read as _;

use flate2::read::DeflateDecoder;

/// No model file is larger.
const LARGEST: u64 = 16 << 20;
const DIRECTORY_END: &[u8] = b"PK\x05\x06";
const ENTRY: &[u8] = b"PK\x01\x02";
const FILE: &[u8] = b"PK\x03\x04";
/// Bytes of the fixed parts of these records.
const DIRECTORY_END_LENGTH: usize = 22;
const ENTRY_LENGTH: usize = 46;
const FILE_LENGTH: usize = 30;

/// Tells whether bytes begin as an archive does.
pub(super) fn is_archive(bytes: &[u8]) -> bool {
    bytes.starts_with(FILE)
}

/// The content of the file of this path; `None` where there is none that can be read.
pub(super) fn content(bytes: &[u8], path: &str) -> Option<Vec<u8>> {
    let last = bytes.len().checked_sub(DIRECTORY_END_LENGTH)?;
    // A comment of up to 64 KiB may follow.
    let earliest = last.saturating_sub(usize::from(u16::MAX));
    let end = (earliest..=last).rev().find(|at| bytes[*at..].starts_with(DIRECTORY_END))?;
    let mut at = whole(bytes, end + 16, 4)?;
    for _ in 0..whole(bytes, end + 10, 2)? {
        if !bytes.get(at..)?.starts_with(ENTRY) {
            return None;
        }
        let [name, extra, comment] = [28, 30, 32].map(|offset| whole(bytes, at + offset, 2));
        let (from, name) = (at + ENTRY_LENGTH, name?);
        if bytes.get(from..from + name)? == path.as_bytes() {
            return unpacked(bytes, at);
        }
        at = from + name + extra? + comment?;
    }
    None
}

/// The content of the entry of the directory at a position.
fn unpacked(bytes: &[u8], entry: usize) -> Option<Vec<u8>> {
    let (method, size, file) =
        (whole(bytes, entry + 10, 2)?, whole(bytes, entry + 20, 4)?, whole(bytes, entry + 42, 4)?);
    let from = file + FILE_LENGTH + whole(bytes, file + 26, 2)? + whole(bytes, file + 28, 2)?;
    let packed = bytes.get(from..from.checked_add(size)?)?;
    match method {
        0 => Some(packed.to_vec()),
        8 => {
            let mut content = Vec::new();
            DeflateDecoder::new(packed).take(LARGEST).read_to_end(&mut content).ok()?;
            Some(content)
        }
        _ => None,
    }
}

/// A number of so many bytes, the lowest first.
fn whole(bytes: &[u8], at: usize, count: usize) -> Option<usize> {
    let digits = bytes.get(at..at.checked_add(count)?)?;
    Some(digits.iter().rev().fold(0, |sum, digit| sum << 8 | usize::from(*digit)))
}
