//! The objects of a PDF: pages, fonts, bookmarks, structure, and what the document says of itself.

use std::collections::BTreeMap;

use pdf_writer::types::{ActionType, AnnotationType, TabOrder};
use pdf_writer::{Date, Filter, Finish, Name, Pdf, Rect, Ref, Settings, Str, TextStr};

use super::deflated::deflated;
use super::font::{Face, Fonts};
use super::fonts::write_font;
use super::ink::{Ink, opacity_key, picture_key};
use super::layout::Heading;
use super::options::{Day, PdfError, PdfOptions};
use super::paint::{Painted, PaintedLink};
use super::paper::Format;
use super::structure::{ROOT, Structure, reference};
use crate::logo::{Picture, Pixels};
use crate::markup::escape;

/// Where a heading is: its page, and its distance from the upper edge.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spot {
    pub(super) page: usize,
    pub(super) down: f32,
}

/// Parts that a PDF is written from.
pub(super) struct Parts<'d, 'f> {
    pub(super) title: &'d str,
    pub(super) options: &'d PdfOptions,
    pub(super) format: Format,
    pub(super) painted: Vec<Painted>,
    pub(super) structure: &'d Structure,
    pub(super) headings: &'d [Heading],
    pub(super) spots: &'d [Spot],
    pub(super) ink: Ink<'f>,
    pub(super) fonts: &'f Fonts,
}

/// References of objects, one after the other.
pub(super) struct References(i32);

impl References {
    pub(super) fn new() -> Self {
        References(1)
    }

    pub(super) fn next(&mut self) -> Ref {
        self.several(1)
    }

    /// The first of so many.
    fn several(&mut self, count: usize) -> Ref {
        let first = Ref::new(self.0);
        self.0 = self.0.saturating_add(i32::try_from(count).unwrap_or(i32::MAX));
        first
    }
}

/// References that several objects need.
struct Shared {
    catalog: Ref,
    pages: Ref,
    resources: Ref,
    tree: Ref,
    elements: Ref,
    each_page: Vec<Ref>,
}

/// The document as bytes.
pub(super) fn write(parts: &Parts<'_, '_>, mut references: References) -> Result<Vec<u8>, PdfError> {
    let mut pdf = Pdf::with_settings(Settings { pretty: false });
    let shared = Shared {
        catalog: references.next(),
        pages: references.next(),
        resources: references.next(),
        tree: references.next(),
        elements: references.several(parts.structure.len()),
        each_page: parts.painted.iter().map(|_| references.next()).collect(),
    };
    write_pages(&mut pdf, parts, &shared, &mut references);
    write_resources(&mut pdf, parts, &shared, &mut references)?;
    write_structure(&mut pdf, parts, &shared, &mut references);
    let outline = write_outline(&mut pdf, parts, &shared, &mut references);
    let metadata = references.next();
    pdf.stream(metadata, xmp(parts).as_bytes())
        .pair(Name(b"Type"), Name(b"Metadata"))
        .pair(Name(b"Subtype"), Name(b"XML"));
    write_information(&mut pdf, parts, references.next());
    let mut catalog = pdf.catalog(shared.catalog);
    catalog.pages(shared.pages).lang(TextStr(LANGUAGE)).metadata(metadata);
    catalog.viewer_preferences().display_doc_title(true);
    catalog.mark_info().marked(true);
    catalog.pair(Name(b"StructTreeRoot"), shared.tree);
    if let Some(outline) = outline {
        catalog.outlines(outline).page_mode(pdf_writer::types::PageMode::UseOutlines);
    }
    catalog.finish();
    Ok(pdf.finish())
}

const LANGUAGE: &str = "en";

fn write_pages(pdf: &mut Pdf, parts: &Parts<'_, '_>, shared: &Shared, references: &mut References) {
    let Format { width, height, .. } = parts.format;
    let paper = parts.format.on_paper(Rect::new(0.0, 0.0, width, height));
    let count = i32::try_from(parts.painted.len()).unwrap_or(i32::MAX);
    pdf.pages(shared.pages).kids(shared.each_page.iter().copied()).count(count);
    let mut key = count;
    for (number, (painted, id)) in parts.painted.iter().zip(&shared.each_page).enumerate() {
        let content = references.next();
        pdf.stream(content, &deflated(&painted.content)).filter(Filter::FlateDecode);
        let mut page = pdf.page(*id);
        page.parent(shared.pages).media_box(paper).contents(content);
        page.pair(Name(b"Resources"), shared.resources);
        page.struct_parents(i32::try_from(number).unwrap_or(i32::MAX)).tab_order(TabOrder::StructureOrder);
        if !painted.links.is_empty() {
            page.annotations(painted.links.iter().map(|link| link.reference));
        }
        page.finish();
        for link in &painted.links {
            write_link(pdf, link, key, parts, shared);
            key += 1;
        }
    }
}

fn write_link(pdf: &mut Pdf, link: &PaintedLink, key: i32, parts: &Parts<'_, '_>, shared: &Shared) {
    let mut annotation = pdf.annotation(link.reference);
    annotation.subtype(AnnotationType::Link).rect(link.area).contents(TextStr(&link.link.words));
    annotation.border(0.0, 0.0, 0.0, None).struct_parent(key);
    annotation.flags(pdf_writer::types::AnnotationFlags::PRINT);
    match link.link.target.strip_prefix('#') {
        None => {
            let uri = Str(link.link.target.as_bytes());
            annotation.action().action_type(ActionType::Uri).uri(uri);
        }
        Some(id) => {
            let heading = parts.headings.iter().position(|heading| heading.id.as_deref() == Some(id));
            let spot = heading.and_then(|heading| parts.spots.get(heading)).copied().unwrap_or_default();
            let top = parts.format.scale * (parts.format.height - spot.down);
            let mut action = annotation.action();
            action.action_type(ActionType::GoTo);
            action.destination().page(shared.each_page[spot.page]).xyz(0.0, top, None);
        }
    }
}

fn write_resources(
    pdf: &mut Pdf,
    parts: &Parts<'_, '_>,
    shared: &Shared,
    references: &mut References,
) -> Result<(), PdfError> {
    let mut fonts = Vec::new();
    for face in Face::ALL {
        let used = &parts.ink.used[face as usize];
        if used.glyphs.num_gids() > 1 {
            let font = references.next();
            write_font(pdf, face, font, used, parts.fonts, &mut || references.next())?;
            fonts.push((face, font));
        }
    }
    let states: Vec<(u16, Ref)> = parts.ink.opacities.iter().map(|degree| (*degree, references.next())).collect();
    for (degree, state) in &states {
        let opacity = f32::from(*degree) / 1000.0;
        pdf.ext_graphics(*state).stroking_alpha(opacity).non_stroking_alpha(opacity);
    }
    let pictures: Vec<Ref> = parts.ink.pictures.iter().map(|picture| write_picture(pdf, picture, references)).collect();
    let mut resources = pdf.indirect(shared.resources).start::<pdf_writer::writers::Resources<'_>>();
    let mut of_fonts = resources.fonts();
    fonts.iter().for_each(|(face, font)| {
        of_fonts.pair(Name(face.key()), *font);
    });
    of_fonts.finish();
    let mut of_states = resources.ext_g_states();
    states.iter().for_each(|(degree, state)| {
        of_states.pair(Name(opacity_key(*degree).as_bytes()), *state);
    });
    of_states.finish();
    let mut of_pictures = resources.x_objects();
    pictures.iter().enumerate().for_each(|(number, picture)| {
        of_pictures.pair(Name(picture_key(number).as_bytes()), *picture);
    });
    Ok(())
}

fn write_picture(pdf: &mut Pdf, picture: &Picture, references: &mut References) -> Ref {
    let (id, mask) = (references.next(), references.next());
    let side = |pixels: u32| i32::try_from(pixels).unwrap_or(i32::MAX);
    let (width, height) = (side(picture.width), side(picture.height));
    match &picture.content {
        Pixels::Jpeg { file, is_grey } => {
            let mut image = pdf.image_xobject(id, file);
            image.filter(Filter::DctDecode);
            image.width(width).height(height).bits_per_component(8);
            match is_grey {
                true => image.color_space().device_gray(),
                false => image.color_space().device_rgb(),
            }
        }
        Pixels::Plain { colours, opacities } => {
            let colours = deflated(colours);
            let mut image = pdf.image_xobject(id, &colours);
            image.filter(Filter::FlateDecode);
            image.width(width).height(height).bits_per_component(8);
            image.color_space().device_rgb();
            image.s_mask(mask);
            image.finish();
            let opacities = deflated(opacities);
            let mut image = pdf.image_xobject(mask, &opacities);
            image.filter(Filter::FlateDecode);
            image.width(width).height(height).bits_per_component(8);
            image.color_space().device_gray();
        }
    }
    id
}

fn write_structure(pdf: &mut Pdf, parts: &Parts<'_, '_>, shared: &Shared, references: &mut References) {
    let element = |node: usize| reference(shared.elements, node);
    let mut parents: BTreeMap<i32, Ref> = BTreeMap::new();
    let mut key = 0;
    for painted in &parts.painted {
        let array = references.next();
        pdf.indirect(array).array().items(painted.nodes.iter().map(|node| element(*node)));
        parents.insert(key, array);
        key += 1;
    }
    for link in parts.painted.iter().flat_map(|painted| &painted.links) {
        parents.insert(key, element(link.link.node));
        key += 1;
    }
    let mut root = pdf.indirect(shared.tree).start::<pdf_writer::writers::StructTreeRoot<'_>>();
    root.child(element(ROOT));
    let mut tree = root.parent_tree();
    let mut numbers = tree.nums();
    parents.iter().for_each(|(key, parent)| {
        numbers.insert(*key, *parent);
    });
    numbers.finish();
    tree.finish();
    root.parent_tree_next_key(key);
    root.finish();
    parts.structure.write(pdf, shared.tree, shared.elements, &shared.each_page);
}

/// A bookmark, and those below it.
struct Bookmark {
    heading: usize,
    id: Ref,
    below: Vec<Bookmark>,
}

/// The bookmarks of headings from `all`, of which the first begins a level.
fn bookmarks(all: &[(usize, usize)], references: &mut References) -> Vec<Bookmark> {
    let mut found = Vec::new();
    let mut rest = all;
    while let Some(((heading, level), behind)) = rest.split_first() {
        let count = behind.iter().take_while(|(_, deeper)| deeper > level).count();
        let id = references.next();
        found.push(Bookmark { heading: *heading, id, below: bookmarks(&behind[..count], references) });
        rest = &behind[count..];
    }
    found
}

fn write_outline(pdf: &mut Pdf, parts: &Parts<'_, '_>, shared: &Shared, references: &mut References) -> Option<Ref> {
    // The title of the page is the title of the document.
    let levels: Vec<(usize, usize)> = parts
        .headings
        .iter()
        .enumerate()
        .filter(|(_, heading)| heading.level > 0)
        .map(|(n, heading)| (n, heading.level))
        .collect();
    let id = references.next();
    let all = bookmarks(&levels, references);
    let (first, last) = (all.first()?, all.last()?);
    let count = i32::try_from(all.len()).unwrap_or(i32::MAX);
    pdf.outline(id).first(first.id).last(last.id).count(count);
    write_bookmarks(pdf, &all, id, parts, shared);
    Some(id)
}

fn write_bookmarks(pdf: &mut Pdf, all: &[Bookmark], parent: Ref, parts: &Parts<'_, '_>, shared: &Shared) {
    for (number, one) in all.iter().enumerate() {
        let mut item = pdf.outline_item(one.id);
        item.title(TextStr(&parts.headings[one.heading].title)).parent(parent);
        if let Some(before) = number.checked_sub(1).and_then(|before| all.get(before)) {
            item.prev(before.id);
        }
        if let Some(next) = all.get(number + 1) {
            item.next(next.id);
        }
        if let (Some(first), Some(last)) = (one.below.first(), one.below.last()) {
            // Closed until the reader opens it.
            item.first(first.id).last(last.id).count(-i32::try_from(one.below.len()).unwrap_or(i32::MAX));
        }
        let spot = parts.spots.get(one.heading).copied().unwrap_or_default();
        let top = parts.format.scale * (parts.format.height - spot.down);
        item.dest().page(shared.each_page[spot.page]).xyz(0.0, top, None);
        item.finish();
        write_bookmarks(pdf, &one.below, one.id, parts, shared);
    }
}

fn write_information(pdf: &mut Pdf, parts: &Parts<'_, '_>, id: Ref) {
    let PdfOptions { author, generator, created, .. } = parts.options;
    let mut information = pdf.document_info(id);
    information.title(TextStr(parts.title)).creator(TextStr(generator)).producer(TextStr(generator));
    if !author.is_empty() {
        information.author(TextStr(author));
    }
    if let Some(Day { year, month, day }) = created {
        information.creation_date(Date::new(*year).month(*month).day(*day));
    }
}

/// The same for programs that read XMP, and that the file follows PDF/UA.
fn xmp(parts: &Parts<'_, '_>) -> String {
    let PdfOptions { author, generator, created, .. } = parts.options;
    let of_author = match author.is_empty() {
        true => String::new(),
        false => format!("<dc:creator><rdf:Seq><rdf:li>{}</rdf:li></rdf:Seq></dc:creator>", escape(author)),
    };
    let of_day = match created {
        None => String::new(),
        Some(day) => format!("<xmp:CreateDate>{day}</xmp:CreateDate>"),
    };
    format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" \
         xmlns:dc=\"http://purl.org/dc/elements/1.1/\" xmlns:xmp=\"http://ns.adobe.com/xap/1.0/\" \
         xmlns:pdf=\"http://ns.adobe.com/pdf/1.3/\">\
         <dc:title><rdf:Alt><rdf:li xml:lang=\"x-default\">{}</rdf:li></rdf:Alt></dc:title>{of_author}\
         <dc:language><rdf:Bag><rdf:li>{LANGUAGE}</rdf:li></rdf:Bag></dc:language>{of_day}\
         <xmp:CreatorTool>{generator}</xmp:CreatorTool><pdf:Producer>{generator}</pdf:Producer>\
         </rdf:Description></rdf:RDF></x:xmpmeta>\n<?xpacket end=\"r\"?>",
        escape(parts.title),
        generator = escape(generator),
    )
}
