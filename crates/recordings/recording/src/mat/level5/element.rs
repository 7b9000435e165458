//! Elements: their tags and numbers, and why one is not read.

/// Deflate cannot expand more than this.
pub(super) const MAX_EXPANSION: usize = 1032;
pub(super) const MATRIX: u32 = 14;
pub(super) const COMPRESSED: u32 = 15;

/// An unsigned number of 4 bytes.
pub(super) fn uint4(bytes: &[u8], big: bool) -> u32 {
    let bytes = bytes.first_chunk().copied().unwrap_or_default();
    if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

/// Why a variable is not read.
pub(super) enum Fault {
    Damaged(String),
    /// The name as far as known, and what is not supported about it.
    Unsupported(String, String),
}

impl Fault {
    pub(super) fn detail(self) -> String {
        match self {
            Self::Damaged(detail) | Self::Unsupported(_, detail) => detail,
        }
    }
}

pub(super) fn broken<T>(detail: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Damaged(detail.into()))
}

/// Bytes of a number of the type that a tag states.
pub(super) fn width(kind: u32) -> Result<usize, Fault> {
    match kind {
        1 | 2 => Ok(1),
        3 | 4 => Ok(2),
        5..=7 => Ok(4),
        9 | 12 | 13 => Ok(8),
        other => broken(format!("numbers of type {other}")),
    }
}

/// Appends numbers of the type that the tag states.
pub(super) fn convert(kind: u32, content: &[u8], big: bool, out: &mut Vec<f64>) {
    // Numbers of 64 bits above 2^53 are rounded, which is said.
    match kind {
        1 => convert_each(content, big, out, |b| f64::from(i8::from_le_bytes(b))),
        2 => convert_each(content, big, out, |b| f64::from(u8::from_le_bytes(b))),
        3 => convert_each(content, big, out, |b| f64::from(i16::from_le_bytes(b))),
        4 => convert_each(content, big, out, |b| f64::from(u16::from_le_bytes(b))),
        5 => convert_each(content, big, out, |b| f64::from(i32::from_le_bytes(b))),
        6 => convert_each(content, big, out, |b| f64::from(u32::from_le_bytes(b))),
        7 => convert_each(content, big, out, |b| f64::from(f32::from_le_bytes(b))),
        12 => convert_each(content, big, out, |b| i64::from_le_bytes(b) as f64),
        13 => convert_each(content, big, out, |b| u64::from_le_bytes(b) as f64),
        _ => convert_each(content, big, out, f64::from_le_bytes),
    }
}

fn convert_each<const N: usize>(content: &[u8], big: bool, out: &mut Vec<f64>, number: fn([u8; N]) -> f64) {
    let (chunks, _) = content.as_chunks::<N>();
    out.extend(chunks.iter().map(|&(mut chunk)| {
        if big {
            chunk.reverse();
        }
        number(chunk)
    }));
}
