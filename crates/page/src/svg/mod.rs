//! A figure as SVG: on its own with title, legend and caption, or inside a page, where a script shows other parts of it.

mod extent;
mod layers;
mod scale;
mod shared;

use std::fmt::Write as _;

use crate::figure::{Axis, Figure, Layer, MAX_POINTS, Panel};
use crate::markup::escape;
use crate::thinned::thinned;
use extent::{equal_ranges, x_extent, y_extent};
use scale::Mapping;
use shared::{Frame, INK, LINE, SOFT, WIDE, line, text};

/// The font of every text.
pub(crate) const FONT: &str = "DejaVu Sans";

/// A drawing on its own.
const ALONE: Canvas = Canvas { width: 900.0, left: 74.0, stretch: 1.25 };
/// From the right end of the axes to that of the drawing.
const MARGIN: f64 = 18.0;
const TITLE: f64 = 30.0;
const LEGEND_ROW: f64 = 20.0;
const ABOVE_PANEL: f64 = 24.0;
const BETWEEN: f64 = 34.0;
const BELOW: f64 = 52.0;
/// Below the panels of a drawing in a page.
const FOOT: f64 = 44.0;
const LINE_HEIGHT: f64 = 17.0;
/// How wide a drawing is, where its axes begin, and how much higher panels are than they say.
#[derive(Debug, Clone, Copy)]
struct Canvas {
    width: f64,
    left: f64,
    stretch: f64,
}

impl Canvas {
    fn right(self) -> f64 {
        self.width - MARGIN
    }
}

/// The figures below each other as one SVG document, with titles, legends and captions.
pub fn svg<'a>(figures: impl IntoIterator<Item = &'a Figure>) -> String {
    let mut body = String::new();
    let mut top = 0.0;
    for (number, figure) in figures.into_iter().enumerate() {
        let figure = &thinned(figure, MAX_POINTS);
        top = draw(&mut body, figure, number, top);
    }
    let (width, height) = (ALONE.width, top.max(1.0));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"{FONT}, sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         {body}</svg>\n"
    )
}

/// The panels of a figure as an SVG element of a page that has title, legend and caption of its own.
pub(crate) fn embedded(figure: &Figure, width: f64, number: usize) -> String {
    let canvas = Canvas { width, left: 58.0, stretch: 1.0 };
    let mut body = String::new();
    let height = panels(&mut body, figure, number, 0.0, canvas) + FOOT - BELOW;
    let axis = |axis: &Axis| escape(&axis_name(axis)).into_owned();
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" font-size=\"12\" role=\"img\" \
         aria-label=\"{}\" data-x-label=\"{}\" data-x-unit=\"{}\"{}>\n<title>{}</title><desc>{}</desc>\n{body}</svg>",
        escape(&figure.title),
        escape(&figure.x.label),
        escape(&figure.x.unit),
        if figure.equal_axes { " data-equal-axes=\"\"" } else { "" },
        escape(&figure.title),
        format_args!(
            "{} over {}. {}",
            figure.panels.iter().map(|panel| axis(&panel.y)).collect::<Vec<_>>().join(", "),
            axis(&figure.x),
            escape(&legend_entries(figure).iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "))
        ),
    )
}

/// What stands before a series' name, as an SVG element of its own.
pub(crate) fn key(layer: &Layer) -> String {
    let mut body = String::new();
    layers::key(&mut body, layer, (0.0, 11.0));
    format!(
        "<svg class=\"key\" width=\"18\" height=\"14\" viewBox=\"0 0 18 14\" aria-hidden=\"true\">{}</svg>",
        body.trim_end()
    )
}

/// Draws one figure from `top` down; returns where it ends.
fn draw(out: &mut String, figure: &Figure, number: usize, top: f64) -> f64 {
    let bold = format!("font-size=\"15\" font-weight=\"bold\" fill=\"{INK}\"");
    label(out, figure, (ALONE.left, top + 20.0), "start", &bold, &figure.title);
    let top = legend(out, figure, top + TITLE);
    let top = panels(out, figure, number, top, ALONE);
    caption(out, figure, top)
}

/// Draws the panels of a figure from `top` down; returns where they end.
fn panels(out: &mut String, figure: &Figure, number: usize, mut top: f64, canvas: Canvas) -> f64 {
    let domain = x_extent(figure);
    for (index, panel) in figure.panels.iter().enumerate() {
        top += ABOVE_PANEL;
        let bottom = top + f64::from(panel.height) * canvas.stretch;
        let frame = frame(figure, panel, domain, (top, bottom), canvas);
        let clip = format!("clip-{number}-{index}");
        let last = index + 1 == figure.panels.len();
        draw_panel(out, figure, panel, &frame, &clip, last);
        top = bottom + if last { BELOW } else { BETWEEN - ABOVE_PANEL };
    }
    top
}

fn frame(figure: &Figure, panel: &Panel, domain: (f64, f64), (top, bottom): (f64, f64), canvas: Canvas) -> Frame {
    let (left, right) = (canvas.left, canvas.right());
    let mut x_range = domain;
    let mut y_range = y_extent(panel, domain);
    if figure.equal_axes {
        (x_range, y_range) = equal_ranges(domain, y_range, right - left, bottom - top);
    }
    Frame {
        x: Mapping::new(figure.x.scale, x_range, left, right),
        y: Mapping::new(panel.y.scale, y_range, bottom, top),
        left,
        right,
        top,
        bottom,
    }
}

/// A panel: axes, then what is drawn between them, then names. Attributes `data-` have what the page's script needs to show
/// another part of it: the scales, the frame, and of each group whether it moves along x, y or both.
fn draw_panel(out: &mut String, figure: &Figure, panel: &Panel, frame: &Frame, clip: &str, last: bool) {
    let Frame { left, right, top, bottom, .. } = *frame;
    let _ = writeln!(
        out,
        "<g class=\"panel\" data-x=\"{}\" data-y=\"{}\" data-frame=\"{left} {right} {top} {bottom}\" data-label=\"{}\" data-unit=\"{}\"{}{}>",
        frame.x.attribute(),
        frame.y.attribute(),
        escape(&panel.y.label),
        escape(&panel.y.unit),
        if panel.y.range.is_some() { " data-fixed=\"\"" } else { "" },
        if last { " data-last=\"\"" } else { "" },
    );
    axes(out, frame, last);
    let (width, height) = (right - left, bottom - top + 4.0);
    let _ = writeln!(
        out,
        "<clipPath id=\"{clip}\"><rect x=\"{left}\" y=\"{:.1}\" width=\"{width}\" height=\"{height:.1}\"/></clipPath>\n\
         <g class=\"inside\" clip-path=\"url(#{clip})\">",
        top - 2.0
    );
    let mut names = layers::MarkNames::default();
    panel.layers.iter().for_each(|layer| layers::draw(out, layer, &mut names, frame));
    out.push_str("</g>\n");
    let note = if panel.note.is_empty() { String::new() } else { format!("  {}", panel.note) };
    let name = format!("{}{note}", axis_name(&panel.y));
    label(out, figure, (left, top - 9.0), "start", &format!("class=\"axis-name\" fill=\"{INK}\""), &name);
    if last {
        let name = axis_name(&figure.x);
        label(out, figure, (right, bottom + 36.0), "end", &format!("class=\"axis-name x\" fill=\"{INK}\""), &name);
    }
    out.push_str("</g>\n");
}

/// Grid, ticks and their labels.
fn axes(out: &mut String, frame: &Frame, last: bool) {
    let Frame { left, right, top, bottom, .. } = *frame;
    let tick = format!("class=\"tick\" fill=\"{SOFT}\"");
    out.push_str("<g class=\"axes\">\n");
    for (value, label) in frame.y.ticks((bottom - top) / 30.0) {
        let y = frame.y.pixel(value);
        line(out, (left, y), (right, y), LINE, "class=\"grid\"");
        text(out, (left - 7.0, y + 4.0), "end", &tick, &label);
    }
    for (value, label) in frame.x.ticks((right - left) / 75.0) {
        let x = frame.x.pixel(value);
        line(out, (x, top), (x, bottom), LINE, "class=\"grid\"");
        if last {
            text(out, (x, bottom + 17.0), "middle", &tick, &label);
        }
    }
    line(out, (left, bottom), (right, bottom), SOFT, "class=\"axis\"");
    out.push_str("</g>\n");
}

fn axis_name(axis: &Axis) -> String {
    if axis.unit.is_empty() { axis.label.clone() } else { format!("{} [{}]", axis.label, axis.unit) }
}

/// The names of the series with the first layer of each; none where there is one series alone.
pub(crate) fn legend_entries(figure: &Figure) -> Vec<(&str, &Layer)> {
    let mut entries: Vec<(&str, &Layer)> = Vec::new();
    for layer in figure.panels.iter().flat_map(|panel| &panel.layers) {
        if let Some(name) = layer.legend_name()
            && !name.is_empty()
            && !entries.iter().any(|(known, _)| *known == name)
        {
            entries.push((name, layer));
        }
    }
    if entries.len() < 2 { Vec::new() } else { entries }
}

/// The names of the series, in rows; returns where the rows end.
fn legend(out: &mut String, figure: &Figure, top: f64) -> f64 {
    let entries = legend_entries(figure);
    if entries.is_empty() {
        return top;
    }
    let (left, right) = (ALONE.left, ALONE.right());
    let (mut x, mut y) = (left, top + 10.0);
    for (name, layer) in entries {
        let width = 24.0 + WIDE * name.chars().count() as f64 + 16.0;
        if x + width > right && x > left {
            (x, y) = (left, y + LEGEND_ROW);
        }
        layers::key(out, layer, (x, y));
        label(out, figure, (x + 24.0, y), "start", &format!("fill=\"{INK}\""), name);
        x += width;
    }
    y + 6.0
}

/// The caption below a figure, broken into lines; returns where it ends.
fn caption(out: &mut String, figure: &Figure, top: f64) -> f64 {
    let room = ((ALONE.right() - ALONE.left) / WIDE) as usize;
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
        label(out, figure, (ALONE.left, y), "start", &format!("fill=\"{SOFT}\""), line);
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
