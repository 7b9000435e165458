//! A table on a terminal: in columns where they fit, one row below the other where they do not.

use unicode_width::UnicodeWidthStr;

use super::lines::{longest_word, wrap};
use super::screen::{Screen, safe};
use crate::table::{Align, Cell, Row, Table};
use crate::tone::Tone;

/// Blanks between two columns.
const GAP: usize = 2;
/// Blanks before a remark below a row, beside those before the table.
const NOTE_INDENT: usize = 4;
/// A last column of text is broken into lines down to this width before others are.
const NARROW: usize = 24;
/// Longer words are no reason to keep a column wide.
const LONG_WORD: usize = 18;

/// The lines of a table, indented.
pub(super) fn table_lines(table: &Table, indent: usize, screen: Screen) -> Vec<String> {
    let room = screen.width.saturating_sub(indent);
    let Some(widths) = fitted(table, room, screen.is_narrow) else { return stacked(table, indent, screen) };
    let mut lines = Vec::new();
    if table.has_headings() {
        push_row(table, &headings(table), &widths, indent, screen, &mut lines);
    }
    for Row { cells, notes } in &table.rows {
        push_row(table, cells, &widths, indent, screen, &mut lines);
        push_notes(notes, indent, screen, &mut lines);
    }
    lines
}

fn headings(table: &Table) -> Vec<Cell> {
    table.columns.iter().map(|column| Cell::toned(column.heading.plain(), Tone::Faint)).collect()
}

fn push_notes(notes: &[String], indent: usize, screen: Screen, lines: &mut Vec<String>) {
    for part in notes.iter().flat_map(|note| wrap(&safe(note), screen.width.saturating_sub(indent + NOTE_INDENT))) {
        lines.push(format!("{}{}", " ".repeat(indent + NOTE_INDENT), screen.painted(Tone::Faint, &part)));
    }
}

/// The widths of columns that fit into the room, if there are any at which every word stays whole. The last column
/// gives way first if it is text, then the widest.
fn fitted(table: &Table, room: usize, must_fit: bool) -> Option<Vec<usize>> {
    let mut widths = of_columns(table, UnicodeWidthStr::width);
    let gaps = GAP * widths.len().saturating_sub(1);
    let room = if must_fit { room.checked_sub(gaps)? } else { room.saturating_sub(gaps) };
    let least = of_columns(table, |text| longest_word(text).min(LONG_WORD));
    let is_text = table.columns.last().is_some_and(|column| column.align == Align::Left);
    if let (true, Some(last)) = (is_text, widths.last_mut()) {
        let others: usize = of_columns(table, UnicodeWidthStr::width).iter().rev().skip(1).sum();
        *last = (*last).min(room.saturating_sub(others).max(NARROW));
    }
    while must_fit && widths.iter().sum::<usize>() > room {
        let can_give = (0..widths.len()).filter(|&index| widths[index] > least[index]);
        let widest = can_give.max_by_key(|&index| widths[index])?;
        widths[widest] -= 1;
    }
    Some(widths)
}

/// The largest measure of the texts of each column.
fn of_columns(table: &Table, measure: impl Fn(&str) -> usize) -> Vec<usize> {
    let of_column = |(index, column): (usize, &crate::table::Column)| {
        let cells = table.rows.iter().filter_map(|row| row.cells.get(index)).map(|cell| measure(&safe(&cell.plain())));
        cells.max().unwrap_or(0).max(measure(&column.heading.plain()))
    };
    table.columns.iter().enumerate().map(of_column).collect()
}

fn push_row(table: &Table, cells: &[Cell], widths: &[usize], indent: usize, screen: Screen, lines: &mut Vec<String>) {
    let texts: Vec<Vec<String>> =
        cells.iter().zip(widths).map(|(cell, width)| wrap(&safe(&cell.plain()), *width)).collect();
    let height = texts.iter().map(Vec::len).max().unwrap_or(0);
    for number in 0..height {
        let mut line = " ".repeat(indent);
        for ((index, cell), of_column) in cells.iter().enumerate().zip(&table.columns) {
            let text = texts[index].get(number).map_or("", String::as_str);
            let padding = " ".repeat(widths[index].saturating_sub(text.width()));
            let (before, after) =
                if of_column.align == Align::Right { (padding.as_str(), "") } else { ("", padding.as_str()) };
            let after = if index + 1 == cells.len() { String::new() } else { format!("{after}{}", " ".repeat(GAP)) };
            line.push_str(&format!("{before}{}{after}", screen.painted(cell.tone, text)));
        }
        lines.push(line.trim_end().to_owned());
    }
}

/// Each row below the one before: its first cell, and below it the others, each behind the heading of its column.
fn stacked(table: &Table, indent: usize, screen: Screen) -> Vec<String> {
    let mut lines = Vec::new();
    for Row { cells, notes } in &table.rows {
        let mut filled = cells.iter().zip(&table.columns).filter(|(cell, _)| !cell.plain().is_empty());
        if let Some((first, _)) = filled.next() {
            push_text(&safe(&first.plain()), first.tone, indent, screen, &mut lines);
        }
        for (cell, column) in filled {
            let heading = column.heading.plain();
            let between = if heading.is_empty() { "" } else { ": " };
            let text = safe(&format!("{heading}{between}{}", cell.plain()));
            push_text(&text, cell.tone, indent + NOTE_INDENT, screen, &mut lines);
        }
        push_notes(notes, indent, screen, &mut lines);
    }
    lines
}

fn push_text(text: &str, tone: Tone, indent: usize, screen: Screen, lines: &mut Vec<String>) {
    for part in wrap(text, screen.width.saturating_sub(indent)) {
        lines.push(format!("{}{}", " ".repeat(indent), screen.painted(tone, &part)).trim_end().to_owned());
    }
}
