//! The fonts of a PDF: which glyph a character has, how wide it is, and what of a font is used.

use skrifa::charmap::Charmap;
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::{FontRef, GlyphId, MetadataProvider};
use subsetter::GlyphRemapper;

use super::options::PdfError;

/// A font.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Face {
    Regular,
    Bold,
    Mono,
}

impl Face {
    pub(super) const ALL: [Face; 3] = [Face::Regular, Face::Bold, Face::Mono];

    /// The font file.
    pub(super) fn data(self) -> &'static [u8] {
        match self {
            Face::Regular => dejavu::sans::regular(),
            Face::Bold => dejavu::sans::bold(),
            Face::Mono => dejavu::sans_mono::regular(),
        }
    }

    /// Its name in the PDF.
    pub(super) fn name(self) -> &'static str {
        match self {
            Face::Regular => "DejaVuSans",
            Face::Bold => "DejaVuSans-Bold",
            Face::Mono => "DejaVuSansMono",
        }
    }

    /// How a content stream calls it.
    pub(super) fn key(self) -> &'static [u8] {
        match self {
            Face::Regular => b"F1",
            Face::Bold => b"F2",
            Face::Mono => b"F3",
        }
    }
}

/// Replacement of a character without a glyph.
const REPLACEMENT: char = '\u{fffd}';

/// A font's characters and widths.
struct Font {
    characters: Charmap<'static>,
    widths: GlyphMetrics<'static>,
}

impl Font {
    fn glyph(&self, c: char) -> Option<u16> {
        self.characters
            .map(c)
            .filter(|glyph| *glyph != GlyphId::NOTDEF)
            .and_then(|glyph| glyph.to_u32().try_into().ok())
    }
}

/// All fonts.
pub(super) struct Fonts([Font; 3]);

impl Fonts {
    /// Reads the fonts that are built in.
    pub(super) fn new() -> Result<Self, PdfError> {
        let read = |face: Face| {
            let font = FontRef::new(face.data()).map_err(|error| PdfError::Font(error.to_string()))?;
            // Widths as a PDF has them: in thousandths of the size.
            let widths = font.glyph_metrics(Size::new(1000.0), LocationRef::default());
            Ok(Font { characters: font.charmap(), widths })
        };
        let [regular, bold, mono] = Face::ALL;
        Ok(Fonts([read(regular)?, read(bold)?, read(mono)?]))
    }

    fn font(&self, face: Face) -> &Font {
        &self.0[face as usize]
    }

    /// The glyph of a character in a font, else in the regular one, else the sign for a character without a glyph.
    pub(super) fn glyph(&self, face: Face, c: char) -> (Face, u16) {
        let shown = if is_hidden(c) { REPLACEMENT } else { c };
        let find = |face: Face, c: char| self.font(face).glyph(c).map(|glyph| (face, glyph));
        find(face, shown)
            .or_else(|| find(Face::Regular, shown))
            .or_else(|| find(Face::Regular, REPLACEMENT))
            .unwrap_or((Face::Regular, 0))
    }

    /// Returns true if a font has a glyph for a character.
    pub(super) fn has(&self, face: Face, c: char) -> bool {
        !is_hidden(c) && self.font(face).glyph(c).is_some()
    }

    /// The width of a glyph in thousandths of the font's size.
    pub(super) fn glyph_width(&self, face: Face, glyph: u16) -> f32 {
        self.font(face).widths.advance_width(GlyphId::from(glyph)).unwrap_or(0.0)
    }

    /// The width of a character in a font of a size.
    pub(super) fn width(&self, face: Face, c: char, size: f32) -> f32 {
        let (face, glyph) = self.glyph(face, c);
        self.glyph_width(face, glyph) * size / 1000.0
    }
}

/// Control characters, and those that turn the direction of writing.
fn is_hidden(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The glyphs of a font that a document uses, and the text that each stands for.
pub(super) struct Used {
    pub(super) glyphs: GlyphRemapper,
    pub(super) texts: Vec<String>,
}

impl Used {
    pub(super) fn new() -> Self {
        Used { glyphs: GlyphRemapper::new(), texts: vec![REPLACEMENT.to_string()] }
    }

    /// The number of a glyph in the part of the font that is embedded.
    pub(super) fn number(&mut self, glyph: u16, text: &str) -> u16 {
        let number = self.glyphs.remap(glyph);
        if usize::from(number) == self.texts.len() {
            self.texts.push(text.to_owned());
        }
        number
    }
}
