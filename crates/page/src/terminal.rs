//! A page on a terminal: text in lines, tables in columns, colour where it is welcome. Figures are left out.

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

use crate::model::{Block, Card, Finding, Page, Weight};
use crate::prose::Prose;
use crate::table::{Align, Cell, Row, Table};
use crate::tone::Tone;

/// How wide lines are, and whether colour is welcome.
#[derive(Debug, Clone, Copy)]
pub struct Screen {
    /// Columns of a line.
    pub width: usize,
    /// Whether escape codes for colour may be used.
    pub colour: bool,
}

/// Blanks before a table, a list or a formula.
const INDENT: usize = 2;
/// Blanks between two columns.
const GAP: usize = 2;
/// Blanks before a remark below a row, beside those before the table.
const NOTE_INDENT: usize = 4;
/// The last column gets at least this much, even if the line then is too long.
const NARROWEST: usize = 24;

/// The page as lines of text.
pub fn terminal(page: &Page, screen: Screen) -> String {
    let mut lines = Lines { screen, all: Vec::new() };
    lines.text(&page.subtitle, 0, Tone::Faint);
    lines.blocks(&page.blocks);
    lines.all.join("\n").trim_end().to_owned()
}

impl Tone {
    /// The text with the terminal's codes around it.
    pub fn paint(self, text: &str) -> String {
        let code = match self {
            _ if text.is_empty() => return String::new(),
            Tone::Plain => return text.to_owned(),
            Tone::Strong => "1",
            Tone::Faint => "2",
            Tone::Good => "32",
            Tone::Caution => "33",
            Tone::Bad => "31",
        };
        format!("\u{1b}[{code}m{text}\u{1b}[0m")
    }
}

impl Screen {
    fn painted(self, tone: Tone, text: &str) -> String {
        if self.colour { tone.paint(text) } else { text.to_owned() }
    }
}

struct Lines {
    screen: Screen,
    all: Vec<String>,
}

impl Lines {
    fn blocks(&mut self, blocks: &[Block]) {
        blocks.iter().for_each(|block| self.block(block));
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Section { title, blocks, .. } => {
                self.heading(title);
                self.blocks(blocks);
            }
            Block::Heading { text } => self.heading(&text.plain()),
            Block::Paragraph { text, weight } => {
                self.text(text, 0, if *weight == Weight::Note { Tone::Faint } else { Tone::Plain });
            }
            Block::Equation { formula } => self.text(&Prose::verbatim(linear(formula)), INDENT, Tone::Plain),
            Block::List { items } => items.iter().for_each(|item| self.item("–", Tone::Faint, &item.plain())),
            Block::Definitions { items } => {
                let columns = [("", Align::Left), ("", Align::Left)];
                let rows = items.iter().map(|(term, meaning)| vec![term.clone().into(), meaning.clone().into()]);
                self.table(&Table::new(&columns).with_rows(rows));
            }
            Block::Table(table) => {
                self.table(table);
                self.gap();
            }
            Block::Cards { items } => self.cards(items),
            Block::Figure(_) | Block::Row { .. } => {}
            Block::Drawing { caption, .. } => self.text(caption, 0, Tone::Plain),
            Block::Finding(finding) => self.finding(finding),
            Block::Callout { tone, title, blocks, .. } => {
                self.gap();
                self.push_painted(Tone::Strong, &self.screen.painted(*tone, &safe(title)));
                self.blocks(blocks);
            }
            Block::Preformatted { text } => self.all.extend(text.lines().map(safe)),
            Block::Fold { summary, blocks } => {
                self.text(summary, 0, Tone::Plain);
                self.blocks(blocks);
            }
        }
    }

    /// A line that stands out, after an empty one.
    fn heading(&mut self, text: &str) {
        self.gap();
        self.push_painted(Tone::Strong, &safe(text));
    }

    /// An empty line, unless there is one, or nothing above.
    fn gap(&mut self) {
        if self.all.last().is_some_and(|line| !line.is_empty()) {
            self.all.push(String::new());
        }
    }

    fn push_painted(&mut self, tone: Tone, text: &str) {
        self.all.push(self.screen.painted(tone, text));
    }

    fn text(&mut self, text: &Prose, indent: usize, tone: Tone) {
        if text.is_empty() {
            return;
        }
        for line in wrap(&safe(&text.plain()), self.screen.width.saturating_sub(indent)) {
            let line = self.screen.painted(tone, &line);
            self.all.push(format!("{}{line}", " ".repeat(indent)));
        }
    }

    fn item(&mut self, mark: &str, tone: Tone, text: &str) {
        self.all.extend(item((mark, tone), text, self.screen));
    }

    fn finding(&mut self, Finding { tone, severity, text, remedy, places }: &Finding) {
        self.item(&format!("{severity}:"), *tone, &text.plain());
        let rest = remedy.iter().map(Prose::plain).chain(places.iter().cloned());
        for line in rest.flat_map(|text| wrap(&safe(&text), self.screen.width.saturating_sub(2 * INDENT))) {
            self.all.push(format!("{}{line}", " ".repeat(2 * INDENT)));
        }
    }

    fn cards(&mut self, items: &[Card]) {
        let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
        for Card { label, value } in items {
            let value = match value {
                Ok(quantity) => quantity.clone().into(),
                Err(why) => Cell::toned(why.plain(), Tone::Faint),
            };
            table.row([label.clone().into(), value]);
        }
        self.table(&table);
    }

    fn table(&mut self, table: &Table) {
        self.all.extend(table_lines(table, INDENT, self.screen));
    }
}

/// A text broken into lines, indented, after a mark such as `warning:`.
fn item((mark, tone): (&str, Tone), text: &str, screen: Screen) -> Vec<String> {
    let mut lines = wrap(&safe(&format!("{mark} {text}")), screen.width.saturating_sub(INDENT)).into_iter();
    let first = lines.next().unwrap_or_default();
    let rest = first.strip_prefix(mark).unwrap_or(&first);
    let first = format!("{}{}{rest}", " ".repeat(INDENT), screen.painted(tone, mark));
    std::iter::once(first).chain(lines.map(|line| format!("{}{line}", " ".repeat(2 * INDENT)))).collect()
}

/// The lines of a table, indented. The last column is broken into lines where it is too wide.
fn table_lines(table: &Table, indent: usize, screen: Screen) -> Vec<String> {
    let widths = widths(table);
    let mut lines = Vec::new();
    if table.has_headings() {
        let heading = |column: &crate::table::Column| Cell::toned(column.heading.plain(), Tone::Faint);
        let cells: Vec<Cell> = table.columns.iter().map(heading).collect();
        push_row(table, &cells, (&widths, indent, screen), &mut lines);
    }
    for Row { cells, notes } in &table.rows {
        push_row(table, cells, (&widths, indent, screen), &mut lines);
        for part in notes.iter().flat_map(|note| wrap(&safe(note), screen.width.saturating_sub(indent + NOTE_INDENT))) {
            lines.push(format!("{}{}", " ".repeat(indent + NOTE_INDENT), screen.painted(Tone::Faint, &part)));
        }
    }
    lines
}

fn widths(table: &Table) -> Vec<usize> {
    let of_column = |(index, column): (usize, &crate::table::Column)| {
        let cells = table.rows.iter().filter_map(|row| row.cells.get(index)).map(|cell| safe(&cell.plain()).width());
        cells.max().unwrap_or(0).max(column.heading.plain().width())
    };
    table.columns.iter().enumerate().map(of_column).collect()
}

fn push_row(
    table: &Table,
    cells: &[Cell],
    (widths, indent, screen): (&[usize], usize, Screen),
    lines: &mut Vec<String>,
) {
    let mut line = " ".repeat(indent);
    let mut column = indent;
    for ((index, cell), of_column) in cells.iter().enumerate().zip(&table.columns) {
        let text = safe(&cell.plain());
        if index + 1 == cells.len() && of_column.align == Align::Left {
            let room = screen.width.saturating_sub(column).max(NARROWEST);
            for (number, part) in wrap(&text, room).iter().enumerate() {
                if number > 0 {
                    lines.push(std::mem::replace(&mut line, " ".repeat(column)).trim_end().to_owned());
                }
                line.push_str(&screen.painted(cell.tone, part));
            }
            continue;
        }
        let padding = " ".repeat(widths[index].saturating_sub(text.width()));
        let (before, after) =
            if of_column.align == Align::Right { (padding.as_str(), "") } else { ("", padding.as_str()) };
        line.push_str(&format!("{before}{}{after}{}", screen.painted(cell.tone, &text), " ".repeat(GAP)));
        column += widths[index] + GAP;
    }
    lines.push(line.trim_end().to_owned());
}

/// A formula in one line: `{over}/{under}` becomes `(over)/(under)`.
pub(crate) fn linear(formula: &str) -> String {
    formula.replace('{', "(").replace('}', ")")
}

/// The text broken at spaces into lines of at most `width` columns; a longer word gets a line of its own. At least one
/// line.
fn wrap(text: &str, width: usize) -> Vec<String> {
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
pub fn safe(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || (c.width() == Some(0) && is_direction(c)) { ' ' } else { c }).collect()
}

/// Characters that turn the direction of what follows.
fn is_direction(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
