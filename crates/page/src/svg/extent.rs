//! What part of the numbers a figure shows.

use super::shared::is_log;
use crate::figure::{Abscissa, Figure, Layer, Panel, Rounded};

/// The x values of a layer that has one for each of `count` samples.
pub(crate) fn values(x: &Abscissa, count: usize) -> Vec<f64> {
    match x {
        Abscissa::Values(values) => values.iter().map(|v| v.0).collect(),
        Abscissa::Uniform { start, step, skip } => {
            let mut index = 0_u64;
            let mut at = |n: usize| {
                index = skip.as_ref().map_or(n as u64, |skip| index + u64::from(skip.get(n).copied().unwrap_or(1)));
                start + step * index as f64
            };
            (0..count).map(&mut at).collect()
        }
    }
}

/// The points of a layer, (x, ys): every y that belongs to the x.
fn points(layer: &Layer) -> (Vec<f64>, Vec<&[Rounded]>) {
    match layer {
        Layer::Line { x, y, .. } | Layer::Stems { x, y, .. } => (values(x, y.len()), vec![y]),
        Layer::Points { x, y, low, high, .. } => {
            let more = [low, high].into_iter().flatten().map(Vec::as_slice);
            (values(x, y.len()), std::iter::once(y.as_slice()).chain(more).collect())
        }
        Layer::Band { x, low, high, .. } => (values(x, low.len()), vec![low, high]),
        Layer::Markers { x, y, .. } | Layer::Path { x, y, .. } => (x.iter().map(|v| v.0).collect(), vec![y]),
        Layer::Shades { x, y, .. } => (x.iter().map(|v| v.0).collect(), vec![y]),
        _ => (Vec::new(), Vec::new()),
    }
}

/// Smallest and largest finite value.
#[derive(Debug, Clone, Copy)]
struct Range(f64, f64);

impl Range {
    const EMPTY: Range = Range(f64::INFINITY, f64::NEG_INFINITY);

    fn take(&mut self, value: f64) {
        if value.is_finite() {
            *self = Range(self.0.min(value), self.1.max(value));
        }
    }

    /// With what bands take beside it; on a logarithmic axis, where a band may reach down without end, not far.
    fn widened(self, bands: Range, log: bool) -> Range {
        if bands.0 > bands.1 {
            return self;
        }
        let (low, high) = (self.0.min(bands.0), self.1.max(bands.1));
        if log && self.0 <= self.1 {
            return Range(low.max(self.0 / BAND_BEYOND), high.min(self.1 * BAND_BEYOND));
        }
        Range(low, high)
    }
}

/// How far a band widens a logarithmic axis, as a factor.
const BAND_BEYOND: f64 = 4.0;

/// Smallest and largest x of all series.
pub(crate) fn x_extent(figure: &Figure) -> (f64, f64) {
    if let Some([low, high]) = figure.x.range {
        return (low.0, high.0);
    }
    let log = is_log(&figure.x);
    let mut range = Range::EMPTY;
    let layers = || figure.panels.iter().flat_map(|panel| &panel.layers);
    for layer in layers().filter(|layer| !matches!(layer, Layer::Band { .. })) {
        points(layer).0.into_iter().filter(|x| !log || *x > 0.0).for_each(|x| range.take(x));
    }
    let Range(low, high) = range;
    let air = if figure.equal_axes {
        0.07
    } else if layers().any(|layer| matches!(layer, Layer::Stems { .. })) {
        0.015
    } else {
        0.0
    };
    if low < high {
        return (low - air * (high - low), high + air * (high - low));
    }
    match (low.is_finite(), log) {
        (true, _) => (low - 0.1 * low.abs() - 1e-9, low + 0.1 * low.abs() + 1.0),
        (false, true) => (1.0, 10.0),
        (false, false) => (0.0, 1.0),
    }
}

/// Range of y for what is in view, with a little air.
pub(crate) fn y_extent(panel: &Panel, (from, to): (f64, f64)) -> (f64, f64) {
    if let Some([low, high]) = panel.y.range {
        return (low.0, high.0);
    }
    let log = is_log(&panel.y);
    let (mut range, mut bands) = (Range::EMPTY, Range::EMPTY);
    for layer in &panel.layers {
        match layer {
            Layer::YRegion { low, high, .. } => [low, high].into_iter().for_each(|v| range.take(v.0)),
            Layer::Stems { .. } => range.take(0.0),
            _ => {}
        }
        let (x, ys) = points(layer);
        for y in ys {
            let in_view = x.iter().zip(y).filter(|(x, y)| (from..=to).contains(*x) && (!log || y.0 > 0.0));
            let range = if matches!(layer, Layer::Band { .. }) { &mut bands } else { &mut range };
            in_view.for_each(|(_, y)| range.take(y.0));
        }
    }
    let Range(low, high) = range.widened(bands, log);
    if low > high {
        return if log { (1.0, 10.0) } else { (0.0, 1.0) };
    }
    if log {
        return (low / 1.2, high * 1.2);
    }
    let spread = 0.07 * (high - low);
    let air = if spread > 0.0 { spread } else { (0.1 * high.abs()).max(if high == 0.0 { 1.0 } else { 0.0 }) };
    (low - air, high + air)
}

/// Widens the shorter of two ranges so that a pixel is worth the same along both.
pub(crate) fn equal_ranges(x: (f64, f64), y: (f64, f64), width: f64, height: f64) -> ((f64, f64), (f64, f64)) {
    let per_pixel = ((x.1 - x.0) / width).max((y.1 - y.0) / height);
    let around = |(a, b): (f64, f64), pixels: f64| {
        let (middle, half) = (0.5 * (a + b), 0.5 * per_pixel * pixels);
        (middle - half, middle + half)
    };
    (around(x, width), around(y, height))
}
