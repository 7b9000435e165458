//! Figures and drawings, with title, legend and caption on one page.

use std::rc::Rc;

use resvg::usvg;

use super::layout::{BODY, GAP, Layout, Place, SMALL, body, bold, small};
use super::options::PdfError;
use super::strip::{Area, Shape, Strip, height, keep_together};
use super::structure::{Node, Role};
use super::text::{SOFT, Style};
use crate::figure::Figure;
use crate::prose::Prose;
use crate::svg;
use crate::thinned::thinned;

/// Points per pixel of a figure across the page, and of one beside another.
const SCALE: f32 = 0.68;
const NARROW_SCALE: f32 = 0.6;
/// Between two figures beside each other.
const BETWEEN: f32 = 14.0;
/// The part of a page that a figure's drawing has at least, whatever stands around it.
const LEAST: f32 = 0.3;
/// The part of a page that a figure takes at most.
const HIGHEST: f32 = 0.86;
/// How far panels are lowered so that two figures are on a page.
const LOWERED: f32 = 0.6;
/// The lowest panel in which a course is still seen, pixels.
const LOWEST_PANEL: f32 = 45.0;
/// Pixels of the sign before a name in the legend.
const KEY_WIDTH: f32 = 18.0;
const KEY_HEIGHT: f32 = 14.0;
const ABOVE: f32 = 12.0;

impl Layout<'_> {
    /// A figure across the page.
    pub(super) fn figure(&mut self, figure: &Figure, place: Place) -> Result<Vec<Strip>, PdfError> {
        self.scaled(figure, place, SCALE)
    }

    fn scaled(&mut self, whole: &Figure, place: Place, scale: f32) -> Result<Vec<Strip>, PdfError> {
        self.figures += 1;
        let mut figure = thinned(whole, self.most_points);
        let symbols = figure.symbols;
        let text = |text: &str| if symbols { text.into() } else { Prose::verbatim(text) };
        let title = self.structure.node(Role::P, place.node);
        let mut above = self.paragraph(&text(&figure.title), bold(BODY), title, place.room);
        above.extend(self.legend(&figure, place)?);
        let node = self.structure.described(Role::Figure, place.node, svg::alternative(whole));
        let caption = self.structure.node(Role::Caption, node);
        let below = self.paragraph(&text(&figure.caption), small(), caption, place.room);
        let taken = ABOVE + height(&above) + height(&below) + GAP;
        lower(&mut figure, self.column, taken, scale);
        let drawing = svg::Drawing { whole, drawn: &figure, packed: &[], number: self.figures };
        let drawing = svg::on_paper(drawing, f64::from(place.room / scale));
        let tree = self.reader.figure(&drawing, &figure.title)?;
        let shown = self.shown(&tree, node, place.room, taken + GAP);
        Ok(together(above, shown, below))
    }

    /// A drawing as wide as there is room, or as high.
    fn shown(&self, tree: &Rc<usvg::Tree>, node: Node, room: f32, taken: f32) -> Strip {
        let size = tree.size();
        let most = (self.column - taken).max(LEAST * self.column);
        let scale = (room / size.width()).min(most / size.height());
        let (width, height) = (scale * size.width(), scale * size.height());
        let mut strip = Strip { height, before: 3.0, ..Strip::default() };
        strip.draw(node, Shape::Drawing(Area { x: 0.5 * (room - width), y: 0.0, width, height }, Rc::clone(tree)));
        strip
    }

    /// The names of the series, in rows.
    fn legend(&mut self, figure: &Figure, place: Place) -> Result<Vec<Strip>, PdfError> {
        let entries = svg::legend_entries(figure);
        let style = Style { colour: SOFT, size: SMALL, ..body() };
        let (width, height) = (0.62 * KEY_WIDTH, 0.62 * KEY_HEIGHT);
        let node = self.structure.node(Role::P, place.node);
        let mut rows: Vec<Strip> = Vec::new();
        let mut x = 0.0;
        for (name, layer) in entries {
            let key = self.reader.figure(&svg::key(layer), name)?;
            let text = if figure.symbols { name.into() } else { Prose::verbatim(name) };
            let lines = self.setter.lines(&text, style, place.room - width - 5.0);
            let needed = width + 5.0 + lines.iter().map(|line| line.width).fold(0.0, f32::max);
            let is_full = x > 0.0 && x + needed > place.room;
            if rows.is_empty() || is_full {
                rows.push(Strip { before: 1.5, ..Strip::default() });
                x = 0.0;
            }
            let Some(row) = rows.last_mut() else { continue };
            let base = style.base();
            row.draw(None, Shape::Drawing(Area { x, y: base - 0.72 * height, width, height }, key));
            for (n, line) in lines.iter().enumerate() {
                let down = n as f32 * style.line_height();
                self.write(row, line, (x + width + 5.0, base + down), node, &mut Vec::new());
                row.height = row.height.max(down + style.line_height());
            }
            x += needed + 14.0;
        }
        Ok(rows)
    }

    /// Figures beside each other; below each other where that is too high for a page.
    pub(super) fn row(&mut self, figures: &[Figure], place: Place) -> Result<Vec<Strip>, PdfError> {
        let count = figures.len().max(1) as f32;
        let room = (place.room - BETWEEN * (count - 1.0)) / count;
        if figures.len() != 2 {
            return self.stack(figures, place);
        }
        let mut whole = Strip { before: ABOVE, ..Strip::default() };
        for (number, figure) in figures.iter().enumerate() {
            let strips = self.scaled(figure, Place { room, ..place }, NARROW_SCALE)?;
            let right = number as f32 * (room + BETWEEN);
            whole.absorb(Strip::of_stack(strips), right, 0.0);
        }
        if whole.height > self.column {
            return self.stack(figures, place);
        }
        Ok(vec![whole])
    }

    fn stack(&mut self, figures: &[Figure], place: Place) -> Result<Vec<Strip>, PdfError> {
        let each = figures.iter().map(|figure| self.figure(figure, place));
        Ok(each.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    /// A drawing that is no plot.
    pub(super) fn drawing(
        &mut self,
        svg: &str,
        description: &str,
        caption: &Prose,
        place: Place,
    ) -> Result<Vec<Strip>, PdfError> {
        let tree = self.reader.drawing(svg, description)?;
        let node = self.structure.described(Role::Figure, place.node, description);
        let of_caption = self.structure.node(Role::Caption, node);
        let below = self.paragraph(caption, small(), of_caption, place.room);
        let shown = self.shown(&tree, node, place.room, height(&below) + 2.0 * GAP);
        Ok(together(Vec::new(), shown, below))
    }
}

/// Puts the strips above a drawing, the drawing, and those below it on one page.
fn together(above: Vec<Strip>, shown: Strip, below: Vec<Strip>) -> Vec<Strip> {
    let mut all = above;
    all.push(shown);
    all.extend(below.into_iter().map(|line| Strip { before: 0.0, ..line }));
    if let Some(first) = all.first_mut() {
        first.before = ABOVE;
    }
    keep_together(&mut all);
    all
}

/// Lowers the panels of a figure that is a little higher than half of a page, so that two are on one, or than most of a
/// page, so that a heading and a few lines have room above it. `taken` is the height of the text around the drawing.
fn lower(figure: &mut Figure, column: f32, taken: f32, scale: f32) {
    let all: u32 = figure.panels.iter().map(|panel| panel.height).sum();
    let around = svg::around_panels(figure) as f32;
    let factor = |part: f32| ((part * column - taken) / scale - around) / all.max(1) as f32;
    let (half, most) = (factor(0.5), factor(HIGHEST));
    let factor = if half >= LOWERED { half } else { most };
    if factor < 1.0 {
        let lowered = |height: f32| (factor * height).max(LOWEST_PANEL.min(height)) as u32;
        figure.panels.iter_mut().for_each(|panel| panel.height = lowered(panel.height as f32));
    }
}
