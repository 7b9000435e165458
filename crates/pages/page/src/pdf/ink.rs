//! Resources that the content of all pages shares: glyphs, degrees of opacity, pictures.

use std::collections::BTreeSet;
use std::rc::Rc;

use pdf_writer::{Content, Name, Str};

use super::font::{Face, Fonts, Used};
use super::text::{Fragment, TAG_PADDING};
use crate::logo::Picture;

/// How far the letters of a symbol slant.
const SLANT: f32 = 0.2;

/// Fonts and states as they are used.
pub(super) struct Ink<'f> {
    fonts: &'f Fonts,
    pub(super) used: [Used; 3],
    /// Degrees of opacity, in thousandths.
    pub(super) opacities: BTreeSet<u16>,
    pub(super) pictures: Vec<Rc<Picture>>,
}

impl<'f> Ink<'f> {
    pub(super) fn new(fonts: &'f Fonts) -> Self {
        let used = [Used::new(), Used::new(), Used::new()];
        Ink { fonts, used, opacities: BTreeSet::new(), pictures: Vec::new() }
    }

    /// Sets the opacity of what is drawn from here on.
    pub(super) fn set_opacity(&mut self, content: &mut Content, opacity: f32) {
        let thousandths = (1000.0 * opacity.clamp(0.0, 1.0)).round() as u16;
        self.opacities.insert(thousandths);
        content.set_parameters(Name(opacity_key(thousandths).as_bytes()));
    }

    /// Shows one glyph of a font of size 1.
    pub(super) fn show_glyph(&mut self, content: &mut Content, face: Face, glyph: u16, text: &str) {
        let (face, glyph) = if glyph == 0 { self.fonts.glyph(Face::Regular, '\u{fffd}') } else { (face, glyph) };
        let number = self.used[face as usize].number(glyph, text);
        content.set_font(Name(face.key()), 1.0).show(Str(&number.to_be_bytes()));
    }

    /// Writes a text, its base beginning at a point of the page.
    pub(super) fn write(&mut self, content: &mut Content, (x, y): (f32, f32), fragment: &Fragment) {
        let style = fragment.style;
        let [red, green, blue] = style.colour;
        let x = if style.is_tag { x + TAG_PADDING } else { x };
        let slant = if style.is_slanted { SLANT } else { 0.0 };
        content.begin_text().set_fill_rgb(red, green, blue);
        content.set_text_matrix([1.0, 0.0, slant, 1.0, x, y + style.rise]);
        for (face, glyphs) in self.runs(style.face, &fragment.text) {
            content.set_font(Name(face.key()), style.size).show(Str(&glyphs));
        }
        content.end_text();
    }

    /// A text in pieces of one font each, as numbers of glyphs.
    fn runs(&mut self, face: Face, text: &str) -> Vec<(Face, Vec<u8>)> {
        let mut runs: Vec<(Face, Vec<u8>)> = Vec::new();
        for c in text.chars() {
            let (found, glyph) = self.fonts.glyph(face, c);
            let is_shown = self.fonts.has(found, c);
            let shown = if is_shown { c } else { '\u{fffd}' };
            let number = self.used[found as usize].number(glyph, shown.encode_utf8(&mut [0; 4]));
            match runs.last_mut() {
                Some((last, glyphs)) if *last == found => glyphs.extend(number.to_be_bytes()),
                _ => runs.push((found, number.to_be_bytes().to_vec())),
            }
        }
        runs
    }

    /// The number of a picture among all.
    pub(super) fn picture(&mut self, picture: &Rc<Picture>) -> usize {
        let known = self.pictures.iter().position(|known| Rc::ptr_eq(known, picture));
        known.unwrap_or_else(|| {
            self.pictures.push(Rc::clone(picture));
            self.pictures.len() - 1
        })
    }
}

/// How a content stream calls a degree of opacity.
pub(super) fn opacity_key(thousandths: u16) -> String {
    format!("G{thousandths}")
}

/// How a content stream calls a picture.
pub(super) fn picture_key(number: usize) -> String {
    format!("P{number}")
}
