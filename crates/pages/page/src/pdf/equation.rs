//! Formulas in a line of their own, with stacked fractions.

use super::font::Face;
use super::layout::{GAP, Layout, Place, body};
use super::strip::{Area, Shape, Strip};
use super::structure::{Node, Role};
use super::text::{INK, Setter, Style};
use crate::formula::{Piece, pieces};
use crate::prose::Prose;
use crate::terminal::linear;

const SIZE: f32 = 10.5;
const INDENT: f32 = 16.0;
/// The smallest scale at which a formula is still shown as one.
const LEAST: f32 = 0.7;
/// Heights above the base, per size: of the line of a fraction, of a power, of an index.
const AXIS: f32 = 0.3;
const POWER: f32 = 0.36;
const INDEX: f32 = -0.18;
/// Beside and between the parts of a fraction.
const AROUND: f32 = 2.0;

/// A piece as it is set: how far it goes up and down from the base, and its shapes, with y from the base.
struct Set {
    width: f32,
    up: f32,
    down: f32,
    shapes: Vec<Shape>,
}

impl Layout<'_> {
    /// A formula; where it is too wide, as text in lines.
    pub(super) fn equation(&mut self, formula: &str, place: Place) -> Vec<Strip> {
        let room = place.room - INDENT;
        let node = self.structure.described(Role::Formula, place.node, linear(formula));
        let style = Style::new(Face::Regular, SIZE, INK);
        let set = row(&self.setter, &pieces(formula), style);
        let scale = room / set.width;
        if scale < LEAST {
            return self.as_text(formula, node, room);
        }
        let style = Style { size: SIZE * scale.min(1.0), ..style };
        let Set { up, down, shapes, .. } = row(&self.setter, &pieces(formula), style);
        let mut strip = Strip { before: GAP, height: up + down, ..Strip::default() };
        shapes.into_iter().for_each(|shape| strip.draw(node, shape));
        strip.shift(INDENT, up);
        strip.height = up + down;
        vec![strip]
    }

    fn as_text(&mut self, formula: &str, node: Node, room: f32) -> Vec<Strip> {
        let mut strips = self.paragraph(&Prose::verbatim(linear(formula)), body(), node, room);
        strips.iter_mut().for_each(|strip| strip.shift(INDENT, 0.0));
        strips
    }
}

/// Pieces beside each other.
fn row(setter: &Setter<'_>, pieces: &[Piece<'_>], style: Style) -> Set {
    let mut whole = Set { width: 0.0, up: 0.0, down: 0.0, shapes: Vec::new() };
    for piece in pieces {
        let set = match piece {
            Piece::Fraction(over, under) => fraction(setter, over, under, style),
            Piece::Symbol(text) => letters(setter, text, Style { is_slanted: true, ..style }),
            Piece::Index(text) => letters(setter, text, style.small(INDEX)),
            Piece::Power(inner) => row(setter, inner, style.small(POWER)),
            Piece::Upright(text) => letters(setter, text, style),
        };
        whole.add(set, (whole.width, 0.0));
    }
    whole
}

impl Set {
    /// Puts another one onto this, shifted to the right and down.
    fn add(&mut self, other: Set, (right, down): (f32, f32)) {
        self.up = self.up.max(other.up - down);
        self.down = self.down.max(other.down + down);
        self.width = self.width.max(right + other.width);
        let mut carrier = Strip::default();
        other.shapes.into_iter().for_each(|shape| carrier.draw(None, shape));
        carrier.shift(right, down);
        self.shapes.extend(carrier.marks.into_iter().map(|mark| mark.shape));
    }
}

fn letters(setter: &Setter<'_>, text: &str, style: Style) -> Set {
    let fragment = setter.fragment(text.to_owned(), style, None);
    Set {
        width: fragment.width,
        up: 0.95 * style.size + style.rise,
        down: 0.28 * style.size - style.rise,
        shapes: vec![Shape::Text(0.0, 0.0, fragment)],
    }
}

fn fraction(setter: &Setter<'_>, over: &[Piece<'_>], under: &[Piece<'_>], style: Style) -> Set {
    let (over, under) = (row(setter, over, style), row(setter, under, style));
    let width = over.width.max(under.width) + 2.0 * AROUND;
    let axis = -(AXIS * style.size + style.rise);
    let mut whole = Set { width: width + 2.0 * AROUND, up: 0.0, down: 0.0, shapes: Vec::new() };
    whole.shapes.push(Shape::Fill(Area { x: AROUND, y: axis, width, height: 0.6 }, style.colour));
    let middle = |part: &Set| AROUND + 0.5 * (width - part.width);
    let (left, down) = (middle(&over), axis - over.down - 0.5);
    whole.add(over, (left, down));
    let (left, down) = (middle(&under), axis + under.up + 0.5);
    whole.add(under, (left, down));
    whole
}
