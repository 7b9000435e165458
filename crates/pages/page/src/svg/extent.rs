//! Range of the numbers that a figure shows.

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

/// The range of a y-axis, and the samples outside it, by x.
#[derive(Debug, Clone)]
pub(crate) struct Extent {
    pub(crate) range: (f64, f64),
    pub(crate) outside: Vec<(f64, f64)>,
}

impl From<(f64, f64)> for Extent {
    fn from(range: (f64, f64)) -> Self {
        Extent { range, outside: Vec::new() }
    }
}

/// Range of y for what is in view, with a little air.
pub(crate) fn y_extent(panel: &Panel, domain: (f64, f64)) -> Extent {
    if let Some([low, high]) = panel.y.range {
        return (low.0, high.0).into();
    }
    let log = is_log(&panel.y);
    let whole = range(panel, domain, log, |_, _| true);
    if log {
        let Range(low, high) = whole;
        return (if low > high { (1.0, 10.0) } else { (low / 1.2, high * 1.2) }).into();
    }
    let limits: Vec<Option<Range>> = panel.layers.iter().map(usual).collect();
    let is_usual = |layer: usize, y: f64| {
        limits.get(layer).and_then(Option::as_ref).is_none_or(|usual| (usual.0..=usual.1).contains(&y))
    };
    let inner = range(panel, domain, log, is_usual);
    if inner.1 - inner.0 > SHRUNK * (whole.1 - whole.0) || inner.0 >= inner.1 {
        return aired(whole).into();
    }
    let range = aired(inner);
    Extent { range, outside: outside(panel, range) }
}

/// The range of what is in view and taken, by number of layer and y.
fn range(panel: &Panel, (from, to): (f64, f64), log: bool, takes: impl Fn(usize, f64) -> bool) -> Range {
    let (mut range, mut bands) = (Range::EMPTY, Range::EMPTY);
    for (number, layer) in panel.layers.iter().enumerate() {
        match layer {
            Layer::YRegion { low, high, .. } => [low, high].into_iter().for_each(|v| range.take(v.0)),
            Layer::Stems { .. } => range.take(0.0),
            _ => {}
        }
        let (x, ys) = points(layer);
        for y in ys {
            let in_view = x.iter().zip(y).filter(|(x, y)| (from..=to).contains(*x) && (!log || y.0 > 0.0));
            let range = if matches!(layer, Layer::Band { .. }) { &mut bands } else { &mut range };
            in_view.filter(|(_, y)| takes(number, y.0)).for_each(|(_, y)| range.take(y.0));
        }
    }
    range.widened(bands, log)
}

fn aired(Range(low, high): Range) -> (f64, f64) {
    if low > high {
        return (0.0, 1.0);
    }
    let spread = 0.07 * (high - low);
    let air = if spread > 0.0 { spread } else { (0.1 * high.abs()).max(if high == 0.0 { 1.0 } else { 0.0 }) };
    (low - air, high + air)
}

/// Samples of a trace so many interquartile ranges from its quartiles are unusual where they are this share of it or
/// less,
const FAR: f64 = 5.0;
const FEW: f64 = 0.01;
/// and where they are in so few places: what happens again and again is no accident.
const PLACES: usize = 3;
/// A trace has at least so many samples.
const TRACE: usize = 200;
/// Unusual samples are left outside an axis only where it shrinks to this share.
const SHRUNK: f64 = 0.5;

/// From where to where the samples of a trace usually lie, where few of them lie elsewhere.
fn usual(layer: &Layer) -> Option<Range> {
    let Layer::Line { y, .. } = layer else { return None };
    let mut values: Vec<f64> = y.iter().map(|y| y.0).filter(|y| y.is_finite()).collect();
    if values.len() < TRACE {
        return None;
    }
    let mut quantile = |share: f64| {
        let at = (share * (values.len() - 1) as f64) as usize;
        *values.select_nth_unstable_by(at, f64::total_cmp).1
    };
    let (lower, upper) = (quantile(0.25), quantile(0.75));
    let reach = FAR * (upper - lower);
    let usual = Range(lower - reach, upper + reach);
    let is_unusual = |(_, y): &(usize, &Rounded)| y.0.is_finite() && !(usual.0..=usual.1).contains(&y.0);
    let unusual: Vec<usize> = y.iter().enumerate().filter(is_unusual).map(|(at, _)| at).collect();
    let few = FEW * values.len() as f64;
    let places = 1 + unusual.windows(2).filter(|pair| (pair[1] - pair[0]) as f64 > few).count();
    (reach > 0.0 && !unusual.is_empty() && unusual.len() as f64 <= few && places <= PLACES).then_some(usual)
}

/// The samples of traces outside a range, by x.
fn outside(panel: &Panel, (low, high): (f64, f64)) -> Vec<(f64, f64)> {
    let mut all = Vec::new();
    for layer in panel.layers.iter().filter(|layer| matches!(layer, Layer::Line { .. })) {
        let (x, ys) = points(layer);
        let of = |y: &[Rounded]| x.iter().copied().zip(y.iter().map(|y| y.0)).collect::<Vec<_>>();
        all.extend(ys.into_iter().flat_map(of).filter(|(_, y)| *y < low || *y > high));
    }
    all.sort_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
    all
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
