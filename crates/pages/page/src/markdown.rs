//! A page as Markdown (CommonMark with tables). Figures are named, and not drawn.

use crate::model::{Block, Card, Finding, Page, Weight};
use crate::prose::{Inline, Prose};
use crate::table::{Align, Cell, Content, Row, Table};
use crate::terminal::linear;

/// The page as Markdown.
pub fn markdown(page: &Page) -> String {
    let mut out = format!("# {}\n\n", escape(&page.title));
    paragraph(&mut out, &inline(&page.subtitle));
    blocks(&mut out, &page.blocks, 2);
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

fn blocks(out: &mut String, all: &[Block], level: usize) {
    all.iter().for_each(|one| block(out, one, level));
}

fn block(out: &mut String, block: &Block, level: usize) {
    match block {
        Block::Section { title, blocks: inside, .. } => {
            heading(out, &escape(title), level);
            blocks(out, inside, level + 1);
        }
        Block::Heading { text } => heading(out, &inline(text), level),
        Block::Paragraph { text, weight: Weight::Note } => paragraph(out, &format!("*{}*", inline(text))),
        Block::Paragraph { text, .. } => paragraph(out, &inline(text)),
        Block::Equation { formula } => paragraph(out, &format!("    {}", linear(formula))),
        Block::List { items } => list(out, items.iter().map(inline)),
        Block::Definitions { items } => {
            list(out, items.iter().map(|(term, meaning)| format!("**{}**: {}", inline(term), inline(meaning))));
        }
        Block::Table(table) => write_table(out, table),
        Block::Cards { items } => list(out, items.iter().map(card)),
        Block::Figure(figure) => paragraph(out, &format!("*Figure: {}*", escape(&figure.title))),
        Block::Row { figures } => {
            figures.iter().for_each(|figure| paragraph(out, &format!("*Figure: {}*", escape(&figure.title))));
        }
        Block::Drawing { description, caption, .. } => {
            paragraph(out, &escape(description));
            paragraph(out, &inline(caption));
        }
        Block::Finding(found) => list(out, std::iter::once(finding(found))),
        Block::Callout { title, blocks: inside, .. } => {
            paragraph(out, &format!("**{}**", escape(title)));
            blocks(out, inside, level);
        }
        Block::Preformatted { text } => paragraph(out, &format!("```\n{}\n```", text.trim_end())),
        Block::Fold { summary, blocks: inside } => {
            paragraph(out, &inline(summary));
            blocks(out, inside, level);
        }
    }
}

fn heading(out: &mut String, text: &str, level: usize) {
    paragraph(out, &format!("{} {text}", "#".repeat(level.min(6))));
}

fn paragraph(out: &mut String, text: &str) {
    if !text.is_empty() {
        out.push_str(text);
        out.push_str("\n\n");
    }
}

fn list(out: &mut String, items: impl Iterator<Item = String>) {
    items.for_each(|item| out.push_str(&format!("- {item}\n")));
    out.push('\n');
}

fn card(Card { label, value }: &Card) -> String {
    let value = match value {
        Ok(quantity) => escape(&quantity.text()),
        Err(why) => inline(why),
    };
    format!("{}: **{value}**", inline(label))
}

fn finding(Finding { severity, text, remedy, places, .. }: &Finding) -> String {
    let mut all = format!("**{}**: {}", escape(severity), inline(text));
    remedy.iter().for_each(|remedy| all.push_str(&format!(" {}", inline(remedy))));
    places.iter().for_each(|place| all.push_str(&format!(" ({})", escape(place))));
    all
}

fn write_table(out: &mut String, table: &Table) {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    out.push_str(&line(table.columns.iter().map(|column| inline(&column.heading)).collect()));
    let side = |align: Align| if align == Align::Right { "---:" } else { "---" };
    out.push_str(&line(table.columns.iter().map(|column| side(column.align).to_owned()).collect()));
    for Row { cells, notes } in &table.rows {
        let mut cells: Vec<String> = cells.iter().map(cell).collect();
        if let Some(last) = cells.last_mut() {
            notes.iter().for_each(|note| last.push_str(&format!(" *{}*", escape(note))));
        }
        out.push_str(&line(cells));
    }
    out.push('\n');
}

fn cell(cell: &Cell) -> String {
    match &cell.content {
        Content::Text(text) => inline(text),
        Content::Quantity(quantity) => escape(&quantity.text()),
        Content::Interval(quantity) => escape(&quantity.interval()),
    }
}

fn inline(text: &Prose) -> String {
    let piece = |piece: &Inline| match piece {
        Inline::Text(text) | Inline::Tag(_, text) => escape(text),
        Inline::Strong(text) => format!("**{}**", escape(text)),
        Inline::Code(text) => format!("`{}`", text.replace('`', "'").replace('|', "\\|")),
        Inline::Symbol(symbol) => {
            let set = |(piece, below)| if below { format!("<sub>{}</sub>", escape(piece)) } else { escape(piece) };
            symbol.pieces().into_iter().map(set).collect()
        }
        Inline::Quantity(quantity) => escape(&quantity.text()),
        Inline::Link { text, target } => format!("[{}]({target})", escape(text)),
    };
    text.0.iter().map(piece).collect()
}

/// The text with the characters escaped that Markdown and its tables give a meaning.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if "\\`*_[]<>|#".contains(c) {
            escaped.push('\\');
        }
        escaped.push(if c.is_control() { ' ' } else { c });
    }
    escaped
}
