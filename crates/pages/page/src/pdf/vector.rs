//! Drawings: from SVG to the operators of a PDF's content.

use std::rc::Rc;

use pdf_writer::Content;
use pdf_writer::types::{LineCapStyle, LineJoinStyle, TextRenderingMode};
use resvg::tiny_skia::{PathSegment, Transform};
use resvg::usvg::{self, Group, Node, Paint, PaintOrder, Path, Text, fontdb};

use super::font::Face;
use super::ink::Ink;
use super::options::PdfError;
use super::text::Colour;

/// Rules of HTML's style sheet for drawings.
const STYLE: &str = include_str!("../../assets/drawing.css");
/// The colours that the style sheet names.
const COLOURS: [(&str, &str); 5] = [
    ("var(--ink)", "#1d232a"),
    ("var(--soft)", "#56616d"),
    ("var(--wash)", "#f5f7f9"),
    ("var(--paper)", "#ffffff"),
    ("var(--link)", "#14568c"),
];

/// Reads drawings, with the fonts that are built in.
pub(super) struct Reader {
    options: usvg::Options<'static>,
    style: String,
}

impl Reader {
    pub(super) fn new() -> Self {
        let style = COLOURS.iter().fold(STYLE.to_owned(), |style, (name, colour)| style.replace(name, colour));
        Reader { options: crate::drawing::options(), style }
    }

    /// A figure, or a part of one: colours and sizes are in its attributes.
    pub(super) fn figure(&self, svg: &str, what: &str) -> Result<Rc<usvg::Tree>, PdfError> {
        self.read(svg, what, "", "")
    }

    /// A drawing of a page: the SVG element in a piece of HTML, with its style sheet.
    pub(super) fn drawing(&self, html: &str, what: &str) -> Result<Rc<usvg::Tree>, PdfError> {
        let style = format!("<style>{}</style>", self.style);
        self.read(html, what, " class=\"diagram\"", &style)
    }

    fn read(&self, text: &str, what: &str, class: &str, style: &str) -> Result<Rc<usvg::Tree>, PdfError> {
        let failed = |reason: &str| PdfError::Drawing { what: what.to_owned(), reason: reason.to_owned() };
        let element = text.find("<svg").zip(text.rfind("</svg>")).and_then(|(start, end)| text.get(start + 4..end + 6));
        let parts = element.and_then(|element| element.split_once('>'));
        let (attributes, content) = parts.ok_or_else(|| failed("it has no element svg"))?;
        let svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\"{class}{attributes}>{style}{content}");
        usvg::Tree::from_str(&svg, &self.options).map(Rc::new).map_err(|error| failed(&error.to_string()))
    }
}

/// Draws a drawing whose upper left corner is at the origin; y goes down.
pub(super) fn draw(tree: &usvg::Tree, content: &mut Content, ink: &mut Ink<'_>) {
    let fonts = tree.fontdb();
    group(tree.root(), 1.0, &mut Pen { content, ink, fonts });
}

struct Pen<'p, 'f> {
    content: &'p mut Content,
    ink: &'p mut Ink<'f>,
    fonts: &'p fontdb::Database,
}

fn group(group: &Group, opacity: f32, pen: &mut Pen<'_, '_>) {
    pen.content.save_state();
    pen.content.transform(matrix(group.transform()));
    if let Some(clip) = group.clip_path() {
        clip_to(clip, pen.content);
    }
    let opacity = opacity * group.opacity().get();
    for child in group.children() {
        match child {
            Node::Group(inner) => self::group(inner, opacity, pen),
            Node::Path(one) => path(one, opacity, pen),
            Node::Text(one) => text(one, opacity, pen),
            Node::Image(_) => {}
        }
    }
    pen.content.restore_state();
}

/// Nothing is drawn from here on outside the paths of a clip.
fn clip_to(clip: &usvg::ClipPath, content: &mut Content) {
    let mut paths = Vec::new();
    paths_of(clip.root(), &mut paths);
    let has_any = !paths.is_empty();
    for one in paths {
        let whole = clip.transform().pre_concat(one.abs_transform());
        if let Some(moved) = one.data().clone().transform(whole) {
            outline(moved.segments(), content);
        }
    }
    if !has_any {
        content.rect(0.0, 0.0, 0.0, 0.0);
    }
    content.clip_nonzero().end_path();
}

fn paths_of<'g>(group: &'g Group, all: &mut Vec<&'g Path>) {
    for child in group.children() {
        match child {
            Node::Group(inner) => paths_of(inner, all),
            Node::Path(one) => all.push(one),
            _ => {}
        }
    }
}

fn path(one: &Path, opacity: f32, pen: &mut Pen<'_, '_>) {
    if !one.is_visible() {
        return;
    }
    let fill = |pen: &mut Pen<'_, '_>| {
        if let Some(fill) = one.fill()
            && set_fill(fill, opacity, pen)
        {
            outline(one.data().segments(), pen.content);
            match fill.rule() {
                usvg::FillRule::NonZero => pen.content.fill_nonzero(),
                usvg::FillRule::EvenOdd => pen.content.fill_even_odd(),
            };
        }
    };
    let stroke = |pen: &mut Pen<'_, '_>| {
        if let Some(stroke) = one.stroke()
            && set_stroke(stroke, opacity, pen)
        {
            outline(one.data().segments(), pen.content);
            pen.content.stroke();
        }
    };
    match one.paint_order() {
        PaintOrder::FillAndStroke => {
            fill(pen);
            stroke(pen);
        }
        PaintOrder::StrokeAndFill => {
            stroke(pen);
            fill(pen);
        }
    }
}

fn outline(segments: impl Iterator<Item = PathSegment>, content: &mut Content) {
    let mut at = (0.0, 0.0);
    for segment in segments {
        match segment {
            PathSegment::MoveTo(p) => {
                content.move_to(short(p.x), short(p.y));
                at = (p.x, p.y);
            }
            PathSegment::LineTo(p) => {
                content.line_to(short(p.x), short(p.y));
                at = (p.x, p.y);
            }
            PathSegment::QuadTo(c, p) => {
                // The cubic curve of the same course.
                let towards = |from: f32, to: f32| short(from + (to - from) * 2.0 / 3.0);
                let (first, second) =
                    ((towards(at.0, c.x), towards(at.1, c.y)), (towards(p.x, c.x), towards(p.y, c.y)));
                content.cubic_to(first.0, first.1, second.0, second.1, short(p.x), short(p.y));
                at = (p.x, p.y);
            }
            PathSegment::CubicTo(c, d, p) => {
                content.cubic_to(short(c.x), short(c.y), short(d.x), short(d.y), short(p.x), short(p.y));
                at = (p.x, p.y);
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
}

/// A length with two decimals, which are as many as can be seen.
fn short(length: f32) -> f32 {
    (100.0 * length).round() / 100.0
}

/// Sets how areas are filled; false where they are not, as the drawings of pages have no gradients.
fn set_fill(fill: &usvg::Fill, opacity: f32, pen: &mut Pen<'_, '_>) -> bool {
    let Some([red, green, blue]) = colour(fill.paint()) else { return false };
    pen.content.set_fill_rgb(red, green, blue);
    pen.ink.set_opacity(pen.content, opacity * fill.opacity().get());
    true
}

fn set_stroke(stroke: &usvg::Stroke, opacity: f32, pen: &mut Pen<'_, '_>) -> bool {
    let Some([red, green, blue]) = colour(stroke.paint()) else { return false };
    let content = &mut *pen.content;
    content.set_stroke_rgb(red, green, blue).set_line_width(stroke.width().get());
    content.set_miter_limit(stroke.miterlimit().get());
    content.set_line_cap(match stroke.linecap() {
        usvg::LineCap::Butt => LineCapStyle::ButtCap,
        usvg::LineCap::Round => LineCapStyle::RoundCap,
        usvg::LineCap::Square => LineCapStyle::ProjectingSquareCap,
    });
    content.set_line_join(match stroke.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => LineJoinStyle::MiterJoin,
        usvg::LineJoin::Round => LineJoinStyle::RoundJoin,
        usvg::LineJoin::Bevel => LineJoinStyle::BevelJoin,
    });
    let dashes = stroke.dasharray().unwrap_or_default();
    content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
    pen.ink.set_opacity(pen.content, opacity * stroke.opacity().get());
    true
}

fn colour(paint: &Paint) -> Option<Colour> {
    match paint {
        Paint::Color(usvg::Color { red, green, blue }) => {
            Some([*red, *green, *blue].map(|part| f32::from(part) / 255.0))
        }
        _ => None,
    }
}

fn matrix(transform: Transform) -> [f32; 6] {
    let Transform { sx, ky, kx, sy, tx, ty } = transform;
    [sx, ky, kx, sy, tx, ty]
}

/// Text as text, with a halo below it where it has one.
fn text(one: &Text, opacity: f32, pen: &mut Pen<'_, '_>) {
    for span in one.layouted().iter().filter(|span| span.visible) {
        if let Some(stroke) = &span.stroke
            && span.paint_order == PaintOrder::StrokeAndFill
            && set_stroke(stroke, opacity, pen)
        {
            glyphs(span, TextRenderingMode::Stroke, pen);
        }
        if let Some(fill) = &span.fill
            && set_fill(fill, opacity, pen)
        {
            glyphs(span, TextRenderingMode::Fill, pen);
        }
    }
}

fn glyphs(span: &usvg::layout::Span, mode: TextRenderingMode, pen: &mut Pen<'_, '_>) {
    pen.content.begin_text().set_text_rendering_mode(mode);
    for glyph in &span.positioned_glyphs {
        let is_bold = pen.fonts.face(glyph.font).is_some_and(|face| face.weight.0 >= 600);
        let face = if is_bold { Face::Bold } else { Face::Regular };
        let number = u16::try_from(glyph.id.0).unwrap_or(0);
        // Glyphs are in units of the font; those of a font of size 1 are in a PDF.
        let of_size_one = glyph.outline_transform().pre_scale(UNITS_PER_EM, UNITS_PER_EM);
        pen.content.set_text_matrix(matrix(of_size_one));
        pen.ink.show_glyph(pen.content, face, number, &glyph.text);
    }
    pen.content.set_text_rendering_mode(TextRenderingMode::Fill).end_text();
}

/// Of the fonts that are built in.
const UNITS_PER_EM: f32 = 2048.0;
