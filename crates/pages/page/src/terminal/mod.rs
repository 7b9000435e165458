//! A page on a terminal: text in lines, tables in columns, colour where it is welcome. Figures are left out.

mod lines;
mod screen;
mod table;

use crate::model::{Block, Card, Finding, Page, Weight};
use crate::prose::Prose;
use crate::table::{Align, Cell, Table};
use crate::tone::Tone;
use lines::wrap;
pub use screen::{Screen, safe};
use table::table_lines;

/// Blanks before a table, a list or a formula.
const INDENT: usize = 2;

/// The page as lines of text.
pub fn terminal(page: &Page, screen: Screen) -> String {
    let mut lines = Lines { screen, all: Vec::new() };
    lines.text(&page.subtitle, 0, Tone::Faint);
    lines.blocks(&page.blocks);
    lines.all.join("\n").trim_end().to_owned()
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
                for line in wrap(&safe(title), self.screen.width) {
                    self.push_painted(Tone::Strong, &self.screen.painted(*tone, &line));
                }
                self.blocks(blocks);
            }
            Block::Preformatted { text } => {
                self.all.extend(text.lines().flat_map(|line| lines::broken(&safe(line), self.screen.width)));
            }
            Block::Fold { summary, blocks } => {
                self.text(summary, 0, Tone::Plain);
                self.blocks(blocks);
            }
        }
    }

    /// A line that stands out, after an empty one.
    fn heading(&mut self, text: &str) {
        self.gap();
        wrap(&safe(text), self.screen.width).iter().for_each(|line| self.push_painted(Tone::Strong, line));
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
        self.all.extend(item(mark, tone, text, self.screen));
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
fn item(mark: &str, tone: Tone, text: &str, screen: Screen) -> Vec<String> {
    let mut lines = wrap(&safe(&format!("{mark} {text}")), screen.width.saturating_sub(2 * INDENT)).into_iter();
    let first = lines.next().unwrap_or_default();
    let rest = first.strip_prefix(mark).unwrap_or(&first);
    let first = format!("{}{}{rest}", " ".repeat(INDENT), screen.painted(tone, mark));
    std::iter::once(first).chain(lines.map(|line| format!("{}{line}", " ".repeat(2 * INDENT)))).collect()
}

/// A formula in one line: `{over}/{under}` becomes `(over)/(under)`.
pub(crate) fn linear(formula: &str) -> String {
    formula.replace('{', "(").replace('}', ")")
}

/// A text, such as a message, in lines of at most `width` columns. Its own lines stay apart, and what a line continues
/// with is indented as it is.
pub fn folded(text: &str, width: usize) -> String {
    let fold = |line: &str| -> Vec<String> {
        let text = line.trim_start_matches(' ');
        let indent = line.len() - text.len();
        let parts = wrap(text, width.saturating_sub(indent));
        parts.iter().map(|part| format!("{}{part}", " ".repeat(indent)).trim_end().to_owned()).collect()
    };
    text.lines().map(safe).flat_map(|line| fold(&line)).collect::<Vec<_>>().join("\n")
}
