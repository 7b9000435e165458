//! A font in a PDF: the glyphs that are used, their widths, and the text that they stand for.

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

use super::deflated::deflated;
use super::font::{Face, Fonts, Used};
use super::options::PdfError;

/// Codes are numbers of glyphs.
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// Writes a font with the glyphs that are used.
pub(super) fn write_font(
    pdf: &mut Pdf,
    face: Face,
    id: Ref,
    used: &Used,
    fonts: &Fonts,
    new_reference: &mut dyn FnMut() -> Ref,
) -> Result<(), PdfError> {
    let [descendant, descriptor, characters, file] = std::array::from_fn(|_| new_reference());
    let subset = subsetter::subset(face.data(), 0, &used.glyphs).map_err(|error| PdfError::Font(error.to_string()))?;
    // Six letters before the name mark a font with a part of its glyphs.
    let name = format!("DYNOID+{}", face.name());
    let name = Name(name.as_bytes());
    pdf.type0_font(id)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(descendant)
        .to_unicode(characters);
    let mut font = pdf.cid_font(descendant);
    font.subtype(CidFontType::Type2).base_font(name).system_info(IDENTITY).font_descriptor(descriptor);
    font.cid_to_gid_map_predefined(Name(b"Identity"));
    let widths = used.glyphs.remapped_gids().map(|glyph| fonts.glyph_width(face, glyph));
    font.widths().consecutive(0, widths);
    font.finish();
    write_descriptor(pdf, face, name, descriptor, file)?;
    pdf.stream(characters, &deflated(&text_of_glyphs(used))).filter(Filter::FlateDecode);
    let length = i32::try_from(subset.len()).unwrap_or(i32::MAX);
    pdf.stream(file, &deflated(&subset)).filter(Filter::FlateDecode).pair(Name(b"Length1"), length);
    Ok(())
}

fn write_descriptor(pdf: &mut Pdf, face: Face, name: Name<'_>, id: Ref, file: Ref) -> Result<(), PdfError> {
    let font = FontRef::new(face.data()).map_err(|error| PdfError::Font(error.to_string()))?;
    let metrics = font.metrics(Size::new(1000.0), LocationRef::default());
    let bounds = metrics.bounds.unwrap_or_default();
    let mono = if face == Face::Mono { FontFlags::FIXED_PITCH } else { FontFlags::empty() };
    pdf.font_descriptor(id)
        .name(name)
        .flags(FontFlags::SYMBOLIC | mono)
        .bbox(Rect::new(bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max))
        .italic_angle(0.0)
        .ascent(metrics.ascent)
        .descent(metrics.descent)
        .cap_height(metrics.cap_height.unwrap_or(729.0))
        .stem_v(if face == Face::Bold { 140.0 } else { 80.0 })
        .font_file2(file);
    Ok(())
}

/// The text that each glyph stands for.
fn text_of_glyphs(used: &Used) -> Vec<u8> {
    let mut map = UnicodeCmap::new(Name(b"Dynoid"), IDENTITY);
    for (number, text) in (0_u16..).zip(&used.texts) {
        map.pair_with_multiple(number, text.chars());
    }
    map.finish().to_vec()
}
