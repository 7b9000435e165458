//! Level 4: matrices one after the other, each behind a header of 20 bytes.

use super::value::{MAX_TEXT, Value, text_rows};
use super::wanted::{Need, Wanted};
use crate::error::of_content;
use crate::source;
use crate::{RecordingError, Source};

const HEADER: usize = 20;
/// Bytes of numbers converted at once; a multiple of every width.
const PIECE: usize = 1 << 16;
/// The longest name, with the NUL at its end.
const MAX_NAME: usize = 128;

/// The header of a matrix.
struct Header {
    big: bool,
    /// Code of the type that a number is stored as: 0 to 5.
    number: u32,
    /// 0 numbers, 1 text, 2 sparse.
    content: u32,
    rows: usize,
    columns: usize,
    is_complex: bool,
    name: usize,
}

impl Header {
    /// The header at the start of `bytes`, if it is one.
    fn read(bytes: &[u8]) -> Option<Self> {
        let (words, _) = bytes.get(..HEADER)?.as_chunks::<4>();
        let kind = u32::from_le_bytes(words[0]);
        let big = kind > 9999;
        let word = |at: usize| if big { u32::from_be_bytes(words[at]) } else { u32::from_le_bytes(words[at]) };
        let kind = word(0);
        let (machine, zero, number, content) = (kind / 1000, kind / 100 % 10, kind / 10 % 10, kind % 10);
        let size = |at: usize| i32::try_from(word(at)).ok().and_then(|s| usize::try_from(s).ok());
        let header =
            Self { big, number, content, rows: size(1)?, columns: size(2)?, is_complex: word(3) == 1, name: size(4)? };
        let plausible = machine == u32::from(big)
            && zero == 0
            && number <= 5
            && content <= 2
            && word(3) <= 1
            && (2..=MAX_NAME).contains(&header.name);
        plausible.then_some(header)
    }

    /// Bytes of a number.
    fn width(&self) -> usize {
        [8, 4, 4, 2, 2, 1][self.number as usize]
    }

    /// Bytes of the matrix after its header.
    fn size(&self) -> Option<usize> {
        let numbers = self.rows.checked_mul(self.columns)?.checked_mul(1 + usize::from(self.is_complex))?;
        numbers.checked_mul(self.width())?.checked_add(self.name)
    }

    /// Value of the matrix whose content begins at `at`.
    fn value(&self, file: &str, source: &dyn Source, at: u64) -> Result<Value, RecordingError> {
        match self.content {
            2 => return Ok(Value::unsupported("a sparse matrix; save it as a full one")),
            0 if self.is_complex => return Ok(Value::not_numeric("complex numbers")),
            1 if self.count() > MAX_TEXT => return Ok(Value::not_numeric("text")),
            _ => {}
        }
        let values = self.numbers(file, source, at)?;
        if self.content == 0 {
            return Ok(Value::array(&[self.rows, self.columns], values, false));
        }
        // Text is stored as the codes of its characters.
        let character = |&code: &f64| char::from_u32(code as u32).unwrap_or(char::REPLACEMENT_CHARACTER);
        Ok(text_rows(self.rows, &values.iter().map(character).collect::<Vec<_>>()))
    }

    fn count(&self) -> usize {
        self.rows.saturating_mul(self.columns)
    }

    /// The real numbers, all of which the file has.
    fn numbers(&self, file: &str, source: &dyn Source, at: u64) -> Result<Vec<f64>, RecordingError> {
        let size = self.count().saturating_mul(self.width());
        let mut values = Vec::new();
        values.try_reserve_exact(self.count()).map_err(|error| of_content(file, Some(at), error.to_string()))?;
        for begin in (0..size).step_by(PIECE) {
            let piece = source::bytes(file, source, at + begin as u64, PIECE.min(size - begin) as u64)?;
            self.convert(&piece, &mut values);
        }
        Ok(values)
    }

    fn convert(&self, content: &[u8], out: &mut Vec<f64>) {
        match self.number {
            0 => self.convert_each(content, out, f64::from_le_bytes),
            1 => self.convert_each(content, out, |b| f64::from(f32::from_le_bytes(b))),
            2 => self.convert_each(content, out, |b| f64::from(i32::from_le_bytes(b))),
            3 => self.convert_each(content, out, |b| f64::from(i16::from_le_bytes(b))),
            4 => self.convert_each(content, out, |b| f64::from(u16::from_le_bytes(b))),
            _ => self.convert_each(content, out, |b| f64::from(u8::from_le_bytes(b))),
        }
    }

    fn convert_each<const N: usize>(&self, content: &[u8], out: &mut Vec<f64>, number: fn([u8; N]) -> f64) {
        let (chunks, _) = content.as_chunks::<N>();
        out.extend(chunks.iter().map(|&(mut chunk)| {
            if self.big {
                chunk.reverse();
            }
            number(chunk)
        }));
    }
}

/// The name at the start of `content`, if it is one a variable can have.
fn name(content: &[u8]) -> Option<&str> {
    let (name, _) = content.split_at(content.iter().position(|&b| b == 0)?);
    let is_valid = |n: &[u8]| n.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_');
    let named = name.first().is_some_and(u8::is_ascii_alphabetic) && is_valid(name);
    std::str::from_utf8(name).ok().filter(|_| named)
}

/// Returns true if content starts like a file of level 4, which has no mark of its own.
pub(super) fn starts(bytes: &[u8]) -> bool {
    let header = Header::read(bytes);
    header.is_some_and(|h| bytes.get(HEADER..HEADER + h.name).is_some_and(|content| name(content).is_some()))
}

/// The variables in the order of the file, with their names.
pub(super) fn variables(
    file: &str,
    source: &dyn Source,
    wanted: &Wanted<'_>,
) -> Result<Vec<(String, Value)>, RecordingError> {
    let length = source::size(file, source)?;
    let mut found = Vec::new();
    let mut at = 0;
    while at < length {
        let available = length - at;
        let truncated =
            |expected: u64| RecordingError::Truncated { file: file.into(), offset: at, expected, available };
        let damaged = || RecordingError::Damaged {
            file: file.into(),
            offset: Some(at),
            detail: "no header of a variable".into(),
        };
        if available < HEADER as u64 {
            return Err(truncated(HEADER as u64));
        }
        let header = Header::read(&source::bytes(file, source, at, HEADER as u64)?).ok_or_else(damaged)?;
        let whole = (header.size().ok_or_else(damaged)? as u64).saturating_add(HEADER as u64);
        if whole > available {
            return Err(truncated(whole));
        }
        let label = source::bytes(file, source, at + HEADER as u64, header.name as u64)?;
        let label = name(&label).ok_or_else(damaged)?.to_owned();
        let begin = HEADER as u64 + header.name as u64;
        let dimensions = [header.rows, header.columns];
        let is_real = header.content == 0 && !header.is_complex;
        let value = match if is_real { wanted.need(&label, &dimensions) } else { Need::Values } {
            Need::Values | Need::Place => header.value(file, source, at + begin)?,
            Need::Shape => Value::shape(&dimensions),
            Need::Nothing => Value::Unread,
        };
        found.push((label, value));
        at += whole;
    }
    Ok(found)
}
