//! What MDF 3 and MDF 4 share: the identification block, byte access, falcon_mdf's errors and values in our terms, and
//! the order of work ([`plan`]).

pub(crate) mod plan;

use falcon_mdf::{Mf4Error, SignalValues};

use crate::{RecordingError, SkipReason};

/// Version times one hundred from the identification block.
pub(crate) fn version(file: &str, bytes: &[u8]) -> Result<u16, RecordingError> {
    let Some(id) = bytes.get(..64) else {
        return Err(truncated(file, 0, 64, bytes.len() as u64));
    };
    let text = latin1(&id[8..16]);
    let unsupported = || RecordingError::UnsupportedVersion {
        file: file.into(),
        version: text.trim().to_owned(),
    };
    let (major, minor) = text.trim().split_once('.').ok_or_else(unsupported)?;
    let major: u16 = major.parse().map_err(|_| unsupported())?;
    let digits: String = minor.chars().take_while(char::is_ascii_digit).collect();
    let minor: u16 = digits.parse().map_err(|_| unsupported())?;
    if !(2..=4).contains(&major) || minor > 99 {
        return Err(unsupported());
    }
    Ok(major * 100 + minor)
}

/// Text of the single-byte encoding, up to the first NUL.
pub(crate) fn latin1(bytes: &[u8]) -> String {
    let text = bytes.iter().take_while(|&&b| b != 0);
    text.map(|&b| char::from(b)).collect()
}

pub(crate) fn truncated(file: &str, offset: u64, expected: u64, length: u64) -> RecordingError {
    RecordingError::Truncated {
        file: file.into(),
        offset,
        expected,
        available: length.saturating_sub(offset),
    }
}

/// `n` bytes at `offset`.
pub(crate) fn slice<'a>(
    file: &str,
    bytes: &'a [u8],
    offset: u64,
    n: u64,
) -> Result<&'a [u8], RecordingError> {
    let range = offset.checked_add(n).and_then(|end| {
        let (start, end) = (usize::try_from(offset).ok()?, usize::try_from(end).ok()?);
        bytes.get(start..end)
    });
    range.ok_or_else(|| truncated(file, offset, n, bytes.len() as u64))
}

/// A failure of falcon_mdf in our terms.
pub(crate) fn failure(file: &str, error: Mf4Error) -> RecordingError {
    let file = file.to_owned();
    let damaged = |offset, detail| RecordingError::Damaged {
        file: file.clone(),
        offset,
        detail,
    };
    match error {
        Mf4Error::TruncatedFile {
            offset,
            expected,
            actual,
        } => RecordingError::Truncated {
            file,
            offset,
            expected: expected as u64,
            available: actual as u64,
        },
        Mf4Error::UnsupportedVersion { major, minor } => RecordingError::UnsupportedVersion {
            file,
            version: format!("{major}.{minor:02}"),
        },
        Mf4Error::Unsupported { feature, detail } => RecordingError::Unsupported {
            file,
            feature: format!("{feature} ({detail})"),
        },
        Mf4Error::InvalidBlockId {
            offset,
            expected,
            actual,
        } => damaged(
            Some(offset),
            format!(
                "a block \"{expected}\" should be there, found \"{}\"",
                actual.escape_debug()
            ),
        ),
        Mf4Error::CyclicLink { chain, offset } => damaged(
            Some(offset),
            format!("the chain {chain} leads back to itself"),
        ),
        other => damaged(None, other.to_string()),
    }
}

/// Samples as numbers, or what they are instead.
pub(crate) fn numbers(values: SignalValues) -> Result<Vec<f64>, SkipReason> {
    let kind = match &values {
        SignalValues::Bytes { .. } | SignalValues::VarBytes { .. } => "bytes",
        SignalValues::Str(_) => "text",
        SignalValues::Complex { .. } => "complex numbers",
        SignalValues::CanopenDate(_) | SignalValues::CanopenTime(_) => "dates",
        SignalValues::Array { .. } | SignalValues::ArrayVarLen { .. } => "arrays",
        _ => {
            return Ok(match values {
                SignalValues::F64(samples) => samples,
                integers => integers.to_f64(),
            });
        }
    };
    Err(SkipReason::NotNumeric { kind: kind.into() })
}

/// Guards against files whose channels overlap so much that decoding would need memory out of proportion: a sample
/// takes at least one bit of a record, and records are seldom described more than a few times over.
pub(crate) fn plausible(
    file: &str,
    channels: usize,
    samples: u64,
    stream_bytes: u64,
) -> Result<(), RecordingError> {
    let decoded = (channels as u64).saturating_mul(samples);
    if decoded <= stream_bytes.saturating_mul(32).saturating_add(4096) {
        return Ok(());
    }
    Err(RecordingError::Damaged {
        file: file.into(),
        offset: None,
        detail: format!(
            "{channels} channels of {samples} samples are described on {stream_bytes} bytes of data"
        ),
    })
}
