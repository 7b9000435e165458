//! A figure as SVG, drawn without a browser: what the plotting script draws, on white, with its legend.

mod extent;
mod layers;
mod scale;

use std::fmt::Write as _;

use crate::figure::{Axis, Figure, Layer, Panel, Scale};
use crate::markup::escape;
use extent::{equal_ranges, x_extent, y_extent};
use scale::Mapping;

/// The font of every text.
pub(crate) const FONT: &str = "DejaVu Sans";

const WIDTH: f64 = 900.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = WIDTH - 18.0;
const TITLE: f64 = 30.0;
const LEGEND_ROW: f64 = 20.0;
const ABOVE_PANEL: f64 = 24.0;
const BETWEEN: f64 = 34.0;
const BELOW: f64 = 52.0;
const LINE_HEIGHT: f64 = 17.0;
/// DejaVu Sans is about 0.6 em wide.
const WIDE: f64 = 7.3;
/// Panels are laid out for a page of about this width; the drawing is a little larger.
const STRETCH: f64 = 1.25;

const INK: &str = "#1d232a";
const SOFT: &str = "#56616d";
const LINE: &str = "#dce1e6";
const REGION: &str = "#0b5fa5";

/// The figures below each other as one SVG document.
pub fn svg(figures: &[Figure]) -> String {
    let mut body = String::new();
    let mut top = 0.0;
    for (number, figure) in figures.iter().enumerate() {
        top = draw(&mut body, figure, number, top);
    }
    let height = top.max(1.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
         font-family=\"{FONT}, sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         {body}</svg>\n"
    )
}

/// Where a panel is drawn.
pub(crate) struct Frame {
    pub(crate) x: Mapping,
    pub(crate) y: Mapping,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

impl Frame {
    pub(crate) const LEFT: f64 = LEFT;
    pub(crate) const RIGHT: f64 = RIGHT;
}

/// Draws one figure from `top` down; returns where it ends.
fn draw(out: &mut String, figure: &Figure, number: usize, top: f64) -> f64 {
    let bold = format!("font-size=\"15\" font-weight=\"bold\" fill=\"{INK}\"");
    label(out, figure, (LEFT, top + 20.0), "start", &bold, &figure.title);
    let mut top = legend(out, figure, top + TITLE);
    let domain = x_extent(figure);
    for (index, panel) in figure.panels.iter().enumerate() {
        top += ABOVE_PANEL;
        let bottom = top + f64::from(panel.height) * STRETCH;
        let frame = frame(figure, panel, domain, top, bottom);
        let clip = format!("clip-{number}-{index}");
        let last = index + 1 == figure.panels.len();
        draw_panel(out, figure, panel, &frame, &clip, last);
        top = bottom + if last { BELOW } else { BETWEEN - ABOVE_PANEL };
    }
    caption(out, figure, top)
}

fn frame(figure: &Figure, panel: &Panel, domain: (f64, f64), top: f64, bottom: f64) -> Frame {
    let mut x_range = domain;
    let mut y_range = y_extent(panel, domain);
    if figure.equal_axes {
        (x_range, y_range) = equal_ranges(domain, y_range, RIGHT - LEFT, bottom - top);
    }
    Frame {
        x: Mapping::new(figure.x.scale, x_range, LEFT, RIGHT),
        y: Mapping::new(panel.y.scale, y_range, bottom, top),
        top,
        bottom,
    }
}

fn draw_panel(out: &mut String, figure: &Figure, panel: &Panel, frame: &Frame, clip: &str, last: bool) {
    let (top, bottom) = (frame.top, frame.bottom);
    for (value, label) in frame.y.ticks((bottom - top) / 30.0) {
        let y = frame.y.pixel(value);
        line(out, (LEFT, y), (RIGHT, y), LINE, "");
        text(out, (LEFT - 7.0, y + 4.0), "end", &format!("fill=\"{SOFT}\""), &label);
    }
    for (value, label) in frame.x.ticks((RIGHT - LEFT) / 75.0) {
        let x = frame.x.pixel(value);
        line(out, (x, top), (x, bottom), LINE, "");
        if last {
            text(out, (x, bottom + 17.0), "middle", &format!("fill=\"{SOFT}\""), &label);
        }
    }
    line(out, (LEFT, bottom), (RIGHT, bottom), SOFT, "");
    let (width, height) = (RIGHT - LEFT, bottom - top + 4.0);
    let _ = writeln!(
        out,
        "<clipPath id=\"{clip}\"><rect x=\"{LEFT}\" y=\"{:.1}\" width=\"{width}\" height=\"{height:.1}\"/></clipPath>\n\
         <g clip-path=\"url(#{clip})\">",
        top - 2.0
    );
    let mut names = layers::MarkNames::default();
    panel.layers.iter().for_each(|layer| layers::draw(out, layer, &mut names, frame));
    out.push_str("</g>\n");
    let note = if panel.note.is_empty() { String::new() } else { format!("  {}", panel.note) };
    let name = format!("{}{note}", axis_name(&panel.y));
    label(out, figure, (LEFT, top - 9.0), "start", &format!("fill=\"{INK}\""), &name);
    if last {
        label(out, figure, (RIGHT, bottom + 36.0), "end", &format!("fill=\"{INK}\""), &axis_name(&figure.x));
    }
}

fn axis_name(axis: &Axis) -> String {
    if axis.unit.is_empty() { axis.label.clone() } else { format!("{} [{}]", axis.label, axis.unit) }
}

/// The names of the series, in rows; returns where the rows end.
fn legend(out: &mut String, figure: &Figure, top: f64) -> f64 {
    let mut entries: Vec<(&str, &Layer)> = Vec::new();
    for layer in figure.panels.iter().flat_map(|panel| &panel.layers) {
        if let Some(name) = layer.legend_name()
            && !name.is_empty()
            && !entries.iter().any(|(known, _)| *known == name)
        {
            entries.push((name, layer));
        }
    }
    if entries.len() < 2 {
        return top;
    }
    let (mut x, mut y) = (LEFT, top + 10.0);
    for (name, layer) in entries {
        let width = 24.0 + WIDE * name.chars().count() as f64 + 16.0;
        if x + width > RIGHT && x > LEFT {
            (x, y) = (LEFT, y + LEGEND_ROW);
        }
        layers::key(out, layer, (x, y));
        label(out, figure, (x + 24.0, y), "start", &format!("fill=\"{INK}\""), name);
        x += width;
    }
    y + 6.0
}

/// The caption below a figure, broken into lines; returns where it ends.
fn caption(out: &mut String, figure: &Figure, top: f64) -> f64 {
    let room = ((RIGHT - LEFT) / WIDE) as usize;
    let mut lines: Vec<String> = Vec::new();
    for word in figure.caption.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    for (number, line) in lines.iter().enumerate() {
        let y = top + LINE_HEIGHT * number as f64;
        label(out, figure, (LEFT, y), "start", &format!("fill=\"{SOFT}\""), line);
    }
    if lines.is_empty() { top } else { top + LINE_HEIGHT * lines.len() as f64 }
}

/// A text of a figure: with indices where the figure speaks in symbols.
fn label(out: &mut String, figure: &Figure, at: (f64, f64), anchor: &str, attributes: &str, content: &str) {
    if figure.symbols {
        return text(out, at, anchor, attributes, content);
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" {attributes}>{}</text>",
        at.0,
        at.1,
        escape(content)
    );
}

/// Text with indices: `T_d` is set with its d below.
pub(crate) fn text(out: &mut String, (x, y): (f64, f64), anchor: &str, attributes: &str, content: &str) {
    let _ = write!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {attributes}>");
    let mut below = false;
    for (piece, is_index) in symbol_pieces(content) {
        let shift = match (below, is_index) {
            (false, true) => " dy=\"3\"",
            (true, false) => " dy=\"-3\"",
            _ => "",
        };
        let size = if is_index { " font-size=\"9\"" } else { "" };
        let _ = write!(out, "<tspan{shift}{size}>{}</tspan>", escape(&piece));
        below = is_index;
    }
    out.push_str("</text>\n");
}

/// Splits text into pieces, each with whether it is an index: a letter, an underscore and letters or digits, where that is
/// a word of its own and no part of a file's name.
fn symbol_pieces(text: &str) -> Vec<(String, bool)> {
    let mut pieces = vec![(String::new(), false)];
    let characters: Vec<char> = text.chars().collect();
    let mut at = 0;
    while at < characters.len() {
        let index = index_at(&characters, at);
        if index.is_empty() {
            if let Some((piece, _)) = pieces.last_mut() {
                piece.push(characters[at]);
            }
            at += 1;
        } else {
            at += 1 + index.chars().count();
            pieces.push((index, true));
            pieces.push((String::new(), false));
        }
    }
    pieces.retain(|(piece, _)| !piece.is_empty());
    pieces
}

/// The index that an underscore at this place begins; empty where none does.
fn index_at(characters: &[char], at: usize) -> String {
    let joins = |c: &char| "_-./\\".contains(*c);
    let in_word = |c: &char| c.is_alphanumeric() || joins(c);
    let before = at.checked_sub(1).and_then(|i| characters.get(i)).is_some_and(|c| c.is_alphabetic());
    let earlier = at.checked_sub(2).and_then(|i| characters.get(i)).is_some_and(in_word);
    if characters[at] != '_' || !before || earlier {
        return String::new();
    }
    let index: String = characters[at + 1..].iter().take_while(|c| c.is_alphanumeric() || **c == ',').collect();
    let index = index.trim_end_matches(',').to_owned();
    let mut after = characters[at + 1 + index.chars().count()..].iter();
    let goes_on = match after.next() {
        Some('_') => true,
        Some(c) if joins(c) => after.next().is_some_and(|c| c.is_alphanumeric()),
        _ => false,
    };
    if goes_on { String::new() } else { index }
}

pub(crate) fn line(out: &mut String, from: (f64, f64), to: (f64, f64), colour: &str, attributes: &str) {
    let _ = writeln!(
        out,
        "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{colour}\" {attributes}/>",
        from.0, from.1, to.0, to.1
    );
}

/// Whether values of an axis have to be positive.
pub(crate) fn is_log(axis: &Axis) -> bool {
    matches!(axis.scale, Scale::Log)
}

impl Layer {
    /// What the layer is called in the legend.
    fn legend_name(&self) -> Option<&str> {
        match self {
            Layer::Line { name, .. }
            | Layer::Points { name, .. }
            | Layer::Stems { name, .. }
            | Layer::Markers { name, .. }
            | Layer::Path { name, .. } => Some(name),
            Layer::YRegion { label, .. } | Layer::XRegion { label, .. } => Some(label),
            Layer::Band { .. }
            | Layer::Shades { .. }
            | Layer::Words { .. }
            | Layer::HorizontalMark { .. }
            | Layer::VerticalMarks { .. } => None,
        }
    }
}
