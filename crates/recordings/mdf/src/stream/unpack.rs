//! Decompression.

use std::io::Read;

use libdeflater::{DecompressionError, Decompressor};
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;

use super::{Codec, Fragment};
use crate::MdfError;
use crate::bytes::{u16_at, u32_at, u64_at};
use crate::error::damaged;

/// Grows at first by this much: what is announced need not be true.
const FIRST: usize = 1 << 24;

/// Unpacks a fragment. All of it is unpacked, even if only a part is needed, because the checksum covers all of it.
pub(super) fn unpack(codec: Codec, packed: &[u8], fragment: &Fragment, out: &mut Vec<u8>) -> Result<(), MdfError> {
    let length = usize::try_from(fragment.length).map_err(|_| MdfError::TooLarge { numbers: fragment.length })?;
    let done = match codec {
        Codec::Deflate => inflate(packed, length, out),
        Codec::Zstandard => zstandard(packed, length, out),
        Codec::Lz4 => drain(FrameDecoder::new(packed), length, out),
        Codec::Unknown(code) => {
            return Err(MdfError::Unsupported { offset: fragment.offset, feature: format!("compression {code}") });
        }
    };
    match done.map_err(|detail| damaged(fragment.offset, format!("data cannot be unpacked: {detail}")))? {
        done if done < length => {
            Err(damaged(fragment.offset, format!("{length} bytes are announced, the packed data hold {done}")))
        }
        _ => Ok(()),
    }
}

fn inflate(packed: &[u8], length: usize, out: &mut Vec<u8>) -> Result<usize, String> {
    let mut inflater = Decompressor::new();
    let mut room = length.min(out.len().max(FIRST));
    loop {
        out.resize(room, 0);
        match inflater.zlib_decompress(packed, out) {
            Ok(done) => return Ok(done),
            Err(DecompressionError::BadData) => return Err("they are damaged, or their checksum is another".into()),
            Err(DecompressionError::InsufficientSpace) if room == length => {
                return Err(format!("they are damaged, or hold more than the {length} bytes announced"));
            }
            Err(DecompressionError::InsufficientSpace) => room = length.min(room.saturating_mul(4)),
        }
    }
}

fn zstandard(packed: &[u8], length: usize, out: &mut Vec<u8>) -> Result<usize, String> {
    let mut decoder = StreamingDecoder::new(packed).map_err(|e| e.to_string())?;
    let done = drain(&mut decoder, length, out)?;
    let frame = &decoder.decoder;
    let sums = frame.get_checksum_from_data().zip(frame.get_calculated_checksum());
    match frame.is_finished() && sums.is_some_and(|(stored, computed)| stored != computed) {
        true => Err("its checksum is another".into()),
        false => Ok(done),
    }
}

/// The size that the frame of Zstandard beginning with `head` says it becomes, if it says so (RFC 8878, 3.1.1.1).
pub(crate) fn zstandard_size(head: &[u8]) -> Option<u64> {
    let descriptor = *head.strip_prefix(b"\x28\xB5\x2F\xFD")?.first()?;
    let is_single = descriptor & 0x20 != 0;
    let identifier = [0, 1, 2, 4][usize::from(descriptor & 3)];
    let at = 5 + usize::from(!is_single) + identifier;
    match descriptor >> 6 {
        0 => is_single.then(|| head.get(at).map(|&size| u64::from(size))).flatten(),
        1 => (at + 2 <= head.len()).then(|| u64::from(u16_at(head, at)) + 256),
        2 => (at + 4 <= head.len()).then(|| u64::from(u32_at(head, at))),
        _ => (at + 8 <= head.len()).then(|| u64_at(head, at)),
    }
}

/// Takes `length` bytes from a decoder, and what follows them as far as it takes to come upon a checksum.
fn drain(mut decoder: impl Read, length: usize, out: &mut Vec<u8>) -> Result<usize, String> {
    out.clear();
    let mut read = || {
        decoder.by_ref().take(length as u64).read_to_end(out)?;
        decoder.read(&mut [0])
    };
    read().map_err(|e| e.to_string())?;
    Ok(out.len())
}
