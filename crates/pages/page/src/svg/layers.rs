//! How each kind of layer is drawn. Every layer is a group that says how it moves when another part of the panel is
//! shown.

use std::fmt::Write as _;

use super::coarse;
use super::coarse::{COARSE, FINE};
use super::extent::values;
use super::shared::{Frame, INK, REGION, WIDE, line, text};
use crate::figure::{Layer, Marker, Rounded, Scale, Style};
use crate::markup::escape;

/// The colour of a style.
pub(crate) fn colour(style: Style) -> &'static str {
    match style {
        Style::Measured => "#a09189",
        Style::Modelled => "#155596",
        Style::Other => "#b74400",
        Style::Residual => "#9a6ec5",
        Style::Fourth => "#00623f",
        Style::Fifth => "#bb425a",
        Style::Sixth => "#2a97a9",
        Style::Seventh => "#b48b00",
        Style::Eighth => "#bd4484",
        Style::Ninth => "#373c44",
        Style::Tenth => "#678d37",
        Style::Guide => "#c9d0d7",
    }
}

/// The name of a style in the page's style sheet.
fn class(style: Style) -> &'static str {
    match style {
        Style::Measured => "measured",
        Style::Modelled => "modelled",
        Style::Other => "other",
        Style::Residual => "residual",
        Style::Fourth => "fourth",
        Style::Fifth => "fifth",
        Style::Sixth => "sixth",
        Style::Seventh => "seventh",
        Style::Eighth => "eighth",
        Style::Ninth => "ninth",
        Style::Tenth => "tenth",
        Style::Guide => "guide",
    }
}

/// A line that travels so many heights of its panel fills an area.
const ROUGH: f64 = 20.0;

/// The stroke of a line: a measurement is wide and light, and a model thin upon it. Where points are denser than
/// pixels, lines become areas: thin strokes then leave what can be left of their shape, and a model lets shine through
/// what it covers.
fn stroke(style: Style, is_dense: bool) -> (f64, &'static str) {
    match (style, is_dense) {
        (Style::Measured, false) => (2.0, ""),
        (Style::Measured, true) => (1.8, ""),
        (Style::Guide, _) => (0.8, ""),
        (Style::Residual, false) => (1.0, ""),
        (_, false) => (1.2, ""),
        (_, true) => (0.7, "stroke-opacity=\"0.75\""),
    }
}

/// Returns true if a line goes up and down so often that it fills an area.
fn is_rough(y: &[Rounded], frame: &Frame) -> bool {
    let pixel = |y: &Rounded| frame.y.pixel(y.0);
    let travel = y.windows(2).map(|pair| (pixel(&pair[1]) - pixel(&pair[0])).abs()).filter(|way| way.is_finite());
    travel.sum::<f64>() > ROUGH * (frame.bottom - frame.top)
}

/// Dots of which each is not read alone.
const MANY: usize = 300;

/// The darkest shade, and how much of ink a shade adds.
const DARKEST: usize = 9;
const SHADE: f64 = 0.085;

const MARK: &str = "stroke-dasharray=\"4 3\" stroke-opacity=\"0.7\" class=\"mark\"";

/// From the name of a mark to one below it.
const NAME_HEIGHT: f64 = 15.0;

/// Dashes by which lines differ without colour. A line that goes up and down has none: its gaps would hide its course.
fn dashes(style: Style, y: &[Rounded]) -> String {
    let pattern = match style {
        Style::Other => "10 3",
        Style::Fourth => "5 2",
        Style::Fifth => "10 3 2 3",
        Style::Sixth => "2 2",
        Style::Seventh => "14 3 5 3",
        Style::Eighth => "7 3 2 3 2 3",
        Style::Ninth => "16 5",
        Style::Tenth => "3 5",
        Style::Measured | Style::Modelled | Style::Residual | Style::Guide => return String::new(),
    };
    if is_smooth(y) { format!("stroke-dasharray=\"{pattern}\"") } else { String::new() }
}

/// A line that travels so many times its own height goes up and down.
const RESTLESS: f64 = 8.0;

fn is_smooth(y: &[Rounded]) -> bool {
    let finite = || y.iter().map(|y| y.0).filter(|y| y.is_finite());
    let travel: f64 = finite().zip(finite().skip(1)).map(|(a, b)| (b - a).abs()).sum();
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
    high <= low || travel <= RESTLESS * (high - low)
}

/// Names of vertical marks along the top of a panel: by row, from where to where each reaches.
#[derive(Default)]
pub(crate) struct MarkNames(Vec<Vec<(f64, f64)>>);

impl MarkNames {
    /// The first row in which a name covers no earlier one.
    fn row(&mut self, from: f64, to: f64) -> usize {
        let is_free = |row: &Vec<(f64, f64)>| row.iter().all(|(start, end)| to < *start || from > *end);
        let row = self.0.iter().position(is_free).unwrap_or(self.0.len());
        if row == self.0.len() {
            self.0.push(Vec::new());
        }
        self.0[row].push((from, to));
        row
    }
}

/// Attributes of a layer for the page's script: its kind, the axes along which it moves unless along both, and the
/// series it belongs to.
fn attributes(layer: &Layer) -> String {
    let (kind, moves) = match layer {
        Layer::Line { .. } => ("line", "xy"),
        Layer::Points { .. } => ("points", "xy"),
        Layer::Stems { .. } => ("stems", "xy"),
        Layer::Markers { .. } => ("markers", "xy"),
        Layer::Path { .. } => ("path", "xy"),
        Layer::Band { .. } => ("band", "xy"),
        Layer::Shades { .. } => ("shades", "xy"),
        Layer::Words { .. } => ("words", "xy"),
        Layer::HorizontalMark { .. } => ("mark", "y"),
        Layer::VerticalMarks { .. } => ("mark", "x"),
        Layer::YRegion { .. } => ("region", "y"),
        Layer::XRegion { .. } => ("region", "x"),
    };
    let series = match layer {
        Layer::Line { name, style, .. }
        | Layer::Points { name, style, .. }
        | Layer::Stems { name, style, .. }
        | Layer::Markers { name, style, .. }
        | Layer::Path { name, style, .. }
        | Layer::Band { name, style, .. } => {
            format!(" data-name=\"{}\" data-style=\"{}\"", escape(name), class(*style))
        }
        _ => String::new(),
    };
    let moves = if moves == "xy" { String::new() } else { format!(" data-moves=\"{moves}\"") };
    format!("data-type=\"{kind}\"{moves}{series}")
}

/// Draws a layer as a group; one that is packed, no finer than can be seen.
pub(crate) fn draw(out: &mut String, layer: &Layer, names: &mut MarkNames, frame: &Frame, is_packed: bool) {
    let _ = writeln!(out, "<g class=\"layer\" {}>", attributes(layer));
    match layer {
        Layer::Line { style, x, y, .. } => trace(out, *style, &values(x, y.len()), y, frame, is_packed),
        _ => contents(out, layer, names, frame),
    }
    out.push_str("</g>\n");
}

fn trace(out: &mut String, style: Style, x: &[f64], y: &[Rounded], frame: &Frame, is_packed: bool) {
    let is_dense = y.len() as f64 > frame.right - frame.left && is_rough(y, frame);
    let (width, attributes) = stroke(style, is_dense);
    // Dashes of what has become an area would be no line but holes.
    let attributes = if is_dense { attributes.to_owned() } else { dashes(style, y) };
    match is_packed {
        false => path(out, &polyline(x, y, frame), style, width, &attributes),
        true => path(out, &coarse::line(&pixels(x, y, frame)), style, width, &format!("{COARSE} {attributes}")),
    }
}

fn contents(out: &mut String, layer: &Layer, names: &mut MarkNames, frame: &Frame) {
    match layer {
        Layer::Line { .. } => {}
        Layer::Points { style, x, y, low, high, .. } => {
            let x = values(x, y.len());
            let size = match low {
                Some(_) => 5.5,
                None if y.len() as f64 > frame.right - frame.left => 2.0,
                None => 4.0,
            };
            match frame.in_page && y.len() > MANY {
                false => path(out, &dots(&x, y, frame), *style, size, "stroke-linecap=\"round\""),
                true => {
                    let attributes = format!("{COARSE} stroke-linecap=\"round\"");
                    path(out, &coarse::dots(&pixels(&x, y, frame)), *style, size, &attributes);
                }
            }
            if let (Some(low), Some(high)) = (low, high) {
                bars(out, &x, low, high, frame);
            }
        }
        Layer::Stems { style, x, y, .. } => stems(out, &values(x, y.len()), y, *style, frame),
        Layer::Markers { style, marker, x, y, .. } => markers(out, x, y, *style, *marker, frame),
        Layer::Path { style, x, y, .. } => {
            let x: Vec<f64> = x.iter().map(|v| v.0).collect();
            let (d, unit) = match frame.in_page {
                true => (coarse::fine_line(&pixels(&x, y, frame)), FINE),
                false => (polyline(&x, y, frame), ""),
            };
            path(out, &d, *style, stroke(*style, false).0, &format!("{unit} {}", dashes(*style, &[])));
        }
        Layer::Band { style, x, low, high, .. } => band(out, &values(x, low.len()), low, high, *style, frame),
        Layer::Shades { x, y, columns } => shades(out, (x, y), columns, frame),
        Layer::Words { style, x, y, words } => write_words(out, (x, y), words, *style, frame),
        Layer::HorizontalMark { y, label } => horizontal_mark(out, y.0, label, frame),
        Layer::VerticalMarks { x, label } => vertical_marks(out, x, label, names, frame),
        Layer::YRegion { low, high, .. } => {
            let (top, bottom) = (frame.y.pixel(high.0), frame.y.pixel(low.0));
            region(out, (frame.left, top), (frame.right, bottom));
        }
        Layer::XRegion { low, high, .. } => {
            let at = |value: f64| frame.x.pixel(value.max(f64::MIN_POSITIVE)).clamp(frame.left, frame.right);
            region(out, (at(low.0), frame.top), (at(high.0), frame.bottom));
        }
    }
}

/// A point in pixels, if it has a place.
fn place(x: f64, y: f64, frame: &Frame) -> Option<(f64, f64)> {
    let at = (frame.x.pixel(x), frame.y.pixel(y));
    // Far outside the frame a renderer may overflow.
    (at.0.is_finite() && at.1.is_finite()).then(|| (at.0.clamp(-1e5, 1e5), at.1.clamp(-1e5, 1e5)))
}

/// Every point in pixels, where it has a place.
fn pixels(x: &[f64], y: &[Rounded], frame: &Frame) -> Vec<Option<(f64, f64)>> {
    x.iter().zip(y).map(|(x, y)| place(*x, y.0, frame)).collect()
}

/// A line that is broken where a value is missing: x in hundredths of a pixel and y, from which the page reads values,
/// in thousandths; each point by its distance from the one before, so that a long line stays short to write.
fn polyline(x: &[f64], y: &[Rounded], frame: &Frame) -> String {
    let mut d = String::new();
    let mut pen: Option<(i64, i64)> = None;
    for (x, y) in x.iter().zip(y) {
        let Some(at) = place(*x, y.0, frame).map(|(px, py)| (parts(px, 2), parts(py, 3))) else {
            pen = None;
            continue;
        };
        match pen {
            None => {
                let _ = write!(d, "M{} {}l", short(at.0, 2), short(at.1, 3));
            }
            Some(before) => {
                let _ = write!(d, " {} {}", short(at.0 - before.0, 2), short(at.1 - before.1, 3));
            }
        }
        pen = Some(at);
    }
    d.replace("l ", "l")
}

/// A length in whole parts of a pixel, of which one has `10^decimals`.
fn parts(pixels: f64, decimals: usize) -> i64 {
    (10_f64.powi(decimals as i32) * pixels).round() as i64
}

/// Such parts as a decimal number without zeros that say nothing: `-.5`, `12`, `3.07`.
fn short(parts: i64, decimals: usize) -> String {
    let one = 10_u64.pow(decimals as u32);
    let sign = if parts < 0 { "-" } else { "" };
    let (whole, part) = (parts.unsigned_abs() / one, parts.unsigned_abs() % one);
    match (whole, part) {
        (whole, 0) => format!("{sign}{whole}"),
        (0, part) => format!("{sign}.{part:0decimals$}").trim_end_matches('0').to_owned(),
        (whole, part) => format!("{sign}{whole}.{part:0decimals$}").trim_end_matches('0').to_owned(),
    }
}

fn each(x: &[f64], y: &[Rounded], frame: &Frame, piece: impl Fn(f64, f64) -> String) -> String {
    x.iter().zip(y).filter_map(|(x, y)| place(*x, y.0, frame)).map(|(px, py)| piece(px, py)).collect()
}

fn dots(x: &[f64], y: &[Rounded], frame: &Frame) -> String {
    each(x, y, frame, |px, py| format!("M{px:.1} {py:.2}h.1"))
}

fn stems(out: &mut String, x: &[f64], y: &[Rounded], style: Style, frame: &Frame) {
    let zero = frame.y.pixel(0.0);
    path(out, &dots(x, y, frame), style, 4.0, "stroke-linecap=\"round\"");
    path(out, &each(x, y, frame, |px, py| format!("M{px:.1} {zero:.1}V{py:.1}")), style, 1.4, "");
}

/// Markers keep their size when another part of the panel is shown, so each is a path of its own.
fn markers(out: &mut String, x: &[Rounded], y: &[Rounded], style: Style, marker: Marker, frame: &Frame) {
    for (px, py) in x.iter().zip(y).filter_map(|(x, y)| place(x.0, y.0, frame)) {
        let at = format!("data-at=\"{px:.2} {py:.2}\" transform=\"translate({px:.2} {py:.2})\"");
        path(out, &shape(marker, 0.0, 0.0), style, 1.7, &at);
    }
}

fn shape(marker: Marker, px: f64, py: f64) -> String {
    match marker {
        Marker::Cross => format!("M{:.1} {:.1}l8 8M{:.1} {:.1}l8 -8", px - 4.0, py - 4.0, px - 4.0, py + 4.0),
        Marker::Ring => format!("M{:.1} {py:.1}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0", px - 4.5),
    }
}

/// Draws the key before a name in the legend, 18 wide.
pub(crate) fn key(out: &mut String, layer: &Layer, (x, y): (f64, f64)) {
    match layer {
        Layer::Markers { style, marker, .. } => path(out, &shape(*marker, x + 9.0, y - 4.0), *style, 1.7, ""),
        Layer::YRegion { .. } | Layer::XRegion { .. } => region(out, (x, y - 9.0), (x + 18.0, y + 1.0)),
        Layer::Line { style, y: values, .. } => {
            path(out, &format!("M{x:.1} {:.1}h18", y - 4.0), *style, 3.0, &dashes(*style, values));
        }
        Layer::Path { style, .. } => {
            path(out, &format!("M{x:.1} {:.1}h18", y - 4.0), *style, 3.0, &dashes(*style, &[]));
        }
        Layer::Points { style, .. } | Layer::Stems { style, .. } => {
            path(out, &format!("M{x:.1} {:.1}h18", y - 4.0), *style, 3.0, "");
        }
        Layer::Band { .. }
        | Layer::Shades { .. }
        | Layer::Words { .. }
        | Layer::HorizontalMark { .. }
        | Layer::VerticalMarks { .. } => {}
    }
}

/// Cells, those of one shade as one path, neighbours in a column as one rectangle.
fn shades(out: &mut String, (x, y): (&[Rounded; 2], &[Rounded; 2]), columns: &[String], frame: &Frame) {
    let edge = |[low, high]: &[Rounded; 2], index: usize, count: usize| {
        low.0 + (high.0 - low.0) * index as f64 / count.max(1) as f64
    };
    let mut cells_of = vec![Vec::new(); DARKEST + 1];
    for (at, column) in columns.iter().enumerate() {
        let (left, right) = (edge(x, at, columns.len()), edge(x, at + 1, columns.len()));
        let cells = column.as_bytes();
        let mut from = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            let (low, high) = (edge(y, from, cells.len()), edge(y, from + run.len(), cells.len()));
            from += run.len();
            let shade = usize::from(run[0].saturating_sub(b'0')).min(DARKEST);
            if let (Some(corner), Some(opposite)) = (place(left, low, frame), place(right, high, frame)) {
                cells_of[shade].push((corner, opposite));
            }
        }
    }
    let paths: Vec<String> = cells_of.iter().map(|cells| coarse::rectangles(cells)).collect();
    for (shade, d) in paths.iter().enumerate().skip(1).filter(|(_, d)| !d.is_empty()) {
        let opacity = SHADE * shade as f64;
        let _ =
            writeln!(out, "<path d=\"{d}\" {COARSE} fill=\"{INK}\" fill-opacity=\"{opacity:.3}\" class=\"shade\"/>");
    }
}

fn write_words(out: &mut String, (x, y): (&[Rounded], &[Rounded]), words: &[String], style: Style, frame: &Frame) {
    let mut taken: Vec<[f64; 4]> = Vec::new();
    for ((x, y), word) in x.iter().zip(y).zip(words) {
        let Some((px, py)) = place(x.0, y.0, frame) else { continue };
        let half = 0.5 * WIDE * word.chars().count() as f64;
        let middle = px.clamp(frame.left + half, frame.right - half);
        let base = (py - 5.0).max(frame.top + 10.0);
        let covers = |t: &[f64; 4]| middle - half < t[1] && middle + half > t[0] && base - 11.0 < t[3] && base > t[2];
        if base > frame.bottom || !(frame.left..=frame.right).contains(&px) {
            continue;
        }
        // The page's script shows it where another part of the panel leaves room for it.
        let covers_another = taken.iter().any(covers);
        if !covers_another {
            taken.push([middle - half, middle + half, base - 11.0, base]);
        }
        let shown = if covers_another { "display=\"none\" " } else { "" };
        let attributes = format!(
            "{shown}fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\" class=\"word w-{}\" data-at=\"{px:.1} {py:.1}\"",
            colour(style),
            class(style)
        );
        text(out, (middle, base), "middle", &attributes, word);
    }
}

/// Error bars. Their caps are short pieces of a wide stroke, which stays as wide when another part is shown.
fn bars(out: &mut String, x: &[f64], low: &[Rounded], high: &[Rounded], frame: &Frame) {
    let (mut bars, mut caps) = (String::new(), String::new());
    for ((x, low), high) in x.iter().zip(low).zip(high) {
        if let (Some((px, bottom)), Some((_, top))) = (place(*x, low.0, frame), place(*x, high.0, frame)) {
            let _ = write!(bars, "M{px:.1} {bottom:.1}V{top:.1}");
            let _ = write!(caps, "M{px:.1} {:.1}v1.3M{px:.1} {:.1}v1.3", bottom - 0.65, top - 0.65);
        }
    }
    for (d, width) in [(bars, 1.3), (caps, 6.0)] {
        let _ =
            writeln!(out, "<path d=\"{d}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"{width}\" class=\"bars\"/>");
    }
}

fn band(out: &mut String, x: &[f64], low: &[Rounded], high: &[Rounded], style: Style, frame: &Frame) {
    // What reaches down to nothing ends where a logarithmic axis does.
    let above = |value: f64| if matches!(frame.y.kind, Scale::Log) { value.max(frame.y.low) } else { value };
    let whole = |((x, low), high): ((&f64, &Rounded), &Rounded)| {
        Some((place(*x, above(low.0), frame)?, place(*x, above(high.0), frame)?))
    };
    let corners: Vec<_> = x.iter().zip(low).zip(high).filter_map(whole).collect();
    let forth: Vec<_> = corners.iter().map(|(_, high)| Some(*high)).collect();
    let back: Vec<_> = corners.iter().rev().map(|(low, _)| Some(*low)).collect();
    let d = coarse::line(&forth) + &coarse::line(&back).replacen('M', "L", 1);
    if !d.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{d}Z\" {COARSE} fill=\"{}\" fill-opacity=\"0.18\" class=\"b-{}\"/>",
            colour(style),
            class(style)
        );
    }
}

/// A band thinner than this, in pixels, lies under its line.
const HIDDEN: f64 = 2.5;

/// Returns true if the larger part of a band cannot be seen beside its line.
pub(crate) fn is_hidden(layer: &Layer, frame: &Frame) -> bool {
    let Layer::Band { low, high, .. } = layer else { return false };
    let pairs = low.iter().zip(high);
    let width = pairs.map(|(low, high)| (frame.y.pixel(high.0) - frame.y.pixel(low.0)).abs());
    let (hidden, seen): (Vec<f64>, Vec<f64>) =
        width.filter(|width| width.is_finite()).partition(|width| *width < HIDDEN);
    hidden.len() > seen.len()
}

fn horizontal_mark(out: &mut String, value: f64, label: &str, frame: &Frame) {
    let y = frame.y.pixel(value);
    if (frame.top..=frame.bottom).contains(&y) {
        line(out, (frame.left, y), (frame.right, y), INK, MARK);
        let base = if y - NAME_HEIGHT < frame.top { y + NAME_HEIGHT } else { y - 6.0 };
        text(out, (frame.left + 6.0, base), "start", &format!("fill=\"{INK}\" class=\"mark-name\""), label);
    }
}

fn vertical_marks(out: &mut String, x: &[Rounded], label: &str, names: &mut MarkNames, frame: &Frame) {
    let in_view = |x: &&Rounded| (frame.x.low..=frame.x.high).contains(&x.0);
    let places: Vec<f64> = x.iter().filter(in_view).map(|x| frame.x.pixel(x.0)).collect();
    for x in &places {
        line(out, (*x, frame.top), (*x, frame.bottom), INK, MARK);
    }
    if let Some(first) = places.first() {
        let before = *first > 0.5 * (frame.left + frame.right);
        let (shift, anchor) = if before { (-5.0, "end") } else { (5.0, "start") };
        let width = WIDE * label.chars().count() as f64;
        let from = if before { first + shift - width } else { first + shift };
        let row = names.row(from, from + width);
        let base = frame.top + 12.0 + NAME_HEIGHT * row as f64;
        text(out, (first + shift, base), anchor, &format!("fill=\"{INK}\" class=\"mark-name\""), label);
    }
}

fn region(out: &mut String, (left, top): (f64, f64), (right, bottom): (f64, f64)) {
    let (width, height) = ((right - left).max(1.0), (bottom - top).max(0.0));
    if [left, top, width, height].iter().all(|v| v.is_finite()) {
        let _ = writeln!(
            out,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{REGION}\" fill-opacity=\"0.11\" class=\"region\"/>"
        );
    }
}

fn path(out: &mut String, d: &str, style: Style, width: f64, attributes: &str) {
    if !d.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{d}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" class=\"s-{}\" {attributes}/>",
            colour(style),
            class(style)
        );
    }
}
