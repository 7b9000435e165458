//! Characters, piece by piece, and delimiters.

use std::ops::Range;

use super::rows::BLANKS;
use crate::source::{bytes, size};
use crate::{Finding, RecordingError, Source};

/// Lines looked at to find the delimiter.
const SAMPLE_LINES: usize = 400;
/// The last of these lines that count: many, or in a short file few.
const MANY: usize = 50;
const FEW: usize = 4;

/// Bytes read at once, of a list those that are looked through for its encoding.
pub(super) const PIECE: u64 = 1 << 22;
const LISTED_PIECE: u64 = 1 << 18;

/// How characters are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Utf8,
    Latin1,
    Utf16 { is_big: bool },
}

impl Encoding {
    /// Bytes of the file that a text takes.
    pub(super) fn bytes(self, text: &str) -> u64 {
        let bytes = match self {
            Self::Utf8 => text.len(),
            Self::Latin1 => text.chars().count(),
            Self::Utf16 { .. } => 2 * text.encode_utf16().count(),
        };
        bytes as u64
    }
}

/// The text of a file, piece by piece.
pub(super) struct Pieces<'a> {
    file: &'a str,
    source: &'a dyn Source,
    at: u64,
    end: u64,
    encoding: Encoding,
    /// The beginning of a character that the last piece cut.
    cut: Vec<u8>,
    /// Bytes read at once.
    piece: u64,
    /// The most lines that there are; none where the file was not looked through.
    lines: Option<usize>,
    /// The bytes of NUL behind the text.
    nulls: u64,
}

impl<'a> Pieces<'a> {
    /// Finds out how the text is stored: UTF-8, UTF-16, or else Latin-1. That, and how many lines
    /// there are, takes looking through all of it, of a list only through what is read of it.
    pub(super) fn open(file: &'a str, source: &'a dyn Source, is_list: bool) -> Result<Self, RecordingError> {
        let end = size(file, source)?;
        let head = bytes(file, source, 0, 4)?;
        let (encoding, at) = beginning(&head);
        let filled = before_nulls(file, source, end)?;
        let filled = if encoding == Encoding::Utf8 { filled } else { filled.next_multiple_of(2).min(end) };
        let nulls = end - filled;
        // The end-of-file mark of DOS is no text.
        let last = bytes(file, source, filled.saturating_sub(1), 1)?;
        let end = if encoding == Encoding::Utf8 && last == [0x1A] { filled - 1 } else { filled };
        let piece = if is_list { LISTED_PIECE } else { PIECE };
        let mut pieces = Self { file, source, at, end, encoding, cut: Vec::new(), piece, lines: None, nulls };
        let (is_utf8, lines) = pieces.survey(if is_list { piece } else { u64::MAX })?;
        if encoding == Encoding::Utf8 && !is_utf8 {
            pieces.encoding = Encoding::Latin1;
        }
        pieces.lines = pieces.is_done().then_some(lines);
        (pieces.at, pieces.cut) = (at, Vec::new());
        Ok(pieces)
    }

    /// The text from a place in the file up to another, both between lines.
    pub(super) fn between(
        file: &'a str,
        source: &'a dyn Source,
        encoding: Encoding,
        bytes: Range<u64>,
    ) -> Result<String, RecordingError> {
        let (at, end, piece) = (bytes.start, bytes.end, bytes.end - bytes.start);
        let mut pieces = Self { file, source, at, end, encoding, cut: Vec::new(), piece, lines: None, nulls: 0 };
        let mut text = String::new();
        pieces.more(&mut text).map(|()| text)
    }

    pub(super) fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The most lines that there are, if they were counted.
    pub(super) fn lines(&self) -> Option<usize> {
        self.lines
    }

    /// Findings about how the text is stored.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let latin1 = (self.encoding == Encoding::Latin1).then_some(Finding::AssumedLatin1);
        let nulls = Finding::NulBytes { offset: self.end, count: self.nulls };
        latin1.into_iter().chain((self.nulls > 0).then_some(nulls)).collect()
    }

    /// How many bytes were read, and how many there are.
    pub(super) fn progress(&self) -> (u64, u64) {
        (self.at, self.end)
    }

    pub(super) fn is_done(&self) -> bool {
        self.at >= self.end
    }

    /// Appends the next piece, of about as much as there is already but no less than is read at once.
    pub(super) fn more(&mut self, text: &mut String) -> Result<(), RecordingError> {
        let read = self.read(self.piece.max(text.len() as u64))?;
        match self.encoding {
            Encoding::Utf8 => {
                let whole = whole_characters(&read);
                // The file was looked through before: what is cut here is no fault.
                text.push_str(&String::from_utf8_lossy(&read[..whole]));
                self.cut = read[whole..].to_vec();
            }
            Encoding::Latin1 => text.extend(read.iter().map(|&b| char::from(b))),
            Encoding::Utf16 { is_big } => {
                let unit = if is_big { u16::from_be_bytes } else { u16::from_le_bytes };
                self.append_utf16(&read, unit, text);
            }
        }
        Ok(())
    }

    fn append_utf16(&mut self, read: &[u8], unit: fn([u8; 2]) -> u16, text: &mut String) {
        let (pairs, rest) = read.as_chunks::<2>();
        let is_cut = |pair: &[u8; 2]| (0xD800..0xDC00).contains(&unit(*pair)) && !self.is_done();
        let whole = if pairs.last().is_some_and(is_cut) { pairs.len() - 1 } else { pairs.len() };
        let units = pairs[..whole].iter().map(|pair| unit(*pair));
        text.extend(char::decode_utf16(units).map(|c| c.unwrap_or('\u{FFFD}')));
        match self.is_done() {
            true if !rest.is_empty() => text.push('\u{FFFD}'),
            true => {}
            false => self.cut = read[2 * whole..].to_vec(),
        }
    }

    /// Reads so many bytes more, behind those that were cut.
    fn read(&mut self, length: u64) -> Result<Vec<u8>, RecordingError> {
        let length = length.min(self.end.saturating_sub(self.at));
        let mut read = std::mem::take(&mut self.cut);
        read.extend(bytes(self.file, self.source, self.at, length)?);
        self.at += length;
        Ok(read)
    }

    /// Finds whether the first `most` bytes are UTF-8, and how many lines begin in them, at most.
    fn survey(&mut self, most: u64) -> Result<(bool, usize), RecordingError> {
        let (mut is_utf8, mut feeds, mut returns) = (true, 0, 0);
        while !self.is_done() && self.at < most {
            let read = self.read(self.piece)?;
            let whole = if self.is_done() { read.len() } else { whole_characters(&read) };
            is_utf8 &= !is_utf8 || std::str::from_utf8(&read[..whole]).is_ok();
            feeds += count(&read[..whole], b'\n');
            returns += count(&read[..whole], b'\r');
            self.cut = read[whole..].to_vec();
        }
        Ok((is_utf8, feeds.max(returns) + 1))
    }
}

fn count(bytes: &[u8], wanted: u8) -> usize {
    bytes.iter().filter(|byte| **byte == wanted).count()
}

/// The bytes up to a character of UTF-8 that is cut at the end.
fn whole_characters(bytes: &[u8]) -> usize {
    let begins = |back: &usize| bytes[bytes.len() - back] & 0b1100_0000 != 0b1000_0000;
    let Some(back) = (1..=bytes.len().min(4)).find(begins) else { return bytes.len() };
    let is_cut = std::str::from_utf8(&bytes[bytes.len() - back..]).is_err_and(|e| e.error_len().is_none());
    if is_cut { bytes.len() - back } else { bytes.len() }
}

/// How a text that begins so is stored, and after how many bytes it begins. Without a byte order mark, UTF-16 shows in
/// the other byte of its first two characters.
fn beginning(head: &[u8]) -> (Encoding, u64) {
    match head {
        [0xFF, 0xFE, ..] => (Encoding::Utf16 { is_big: false }, 2),
        [0xFE, 0xFF, ..] => (Encoding::Utf16 { is_big: true }, 2),
        [0xEF, 0xBB, 0xBF, ..] => (Encoding::Utf8, 3),
        [1..=0xFF, 0, 1..=0xFF, 0, ..] => (Encoding::Utf16 { is_big: false }, 0),
        [0, 1..=0xFF, 0, 1..=0xFF, ..] => (Encoding::Utf16 { is_big: true }, 0),
        _ => (Encoding::Utf8, 0),
    }
}

/// Where the bytes of NUL begin that end a file: a writer that lost power leaves them.
fn before_nulls(file: &str, source: &dyn Source, mut end: u64) -> Result<u64, RecordingError> {
    while end > 0 {
        let begin = end.saturating_sub(LISTED_PIECE);
        let piece = bytes(file, source, begin, end - begin)?;
        if let Some(last) = piece.iter().rposition(|&byte| byte != 0) {
            return Ok(begin + last as u64 + 1);
        }
        end = begin;
    }
    Ok(0)
}

/// Content without the bytes of NUL at its end, and the end-of-file mark of DOS.
fn without_end(bytes: &[u8]) -> &[u8] {
    let filled = &bytes[..bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1)];
    filled.strip_suffix(b"\x1A").unwrap_or(filled)
}

/// Returns true if a file that begins so may be text: no control characters other than white space, and a line end
/// before bytes of NUL.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    match beginning(bytes) {
        (Encoding::Utf16 { .. }, 2) => true,
        (Encoding::Utf16 { is_big }, _) => {
            let (pairs, _) = bytes.as_chunks::<2>();
            let filled = &pairs[..pairs.iter().rposition(|pair| *pair != [0, 0]).map_or(0, |last| last + 1)];
            !filled.iter().any(|&[a, b]| if is_big { a == 0 && is_control(b) } else { b == 0 && is_control(a) })
        }
        _ => {
            let text = without_end(bytes);
            !text.iter().any(|&b| is_control(b)) && (bytes.last() != Some(&0) || text.contains(&b'\n'))
        }
    }
}

/// Returns true if a character is a control character other than white space.
fn is_control(byte: u8) -> bool {
    byte.is_ascii_control() && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0C)
}

/// Delimiters that may separate the cells, the likelier first. A first line `sep=;` states one. Otherwise they are
/// those of tab, semicolon, bar and comma that occur, outside quotes, in at least half of the last lines of the sample.
/// Above these there may be other text. Blanks count where `may_be_blanks` and nothing else occurs.
pub(super) fn delimiters(content: &str, may_be_blanks: bool) -> Vec<u8> {
    let stated = content.lines().next().and_then(|line| line.trim_matches('"').strip_prefix("sep=")).map(str::as_bytes);
    if let Some([stated @ (b';' | b',' | b'\t' | b'|')]) = stated {
        return vec![*stated];
    }
    let is_filled = |line: &&str| !line.trim().is_empty() && !line.starts_with(['#', '%']);
    let lines: Vec<&str> = content.lines().filter(is_filled).take(SAMPLE_LINES).collect();
    let occurring = [MANY, FEW].into_iter().map(|tail| {
        let lines = &lines[lines.len().saturating_sub(tail)..];
        let is_frequent = |&d: &u8| {
            let with = lines.iter().filter(|l| occurs(l, d)).count();
            with > 0 && with * 2 >= lines.len()
        };
        [b'\t', b';', b'|', b','].into_iter().filter(is_frequent).collect::<Vec<_>>()
    });
    let blanks = (may_be_blanks && !lines.is_empty()).then(|| vec![BLANKS]);
    occurring.chain(blanks).find(|found| !found.is_empty()).unwrap_or_default()
}

fn occurs(line: &str, delimiter: u8) -> bool {
    let mut quoted = false;
    line.trim().bytes().any(|b| {
        quoted ^= b == b'"';
        b == delimiter && !quoted
    })
}
