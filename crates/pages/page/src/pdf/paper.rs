//! Sizes of paper.

use pdf_writer::Rect;

use super::options::Paper;

/// A page in points: its size, and the margins around its content. Where the page is scaled down, points are those
/// before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    pub(super) width: f32,
    pub(super) height: f32,
    pub(super) margin_side: f32,
    pub(super) margin_top: f32,
    pub(super) margin_bottom: f32,
    /// How much smaller all of it is on paper.
    pub(super) scale: f32,
}

impl Format {
    pub(super) fn new(paper: Paper, scale: f32) -> Self {
        let (width, height) = match paper {
            Paper::A4 => (595.28, 841.89),
            Paper::Letter => (612.0, 792.0),
        };
        Format {
            width: width / scale,
            height: height / scale,
            margin_side: 48.0 / scale,
            margin_top: 56.0 / scale,
            margin_bottom: 54.0 / scale,
            scale,
        }
    }

    /// An area of the page on paper.
    pub(super) fn on_paper(self, area: Rect) -> Rect {
        let Rect { x1, y1, x2, y2 } = area;
        Rect::new(self.scale * x1, self.scale * y1, self.scale * x2, self.scale * y2)
    }

    /// The width of the content.
    pub(super) fn room(self) -> f32 {
        self.width - 2.0 * self.margin_side
    }

    /// The height of the content.
    pub(super) fn column(self) -> f32 {
        self.height - self.margin_top - self.margin_bottom
    }
}
