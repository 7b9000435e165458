//! A page as a PDF, for paper and archives: set in lines by the widths of glyphs, divided into pages, and tagged, so
//! that programs read it in order. It has bookmarks, links, and the fonts it needs. The same page gives the same bytes.

mod contents;
mod deflated;
mod document;
mod equation;
mod figure;
mod font;
mod fonts;
mod ink;
mod layout;
mod options;
mod paint;
mod paper;
mod strip;
mod structure;
mod table;
mod text;
mod vector;

use std::collections::BTreeSet;
use std::rc::Rc;

use crate::model::{Block, Page};
use crate::thinned::most_points;
use document::{Parts, References, Spot};
use font::{Face, Fonts};
use ink::Ink;
use layout::{Layout, Place};
pub use options::{Day, Paper, PdfError, PdfOptions};
use paint::{Edges, Painted, Painter};
use paper::Format;
use strip::{Area, Shape, Sheet, Strip, paginate};
use structure::{ROOT, Role, Structure};
use text::{SOFT, Setter, Style};
use vector::Reader;

/// Fewer sections need no list of contents.
const CONTENTS: usize = 4;
/// The largest logo, points.
const LOGO_WIDTH: f32 = 120.0;
const LOGO_HEIGHT: f32 = 48.0;
/// Scales at which a page is tried that is to be on one sheet of paper.
const SCALES: [f32; 8] = [1.0, 0.93, 0.86, 0.8, 0.72, 0.64, 0.57, 0.5];
/// A distance from the edge of the paper to the texts there, whatever the scale.
const HEAD: f32 = 34.0;
const FOOT: f32 = 30.0;

/// The page as a PDF.
///
/// # Errors
/// [`PdfError`] where a drawing of the page cannot be read.
pub fn pdf(page: &Page, options: &PdfOptions) -> Result<Vec<u8>, PdfError> {
    let fonts = Fonts::new()?;
    let sections = section_ids(&page.blocks);
    let scales = if options.on_one_page { &SCALES[..] } else { &SCALES[..1] };
    let mut found = laid_out(page, Format::new(options.paper, scales[0]), &fonts, &sections)?;
    for scale in &scales[1..] {
        if found.sheets.len() > 1 {
            found = laid_out(page, Format::new(options.paper, *scale), &fonts, &sections)?;
        }
    }
    write(page, options, found, &fonts)
}

/// Characters of a page's texts that the fonts lack, each once. A PDF and a figure drawn to pixels show a sign in their
/// place; a page for a browser shows them.
///
/// # Errors
/// [`PdfError`] where the fonts that are built in cannot be used.
pub fn without_glyph(page: &Page) -> Result<String, PdfError> {
    let fonts = Fonts::new()?;
    // All texts of a page, whatever holds them.
    let texts = serde_json::to_string(page).unwrap_or_default();
    let is_missing = |c: &char| !c.is_ascii() && !fonts.has(Face::Regular, *c);
    Ok(texts.chars().filter(is_missing).collect::<BTreeSet<char>>().into_iter().collect())
}

/// A page in sheets of paper.
struct LaidOut<'l> {
    format: Format,
    layout: Layout<'l>,
    sheets: Vec<Sheet>,
}

fn laid_out<'l>(
    page: &Page,
    format: Format,
    fonts: &'l Fonts,
    sections: &'l BTreeSet<String>,
) -> Result<LaidOut<'l>, PdfError> {
    let mut layout = Layout {
        setter: Setter::new(fonts, sections),
        structure: Structure::new(),
        reader: Reader::new(),
        headings: Vec::new(),
        column: format.column(),
        most_points: most_points(&page.figures()),
        figures: 0,
    };
    let strips = strips(page, &mut layout, format.room())?;
    let sheets = paginate(strips, format.column());
    Ok(LaidOut { format, layout, sheets })
}

/// Draws the sheets and writes the document.
fn write(page: &Page, options: &PdfOptions, found: LaidOut<'_>, fonts: &Fonts) -> Result<Vec<u8>, PdfError> {
    let LaidOut { format, layout: Layout { setter, mut structure, headings, .. }, sheets } = found;
    let spots = spots(&sheets, headings.len(), format);
    let heading_pages: Vec<usize> = spots.iter().map(|spot| spot.page).collect();
    let mut ink = Ink::new(fonts);
    let mut references = References::new();
    let mut painter =
        Painter { ink: &mut ink, structure: &mut structure, format, heading_pages: &heading_pages, fonts };
    let paint = |(number, sheet): (usize, &Sheet)| {
        let edges = edges(number, sheets.len(), page, options, &setter, format);
        painter.page(number, sheet, &edges, &mut || references.next())
    };
    let painted: Vec<Painted> = sheets.iter().enumerate().map(paint).collect();
    let parts = Parts {
        title: &page.title,
        options,
        format,
        painted,
        structure: &structure,
        headings: &headings,
        spots: &spots,
        ink,
        fonts,
    };
    document::write(&parts, references)
}

/// The sections that links may point to.
fn section_ids(blocks: &[Block]) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for block in blocks {
        match block {
            Block::Section { id, blocks, .. } => {
                all.insert(id.clone());
                all.extend(section_ids(blocks));
            }
            Block::Callout { blocks, .. } | Block::Fold { blocks, .. } => all.extend(section_ids(blocks)),
            _ => {}
        }
    }
    all
}

/// All strips of the page: title, the first section, contents, the other sections.
fn strips(page: &Page, layout: &mut Layout<'_>, room: f32) -> Result<Vec<Strip>, PdfError> {
    let place = Place { room, node: ROOT, level: 1 };
    let mut all = masthead(page, layout, place);
    let sections: Vec<(&str, &str)> = page.blocks.iter().filter_map(Block::as_section).collect();
    // The answer comes first; whoever wants more finds it in the contents behind it.
    let is_section = |block: &Block| block.as_section().is_some();
    let behind_answer = page.blocks.iter().position(is_section).map_or(0, |first| first + 1);
    let (answer, rest) = page.blocks.split_at(behind_answer);
    all.extend(layout.blocks(answer, place)?);
    let mut before = Vec::new();
    if sections.len() >= CONTENTS {
        // Its numbers of headings are known when all headings are.
        before = std::mem::take(&mut all);
    }
    all.extend(layout.blocks(rest, place)?);
    if before.is_empty() {
        return Ok(all);
    }
    let entry = |(id, title): &(&str, &str)| {
        let heading = layout.headings.iter().position(|heading| heading.id.as_deref() == Some(*id))?;
        Some((heading, (*id).to_owned(), (*title).to_owned()))
    };
    let entries: Vec<_> = sections.iter().filter_map(entry).collect();
    before.extend(layout.contents(&entries, place));
    before.extend(all);
    Ok(before)
}

/// Title, subtitle, and the logo to the right of them.
fn masthead(page: &Page, layout: &mut Layout<'_>, place: Place) -> Vec<Strip> {
    let Some(logo) = &page.logo else { return layout.title(&page.title, &page.subtitle, place) };
    let picture = Rc::new(logo.picture().clone());
    let (width, height) = (picture.width as f32, picture.height as f32);
    let scale = (LOGO_WIDTH / width).min(LOGO_HEIGHT / height);
    let (width, height) = (scale * width, scale * height);
    let left = place.room - width;
    let strips = layout.title(&page.title, &page.subtitle, Place { room: left - 16.0, ..place });
    let heading = strips.first().and_then(|first| first.heading);
    let mut whole = Strip { heading, is_kept: true, ..Strip::of_stack(strips) };
    let node = layout.structure.described(Role::Figure, ROOT, "Logo");
    whole.draw(node, Shape::Picture(Area { x: left, y: 0.0, width, height }, picture));
    whole.height = whole.height.max(height);
    vec![whole]
}

/// Where each heading is.
fn spots(sheets: &[Sheet], count: usize, format: Format) -> Vec<Spot> {
    let mut all = vec![Spot::default(); count];
    for (page, sheet) in sheets.iter().enumerate() {
        for (y, strip) in sheet {
            if let Some(spot) = strip.heading.and_then(|heading| all.get_mut(heading)) {
                *spot = Spot { page, down: format.margin_top + y - 6.0 };
            }
        }
    }
    all
}

/// The running head, the program, and the number of the page.
fn edges(number: usize, count: usize, page: &Page, options: &PdfOptions, setter: &Setter<'_>, format: Format) -> Edges {
    let style = Style::new(Face::Regular, 7.4, SOFT);
    let (left, right) = (format.margin_side, format.width - format.margin_side);
    let (head, foot) = (HEAD / format.scale, format.height - FOOT / format.scale);
    let of_page = format!("page {} of {count}", number + 1);
    let width = setter.fragment(of_page.clone(), style, None).width;
    let all = [
        (left, head, setter.cut(&page.running_head, style, right - left)),
        (left, foot, setter.cut(&options.generator, style, right - left - width - 20.0)),
        (right - width, foot, setter.cut(&of_page, style, right - left)),
    ];
    let texts = all
        .into_iter()
        .flat_map(|(x, y, line)| line.fragments.into_iter().map(move |(shift, one)| (x + shift, y, one)));
    Edges { texts: texts.filter(|(.., fragment)| !fragment.text.is_empty()).collect() }
}
