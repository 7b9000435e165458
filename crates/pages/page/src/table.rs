//! Tables.

use serde::Serialize;

use crate::prose::Prose;
use crate::quantity::Quantity;
use crate::tone::Tone;

/// A column's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Align {
    /// Text.
    Left,
    /// Numbers.
    Right,
}

/// A column: its heading and its side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Column {
    /// The heading; empty for none.
    pub heading: Prose,
    /// The side.
    pub align: Align,
}

/// The content of a cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// Text.
    Text(Prose),
    /// A value with its uncertainty and unit.
    Quantity(Quantity),
    /// The bounds of a quantity's interval.
    Interval(Quantity),
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Content of the cell.
    pub content: Content,
    /// Meaning of its colour.
    pub tone: Tone,
}

/// A row, and the remarks below it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// One cell a column.
    pub cells: Vec<Cell>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// Rows of cells under headings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// The columns, left to right.
    pub columns: Vec<Column>,
    /// The rows, top to bottom.
    pub rows: Vec<Row>,
}

impl Cell {
    /// A text with a tone.
    pub fn toned(text: impl AsRef<str>, tone: Tone) -> Self {
        Cell { content: Content::Text(text.as_ref().into()), tone }
    }

    /// The bounds of a quantity's interval.
    pub fn interval(quantity: Quantity) -> Self {
        Cell { content: Content::Interval(quantity), tone: Tone::Plain }
    }

    /// Text of a cell, without markup.
    pub fn plain(&self) -> String {
        match &self.content {
            Content::Text(text) => text.plain(),
            Content::Quantity(quantity) => quantity.text(),
            Content::Interval(quantity) => quantity.interval(),
        }
    }
}

impl<T: AsRef<str>> From<T> for Cell {
    fn from(text: T) -> Self {
        Cell::toned(text, Tone::Plain)
    }
}

impl From<Prose> for Cell {
    fn from(text: Prose) -> Self {
        Cell { content: Content::Text(text), tone: Tone::Plain }
    }
}

impl From<Quantity> for Cell {
    fn from(quantity: Quantity) -> Self {
        Cell { content: Content::Quantity(quantity), tone: Tone::Plain }
    }
}

impl Table {
    /// A table with headings; it has no line of headings if all are empty.
    pub fn new(columns: &[(&str, Align)]) -> Self {
        let column = |(heading, align): &(&str, Align)| Column { heading: (*heading).into(), align: *align };
        Table { columns: columns.iter().map(column).collect(), rows: Vec::new() }
    }

    /// A table of text.
    pub fn of_text(headings: &[&str]) -> Self {
        Table::new(&headings.iter().map(|heading| (*heading, Align::Left)).collect::<Vec<_>>())
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl Into<Vec<Cell>>) {
        self.rows.push(Row { cells: cells.into(), notes: Vec::new() });
    }

    /// Adds a remark below the last row.
    pub fn note(&mut self, text: &str) {
        if let Some(last) = self.rows.last_mut() {
            last.notes.push(text.to_owned());
        }
    }

    /// The same table with rows.
    #[must_use]
    pub fn with_rows(mut self, rows: impl IntoIterator<Item = Vec<Cell>>) -> Self {
        rows.into_iter().for_each(|cells| self.row(cells));
        self
    }

    /// Returns true if it has no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns true if any column has a heading.
    pub(crate) fn has_headings(&self) -> bool {
        self.columns.iter().any(|column| !column.heading.is_empty())
    }
}
