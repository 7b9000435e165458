//! From blocks to strips of a page.

use std::rc::Rc;

use super::font::Face;
use super::options::PdfError;
use super::strip::{Area, LinkArea, Shape, Strip, height, keep_ends, keep_together};
use super::structure::{Node, Role, Structure};
use super::text::{Fragment, INK, LINE, Line, Link, SOFT, Setter, Style, TAG_MARGIN, WASH, colour};
use super::vector::Reader;
use crate::model::{Block, Card, Weight};
use crate::prose::Prose;
use crate::tone::Tone;

/// Sizes of text, points.
pub(super) const BODY: f32 = 8.8;
pub(super) const SMALL: f32 = 7.8;
const LEAD: f32 = 9.6;
const TITLE: f32 = 20.0;
const SECTION: f32 = 14.5;
const HEADING: f32 = 10.2;
const CODE: f32 = 7.2;
/// Space above blocks.
pub(super) const GAP: f32 = 7.0;
const ABOVE_SECTION: f32 = 24.0;
const ABOVE_HEADING: f32 = 13.0;
/// From the edge of a framed block to its content.
const PADDING: f32 = 10.0;
/// Cards beside each other.
const CARDS: usize = 3;
/// From the frame of a card to its text.
const CARD_PADDING: f32 = 7.0;
/// From the mark of an item to its text.
const ITEM: f32 = 11.0;
/// Nesting of headings.
const LEVELS: [Role; 6] = [Role::H1, Role::H2, Role::H3, Role::H4, Role::H5, Role::H6];

/// A heading with an entry among the bookmarks.
pub(super) struct Heading {
    pub(super) level: usize,
    pub(super) title: String,
    /// Name that links use for it.
    pub(super) id: Option<String>,
}

/// Where blocks are put: how wide, below which node, how deep.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) room: f32,
    pub(super) node: Node,
    pub(super) level: usize,
}

/// A line of a cell, and what it is part of.
pub(super) struct CellLine {
    pub(super) line: Line,
    pub(super) x: f32,
    pub(super) style: Style,
    pub(super) node: Node,
    pub(super) before: f32,
}

/// Turns blocks into strips.
pub(super) struct Layout<'l> {
    pub(super) setter: Setter<'l>,
    pub(super) structure: Structure,
    pub(super) reader: Reader,
    pub(super) headings: Vec<Heading>,
    /// The height of a page's content.
    pub(super) column: f32,
    pub(super) most_points: usize,
    pub(super) figures: usize,
}

/// Returns true if the end of a block is on a page with the start of the next. A remark belongs to the block before it,
/// and a text to the block that it announces.
fn belong_together(before: &Block, next: &Block) -> bool {
    match next {
        Block::Paragraph { weight: Weight::Note, .. } => true,
        Block::Table(_) | Block::List { .. } | Block::Equation { .. } | Block::Figure(_) => {
            matches!(before, Block::Paragraph { .. })
        }
        _ => false,
    }
}

pub(super) fn body() -> Style {
    Style::new(Face::Regular, BODY, INK)
}

pub(super) fn small() -> Style {
    Style::new(Face::Regular, SMALL, SOFT)
}

pub(super) fn bold(size: f32) -> Style {
    Style::new(Face::Bold, size, INK)
}

impl Layout<'_> {
    /// Blocks below each other.
    pub(super) fn blocks(&mut self, blocks: &[Block], place: Place) -> Result<Vec<Strip>, PdfError> {
        let mut all: Vec<Strip> = Vec::new();
        let mut before = None;
        let mut rest = blocks;
        while let Some((first, behind)) = rest.split_first() {
            let findings = rest.iter().take_while(|block| matches!(block, Block::Finding(_))).count();
            let strips = match findings {
                0 => self.block(first, place)?,
                _ => self.findings(&rest[..findings], place),
            };
            rest = if findings == 0 { behind } else { &rest[findings..] };
            if let (true, Some(last)) = (before.is_some_and(|before| belong_together(before, first)), all.last_mut()) {
                last.is_kept = true;
            }
            before = Some(first);
            all.extend(strips);
        }
        Ok(all)
    }

    fn block(&mut self, block: &Block, place: Place) -> Result<Vec<Strip>, PdfError> {
        Ok(match block {
            Block::Section { id, title, blocks } => return self.section(id, title, blocks, place),
            Block::Heading { text } => vec![self.heading(text, HEADING, place, None)],
            Block::Paragraph { text, weight } => self.weighted(text, *weight, place),
            Block::Equation { formula } => self.equation(formula, place),
            Block::List { items } => self.list(items, place),
            Block::Definitions { items } => self.definitions(items, place),
            Block::Table(table) => self.table(table, place),
            Block::Cards { items } => self.cards(items, place),
            Block::Figure(figure) => self.figure(figure, place)?,
            Block::Row { figures } => self.row(figures, place)?,
            Block::Drawing { svg, description, caption } => self.drawing(svg, description, caption, place)?,
            Block::Finding(_) => self.findings(std::slice::from_ref(block), place),
            Block::Callout { tone, kicker, title, blocks } => {
                return self.callout(*tone, kicker, title, blocks, place);
            }
            Block::Preformatted { text } => self.preformatted(text, place),
            Block::Fold { summary, blocks } => return self.fold(summary, blocks, place),
        })
    }

    /// The title of the page.
    pub(super) fn title(&mut self, title: &str, subtitle: &Prose, place: Place) -> Vec<Strip> {
        let mut all = vec![self.heading(&Prose::verbatim(title), TITLE, Place { level: 0, ..place }, None)];
        let node = self.structure.node(Role::P, place.node);
        all.extend(self.paragraph(subtitle, small(), node, place.room));
        keep_together(&mut all);
        all
    }

    fn section(&mut self, id: &str, title: &str, blocks: &[Block], place: Place) -> Result<Vec<Strip>, PdfError> {
        let place = Place { node: self.structure.node(Role::Sect, place.node), ..place };
        let mut all = vec![self.heading(&Prose::verbatim(title), SECTION, place, Some(id))];
        all[0].before = ABOVE_SECTION;
        all.extend(self.blocks(blocks, Place { level: place.level + 1, ..place })?);
        Ok(all)
    }

    /// A heading, which is kept with what follows.
    pub(super) fn heading(&mut self, text: &Prose, size: f32, place: Place, id: Option<&str>) -> Strip {
        let node = self.structure.node(LEVELS[place.level.min(LEVELS.len() - 1)], place.node);
        let strips = self.paragraph(text, bold(size), node, place.room);
        let heading = Heading { level: place.level, title: text.plain(), id: id.map(str::to_owned) };
        self.headings.push(heading);
        Strip {
            before: ABOVE_HEADING,
            is_kept: true,
            heading: Some(self.headings.len() - 1),
            ..Strip::of_stack(strips)
        }
    }

    fn weighted(&mut self, text: &Prose, weight: Weight, place: Place) -> Vec<Strip> {
        let style = match weight {
            Weight::Lead => Style { size: LEAD, ..body() },
            Weight::Body => body(),
            Weight::Note => small(),
        };
        let node = self.structure.node(Role::P, place.node);
        self.paragraph(text, style, node, place.room)
    }

    /// A paragraph, a strip a line.
    pub(super) fn paragraph(&mut self, text: &Prose, style: Style, node: Node, room: f32) -> Vec<Strip> {
        let lines = self.setter.lines(text, style, room);
        let mut known = Vec::new();
        let mut strips: Vec<Strip> = lines
            .iter()
            .map(|line| {
                let mut strip = Strip { height: style.line_height(), ..Strip::default() };
                self.write(&mut strip, line, (0.0, style.base()), node, &mut known);
                strip
            })
            .collect();
        if let Some(first) = strips.first_mut() {
            first.before = GAP;
        }
        keep_ends(&mut strips);
        strips
    }

    /// Writes a line into a strip. `known` has the links of the text so far, each with its node.
    pub(super) fn write(
        &mut self,
        strip: &mut Strip,
        line: &Line,
        (x, base): (f32, f32),
        node: Node,
        known: &mut Vec<(usize, Node)>,
    ) {
        for (shift, fragment) in &line.fragments {
            let Fragment { style, width, link, text } = fragment;
            let area = Area {
                x: x + shift,
                y: base - style.rise - 0.95 * style.size,
                width: *width,
                height: 1.25 * style.size,
            };
            if style.is_tag {
                let frame = Area { width: width - TAG_MARGIN, ..area };
                strip.draw(None, Shape::Outline(frame, style.colour));
            }
            let node = match link {
                None => node,
                Some(Link { number, target }) => {
                    let known_node = known.iter().find(|(known, _)| known == number).map(|(_, node)| *node);
                    let of_link = known_node.unwrap_or_else(|| self.structure.node(Role::Link, node));
                    known.push((*number, of_link));
                    let words = text.trim().to_owned();
                    strip.links.push(LinkArea { area, target: Rc::clone(target), node: of_link, words });
                    of_link
                }
            };
            strip.draw(node, Shape::Text(x + shift, base, fragment.clone()));
        }
    }

    /// Cells beside each other, each of lines. What is higher than most of a page is divided between lines.
    pub(super) fn side_by_side(&mut self, cells: Vec<Vec<CellLine>>, nodes: &[Node], most: f32) -> Vec<Strip> {
        let mut cells: Vec<_> = cells.into_iter().map(|cell| (cell.into_iter().peekable(), Vec::new())).collect();
        let mut all = Vec::new();
        loop {
            let mut strip = Strip::default();
            for ((lines, known), node) in cells.iter_mut().zip(nodes) {
                strip.draw(*node, Shape::Nothing);
                let mut y = 0.0;
                while let Some(next) =
                    lines.next_if(|next| y == 0.0 || y + next.before + next.style.line_height() <= most)
                {
                    y += if y == 0.0 { 0.0 } else { next.before };
                    self.write(&mut strip, &next.line, (next.x, y + next.style.base()), next.node, known);
                    y += next.style.line_height();
                }
                strip.height = strip.height.max(y);
            }
            all.push(strip);
            if cells.iter_mut().all(|(lines, _)| lines.peek().is_none()) {
                return all;
            }
        }
    }

    /// The lines of a cell.
    pub(super) fn cell_lines(&self, text: &Prose, style: Style, x: f32, room: f32, node: Node) -> Vec<CellLine> {
        let lines = self.setter.lines(text, style, room);
        lines.into_iter().map(|line| CellLine { line, x, style, node, before: 0.0 }).collect()
    }

    fn list(&mut self, items: &[Prose], place: Place) -> Vec<Strip> {
        let list = self.structure.node(Role::L, place.node);
        let mut all = Vec::new();
        for item in items {
            let (mark, text) = self.item(list);
            let cells = vec![
                self.cell_lines(&Prose::verbatim("•"), body(), 2.0, ITEM, mark),
                self.cell_lines(item, body(), ITEM, place.room - ITEM, text),
            ];
            all.extend(self.entry(cells, [mark, text], if all.is_empty() { GAP } else { 3.0 }));
        }
        all
    }

    /// The nodes of an item of a list: its label and its text.
    fn item(&mut self, list: Node) -> (Node, Node) {
        let item = self.structure.node(Role::LI, list);
        (self.structure.node(Role::Lbl, item), self.structure.node(Role::LBody, item))
    }

    /// An item of a list.
    fn entry(&mut self, cells: Vec<Vec<CellLine>>, nodes: [Node; 2], before: f32) -> Vec<Strip> {
        let mut strips = self.side_by_side(cells, &nodes, 0.8 * self.column);
        if let Some(first) = strips.first_mut() {
            first.before = before;
        }
        strips
    }

    fn definitions(&mut self, items: &[(Prose, Prose)], place: Place) -> Vec<Strip> {
        let list = self.structure.node(Role::L, place.node);
        let widest = items.iter().map(|(term, _)| self.setter.width(term, bold(BODY))).fold(0.0, f32::max);
        let terms = widest.min(0.3 * place.room);
        let mut all = Vec::new();
        for (term, meaning) in items {
            let (label, text) = self.item(list);
            let left = terms + PADDING;
            let cells = vec![
                self.cell_lines(term, bold(BODY), 0.0, terms, label),
                self.cell_lines(meaning, body(), left, place.room - left, text),
            ];
            all.extend(self.entry(cells, [label, text], if all.is_empty() { GAP } else { 3.0 }));
        }
        all
    }

    fn findings(&mut self, findings: &[Block], place: Place) -> Vec<Strip> {
        let list = self.structure.node(Role::L, place.node);
        let found = findings.iter().filter_map(|block| match block {
            Block::Finding(found) => Some((Prose::tag(found.tone, found.severity.as_str()), found)),
            _ => None,
        });
        let found: Vec<_> = found.collect();
        let widest = found.iter().map(|(tag, _)| self.setter.width(tag, body())).fold(0.0, f32::max);
        let left = widest.min(0.25 * place.room) + PADDING;
        let mut all = Vec::new();
        for (tag, found) in found {
            let (label, text) = self.item(list);
            let mut lines = Vec::new();
            let strong = |text: &Prose| (text.clone(), bold(BODY));
            let places = found.places.iter().map(|place| (Prose::verbatim(place.as_str()), small()));
            for (words, style) in
                [(found.text.clone(), body())].into_iter().chain(found.remedy.iter().map(strong)).chain(places)
            {
                let node = self.structure.node(Role::P, text);
                let mut more = self.cell_lines(&words, style, left, place.room - left, node);
                more.iter_mut().take(1).for_each(|first| first.before = 1.5);
                lines.extend(more);
            }
            let cells = vec![self.cell_lines(&tag, body(), 0.5, left - PADDING + 1.0, label), lines];
            all.extend(self.entry(cells, [label, text], GAP));
        }
        all
    }

    /// Cards in rows: value and unit large, the uncertainty small below.
    fn cards(&mut self, items: &[Card], place: Place) -> Vec<Strip> {
        let list = self.structure.node(Role::L, place.node);
        let width = place.room / CARDS as f32;
        let mut all = Vec::new();
        for row in items.chunks(CARDS) {
            let cards: Vec<Strip> = row.iter().map(|card| self.card(card, list, width)).collect();
            let height = cards.iter().map(|card| card.height).fold(0.0, f32::max);
            let mut strip = Strip { before: if all.is_empty() { GAP } else { 0.0 }, ..Strip::default() };
            for (n, card) in cards.into_iter().enumerate() {
                let x = n as f32 * width;
                strip.draw(None, Shape::Outline(Area { x, y: 0.0, width, height }, LINE));
                strip.absorb(card, x + CARD_PADDING, 0.0);
            }
            all.push(strip);
        }
        keep_together(&mut all);
        all
    }

    fn card(&mut self, Card { label, value }: &Card, list: Node, width: f32) -> Strip {
        let (name, text) = self.item(list);
        let room = width - 2.0 * CARD_PADDING;
        let mut strips = self.paragraph(label, small(), name, room);
        let large = |size: f32| Style { size, ..bold(size) };
        let (value, range) = match value {
            Err(why) => ((Prose::verbatim("not estimated"), Style { colour: SOFT, ..body() }), why.clone()),
            Ok(quantity) => match quantity.short() {
                None => ((Prose::verbatim(quantity.text()), large(11.0)), Prose::default()),
                Some(digits) => (
                    (Prose::verbatim(format!("{} {}", digits.value, digits.unit)), large(13.0)),
                    Prose::verbatim(format!("{}\u{a0}\u{a0} {}", digits.spread, digits.interval)),
                ),
            },
        };
        for (words, style) in [value, (range, small())] {
            let node = self.structure.node(Role::P, text);
            strips.extend(self.paragraph(&words, style, node, room));
        }
        strips.iter_mut().for_each(|strip| strip.before = 0.0);
        let mut card = Strip::of_stack(strips);
        card.shift(0.0, 4.0);
        card.height += 9.0;
        card
    }

    /// A conclusion on a tinted ground, with a bar in the colour of its tone.
    fn callout(
        &mut self,
        tone: Tone,
        kicker: &str,
        title: &str,
        blocks: &[Block],
        place: Place,
    ) -> Result<Vec<Strip>, PdfError> {
        let node = self.structure.node(Role::Div, place.node);
        let inner = Place { room: place.room - 2.0 * PADDING, node, ..place };
        let label = self.structure.node(Role::P, node);
        let mut all = self.paragraph(
            &Prose::verbatim(kicker.to_uppercase()),
            Style { face: Face::Bold, size: 7.0, ..small() },
            label,
            inner.room,
        );
        let of_title = self.structure.node(LEVELS[place.level.min(LEVELS.len() - 1)], node);
        let style = Style { colour: colour(tone), ..bold(SECTION) };
        all.extend(self.paragraph(&Prose::verbatim(title), style, of_title, inner.room));
        all.iter_mut().for_each(|strip| strip.before = 0.0);
        all.extend(self.blocks(blocks, inner)?);
        Ok(self.framed(all, colour(tone), place.room))
    }

    /// Strips on a tinted ground.
    fn framed(&mut self, mut strips: Vec<Strip>, bar: [f32; 3], width: f32) -> Vec<Strip> {
        let count = strips.len();
        for (n, strip) in strips.iter_mut().enumerate() {
            strip.before = if n == 0 { 7.0 } else { strip.before };
            strip.take_space();
            strip.height += if n + 1 == count { 8.0 } else { 0.0 };
            strip.shift(PADDING, 0.0);
            let ground = Area { x: 0.0, y: 0.0, width, height: strip.height };
            let decoration = |area, colour| super::strip::Mark { node: None, shape: Shape::Fill(area, colour) };
            strip.marks.insert(0, decoration(ground, WASH));
            strip.marks.insert(1, decoration(Area { width: 3.0, ..ground }, bar));
        }
        if height(&strips) < 0.7 * self.column {
            keep_together(&mut strips);
        }
        if let Some(first) = strips.first_mut() {
            first.before = GAP + 2.0;
        }
        strips
    }

    /// Text in which every space counts.
    fn preformatted(&mut self, text: &str, place: Place) -> Vec<Strip> {
        let node = self.structure.node(Role::P, place.node);
        let style = Style::new(Face::Mono, CODE, INK);
        let mut all = Vec::new();
        for line in text.trim_end().lines() {
            let unbroken = Prose::verbatim(line.replace('\t', "    ").replace(' ', "\u{a0}"));
            let mut strips = self.paragraph(&unbroken, style, node, place.room - 2.0 * PADDING);
            if strips.is_empty() {
                strips.push(Strip { height: style.line_height(), ..Strip::default() });
            }
            strips.iter_mut().for_each(|strip| strip.before = 0.0);
            all.extend(strips);
        }
        self.framed(all, LINE, place.room)
    }

    /// Details: on paper they are always shown.
    fn fold(&mut self, summary: &Prose, blocks: &[Block], place: Place) -> Result<Vec<Strip>, PdfError> {
        let node = self.structure.node(Role::P, place.node);
        let mut all = self.paragraph(summary, bold(BODY), node, place.room);
        all.iter_mut().for_each(|strip| strip.is_kept = true);
        if let Some(first) = all.first_mut() {
            first.before = ABOVE_HEADING;
        }
        all.extend(self.blocks(blocks, place)?);
        Ok(all)
    }
}
