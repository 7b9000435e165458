//! Pages as content streams, each piece marked with the node of the structure that it belongs to.

use pdf_writer::types::ArtifactType;
use pdf_writer::{Content, Finish, Name, Rect, Ref};

use super::ink::{Ink, picture_key};
use super::strip::{Area, LinkArea, Mark, Shape, Sheet, Strip};
use super::structure::{Node, Role, Structure};
use super::text::{Colour, Fragment};
use super::{paper::Format, vector};

/// A page as it is written.
pub(super) struct Painted {
    pub(super) content: Vec<u8>,
    /// The nodes of its pieces, by their numbers.
    pub(super) nodes: Vec<Node>,
    pub(super) links: Vec<PaintedLink>,
}

/// A link as it is written.
pub(super) struct PaintedLink {
    pub(super) reference: Ref,
    pub(super) area: Rect,
    pub(super) link: LinkArea,
}

/// Texts at the edges of a page.
pub(super) struct Edges {
    pub(super) texts: Vec<(f32, f32, Fragment)>,
}

/// Draws pages.
pub(super) struct Painter<'p, 'f> {
    pub(super) ink: &'p mut Ink<'f>,
    pub(super) structure: &'p mut Structure,
    pub(super) format: Format,
    /// The page of each heading.
    pub(super) heading_pages: &'p [usize],
    pub(super) fonts: &'f super::font::Fonts,
}

impl Painter<'_, '_> {
    /// Draws a page.
    pub(super) fn page(
        &mut self,
        number: usize,
        sheet: &Sheet,
        edges: &Edges,
        new_reference: &mut dyn FnMut() -> Ref,
    ) -> Painted {
        let mut page = Page { number, content: Content::new(), nodes: Vec::new(), is_open: None, top: 0.0 };
        let scale = self.format.scale;
        page.content.save_state().transform([scale, 0.0, 0.0, scale, 0.0, 0.0]);
        for (y, strip) in sheet {
            page.top = self.format.margin_top + y;
            self.strip(&mut page, strip);
        }
        page.close();
        self.edges(&mut page.content, edges);
        page.content.restore_state();
        let links = self.links(number, sheet, new_reference);
        Painted { content: page.content.finish().to_vec(), nodes: page.nodes, links }
    }

    fn strip(&mut self, page: &mut Page, strip: &Strip) {
        for Mark { node, shape } in &strip.marks {
            if let (Some(node), Shape::Nothing) = (node, shape) {
                self.structure.place(*node);
                continue;
            }
            page.mark(*node, self.structure);
            self.shape(page, *node, shape);
        }
    }

    fn shape(&mut self, page: &mut Page, node: Option<Node>, shape: &Shape) {
        match shape {
            Shape::Text(x, y, fragment) => self.text(page, (*x, *y), fragment),
            Shape::PageOf(x, y, heading, look) => {
                let number = self.heading_pages.get(*heading).map_or(0, |page| page + 1).to_string();
                let width: f32 = number.chars().map(|c| self.fonts.width(look.style.face, c, look.style.size)).sum();
                self.text(page, (x - width, *y), &Fragment { text: number, width, ..look.clone() });
            }
            Shape::Fill(area, colour) => self.rectangle(page, *area, *colour, true),
            Shape::Outline(area, colour) => self.rectangle(page, *area, *colour, false),
            Shape::Drawing(area, tree) => {
                let scale = area.width / tree.size().width();
                let corner = self.rect(page.top, *area);
                page.content.save_state().rect(corner.x1, corner.y1, area.width, area.height);
                page.content.clip_nonzero().end_path();
                page.content.transform([scale, 0.0, 0.0, -scale, corner.x1, corner.y2]);
                vector::draw(tree, &mut page.content, self.ink);
                page.content.restore_state();
                self.describe_area(node, corner);
            }
            Shape::Picture(area, picture) => {
                let key = picture_key(self.ink.picture(picture));
                let corner = self.rect(page.top, *area);
                page.content.save_state().transform([area.width, 0.0, 0.0, area.height, corner.x1, corner.y1]);
                page.content.x_object(Name(key.as_bytes())).restore_state();
                self.describe_area(node, corner);
            }
            Shape::Nothing => {}
        }
    }

    fn describe_area(&mut self, node: Option<Node>, area: Rect) {
        if let Some(node) = node.filter(|node| self.structure.role(*node) == Role::Figure) {
            self.structure.set_area(node, self.format.on_paper(area));
        }
    }

    fn text(&mut self, page: &mut Page, (x, y): (f32, f32), fragment: &Fragment) {
        let at = (self.format.margin_side + x, self.format.height - page.top - y);
        self.ink.write(&mut page.content, at, fragment);
    }

    fn rectangle(&self, page: &mut Page, area: Area, [red, green, blue]: Colour, is_filled: bool) {
        let Rect { x1, y1, .. } = self.rect(page.top, area);
        let content = &mut page.content;
        match is_filled {
            true => {
                content.set_fill_rgb(red, green, blue).rect(x1, y1, area.width, area.height).fill_nonzero();
            }
            false => {
                content.set_stroke_rgb(red, green, blue).set_line_width(0.6).set_dash_pattern([], 0.0);
                content.rect(x1, y1, area.width, area.height).stroke();
            }
        }
    }

    /// An area of a strip on the page, whose y goes up.
    fn rect(&self, top: f32, area: Area) -> Rect {
        let left = self.format.margin_side + area.x;
        let bottom = self.format.height - top - area.y - area.height;
        Rect::new(left, bottom, left + area.width, bottom + area.height)
    }

    fn edges(&mut self, content: &mut Content, edges: &Edges) {
        if edges.texts.is_empty() {
            return;
        }
        let mut artifact = content.begin_marked_content_with_properties(Name(b"Artifact"));
        artifact.properties().artifact().kind(ArtifactType::Pagination);
        artifact.finish();
        for (x, y, fragment) in &edges.texts {
            self.ink.write(content, (*x, self.format.height - y), fragment);
        }
        content.end_marked_content();
    }

    fn links(&mut self, number: usize, sheet: &Sheet, new_reference: &mut dyn FnMut() -> Ref) -> Vec<PaintedLink> {
        let mut all = Vec::new();
        for (y, strip) in sheet {
            for link in &strip.links {
                let reference = new_reference();
                self.structure.add_link(link.node, number, reference);
                let area = self.format.on_paper(self.rect(self.format.margin_top + y, link.area));
                all.push(PaintedLink { reference, area, link: link.clone() });
            }
        }
        all
    }
}

/// A page as it is drawn.
struct Page {
    number: usize,
    content: Content,
    nodes: Vec<Node>,
    /// Whose content is open: that of a node, or decoration.
    is_open: Option<Option<Node>>,
    /// The upper end of the strip that is drawn.
    top: f32,
}

impl Page {
    /// Marks what follows as content of a node, or as decoration.
    fn mark(&mut self, node: Option<Node>, structure: &mut Structure) {
        if self.is_open == Some(node) {
            return;
        }
        self.close();
        self.is_open = Some(node);
        let Some(node) = node else {
            self.content.begin_marked_content(Name(b"Artifact"));
            return;
        };
        let number = i32::try_from(self.nodes.len()).unwrap_or(i32::MAX);
        structure.add_content(node, self.number, number);
        self.nodes.push(node);
        let role = structure.role(node).to_name();
        self.content.begin_marked_content_with_properties(role).properties().identify(number);
    }

    fn close(&mut self) {
        if self.is_open.take().is_some() {
            self.content.end_marked_content();
        }
    }
}
