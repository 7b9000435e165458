//! A page as data: blocks below each other, without a word about how they are shown.

use serde::Serialize;

use crate::figure::Figure;
use crate::logo::Logo;
use crate::prose::Prose;
use crate::quantity::Quantity;
use crate::table::Table;
use crate::thinned::{HELD_SAMPLES, thin};
use crate::tone::Tone;

/// A page: a title, and blocks below it.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Page {
    /// Subject of the page.
    pub title: String,
    /// A line below the title; empty for none.
    pub subtitle: Prose,
    /// A line at the top of each printed page; empty for none.
    pub running_head: String,
    /// A picture at the top.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub logo: Option<Logo>,
    /// The content.
    pub blocks: Vec<Block>,
}

/// One block of a page.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Block {
    /// A part of the page with a heading of its own and an entry in the contents.
    Section {
        /// Where links point to.
        id: String,
        /// The heading.
        title: String,
        /// Blocks below the heading.
        blocks: Vec<Block>,
    },
    /// A heading inside a section.
    Heading {
        /// Its text.
        text: Prose,
    },
    /// A paragraph.
    Paragraph {
        /// Its text.
        text: Prose,
        /// How much it stands out.
        weight: Weight,
    },
    /// A formula in a line of its own, written as `{over}/{under}` where a fraction is stacked.
    Equation {
        /// The formula.
        formula: String,
    },
    /// A list without order.
    List {
        /// Its items.
        items: Vec<Prose>,
    },
    /// Terms with what they mean.
    Definitions {
        /// Term and meaning.
        items: Vec<(Prose, Prose)>,
    },
    /// A table.
    Table(Table),
    /// Numbers to be read at a glance.
    Cards {
        /// The cards, in reading order.
        items: Vec<Card>,
    },
    /// A figure.
    Figure(Figure),
    /// Figures next to each other, where there is room.
    Row {
        /// The figures, left to right.
        figures: Vec<Figure>,
    },
    /// A drawing that is no plot.
    Drawing {
        /// The drawing.
        svg: String,
        /// The drawing in words.
        description: String,
        /// Caption that points out what to see in it.
        caption: Prose,
    },
    /// A finding, and how to remedy it.
    Finding(Finding),
    /// A framed conclusion.
    Callout {
        /// How good the news is.
        tone: Tone,
        /// Kind of the statement.
        kicker: String,
        /// The conclusion.
        title: String,
        /// Its reasons.
        blocks: Vec<Block>,
    },
    /// Text in which every space counts.
    Preformatted {
        /// The text.
        text: String,
    },
    /// Details that are shown on request.
    Fold {
        /// Summary of the content.
        summary: Prose,
        /// The details.
        blocks: Vec<Block>,
    },
}

/// How much a paragraph stands out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Weight {
    /// The first of a section, that says what it is about.
    Lead,
    /// Most text.
    Body,
    /// A remark.
    Note,
}

/// A number to be read at a glance.
#[derive(Debug, Clone, Serialize)]
pub struct Card {
    /// Name of the number.
    pub label: Prose,
    /// The number, or why there is none.
    pub value: Result<Quantity, Prose>,
}

/// Finding, and how to remedy it.
#[derive(Debug, Clone, Serialize)]
pub struct Finding {
    /// How grave it is.
    pub tone: Tone,
    /// How grave it is, in a word.
    pub severity: String,
    /// The finding in words.
    pub text: Prose,
    /// Its remedy.
    pub remedy: Option<Prose>,
    /// Where it was found.
    pub places: Vec<String>,
}

impl Finding {
    /// A finding that says all by its text.
    pub fn new(tone: Tone, severity: impl Into<String>, text: impl Into<Prose>) -> Self {
        Finding { tone, severity: severity.into(), text: text.into(), remedy: None, places: Vec::new() }
    }
}

impl Page {
    /// A page of blocks.
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Page { title: title.into(), blocks, ..Page::default() }
    }

    /// A page of figures.
    pub fn of_figures(title: impl Into<String>, figures: Vec<Figure>) -> Self {
        Page::new(title, figures.into_iter().map(Block::figure).collect())
    }

    /// Every figure of the page, in reading order.
    pub fn figures(&self) -> Vec<&Figure> {
        figures(&self.blocks)
    }
}

fn figures<'a>(blocks: &'a [Block]) -> Vec<&'a Figure> {
    let of_block = |block: &'a Block| match block {
        Block::Figure(figure) => vec![figure],
        Block::Row { figures } => figures.iter().collect(),
        Block::Section { blocks, .. } | Block::Callout { blocks, .. } | Block::Fold { blocks, .. } => figures(blocks),
        _ => Vec::new(),
    };
    blocks.iter().flat_map(of_block).collect()
}

/// Blocks as they are put together.
#[derive(Debug, Clone, Default)]
pub struct Blocks(Vec<Block>);

impl Blocks {
    /// Adds a block, or several.
    pub fn push(&mut self, more: impl Into<Blocks>) {
        self.0.extend(more.into().0);
    }

    /// Returns true if there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The blocks, to become part of a page.
    pub fn into_vec(self) -> Vec<Block> {
        self.0
    }
}

impl From<Block> for Blocks {
    fn from(block: Block) -> Self {
        Blocks(vec![block])
    }
}

impl From<Vec<Block>> for Blocks {
    fn from(blocks: Vec<Block>) -> Self {
        Blocks(blocks)
    }
}

impl From<Figure> for Blocks {
    fn from(figure: Figure) -> Self {
        Block::figure(figure).into()
    }
}

impl From<Table> for Blocks {
    fn from(table: Table) -> Self {
        Block::Table(table).into()
    }
}

impl<B: Into<Blocks>> FromIterator<B> for Blocks {
    fn from_iter<I: IntoIterator<Item = B>>(pieces: I) -> Self {
        Blocks(pieces.into_iter().flat_map(|piece| piece.into().0).collect())
    }
}

impl Block {
    /// A figure with no more samples of a line than a page can use, so that hours of recordings need little memory.
    pub fn figure(mut figure: Figure) -> Self {
        thin(&mut figure, HELD_SAMPLES);
        Block::Figure(figure)
    }

    /// Id and title of a section.
    pub(crate) fn as_section(&self) -> Option<(&str, &str)> {
        match self {
            Block::Section { id, title, .. } => Some((id, title)),
            _ => None,
        }
    }

    /// A heading inside a section.
    pub fn heading(text: impl Into<Prose>) -> Self {
        Block::Heading { text: text.into() }
    }

    /// A paragraph.
    pub fn paragraph(text: impl Into<Prose>) -> Self {
        Block::Paragraph { text: text.into(), weight: Weight::Body }
    }

    /// The paragraph that says what a section is about.
    pub fn lead(text: impl Into<Prose>) -> Self {
        Block::Paragraph { text: text.into(), weight: Weight::Lead }
    }

    /// A remark.
    pub fn note(text: impl Into<Prose>) -> Self {
        Block::Paragraph { text: text.into(), weight: Weight::Note }
    }

    /// A formula in a line of its own.
    pub fn equation(formula: impl Into<String>) -> Self {
        Block::Equation { formula: formula.into() }
    }

    /// A part of the page with an entry in the contents.
    pub fn section(id: impl Into<String>, title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Block::Section { id: id.into(), title: title.into(), blocks }
    }
}
