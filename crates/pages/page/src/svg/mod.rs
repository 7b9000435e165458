//! A figure as SVG: on its own with title, legend and caption, or inside a page, where a script shows other parts of
//! it.

mod alt;
mod coarse;
mod extent;
mod layers;
mod scale;
mod shared;

use std::fmt::Write as _;

use crate::figure::{Figure, Layer, MAX_POINTS, Panel};
use crate::markup::escape;
use crate::thinned::{Place, thinned};
use alt::axis_name;
use extent::{Extent, equal_ranges, x_extent, y_extent};
use scale::Mapping;
use shared::{Frame, INK, LINE, SOFT, WIDE, line, text};

/// The font of every text.
pub(crate) const FONT: &str = "DejaVu Sans";

/// A drawing on its own.
const ALONE: Canvas = Canvas { width: 900.0, left: 74.0, stretch: 1.25, in_page: false };
/// From the right end of the axes to that of the drawing.
const MARGIN: f64 = 18.0;
const TITLE: f64 = 30.0;
const LEGEND_ROW: f64 = 20.0;
const ABOVE_PANEL: f64 = 24.0;
const BETWEEN: f64 = 34.0;
const BELOW: f64 = 52.0;
/// Where the axes of a drawing in a page begin.
const LEFT: f64 = 58.0;
/// Below the panels of a drawing in a page.
const FOOT: f64 = 44.0;
const LINE_HEIGHT: f64 = 17.0;
/// From an arrow at the edge of a panel to the next one.
const ARROWS_APART: f64 = 12.0;

/// How wide a drawing is, where its axes begin, how much higher panels are than they say, and whether it is in a page.
#[derive(Debug, Clone, Copy)]
struct Canvas {
    width: f64,
    left: f64,
    stretch: f64,
    in_page: bool,
}

impl Canvas {
    fn right(self) -> f64 {
        self.width - MARGIN
    }
}

/// A figure as it is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Drawing<'a> {
    /// With all of its samples, from which the axes take their ranges.
    pub(crate) whole: &'a Figure,
    /// With those that are drawn.
    pub(crate) drawn: &'a Figure,
    /// Lines that need not be drawn finer than can be seen, since the page has their samples.
    pub(crate) packed: &'a [Place],
    /// Its number in the document.
    pub(crate) number: usize,
}

/// The figures below each other as one SVG document, with titles, legends and captions.
pub fn svg<'a>(figures: impl IntoIterator<Item = &'a Figure>) -> String {
    let mut body = String::new();
    let mut top = 0.0;
    for (number, whole) in figures.into_iter().enumerate() {
        let drawn = &thinned(whole, MAX_POINTS);
        top = draw(&mut body, Drawing { whole, drawn, packed: &[], number }, top);
    }
    let (width, height) = (ALONE.width, top.max(1.0));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"{FONT}, sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         {body}</svg>\n"
    )
}

/// The panels of a figure as an SVG element of a page that has title, legend and caption of its own.
pub(crate) fn embedded(drawing: Drawing, width: f64) -> String {
    panels_alone(drawing, Canvas { width, left: LEFT, stretch: 1.0, in_page: true })
}

/// The same for paper, without what a page's script needs.
#[cfg(feature = "pdf")]
pub(crate) fn on_paper(drawing: Drawing, width: f64) -> String {
    panels_alone(drawing, Canvas { width, left: LEFT, stretch: 1.0, in_page: false })
}

fn panels_alone(drawing: Drawing, canvas: Canvas) -> String {
    let (figure, width) = (drawing.drawn, canvas.width);
    let mut body = String::new();
    let height = panels(&mut body, drawing, 0.0, canvas) + FOOT - BELOW;
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" font-size=\"12\" role=\"img\" \
         aria-label=\"{}\" data-x-label=\"{}\" data-x-unit=\"{}\" data-recording=\"{}\"{}>\n<title>{}</title>\
         <desc>{}</desc>\n{body}</svg>",
        escape(&alt::label(drawing.whole)),
        escape(&figure.x.label),
        escape(&figure.x.unit),
        escape(&figure.recording),
        if figure.equal_axes { " data-equal-axes=\"\"" } else { "" },
        escape(&figure.title),
        escape(&alt::description(drawing.whole)),
    )
}

/// The height of what is around the panels of a drawing in a page, pixels.
#[cfg(feature = "pdf")]
pub(crate) fn around_panels(figure: &Figure) -> f64 {
    let count = figure.panels.len() as f64;
    ABOVE_PANEL + (count - 1.0).max(0.0) * BETWEEN + FOOT
}

/// Description of a figure for readers who do not see it. Its caption is text of its own.
#[cfg(feature = "pdf")]
pub(crate) fn alternative(figure: &Figure) -> String {
    let title = figure.title.trim_end_matches('.');
    let joint = if title.is_empty() { "" } else { ". " };
    format!("{title}{joint}{}", alt::description(figure))
}

/// Key before a series' name, as an SVG element of its own.
pub(crate) fn key(layer: &Layer) -> String {
    let mut body = String::new();
    layers::key(&mut body, layer, (0.0, 11.0));
    format!(
        "<svg class=\"key\" width=\"18\" height=\"14\" viewBox=\"0 0 18 14\" aria-hidden=\"true\">{}</svg>",
        body.trim_end()
    )
}

/// Draws one figure from `top` down; returns where it ends.
fn draw(out: &mut String, drawing: Drawing, top: f64) -> f64 {
    let figure = drawing.drawn;
    let bold = format!("font-size=\"15\" font-weight=\"bold\" fill=\"{INK}\"");
    label(out, figure, (ALONE.left, top + 20.0), "start", &bold, &figure.title);
    let top = legend(out, figure, top + TITLE);
    let top = panels(out, drawing, top, ALONE);
    caption(out, figure, top)
}

/// Draws the panels of a figure from `top` down; returns where they end.
fn panels(out: &mut String, drawing: Drawing, mut top: f64, canvas: Canvas) -> f64 {
    let Drawing { whole, drawn, .. } = drawing;
    let domain = x_extent(whole);
    for (index, (panel, all)) in drawn.panels.iter().zip(&whole.panels).enumerate() {
        top += ABOVE_PANEL;
        let bottom = top + f64::from(panel.height) * canvas.stretch;
        let extent = y_extent(all, domain);
        let frame = frame(drawn, panel, domain, extent.range, (top, bottom), canvas);
        draw_panel(out, drawing, index, &frame, &extent);
        let last = index + 1 == drawn.panels.len();
        top = bottom + if last { BELOW } else { BETWEEN - ABOVE_PANEL };
    }
    top
}

fn frame(
    figure: &Figure,
    panel: &Panel,
    domain: (f64, f64),
    range: (f64, f64),
    (top, bottom): (f64, f64),
    canvas: Canvas,
) -> Frame {
    let (left, right) = (canvas.left, canvas.right());
    let (mut x_range, mut y_range) = (domain, range);
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
        in_page: canvas.in_page,
    }
}

/// A panel: axes, then what is drawn between them, then names. Attributes `data-` have what the page's script needs to
/// show another part of it: the scales, the frame, and of each group whether it moves along x, y or both.
fn draw_panel(out: &mut String, drawing: Drawing, index: usize, frame: &Frame, extent: &Extent) {
    let Frame { left, right, top, bottom, .. } = *frame;
    let figure = drawing.drawn;
    let Some(panel) = figure.panels.get(index) else { return };
    let clip = format!("clip-{}-{index}", drawing.number);
    let last = index + 1 == figure.panels.len();
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
    for (number, layer) in panel.layers.iter().enumerate() {
        layers::draw(out, layer, &mut names, frame, drawing.packed.contains(&(index, number)));
    }
    out.push_str("</g>\n");
    outside(out, frame, extent);
    let hidden = hidden_bands(panel, frame);
    let remarks = [panel.note.as_str(), &hidden];
    let notes: String = remarks.iter().filter(|note| !note.is_empty()).map(|note| format!(", {note}")).collect();
    let name = format!("{}{notes}", axis_name(&panel.y));
    label(out, figure, (left, top - 9.0), "start", &format!("class=\"axis-name\" fill=\"{INK}\""), &name);
    if last {
        let name = axis_name(&figure.x);
        label(out, figure, (right, bottom + 36.0), "end", &format!("class=\"axis-name x\" fill=\"{INK}\""), &name);
    }
    out.push_str("</g>\n");
}

/// Says of which bands nothing is seen beside their lines: of all of a panel, or of those named.
fn hidden_bands(panel: &Panel, frame: &Frame) -> String {
    let bands: Vec<&Layer> = panel.layers.iter().filter(|layer| matches!(layer, Layer::Band { .. })).collect();
    let hidden: Vec<&&Layer> = bands.iter().filter(|layer| layers::is_hidden(layer, frame)).collect();
    let mut names: Vec<&str> = Vec::new();
    for layer in &hidden {
        if let Layer::Band { name, .. } = layer
            && !names.contains(&name.as_str())
        {
            names.push(name);
        }
    }
    match hidden.len() {
        0 => String::new(),
        count if count == bands.len() => "band narrower than its line".to_owned(),
        _ => format!("band narrower than its line: {}", names.join(", ")),
    }
}

/// Arrows where samples lie outside the axis, and how many do.
fn outside(out: &mut String, frame: &Frame, extent: &Extent) {
    if extent.outside.is_empty() {
        return;
    }
    let _ = writeln!(out, "<g class=\"layer outside\" data-type=\"outside\" data-moves=\"x\" fill=\"{INK}\">");
    let mut last = [f64::NEG_INFINITY; 2];
    for (x, y) in &extent.outside {
        let (x, is_above) = (frame.x.pixel(*x), *y > extent.range.1);
        let before = &mut last[usize::from(is_above)];
        if x - *before >= ARROWS_APART {
            *before = x;
            let (tip, base) = if is_above { (frame.top, 6) } else { (frame.bottom, -6) };
            let at = format!("data-at=\"{x:.1} {tip:.1}\" transform=\"translate({x:.1} {tip:.1})\"");
            let _ = write!(out, "<path d=\"M0 0L-4 {base}H4Z\" {at}/>");
        }
    }
    let count = extent.outside.len();
    let words = format!("{count} {} outside", if count == 1 { "sample" } else { "samples" });
    text(out, (frame.right, frame.top - 9.0), "end", "", &words);
    out.push_str("</g>\n");
}

/// Grid, ticks and their labels.
fn axes(out: &mut String, frame: &Frame, last: bool) {
    let Frame { left, right, top, bottom, .. } = *frame;
    let (vertical, horizontal) = (frame.y.ticks((bottom - top) / 30.0), frame.x.ticks((right - left) / 75.0));
    let mut grid = String::new();
    for (value, _) in &vertical {
        let _ = write!(grid, "M{left} {:.1}H{right}", frame.y.pixel(*value));
    }
    for (value, _) in &horizontal {
        let _ = write!(grid, "M{:.1} {top:.1}V{bottom:.1}", frame.x.pixel(*value));
    }
    let _ = writeln!(out, "<g class=\"axes\"><path d=\"{grid}\" stroke=\"{LINE}\" class=\"grid\"/>");
    let at = |(value, label)| (left - 7.0, frame.y.pixel(value) + 4.0, label);
    ticks(out, "end", vertical.into_iter().map(at));
    if last {
        let at = |(value, label)| (frame.x.pixel(value), bottom + 17.0, label);
        ticks(out, "middle", horizontal.into_iter().map(at));
    }
    line(out, (left, bottom), (right, bottom), SOFT, "class=\"axis\"");
    out.push_str("</g>\n");
}

/// Names of ticks, each with its place.
fn ticks(out: &mut String, anchor: &str, all: impl Iterator<Item = (f64, f64, String)>) {
    let _ = write!(out, "<g class=\"tick\" fill=\"{SOFT}\" text-anchor=\"{anchor}\">");
    for (x, y, label) in all {
        let _ = write!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escape(&label));
    }
    out.push_str("</g>\n");
}

/// The names of the series with a layer of each that has points; none where there is one series alone.
pub(crate) fn legend_entries(figure: &Figure) -> Vec<(&str, &Layer)> {
    let mut entries: Vec<(&str, &Layer)> = Vec::new();
    for layer in figure.panels.iter().flat_map(|panel| &panel.layers) {
        let Some(name) = layer.legend_name().filter(|name| !name.is_empty()) else { continue };
        match entries.iter_mut().find(|(known, _)| *known == name) {
            None => entries.push((name, layer)),
            Some((_, first)) if matches!(first, Layer::Line { y, .. } if y.is_empty()) => *first = layer,
            Some(_) => {}
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
    /// Name of the layer in the legend.
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
