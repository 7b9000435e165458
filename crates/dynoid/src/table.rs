//! Tables of text, and text broken into lines.

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// How a text is shown where colour is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Plain,
    Bold,
    Faint,
    Good,
    Caution,
    Bad,
}

impl Style {
    /// The text with the terminal's codes around it.
    pub(crate) fn paint(self, text: &str) -> String {
        let code = match self {
            _ if text.is_empty() => return String::new(),
            Style::Plain => return text.to_owned(),
            Style::Bold => "1",
            Style::Faint => "2",
            Style::Good => "32",
            Style::Caution => "33",
            Style::Bad => "31",
        };
        format!("\u{1b}[{code}m{text}\u{1b}[0m")
    }
}

/// A cell of a table.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    text: String,
    style: Style,
}

impl Cell {
    pub(crate) fn styled(text: impl AsRef<str>, style: Style) -> Self {
        Cell { text: safe(text.as_ref()), style }
    }
}

impl<T: AsRef<str>> From<T> for Cell {
    fn from(text: T) -> Self {
        Cell::styled(text, Style::Plain)
    }
}

/// A column's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

/// Rows of cells under headings; the last column is broken into lines where it is too wide.
#[derive(Debug)]
pub(crate) struct Table {
    columns: Vec<(&'static str, Align)>,
    rows: Vec<Vec<Cell>>,
    /// What stands below a row, by the row's index.
    notes: Vec<(usize, String)>,
}

const GAP: usize = 2;
const NOTE_INDENT: usize = 4;
/// The last column gets at least this much, even if the line then is too long.
const NARROWEST: usize = 24;

impl Table {
    /// A table with headings; without a line of headings if all are empty.
    pub(crate) fn new(columns: &[(&'static str, Align)]) -> Self {
        Table { columns: columns.to_vec(), rows: Vec::new(), notes: Vec::new() }
    }

    pub(crate) fn row(&mut self, cells: impl Into<Vec<Cell>>) {
        self.rows.push(cells.into());
    }

    /// A remark below the last row.
    pub(crate) fn note(&mut self, text: &str) {
        self.notes.push((self.rows.len().saturating_sub(1), safe(text)));
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The table's lines, indented.
    pub(crate) fn lines(&self, indent: usize, width: usize, colour: bool) -> Vec<String> {
        let widths = self.widths();
        let mut lines = Vec::new();
        if self.columns.iter().any(|(heading, _)| !heading.is_empty()) {
            let cells: Vec<Cell> =
                self.columns.iter().map(|(heading, _)| Cell::styled(heading, Style::Faint)).collect();
            self.push_row(&cells, &widths, (indent, width), colour, &mut lines);
        }
        for (index, row) in self.rows.iter().enumerate() {
            self.push_row(row, &widths, (indent, width), colour, &mut lines);
            for (_, note) in self.notes.iter().filter(|(of, _)| *of == index) {
                let parts = wrap(note, width.saturating_sub(indent + NOTE_INDENT));
                let painted = parts.iter().map(|part| if colour { Style::Faint.paint(part) } else { part.clone() });
                lines.extend(painted.map(|part| format!("{}{part}", " ".repeat(indent + NOTE_INDENT))));
            }
        }
        lines
    }

    fn widths(&self) -> Vec<usize> {
        let of_column = |index: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(index)).map(|cell| cell.text.width());
            cells.max().unwrap_or(0).max(self.columns[index].0.width())
        };
        (0..self.columns.len()).map(of_column).collect()
    }

    fn push_row(
        &self,
        row: &[Cell],
        widths: &[usize],
        (indent, width): (usize, usize),
        colour: bool,
        lines: &mut Vec<String>,
    ) {
        let mut line = " ".repeat(indent);
        let mut column = indent;
        for (index, cell) in row.iter().enumerate() {
            let paint = |text: &str| if colour { cell.style.paint(text) } else { text.to_owned() };
            if index + 1 == row.len() && self.columns[index].1 == Align::Left {
                let room = width.saturating_sub(column).max(NARROWEST);
                for (number, part) in wrap(&cell.text, room).iter().enumerate() {
                    if number > 0 {
                        lines.push(std::mem::replace(&mut line, " ".repeat(column)).trim_end().to_owned());
                    }
                    line.push_str(&paint(part));
                }
                continue;
            }
            let padding = " ".repeat(widths[index].saturating_sub(cell.text.width()));
            let (before, after) =
                if self.columns[index].1 == Align::Right { (padding.as_str(), "") } else { ("", padding.as_str()) };
            line.push_str(&format!("{before}{}{after}{}", paint(&cell.text), " ".repeat(GAP)));
            column += widths[index] + GAP;
        }
        lines.push(line.trim_end().to_owned());
    }
}

/// The text broken at spaces into lines of at most `width` columns; a longer word gets a line of its own. At least one
/// line.
pub(crate) fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if line.is_empty() {
            line.push_str(word);
        } else if line.width() + 1 + word.width() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// A text from outside made safe for a terminal: no control characters, and so no escape codes.
pub(crate) fn safe(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || (c.width() == Some(0) && is_direction(c)) { ' ' } else { c }).collect()
}

/// Characters that turn the direction of what follows.
fn is_direction(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
