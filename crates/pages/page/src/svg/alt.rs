//! A figure in words, for readers who do not see it.

use crate::decimal::digits;
use crate::figure::{Axis, Figure, Layer, Panel, Rounded, Style};

/// Title and result: the caption, or the ranges of the series where there is none.
pub(super) fn label(figure: &Figure) -> String {
    let result = if figure.caption.is_empty() { ranges(figure) } else { figure.caption.clone() };
    let title = figure.title.trim_end_matches('.');
    match (title.is_empty(), result.is_empty()) {
        (true, _) => result,
        (_, true) => title.to_owned(),
        _ => format!("{title}. {result}"),
    }
}

/// Describes the quantities over their axis, and from where to where each series goes.
pub(super) fn description(figure: &Figure) -> String {
    let names: Vec<String> = figure.panels.iter().map(|panel| axis_name(&panel.y)).collect();
    format!("{} over {}. {}", names.join(", "), axis_name(&figure.x), ranges(figure))
}

pub(super) fn axis_name(axis: &Axis) -> String {
    if axis.unit.is_empty() { axis.label.clone() } else { format!("{} [{}]", axis.label, axis.unit) }
}

fn ranges(figure: &Figure) -> String {
    figure
        .panels
        .iter()
        .flat_map(|panel| panel.layers.iter().filter_map(|layer| range(panel, layer)))
        .collect::<Vec<_>>()
        .join(" ")
}

/// A sentence: the range of a series, or of a residual the largest magnitude.
fn range(panel: &Panel, layer: &Layer) -> Option<String> {
    let (name, style, y) = match layer {
        Layer::Line { name, style, y, .. }
        | Layer::Points { name, style, y, .. }
        | Layer::Stems { name, style, y, .. } => (name, *style, y),
        _ => return None,
    };
    let (low, high) = ends(y)?;
    let unit = if panel.y.unit.is_empty() { String::new() } else { format!(" {}", panel.y.unit) };
    let series = if *name == panel.y.label { name.clone() } else { format!("{}, {name}", panel.y.label) };
    let number = |value: f64| digits(value, 3).replace('-', "−");
    Some(match style {
        Style::Residual if name.contains("residual") => {
            format!("{series}: at most {}{unit}.", number(low.abs().max(high.abs())))
        }
        _ => format!("{series}: {} to {}{unit}.", number(low), number(high)),
    })
}

fn ends(y: &[Rounded]) -> Option<(f64, f64)> {
    let finite = y.iter().map(|y| y.0).filter(|y| y.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
    (low <= high).then_some((low, high))
}
