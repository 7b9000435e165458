//! Characters and delimiters.

use std::borrow::Cow;

use super::rows::BLANKS;

/// Lines looked at to find the delimiter.
const SAMPLE_LINES: usize = 400;
/// The last of these lines that count: many, or in a short file few.
const MANY: usize = 50;
const FEW: usize = 4;

/// Content as text.
pub(crate) struct Text<'a> {
    pub(crate) content: Cow<'a, str>,
    pub(crate) assumed_latin1: bool,
}

impl<'a> Text<'a> {
    /// Decodes UTF-8, UTF-16 with a byte order mark, or else Latin-1.
    pub(crate) fn decode(bytes: &'a [u8]) -> Self {
        let known = |content| Self { content, assumed_latin1: false };
        if let Some(utf16) = utf16(bytes) {
            return known(Cow::Owned(utf16));
        }
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let bytes = without_end_mark(bytes);
        match std::str::from_utf8(bytes) {
            Ok(text) => known(Cow::Borrowed(text)),
            Err(_) => {
                Self { content: Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()), assumed_latin1: true }
            }
        }
    }
}

/// Content without the end-of-file mark of DOS.
fn without_end_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_suffix(b"\x1A").unwrap_or(bytes)
}

fn utf16(bytes: &[u8]) -> Option<String> {
    let (decode, body): (fn([u8; 2]) -> u16, _) = match bytes {
        [0xFF, 0xFE, body @ ..] => (u16::from_le_bytes, body),
        [0xFE, 0xFF, body @ ..] => (u16::from_be_bytes, body),
        _ => return None,
    };
    let units = body.chunks(2).map(|pair| match pair {
        [a, b] => decode([*a, *b]),
        _ => 0xFFFD,
    });
    Some(char::decode_utf16(units).map(|c| c.unwrap_or('\u{FFFD}')).collect())
}

/// Whether content may be text: no control characters other than white space in its first bytes.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    if matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) {
        return true;
    }
    let control = |b: &u8| b.is_ascii_control() && !matches!(b, b'\t' | b'\n' | b'\r' | 0x0C);
    !without_end_mark(bytes).iter().take(4096).any(control)
}

/// What separates the cells: what a first line `sep=;` says, or else the first of tab, semicolon and comma that occurs,
/// outside quotes, in at least half of the last lines of the sample, above which there may be other text; blanks, where
/// `may_be_blanks` and nothing else occurs.
pub(super) fn delimiter(content: &str, may_be_blanks: bool) -> Option<u8> {
    let stated = content.lines().next().and_then(|line| line.trim_matches('"').strip_prefix("sep=")).map(str::as_bytes);
    if let Some([stated @ (b';' | b',' | b'\t' | b'|')]) = stated {
        return Some(*stated);
    }
    let is_filled = |line: &&str| !line.trim().is_empty() && !line.starts_with(['#', '%']);
    let lines: Vec<&str> = content.lines().filter(is_filled).take(SAMPLE_LINES).collect();
    let occurring = [MANY, FEW].into_iter().find_map(|tail| {
        let lines = &lines[lines.len().saturating_sub(tail)..];
        [b'\t', b';', b',', b'|'].into_iter().find(|&d| {
            let with = lines.iter().filter(|l| occurs(l, d)).count();
            with > 0 && with * 2 >= lines.len()
        })
    });
    occurring.or((may_be_blanks && !lines.is_empty()).then_some(BLANKS))
}

fn occurs(line: &str, delimiter: u8) -> bool {
    let mut quoted = false;
    line.trim().bytes().any(|b| {
        quoted ^= b == b'"';
        b == delimiter && !quoted
    })
}
