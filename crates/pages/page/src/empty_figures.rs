//! Figures without values, which a page leaves out.

use crate::figure::{Figure, Layer, Rounded};
use crate::model::{Block, Page};

impl Figure {
    /// Tells whether none of its curves has a value that can be drawn.
    pub fn is_empty(&self) -> bool {
        self.panels.iter().flat_map(|panel| &panel.layers).all(|layer| !has_values(layer))
    }
}

fn has_values(layer: &Layer) -> bool {
    let any = |values: &[Rounded]| values.iter().any(|value| value.0.is_finite());
    match layer {
        Layer::Line { y, .. }
        | Layer::Points { y, .. }
        | Layer::Stems { y, .. }
        | Layer::Markers { y, .. }
        | Layer::Path { y, .. } => any(y),
        Layer::Band { low, high, .. } => any(low) || any(high),
        Layer::Shades { columns, .. } => columns.iter().any(|column| !column.is_empty()),
        Layer::Words { .. }
        | Layer::HorizontalMark { .. }
        | Layer::VerticalMarks { .. }
        | Layer::YRegion { .. }
        | Layer::XRegion { .. } => false,
    }
}

impl Page {
    /// The same page with a remark in place of each figure that is empty.
    #[must_use]
    pub fn with_remarks_for_empty_figures(self, remark: &dyn Fn(&Figure) -> String) -> Page {
        Page { blocks: remarked(self.blocks, remark), ..self }
    }
}

fn remarked(blocks: Vec<Block>, remark: &dyn Fn(&Figure) -> String) -> Vec<Block> {
    blocks.into_iter().flat_map(|block| of_block(block, remark)).collect()
}

fn of_block(block: Block, remark: &dyn Fn(&Figure) -> String) -> Vec<Block> {
    let note = |figure: &Figure| Block::note(remark(figure));
    match block {
        Block::Figure(figure) if figure.is_empty() => vec![note(&figure)],
        Block::Row { figures } => {
            let (empty, drawn): (Vec<Figure>, Vec<Figure>) = figures.into_iter().partition(Figure::is_empty);
            let row = (!drawn.is_empty()).then_some(Block::Row { figures: drawn });
            row.into_iter().chain(empty.iter().map(note)).collect()
        }
        Block::Section { id, title, blocks } => vec![Block::Section { id, title, blocks: remarked(blocks, remark) }],
        Block::Callout { tone, kicker, title, blocks } => {
            vec![Block::Callout { tone, kicker, title, blocks: remarked(blocks, remark) }]
        }
        Block::Fold { summary, blocks } => vec![Block::Fold { summary, blocks: remarked(blocks, remark) }],
        other => vec![other],
    }
}
