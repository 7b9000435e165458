//! Blocks of a page as HTML.

use super::figure;
use super::figure::Points;
use super::text::{class, formula, prose};
use crate::markup;
use crate::markup::Markup;
use crate::model::{Block, Card, Finding, Weight};
use crate::prose::Prose;
use crate::table::{Align, Cell, Column, Content, Row, Table};
use crate::tone::Tone;

/// Characters of a cell that stays on one line.
const UNBROKEN: usize = 22;

/// Puts blocks into HTML; it numbers figures as they come.
#[derive(Debug)]
pub(super) struct Renderer {
    figures: usize,
    points: Points,
    in_section: bool,
}

impl Renderer {
    /// Has at most so many points of a line.
    pub(super) fn new(points: Points) -> Self {
        Renderer { figures: 0, points, in_section: false }
    }

    /// Blocks below each other.
    pub(super) fn blocks(&mut self, blocks: &[Block]) -> Markup {
        let mut all = Markup::default();
        let mut rest = blocks;
        while let Some((first, behind)) = rest.split_first() {
            if matches!(first, Block::Finding(_)) {
                let count = rest.iter().take_while(|block| matches!(block, Block::Finding(_))).count();
                all.push(findings(&rest[..count]));
                rest = &rest[count..];
            } else {
                all.push(self.block(first));
                rest = behind;
            }
        }
        all
    }

    fn block(&mut self, block: &Block) -> Markup {
        match block {
            Block::Section { id, title, blocks } => {
                self.in_section = true;
                let content = self.blocks(blocks);
                self.in_section = false;
                markup!("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title, content)
            }
            // No level of headings is left out, so that readers of the screen know what belongs to what.
            Block::Heading { text } if self.in_section => markup!("<h3>{}</h3>\n", prose(text)),
            Block::Heading { text } => markup!("<h2 class=\"minor\">{}</h2>\n", prose(text)),
            Block::Paragraph { text, weight } => paragraph(text, *weight),
            Block::Equation { formula: text } => markup!("<p class=\"equation\">{}</p>\n", formula(text)),
            Block::List { items } => {
                let items: Markup = items.iter().map(|item| markup!("<li>{}</li>", prose(item))).collect();
                markup!("<ul>{}</ul>\n", items)
            }
            Block::Definitions { items } => {
                let item = |(term, meaning)| markup!("<dt>{}</dt><dd>{}</dd>\n", prose(term), prose(meaning));
                let items: Markup = items.iter().map(|(term, meaning)| item((term, meaning))).collect();
                markup!("<dl>{}</dl>\n", items)
            }
            Block::Table(table) => write_table(table),
            Block::Cards { items } => {
                let cards: Markup = items.iter().map(card).collect();
                markup!("<div class=\"cards\">{}</div>\n", cards)
            }
            Block::Figure(one) => self.figure(one, figure::WIDE),
            Block::Row { figures } => {
                let figures: Markup = figures.iter().map(|one| self.figure(one, figure::NARROW)).collect();
                markup!("<div class=\"pair\">{}</div>\n", figures)
            }
            Block::Drawing { svg, description, caption } => markup!(
                "<figure class=\"diagram\" aria-label=\"{}\">{}<figcaption>{}</figcaption></figure>\n",
                description,
                Markup::raw(svg.as_str()),
                prose(caption)
            ),
            Block::Finding(one) => finding(one),
            Block::Callout { tone, kicker, title, blocks } => markup!(
                "<div class=\"callout {}\"><p class=\"kicker\">{}</p><h2>{}</h2>{}</div>\n",
                class(*tone),
                kicker,
                title,
                self.blocks(blocks)
            ),
            Block::Preformatted { text } => markup!("<pre>{}</pre>\n", text),
            Block::Fold { summary, blocks } => {
                markup!("<details><summary>{}</summary>\n{}</details>\n", prose(summary), self.blocks(blocks))
            }
        }
    }

    fn figure(&mut self, one: &crate::Figure, width: f64) -> Markup {
        self.figures += 1;
        figure::figure(one, width, self.figures, self.points)
    }
}

fn paragraph(text: &Prose, weight: Weight) -> Markup {
    match weight {
        Weight::Lead => markup!("<p class=\"lead\">{}</p>\n", prose(text)),
        Weight::Body => markup!("<p>{}</p>\n", prose(text)),
        Weight::Note => markup!("<p class=\"note\">{}</p>\n", prose(text)),
    }
}

fn findings(all: &[Block]) -> Markup {
    let item = |block: &Block| match block {
        Block::Finding(one) => Some(finding(one)),
        _ => None,
    };
    let items: Markup = all.iter().filter_map(item).collect();
    markup!("<ul class=\"findings\">{}</ul>\n", items)
}

fn finding(Finding { tone, severity, text, remedy, places }: &Finding) -> Markup {
    let remedy: Markup = remedy.iter().map(|todo| markup!("<p class=\"todo\">{}</p>", prose(todo))).collect();
    let places: Markup = places.iter().map(|place| markup!("<p class=\"where\">{}</p>", place)).collect();
    markup!(
        "<li><span class=\"tag {}\">{}</span><div><p>{}</p>{}{}</div></li>\n",
        class(*tone),
        severity,
        prose(text),
        remedy,
        places
    )
}

/// Value and unit large, the uncertainty small below.
fn card(Card { label, value }: &Card) -> Markup {
    let (state, value) = match value {
        Err(why) => (" absent", markup!("<p class=\"value\">not estimated</p><p class=\"range\">{}</p>", prose(why))),
        Ok(quantity) => match quantity.short() {
            None => ("", markup!("<p class=\"value\">{}</p>", quantity.text())),
            Some(digits) => (
                "",
                markup!(
                    "<p class=\"value\">{} <small>{}</small></p>\
                     <p class=\"range\"><span class=\"n\">{}</span> &ensp;<span class=\"n\">{}</span></p>",
                    digits.value,
                    digits.unit,
                    digits.spread,
                    digits.interval
                ),
            ),
        },
    };
    markup!("<div class=\"card{}\"><p class=\"name\">{}</p>{}</div>", state, prose(label), value)
}

fn write_table(table: &Table) -> Markup {
    let columns = &table.columns;
    let head = match table.has_headings() {
        true => markup!("<thead><tr>{}</tr></thead>", columns.iter().map(heading).collect::<Markup>()),
        false => Markup::default(),
    };
    let rows: Markup = table.rows.iter().map(|row| write_row(row, columns)).collect();
    markup!("<div class=\"wide\"><table>{}<tbody>\n{}</tbody></table></div>\n", head, rows)
}

fn heading(column: &Column) -> Markup {
    match column.heading.is_empty() {
        true => markup!("<td></td>"),
        false => markup!("<th scope=\"col\"{}>{}</th>", side(column.align), prose(&column.heading)),
    }
}

fn write_row(Row { cells, notes }: &Row, columns: &[Column]) -> Markup {
    let cells: Markup = cells.iter().zip(columns).map(|(one, column)| cell(one, column)).collect();
    let notes: Markup = notes
        .iter()
        .map(|note| {
            markup!("<tr class=\"remark\"><td colspan=\"{}\">{}</td></tr>\n", columns.len(), prose(&note.into()))
        })
        .collect();
    markup!("<tr>{}</tr>\n{}", cells, notes)
}

fn side(align: Align) -> Markup {
    Markup::raw(if align == Align::Right { " class=\"right\"" } else { "" })
}

/// Writes a cell; short text does not break across lines.
fn cell(Cell { content, tone }: &Cell, Column { heading, align, .. }: &Column) -> Markup {
    let (text, is_short) = match content {
        Content::Text(text) => (prose(text), text.plain().chars().count() <= UNBROKEN),
        Content::Quantity(quantity) => (markup!("{}", quantity.text()), true),
        Content::Interval(quantity) => (markup!("{}", quantity.interval()), true),
    };
    let names = [("n", is_short), ("right", *align == Align::Right), (class(*tone), *tone != Tone::Plain)];
    let names: Vec<&str> = names.into_iter().filter(|(_, holds)| *holds).map(|(name, _)| name).collect();
    let class = if names.is_empty() { Markup::default() } else { markup!(" class=\"{}\"", names.join(" ")) };
    // On a narrow screen, where cells are below each other, each shows the heading of its column.
    let label = match heading.is_empty() {
        true => Markup::default(),
        false => markup!(" data-label=\"{}\"", heading.plain()),
    };
    markup!("<td{}{}>{}</td>", class, label, text)
}
