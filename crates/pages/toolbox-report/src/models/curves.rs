//! Curves of models with bands: figures, summaries and points.

use lti::Mode;
use page::decimal::{range, significant, with_range};
use page::{Abscissa, Align, Axis, Block, Blocks, Figure, Layer, Page, Panel, Style, Table, rounded};

use super::facts::{CurveFacts, Fact, Points, QuantityFacts};
use super::model::Model;
use crate::blocks::{heading, line, name};
use crate::figures::figure;
use crate::words::growing_pole;

/// Curves of several models.
pub struct Curves {
    pub(super) models: Vec<Model>,
    pub(super) curves: Vec<Curve>,
    pub(super) over: Over,
    /// Confidence of the bands.
    pub(super) level: f64,
}

/// Quantity over which curves are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Over {
    Frequency,
    Time,
}

impl Over {
    fn axis(self) -> Axis {
        match self {
            Over::Frequency => Axis::frequency(),
            Over::Time => Axis::time(),
        }
    }

    fn points(self, x: Vec<f64>) -> Points {
        match self {
            Over::Frequency => Points::Frequency(x),
            Over::Time => Points::Time(x),
        }
    }
}

/// How much of a curve is put into words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// A summary.
    Summary,
    /// Every point.
    Points,
}

/// A curve with a band, over frequency or time.
pub(super) struct Curve {
    pub(super) model: usize,
    pub(super) channel: String,
    pub(super) x: Vec<f64>,
    pub(super) quantities: Vec<Quantity>,
    pub(super) summary: Vec<Fact>,
}

/// Quantity that a curve shows.
pub(super) struct Quantity {
    pub(super) axis: Axis,
    pub(super) values: Vec<f64>,
    pub(super) band: Option<Vec<(f64, f64)>>,
}

/// That a model is not stable, and what follows.
pub(super) fn unstable(mode: &Mode, what: &str) -> Fact {
    Fact::remark("not stable", &format!("{}: {what}", growing_pole(mode)))
}

impl Curves {
    /// The curves in tables, and models of the same channel in one figure.
    pub fn page(&self, detail: Detail) -> Page {
        let mut all = Blocks::default();
        for curve in &self.curves {
            all.push(heading(format!("{}: {}", self.models[curve.model].name, curve.channel)));
            match detail {
                Detail::Points => all.push(points(curve, &self.over.axis(), self.level)),
                Detail::Summary => all.push(summary(curve, self.level)),
            }
        }
        all.push(self.figures().into_iter().map(Block::figure).collect::<Blocks>());
        Page::new("Models", all.into_vec())
    }

    /// Models of the same channel in one figure.
    pub fn figures(&self) -> Vec<Figure> {
        figures(&self.curves, &self.models, &self.over.axis())
    }

    /// The curves in numbers.
    pub fn facts(&self) -> Vec<CurveFacts> {
        self.curves.iter().map(|curve| curve.facts(&self.models[curve.model], self.over)).collect()
    }
}

impl Curve {
    fn facts(&self, model: &Model, over: Over) -> CurveFacts {
        let quantity = |q: &Quantity| QuantityFacts {
            name: q.axis.label.clone(),
            unit: q.axis.unit.clone(),
            values: q.values.clone(),
            band: q.band.clone(),
        };
        CurveFacts {
            model: model.name.clone(),
            channel: self.channel.clone(),
            at: over.points(self.x.clone()),
            quantities: self.quantities.iter().map(quantity).collect(),
            summary: self.summary.clone(),
        }
    }
}

fn figures(curves: &[Curve], models: &[Model], x: &Axis) -> Vec<Figure> {
    let mut names: Vec<&str> = Vec::new();
    for curve in curves {
        if !names.contains(&curve.channel.as_str()) {
            names.push(&curve.channel);
        }
    }
    let of_channel = |name: &&str| {
        let same: Vec<&Curve> = curves.iter().filter(|c| c.channel == *name).collect();
        curve_figure(name, &same, models, x.clone())
    };
    names.iter().map(of_channel).collect()
}

fn curve_figure(title: &str, curves: &[&Curve], models: &[Model], x: Axis) -> Figure {
    let count = curves.first().map_or(0, |c| c.quantities.len());
    let panel = |index: usize| {
        let mut layers = Vec::new();
        for curve in curves {
            let (quantity, style) = (&curve.quantities[index], Style::of_model(curve.model));
            let name = models[curve.model].name.clone();
            if let Some(band) = &quantity.band {
                let (low, high): (Vec<f64>, Vec<f64>) = band.iter().copied().unzip();
                let x = Abscissa::Values(rounded(&curve.x));
                layers.push(Layer::Band { name: name.clone(), style, x, low: rounded(&low), high: rounded(&high) });
            }
            layers.push(Layer::curve(&name, style, &curve.x, &quantity.values));
        }
        let axis = curves.first().map_or_else(|| Axis::linear("", ""), |c| c.quantities[index].axis.clone());
        Panel::new(axis, if index == 0 { 200 } else { 130 }, layers)
    };
    figure(title, x, (0..count).map(panel).collect())
}

/// The heading of intervals.
pub(super) fn interval_heading(level: f64) -> String {
    format!("{} % interval", significant(100.0 * level))
}

fn summary(curve: &Curve, level: f64) -> Table {
    let has_intervals = curve.summary.iter().any(|fact| fact.interval.is_some());
    let heading = if has_intervals { interval_heading(level) } else { String::new() };
    let mut table = Table::new(&[("", Align::Left), ("", Align::Right), (&heading, Align::Left), ("", Align::Left)]);
    for fact in &curve.summary {
        let value = fact.value.map_or_else(|| "–".to_owned(), |value| with_range(value, &fact.unit, None));
        // Without width it is no interval but a bound, such as an overshoot of nothing.
        let interval = fact.interval.filter(|(low, high)| low < high);
        table.row([name(&fact.name), value.into(), range(interval).into(), name(&fact.remark)]);
    }
    table
}

/// Every point of a curve.
fn points(curve: &Curve, x: &Axis, level: f64) -> Blocks {
    let has_band = curve.quantities.iter().any(|q| q.band.is_some());
    let units = curve.quantities.iter().map(|q| format!("{} [{}]", q.axis.label, q.axis.unit));
    let mut columns = vec![("at", Align::Right)];
    for _ in &curve.quantities {
        columns.push(("value", Align::Right));
        if has_band {
            columns.extend([("from", Align::Right), ("to", Align::Right)]);
        }
    }
    let names: Vec<String> = std::iter::once(format!("{} [{}]", x.label, x.unit)).chain(units).collect();
    let intervals = if has_band { format!(", each from … to: {}", interval_heading(level)) } else { String::new() };
    let mut table = Table::new(&columns);
    for n in 0..curve.x.len() {
        let mut row = vec![significant(curve.x[n]).into()];
        for quantity in &curve.quantities {
            row.push(significant(quantity.values[n]).into());
            let ends = quantity.band.as_ref().map(|band| [band[n].0, band[n].1]);
            row.extend(ends.into_iter().flatten().map(|end| significant(end).into()));
        }
        table.row(row);
    }
    [line(format!("{}{intervals}", names.join(", "))), Block::Table(table)].into_iter().collect()
}
