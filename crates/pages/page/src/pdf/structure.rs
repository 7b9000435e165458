//! The structure of a PDF: what is a heading, a paragraph, a cell, and in which order it is read.

use pdf_writer::types::{ListNumbering, TableHeaderScope};
use pdf_writer::writers::StructElement;
use pdf_writer::{Finish, Pdf, Rect, Ref, TextStr};

pub(super) use pdf_writer::types::StructRole as Role;

/// A node of the structure.
pub(super) type Node = usize;

/// Child of a node.
#[derive(Debug, Clone, Copy)]
enum Child {
    Node(Node),
    /// A piece of a page's content: the page, and its number there.
    Content(usize, i32),
    /// A link on a page.
    Link(usize, Ref),
}

#[derive(Debug)]
struct Element {
    role: Role,
    parent: Option<Node>,
    is_placed: bool,
    children: Vec<Child>,
    /// Description of the picture, in words.
    alternative: Option<String>,
    scope: Option<TableHeaderScope>,
    columns: i32,
    /// Where it is on its page.
    area: Option<Rect>,
}

/// All nodes. A node joins its parent when its first content is drawn, so that children are in the order of the pages.
pub(super) struct Structure(Vec<Element>);

/// The whole document.
pub(super) const ROOT: Node = 0;

impl Structure {
    pub(super) fn new() -> Self {
        let mut all = Structure(Vec::new());
        all.add(Role::Document, None);
        all.0[ROOT].is_placed = true;
        all
    }

    fn add(&mut self, role: Role, parent: Option<Node>) -> Node {
        self.0.push(Element {
            role,
            parent,
            is_placed: false,
            children: Vec::new(),
            alternative: None,
            scope: None,
            columns: 1,
            area: None,
        });
        self.0.len() - 1
    }

    /// A node below another one.
    pub(super) fn node(&mut self, role: Role, parent: Node) -> Node {
        self.add(role, Some(parent))
    }

    /// A node that is shown as a picture or formula, with what it shows in words.
    pub(super) fn described(&mut self, role: Role, parent: Node, text: impl Into<String>) -> Node {
        let node = self.node(role, parent);
        self.0[node].alternative = Some(text.into());
        node
    }

    /// A cell with the heading of a column or row.
    pub(super) fn heading_cell(&mut self, parent: Node, scope: TableHeaderScope) -> Node {
        let node = self.node(Role::TH, parent);
        self.0[node].scope = Some(scope);
        node
    }

    /// A cell across columns.
    pub(super) fn wide_cell(&mut self, parent: Node, columns: usize) -> Node {
        let node = self.node(Role::TD, parent);
        self.0[node].columns = columns.try_into().unwrap_or(1);
        node
    }

    /// How content streams mark a node's content.
    pub(super) fn role(&self, node: Node) -> Role {
        self.0[node].role
    }

    pub(super) fn set_area(&mut self, node: Node, area: Rect) {
        self.0[node].area = Some(area);
    }

    /// Puts a node below its parent, and that below its own.
    pub(super) fn place(&mut self, node: Node) {
        if self.0[node].is_placed {
            return;
        }
        self.0[node].is_placed = true;
        if let Some(parent) = self.0[node].parent {
            self.place(parent);
            self.0[parent].children.push(Child::Node(node));
        }
    }

    /// Adds content of a page to a node.
    pub(super) fn add_content(&mut self, node: Node, page: usize, number: i32) {
        self.place(node);
        self.0[node].children.push(Child::Content(page, number));
    }

    /// Adds a link on a page to a node.
    pub(super) fn add_link(&mut self, node: Node, page: usize, link: Ref) {
        self.place(node);
        self.0[node].children.push(Child::Link(page, link));
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Writes the nodes that have been placed. `first` is the reference of the root, and those of the others follow.
    pub(super) fn write(&self, pdf: &mut Pdf, tree: Ref, first: Ref, pages: &[Ref]) {
        for (number, element) in self.0.iter().enumerate().filter(|(_, element)| element.is_placed) {
            let mut writer = pdf.struct_element(reference(first, number));
            writer.kind(element.role);
            writer.parent(element.parent.map_or(tree, |parent| reference(first, parent)));
            if let Some(text) = &element.alternative {
                writer.alt(TextStr(text));
            }
            write_attributes(&mut writer, element);
            write_children(&mut writer, element, first, pages);
            writer.finish();
        }
    }
}

/// The reference of a node.
pub(super) fn reference(first: Ref, node: Node) -> Ref {
    Ref::new(first.get().saturating_add(i32::try_from(node).unwrap_or(i32::MAX)))
}

fn write_attributes(writer: &mut StructElement<'_>, element: &Element) {
    let is_list = element.role == Role::L;
    if element.scope.is_none() && element.columns == 1 && element.area.is_none() && !is_list {
        return;
    }
    let mut all = writer.attributes();
    if let Some(scope) = element.scope {
        all.push().table().scope(scope);
    }
    if element.columns > 1 {
        all.push().table().col_span(element.columns);
    }
    if let Some(area) = element.area {
        all.push().layout().bbox(area);
    }
    if is_list {
        all.push().list().list_numbering(ListNumbering::Disc);
    }
}

fn write_children(writer: &mut StructElement<'_>, element: &Element, first: Ref, pages: &[Ref]) {
    let mut all = writer.children();
    for child in &element.children {
        match child {
            Child::Node(node) => {
                all.struct_element(reference(first, *node));
            }
            Child::Content(page, number) => {
                all.marked_content_ref().page(pages[*page]).marked_content_id(*number);
            }
            Child::Link(page, link) => {
                all.object_ref().page(pages[*page]).object(*link);
            }
        }
    }
}
