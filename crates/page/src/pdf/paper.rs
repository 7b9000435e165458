//! Sizes of paper.

/// A size of paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Paper {
    /// 210 mm × 297 mm.
    #[default]
    A4,
    /// 8.5 in × 11 in.
    Letter,
}

/// A page in points: its size, and the margins around its content.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    pub(super) width: f32,
    pub(super) height: f32,
    pub(super) margin_side: f32,
    pub(super) margin_top: f32,
    pub(super) margin_bottom: f32,
}

impl Format {
    pub(super) fn new(paper: Paper) -> Self {
        let (width, height) = match paper {
            Paper::A4 => (595.28, 841.89),
            Paper::Letter => (612.0, 792.0),
        };
        Format { width, height, margin_side: 48.0, margin_top: 56.0, margin_bottom: 54.0 }
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
