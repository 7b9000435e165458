//! Tables: columns that fit the page, headings that are repeated, rows that stay whole.

use std::rc::Rc;

use pdf_writer::types::TableHeaderScope;

use super::font::Face;
use super::layout::{CellLine, GAP, Layout, Place, small};
use super::strip::{Area, Shape, Strip, height, keep_together};
use super::structure::{Node, Role};
use super::text::{Colour, INK, LINE, SOFT, Style, colour};
use crate::prose::{Inline, Prose};
use crate::table::{Align, Cell, Content, Row, Table};
use crate::tone::Tone;

/// Sizes of a table's text: the first at which the columns fit.
const SIZES: [f32; 4] = [8.0, 7.4, 6.8, 6.2];
/// Between columns.
const BETWEEN: f32 = 9.0;
/// Longer words may be broken, points, and longer numbers with interval and unit.
const LONG_WORD: f32 = 92.0;
const LONG_NUMBER: f32 = 170.0;
/// Widths at which a text of several lines reads well, and still well enough, points.
const EASE: [f32; 2] = [84.0, 60.0];
/// The narrowest column whose words are broken; a table that needs narrower ones has its cells below each other.
const NARROWEST: f32 = 30.0;
/// Above and below the text of a row.
const AROUND: f32 = 2.6;
/// A table that is not higher, in pages, stays on one page.
const SHORT: f32 = 0.35;
const NOTE_INDENT: f32 = 8.0;

/// The columns of a table: where each begins, how wide it is, and the size of the text.
struct Columns {
    places: Vec<(f32, f32)>,
    size: f32,
}

/// The text of a cell.
pub(super) fn words(cell: &Cell) -> Prose {
    match &cell.content {
        Content::Text(text) => text.clone(),
        Content::Quantity(quantity) => quantity.clone().into(),
        Content::Interval(quantity) => Prose::verbatim(quantity.interval().replace(' ', "\u{a0}")),
    }
}

fn look(cell: &Cell, size: f32) -> Style {
    let face = if cell.tone == Tone::Strong { Face::Bold } else { Face::Regular };
    Style::new(face, size, colour(cell.tone))
}

fn heading_look(size: f32) -> Style {
    Style::new(Face::Bold, 0.94 * size, SOFT)
}

impl Layout<'_> {
    /// A table in columns, or, if it has too many of them, with the cells of each row below each other.
    pub(super) fn table(&mut self, table: &Table, place: Place) -> Vec<Strip> {
        let mut all = match self.columns(table, place.room) {
            Some(columns) => self.in_columns(table, &columns, place),
            None => self.stacked(table, place),
        };
        if let Some(first) = all.first_mut() {
            first.before = GAP;
        }
        if height(&all) < SHORT * self.column {
            keep_together(&mut all);
        }
        all
    }

    /// The widths at which the table fits: with whole words in the largest text that allows it, else with broken words.
    fn columns(&self, table: &Table, room: f32) -> Option<Columns> {
        let count = table.columns.len();
        let room = room - BETWEEN * count.saturating_sub(1) as f32;
        let measured: Vec<_> = SIZES.iter().map(|size| (*size, self.measured(table, *size))).collect();
        let at_ease = |ease: f32| {
            measured.iter().find_map(|(size, (natural, least))| {
                let enough = |(natural, least): (&f32, &f32)| natural.min(least.max(ease));
                let enough: Vec<f32> = natural.iter().zip(least).map(enough).collect();
                shared(natural, &enough, room).map(|widths| (widths, *size))
            })
        };
        let whole_words = || {
            measured
                .iter()
                .find_map(|(size, (natural, least))| shared(natural, least, room).map(|widths| (widths, *size)))
        };
        let broken = || {
            let size = SIZES[SIZES.len() - 1];
            let (natural, _) = self.measured(table, size);
            let least = vec![NARROWEST; count];
            shared(&natural, &least, room).map(|widths| (widths, size))
        };
        let (widths, size) = EASE.into_iter().find_map(at_ease).or_else(whole_words).or_else(broken)?;
        let mut left = 0.0;
        let placed = widths.into_iter().map(|width| {
            let x = left;
            left += width + BETWEEN;
            (x, width)
        });
        Some(Columns { places: placed.collect(), size })
    }

    /// The widths of columns whose text is not broken, and of those whose words are not.
    fn measured(&self, table: &Table, size: f32) -> (Vec<f32>, Vec<f32>) {
        let of_column = |index: usize| {
            let heading = &table.columns[index].heading;
            let texts = table.rows.iter().filter_map(|row| row.cells.get(index));
            let texts =
                texts.map(|cell| (words(cell), look(cell, size))).chain([(heading.clone(), heading_look(size))]);
            texts.fold((0.0_f32, 0.0_f32), |(natural, least), (text, style)| {
                let is_number = text.0.iter().any(|piece| matches!(piece, Inline::Quantity(_)));
                let longest = if is_number { LONG_NUMBER } else { LONG_WORD };
                let word = self.setter.longest_word(&text, style).min(longest);
                (natural.max(self.setter.width(&text, style)), least.max(word))
            })
        };
        // A hair more, so that what fits exactly is not broken by the rounding of a sum.
        (0..table.columns.len()).map(of_column).map(|(natural, least)| (natural + 0.01, least + 0.01)).unzip()
    }

    fn in_columns(&mut self, table: &Table, columns: &Columns, place: Place) -> Vec<Strip> {
        let node = self.structure.node(Role::Table, place.node);
        let head = table.has_headings().then(|| self.head(table, columns, node, place.room));
        let body = self.structure.node(Role::TBody, node);
        let is_low = |head: &&Strip| head.height < 0.4 * self.column;
        let repeated = head.as_ref().filter(is_low).map(|head| Rc::new(as_decoration(head)));
        let most = 0.8 * self.column - repeated.as_ref().map_or(0.0, |head| head.height);
        let mut rows = Vec::new();
        for row in &table.rows {
            let mut strips = self.table_row(row, columns, table, body, most);
            if let Some(last) = strips.last_mut() {
                let width = place.room.min(columns.places.last().map_or(0.0, |(x, width)| x + width));
                rule(last, width, 0.4, LINE);
            }
            strips.iter_mut().for_each(|strip| strip.repeated.clone_from(&repeated));
            rows.extend(strips);
        }
        let mut all: Vec<Strip> = head.into_iter().collect();
        if let Some(first) = rows.first_mut() {
            first.repeated = None;
        }
        all.extend(rows);
        all
    }

    /// The headings, which are kept with the first row.
    fn head(&mut self, table: &Table, columns: &Columns, node: Node, room: f32) -> Strip {
        let group = self.structure.node(Role::THead, node);
        let row = self.structure.node(Role::TR, group);
        let style = heading_look(columns.size);
        let mut nodes = Vec::new();
        let mut cells = Vec::new();
        for (column, (x, width)) in table.columns.iter().zip(&columns.places) {
            let cell = match column.heading.is_empty() {
                true => self.structure.node(Role::TD, row),
                false => self.structure.heading_cell(row, TableHeaderScope::Column),
            };
            cells.push(aligned(self.cell_lines(&column.heading, style, *x, *width, cell), *width, column.align));
            nodes.push(cell);
        }
        let mut head = Strip::of_stack(self.side_by_side(cells, &nodes, self.column));
        head.height += AROUND;
        head.is_kept = true;
        let width = room.min(columns.places.last().map_or(0.0, |(x, width)| x + width));
        rule(&mut head, width, 0.7, SOFT);
        head
    }

    /// A row and its remarks.
    fn table_row(&mut self, row: &Row, columns: &Columns, table: &Table, body: Node, most: f32) -> Vec<Strip> {
        let node = self.structure.node(Role::TR, body);
        let mut nodes = Vec::new();
        let mut cells = Vec::new();
        for (number, ((cell, (x, width)), column)) in
            row.cells.iter().zip(&columns.places).zip(&table.columns).enumerate()
        {
            let of_cell = match number == 0 && !table.has_headings() {
                true => self.structure.heading_cell(node, TableHeaderScope::Row),
                false => self.structure.node(Role::TD, node),
            };
            let lines = self.cell_lines(&words(cell), look(cell, columns.size), *x, *width, of_cell);
            cells.push(aligned(lines, *width, column.align));
            nodes.push(of_cell);
        }
        let mut strips = self.side_by_side(cells, &nodes, most);
        for note in &row.notes {
            strips.extend(self.remark(note, columns, body));
        }
        keep_together(&mut strips);
        if let Some(first) = strips.first_mut() {
            first.shift(0.0, AROUND);
            first.height += AROUND;
        }
        if let Some(last) = strips.last_mut() {
            last.height += AROUND;
        }
        strips
    }

    /// A remark below a row, across all columns.
    fn remark(&mut self, note: &str, columns: &Columns, body: Node) -> Vec<Strip> {
        let row = self.structure.node(Role::TR, body);
        let cell = self.structure.wide_cell(row, columns.places.len());
        let room = columns.places.last().map_or(0.0, |(x, width)| x + width).max(200.0) - NOTE_INDENT;
        let style = Style { size: columns.size, ..small() };
        let mut strips = self.paragraph(&note.into(), style, cell, room);
        strips.iter_mut().for_each(|strip| {
            strip.before = 0.0;
            strip.shift(NOTE_INDENT, 0.0);
        });
        strips
    }

    /// The cells of each row below each other, behind the headings of their columns.
    fn stacked(&mut self, table: &Table, place: Place) -> Vec<Strip> {
        let list = self.structure.node(Role::L, place.node);
        let style = Style::new(Face::Regular, SIZES[0], INK);
        let mut all = Vec::new();
        for row in &table.rows {
            let item = self.structure.node(Role::LI, list);
            let body = self.structure.node(Role::LBody, item);
            let mut strips = Vec::new();
            let filled = row.cells.iter().zip(&table.columns).filter(|(cell, _)| !words(cell).is_empty());
            for (cell, column) in filled {
                let node = self.structure.node(Role::P, body);
                let heading = if column.heading.is_empty() { "" } else { ": " };
                let text = Prose::strong(column.heading.plain()).then(Prose::verbatim(heading)).then(words(cell));
                strips.extend(self.paragraph(&text, Style { colour: colour(cell.tone), ..style }, node, place.room));
            }
            for note in &row.notes {
                let node = self.structure.node(Role::P, body);
                strips.extend(self.paragraph(&note.into(), small(), node, place.room));
            }
            strips.iter_mut().for_each(|strip| strip.before = 0.0);
            if let Some(last) = strips.last_mut() {
                last.height += 2.0 * AROUND;
                rule(last, place.room, 0.4, LINE);
            }
            all.extend(strips);
        }
        all
    }
}

/// A line at the lower end of a strip.
fn rule(strip: &mut Strip, width: f32, height: f32, colour: Colour) {
    let y = strip.height - 0.5 * height;
    strip.draw(None, Shape::Fill(Area { x: 0.0, y, width, height }, colour));
}

/// Lines at the right end of their column, where it has numbers.
fn aligned(mut lines: Vec<CellLine>, width: f32, align: Align) -> Vec<CellLine> {
    if align == Align::Right {
        lines.iter_mut().for_each(|line| line.x += (width - line.line.width).max(0.0));
    }
    lines
}

/// The headings as they are repeated: read once, and only seen again.
fn as_decoration(head: &Strip) -> Strip {
    let mut copy = head.clone();
    copy.marks.retain(|mark| !matches!(mark.shape, Shape::Nothing));
    copy.marks.iter_mut().for_each(|mark| mark.node = None);
    copy.links.clear();
    copy
}

/// Widths of columns that fit the room together, each between that of its longest word and that of its text. A column
/// with more text gets more, though less than in proportion, so that a short text beside it has few lines too.
fn shared(natural: &[f32], least: &[f32], room: f32) -> Option<Vec<f32>> {
    let at = |share: f32| -> Vec<f32> {
        let width = |(natural, least): (&f32, &f32)| natural.min(least + share * (natural - least).max(0.0).sqrt());
        natural.iter().zip(least).map(width).collect()
    };
    let fits = |widths: &[f32]| widths.iter().sum::<f32>() <= room;
    if fits(natural) {
        return Some(natural.to_vec());
    }
    let (mut low, mut high) = (0.0, room);
    if !fits(&at(low)) {
        return None;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        *(if fits(&at(middle)) { &mut low } else { &mut high }) = middle;
    }
    Some(at(low))
}
