//! Characters, delimiters and numbers.

use std::borrow::Cow;

use crate::CsvProblem;

/// Lines looked at to find the delimiter.
const SAMPLE_LINES: usize = 50;

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

impl Text<'_> {
    /// Makes columns that are set apart by blanks alone into columns set apart by tabs.
    pub(crate) fn separate_by_tabs(&mut self) {
        if delimiter(&self.content).is_some_and(|d| d != b'\t') {
            return;
        }
        let lines = self.content.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join("\t") + "\n");
        self.content = Cow::Owned(lines.collect());
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

/// The first of tab, semicolon and comma that occurs, outside quotes, in at least half of the lines.
pub(crate) fn delimiter(content: &str) -> Option<u8> {
    let lines: Vec<&str> = content.lines().filter(|l| !l.trim().is_empty()).take(SAMPLE_LINES).collect();
    [b'\t', b';', b','].into_iter().find(|&d| {
        let with = lines.iter().filter(|l| occurs(l, d)).count();
        with > 0 && with * 2 >= lines.len()
    })
}

fn occurs(line: &str, delimiter: u8) -> bool {
    let mut quoted = false;
    line.bytes().any(|b| {
        quoted ^= b == b'"';
        b == delimiter && !quoted
    })
}

/// A cell as a number; NaN where it is empty. `decimal` is the decimal sign seen so far.
pub(crate) fn number(cell: &str, decimal: &mut Option<char>) -> Result<f64, CsvProblem> {
    let cell = cell.trim();
    if cell.is_empty() {
        return Ok(f64::NAN);
    }
    let sign = cell.chars().find(|c| matches!(c, '.' | ','));
    if let Some(sign) = sign {
        if decimal.is_some_and(|seen| seen != sign) {
            return Err(CsvProblem::MixedDecimalSigns { text: cell.into() });
        }
        *decimal = Some(sign);
    }
    plain_number(cell).ok_or_else(|| CsvProblem::NotANumber { text: cell.into() })
}

/// A number with a decimal point or comma.
pub(crate) fn plain_number(cell: &str) -> Option<f64> {
    match cell.contains(',') {
        false => cell.parse().ok(),
        true if cell.contains('.') => None,
        true => cell.replacen(',', ".", 1).parse().ok(),
    }
}
