//! Strips of a page, and how they are put onto pages.

use std::rc::Rc;

use resvg::usvg;

use super::structure::Node;
use super::text::{Colour, Fragment};
use crate::logo::Picture;

/// A rectangle: its upper left corner, width and height. x goes right and y goes down, in points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) width: f32,
    pub(super) height: f32,
}

/// Something drawn.
#[derive(Debug, Clone)]
pub(super) enum Shape {
    /// Text, by the left end of its base.
    Text(f32, f32, Fragment),
    /// A filled rectangle.
    Fill(Area, Colour),
    /// The outline of a rectangle.
    Outline(Area, Colour),
    /// A drawing, scaled to its width.
    Drawing(Area, Rc<usvg::Tree>),
    /// A picture of pixels.
    Picture(Area, Rc<Picture>),
    /// The number of the page with a heading, by the right end of its base. The fragment has the look.
    PageOf(f32, f32, usize, Fragment),
    /// Nothing: an empty cell.
    Nothing,
}

/// A shape, and what it is part of; without a node it is decoration.
#[derive(Debug, Clone)]
pub(super) struct Mark {
    pub(super) node: Option<Node>,
    pub(super) shape: Shape,
}

/// An area that leads elsewhere.
#[derive(Debug, Clone)]
pub(super) struct LinkArea {
    pub(super) area: Area,
    pub(super) target: Rc<str>,
    pub(super) node: Node,
    /// Its target in words.
    pub(super) words: String,
}

/// A part of the page's height that no page's end divides.
#[derive(Debug, Clone, Default)]
pub(super) struct Strip {
    pub(super) height: f32,
    /// Free space above, unless it is the first of a page.
    pub(super) before: f32,
    /// True if the next strip is on the same page.
    pub(super) is_kept: bool,
    pub(super) marks: Vec<Mark>,
    pub(super) links: Vec<LinkArea>,
    /// The heading in it, by its number.
    pub(super) heading: Option<usize>,
    /// Strip that is repeated above it if it begins a page.
    pub(super) repeated: Option<Rc<Strip>>,
}

impl Strip {
    pub(super) fn draw(&mut self, node: impl Into<Option<Node>>, shape: Shape) {
        self.marks.push(Mark { node: node.into(), shape });
    }

    /// Moves all of it.
    pub(super) fn shift(&mut self, right: f32, down: f32) {
        for mark in &mut self.marks {
            match &mut mark.shape {
                Shape::Text(x, y, _) | Shape::PageOf(x, y, ..) => (*x, *y) = (*x + right, *y + down),
                Shape::Fill(area, _) | Shape::Outline(area, _) | Shape::Drawing(area, _) | Shape::Picture(area, _) => {
                    *area = area.shifted(right, down)
                }
                Shape::Nothing => {}
            }
        }
        for link in &mut self.links {
            link.area = link.area.shifted(right, down);
        }
        if let Some(repeated) = &self.repeated {
            let mut moved = Strip::clone(repeated);
            moved.shift(right, 0.0);
            self.repeated = Some(Rc::new(moved));
        }
    }

    /// The space above becomes part of it.
    pub(super) fn take_space(&mut self) {
        let before = std::mem::take(&mut self.before);
        self.shift(0.0, before);
        self.height += before;
    }

    /// Puts another strip's content onto this one, `down` below its top.
    pub(super) fn absorb(&mut self, mut other: Strip, right: f32, down: f32) {
        other.shift(right, down);
        self.height = self.height.max(down + other.height);
        self.marks.append(&mut other.marks);
        self.links.append(&mut other.links);
    }

    /// Makes the drawings of a strip smaller, about the middle of their width.
    fn scale(&mut self, scale: f32) {
        self.height *= scale;
        for mark in &mut self.marks {
            if let Shape::Drawing(area, _) = &mut mark.shape {
                let (width, height) = (scale * area.width, scale * area.height);
                *area = Area { x: area.x + 0.5 * (area.width - width), y: scale * area.y, width, height };
            }
        }
    }

    /// Strips below each other as one.
    pub(super) fn of_stack(all: Vec<Strip>) -> Strip {
        let mut whole = Strip::default();
        for strip in all {
            let down = if whole.height > 0.0 { whole.height + strip.before } else { 0.0 };
            whole.absorb(strip, 0.0, down);
        }
        whole
    }
}

impl Area {
    fn shifted(self, right: f32, down: f32) -> Self {
        Area { x: self.x + right, y: self.y + down, ..self }
    }
}

/// The highest line of text.
const HIGHEST_LINE: f32 = 40.0;

/// A strip in parts that fit a page, where a single one does not: text of unusual length without a place to divide it.
fn divided(strip: Strip, page: f32) -> Vec<Strip> {
    if strip.height <= page {
        return vec![strip];
    }
    let part = page - HIGHEST_LINE;
    let count = (strip.height / part).ceil() as usize;
    let mut parts: Vec<Strip> =
        (0..count).map(|_| Strip { height: page, is_kept: false, ..Strip::default() }).collect();
    let at = |top: f32| ((top.max(0.0) / part) as usize).min(count - 1);
    for mark in strip.marks {
        let top = mark.shape.top();
        let number = at(top);
        let mut carrier = Strip { marks: vec![mark], ..Strip::default() };
        carrier.shift(0.0, -(number as f32 * part));
        carrier.marks.iter_mut().for_each(|mark| mark.shape.crop(page));
        parts[number].marks.append(&mut carrier.marks);
    }
    for mut link in strip.links {
        let number = at(link.area.y);
        link.area.y -= number as f32 * part;
        parts[number].links.push(link);
    }
    if let Some(first) = parts.first_mut() {
        (first.heading, first.before) = (strip.heading, strip.before);
    }
    parts
}

impl Shape {
    /// The upper end.
    fn top(&self) -> f32 {
        match self {
            Shape::Text(_, base, fragment) | Shape::PageOf(_, base, _, fragment) => base - fragment.style.base(),
            Shape::Fill(area, _) | Shape::Outline(area, _) | Shape::Drawing(area, _) | Shape::Picture(area, _) => {
                area.y
            }
            Shape::Nothing => 0.0,
        }
    }

    /// Rectangles end where the page does.
    fn crop(&mut self, page: f32) {
        if let Shape::Fill(area, _) | Shape::Outline(area, _) = self {
            area.height = area.height.min(page - area.y);
        }
    }
}

/// The height of strips below each other, without the space above the first.
pub(super) fn height(strips: &[Strip]) -> f32 {
    strips.iter().map(|strip| strip.before + strip.height).sum::<f32>()
        - strips.first().map_or(0.0, |first| first.before)
}

/// Keeps strips on one page, all but the last with the next.
pub(super) fn keep_together(strips: &mut [Strip]) {
    if let Some((_, all)) = strips.split_last_mut() {
        all.iter_mut().for_each(|strip| strip.is_kept = true);
    }
}

/// Keeps the first two and the last two of strips on one page each, so that no line of a paragraph is alone.
pub(super) fn keep_ends(strips: &mut [Strip]) {
    let count = strips.len();
    if count > 1 {
        strips[0].is_kept = true;
        strips[count - 2].is_kept = true;
    }
}

/// The part of its size to which a drawing is made smaller at most, so that it need not go to the next page.
const LEAST_SHRUNK: f32 = 0.75;
/// The lowest strip that is a drawing of its own, and no sign in a line.
const LOWEST_DRAWING: f32 = 60.0;

/// Makes drawings smaller if that lets strips fit a height; whether they do.
fn shrunk(group: &mut [Strip], room: f32) -> bool {
    let is_drawing = |strip: &Strip| {
        let drawn = |mark: &Mark| matches!(&mark.shape, Shape::Drawing(area, _) if area.height >= LOWEST_DRAWING);
        !strip.marks.is_empty() && strip.marks.iter().all(drawn)
    };
    let drawn: f32 = group.iter().filter(|strip| is_drawing(strip)).map(|strip| strip.height).sum();
    let scale = (room - (height(group) - drawn)) / drawn.max(f32::MIN_POSITIVE);
    if scale < LEAST_SHRUNK {
        return false;
    }
    group.iter_mut().filter(|strip| is_drawing(strip)).for_each(|strip| strip.scale(scale));
    true
}

/// The strips of a page, each with its distance from the upper margin.
pub(super) type Sheet = Vec<(f32, Strip)>;

/// Puts strips onto pages of a height. What is kept together but higher than a page is divided where the page ends.
pub(super) fn paginate(strips: Vec<Strip>, page: f32) -> Vec<Sheet> {
    let mut pages = Pages { page, full: Vec::new(), open: Sheet::new(), y: 0.0 };
    let mut group: Vec<Strip> = Vec::new();
    for strip in strips.into_iter().flat_map(|strip| divided(strip, page)) {
        let goes_on = strip.is_kept;
        group.push(strip);
        if !goes_on {
            pages.add(std::mem::take(&mut group));
        }
    }
    pages.add(group);
    pages.full.push(pages.open);
    pages.full
}

struct Pages {
    page: f32,
    full: Vec<Sheet>,
    open: Sheet,
    y: f32,
}

impl Pages {
    fn add(&mut self, group: Vec<Strip>) {
        let Some(first) = group.first() else { return };
        let needed = height(&group);
        let on_top = needed + first.repeated.as_ref().map_or(0.0, |repeated| repeated.height);
        let room = self.page - self.y - first.before;
        let fits = |group: &[Strip], room: f32| height(group) <= room;
        let mut group = group;
        if self.y > 0.0 && !fits(&group, room) && on_top <= self.page && !shrunk(&mut group, room) {
            self.turn();
        }
        group.into_iter().for_each(|strip| self.put(strip));
    }

    fn put(&mut self, strip: Strip) {
        if self.y > 0.0 && self.y + strip.before + strip.height > self.page {
            self.turn();
        }
        if self.y > 0.0 {
            self.y += strip.before;
        } else if let Some(repeated) = &strip.repeated {
            self.y = repeated.height;
            self.open.push((0.0, Strip::clone(repeated)));
        }
        let height = strip.height;
        self.open.push((self.y, strip));
        self.y += height;
    }

    fn turn(&mut self) {
        self.full.push(std::mem::take(&mut self.open));
        self.y = 0.0;
    }
}
