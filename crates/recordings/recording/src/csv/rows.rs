//! Text split into rows and cells.

/// Stands for blanks, any number of them, as what separates cells.
pub(super) const BLANKS: u8 = b' ';
/// The longest cell in quotes; a quote without end does not swallow the file.
pub(super) const MAX_QUOTED: usize = 1 << 16;

/// A cell, without the quotes and blanks around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell<'a> {
    pub(super) text: &'a str,
    /// Quotes within are doubled.
    is_doubled: bool,
}

impl Cell<'_> {
    /// The text with single quotes, on one line.
    pub(super) fn label(&self) -> String {
        let text = if self.is_doubled { self.text.replace("\"\"", "\"") } else { self.text.to_owned() };
        match text.contains(['\n', '\r']) {
            true => text.split_whitespace().collect::<Vec<_>>().join(" "),
            false => text,
        }
    }
}

/// A line of cells; a line break in quotes is part of its cell.
#[derive(Debug, Clone, Default)]
pub(super) struct Row<'a> {
    pub(super) cells: Vec<Cell<'a>>,
    /// Number of its first line, from 1.
    pub(super) line: u64,
    /// True if a line end follows.
    pub(super) is_ended: bool,
}

impl<'a> Row<'a> {
    /// The cell's text, empty beyond the row's end.
    pub(super) fn text(&self, column: usize) -> &'a str {
        self.cells.get(column).map_or("", |cell| cell.text)
    }

    /// Columns up to the last that is filled.
    pub(super) fn width(&self) -> usize {
        self.cells.iter().rposition(|cell| !cell.text.is_empty()).map_or(0, |last| last + 1)
    }

    pub(super) fn filled(&self) -> impl Iterator<Item = &'a str> {
        self.cells.iter().map(|cell| cell.text).filter(|text| !text.is_empty())
    }

    /// Returns true if the line is a comment. Spreadsheets begin the names of their errors with the same sign.
    pub(super) fn is_comment(&self) -> bool {
        let first = self.text(0);
        first.starts_with('%') || (first.starts_with('#') && !super::number::is_error_word(first))
    }
}

/// A place in the text, from which rows are read on.
#[derive(Debug, Clone)]
pub(super) struct Rows<'a> {
    content: &'a str,
    delimiter: u8,
    at: usize,
    line: u64,
}

impl<'a> Rows<'a> {
    pub(super) fn new(content: &'a str, delimiter: u8) -> Self {
        Self { content, delimiter, at: 0, line: 1 }
    }

    /// Of text whose beginning was dropped: from a place in it on, at a line of the file.
    pub(super) fn resume(content: &'a str, delimiter: u8, (at, line): (usize, u64)) -> Self {
        Self { content, delimiter, at, line }
    }

    /// The place in the text, and the line of the file.
    pub(super) fn place(&self) -> (usize, u64) {
        (self.at, self.line)
    }

    /// Reads the next row; false at the end.
    pub(super) fn next(&mut self, row: &mut Row<'a>) -> bool {
        row.cells.clear();
        row.line = self.line;
        if self.at >= self.content.len() {
            return false;
        }
        loop {
            let cell = self.quoted().unwrap_or_else(|| self.plain());
            row.cells.push(cell);
            match self.content.as_bytes().get(self.at) {
                Some(b'\n') => self.at += 1,
                Some(b'\r') => self.at += 1 + usize::from(self.content.as_bytes().get(self.at + 1) == Some(&b'\n')),
                Some(_) => {
                    self.at += 1;
                    continue;
                }
                None => {
                    row.is_ended = false;
                    return true;
                }
            }
            self.line += 1;
            row.is_ended = true;
            return true;
        }
    }

    /// Up to the next delimiter or line end.
    fn plain(&mut self) -> Cell<'a> {
        let bytes = self.content.as_bytes();
        if self.delimiter == BLANKS {
            self.skip_blanks();
        }
        let (start, delimiter) = (self.at, self.delimiter);
        let is_blanks = delimiter == BLANKS;
        let ends = |b: u8| b == delimiter || b == b'\n' || b == b'\r' || (is_blanks && b == b'\t');
        let end = bytes[start..].iter().position(|&b| ends(b)).map_or(bytes.len(), |length| start + length);
        self.at = end;
        if is_blanks {
            self.stay_before_next();
        }
        Cell { text: self.content[start..end].trim_ascii(), is_doubled: false }
    }

    fn skip_blanks(&mut self) {
        let blanks = self.content.as_bytes()[self.at..].iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
        self.at += blanks;
    }

    /// Where blanks separate: to the last blank before the next cell, or to the line's end.
    fn stay_before_next(&mut self) {
        let from = self.at;
        self.skip_blanks();
        let at_end = matches!(self.content.as_bytes().get(self.at), None | Some(b'\n' | b'\r'));
        if !at_end && self.at > from {
            self.at -= 1;
        }
    }

    /// A cell in quotes, if one begins here; what only looks like one is read as it stands.
    fn quoted(&mut self) -> Option<Cell<'a>> {
        let bytes = self.content.as_bytes();
        let blanks = bytes[self.at..].iter().take_while(|&&b| b == b' ').count();
        let start = self.at + blanks + 1;
        if bytes.get(start - 1) != Some(&b'"') {
            return None;
        }
        let limit = bytes.len().min(start + MAX_QUOTED);
        let (mut end, mut is_doubled) = (start, false);
        loop {
            end += bytes.get(end..limit)?.iter().position(|&b| b == b'"')?;
            if bytes.get(end + 1) != Some(&b'"') {
                break;
            }
            (end, is_doubled) = (end + 2, true);
        }
        let after = end + 1 + bytes[end + 1..].iter().take_while(|&&b| b == b' ').count();
        let is_end = |b: &u8| *b == self.delimiter || matches!(b, b'\n' | b'\r' | b'\t');
        if bytes.get(after).is_some_and(|b| !is_end(b)) && !(self.delimiter == BLANKS && after > end + 1) {
            return None;
        }
        let text = &self.content[start..end];
        self.line += line_breaks(text);
        self.at = if self.delimiter == BLANKS { end + 1 } else { after };
        if self.delimiter == BLANKS {
            self.stay_before_next();
        } else if bytes.get(after) == Some(&b'\t') && self.delimiter != b'\t' {
            self.plain();
        }
        Some(Cell { text: text.trim_ascii(), is_doubled })
    }
}

fn line_breaks(text: &str) -> u64 {
    let bytes = text.as_bytes();
    let returns = bytes.iter().enumerate().filter(|(i, b)| **b == b'\r' && bytes.get(i + 1) != Some(&b'\n'));
    (returns.count() + bytes.iter().filter(|b| **b == b'\n').count()) as u64
}
