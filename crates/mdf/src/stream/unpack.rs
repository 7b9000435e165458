//! Decompression.

use std::io::Read;

use flate2::{Decompress, FlushDecompress, Status};
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;

use super::{Codec, Fragment};
use crate::MdfError;
use crate::error::damaged;

/// Grows at first by this much: what is announced need not be true.
const FIRST: usize = 1 << 24;

/// Unpacks the first `needed` bytes; those of deflate and LZ4 are checked against the checksum, if there is no more. (The
/// decoder of Zstandard passes over checksums.)
pub(super) fn unpack(
    codec: Codec,
    packed: &[u8],
    fragment: &Fragment,
    needed: u64,
    out: &mut Vec<u8>,
) -> Result<(), MdfError> {
    let length = usize::try_from(needed).map_err(|_| MdfError::TooLarge { numbers: needed })?;
    let done = match codec {
        Codec::Deflate => inflate(packed, length, out),
        Codec::Zstandard => {
            StreamingDecoder::new(packed).map_err(|e| e.to_string()).and_then(|decoder| drain(decoder, length, out))
        }
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
    let mut inflater = Decompress::new(true);
    out.resize(length.min(out.len().max(FIRST)), 0);
    let mut done = 0;
    loop {
        let rest = packed.get(inflater.total_in() as usize..).unwrap_or_default();
        let status = inflater.decompress(rest, &mut out[done..], FlushDecompress::Finish);
        let status = status.map_err(|e| e.to_string())?;
        done = inflater.total_out() as usize;
        if status == Status::StreamEnd || done < out.len() || done == length {
            return Ok(done);
        }
        out.resize(length.min(done.saturating_mul(4)), 0);
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
