//! Orders and delay of ARX models, by several criteria.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use ident::{Criteria, Criterion, OrderTable, ScannedStructure};
use numerics::null::nan_if_null;
use page::decimal::{percent, significant};
use page::{Align, Axis, Block, Figure, Layer, Page, Panel, Style, Table, Tone};
use serde::{Deserialize, Serialize};

use crate::blocks::{finding, line};
use crate::figures::figure;

/// Structures that were compared.
pub struct Orders {
    /// The structures.
    pub table: OrderTable,
    /// Ranges of na, nb and nk that were tried.
    pub ranges: [RangeInclusive<usize>; 3],
    /// True if they were ranked on data that none was fitted to, too.
    pub is_validated: bool,
}

impl Orders {
    /// Page of the structure that each criterion likes best, and the doubts about it.
    pub fn page(&self) -> Page {
        let (table, criteria) = (&self.table, self.criteria());
        let scanned = format!("{} structures on {} samples", table.structures().len(), table.samples());
        let mut all = vec![Block::Table(best(table, &criteria)), line(scanned)];
        let edges = edges(table, &criteria, &self.ranges);
        all.extend(edges.iter().map(|edge| finding(Tone::Caution, "doubt", &edge.words())));
        all.push(Block::figure(loss_figure(table)));
        Page::new("Order", all)
    }

    /// The structures in numbers.
    pub fn facts(&self) -> OrderFacts {
        let (table, criteria) = (&self.table, self.criteria());
        let best =
            |(name, criterion): &(&str, Criterion)| ((*name).to_owned(), StructureFacts::of(table.best(*criterion)));
        OrderFacts {
            best: criteria.iter().map(best).collect(),
            at_edge: edges(table, &criteria, &self.ranges),
            structures: table.structures().iter().map(StructureFacts::of).collect(),
        }
    }

    fn criteria(&self) -> Vec<(&'static str, Criterion)> {
        let mut criteria = vec![
            ("AIC", Criterion::Aic),
            ("AICc", Criterion::Aicc),
            ("BIC", Criterion::Bic),
            ("FPE", Criterion::Fpe),
            ("MDL", Criterion::Mdl),
        ];
        if self.is_validated {
            criteria.push(("unseen data", Criterion::Validation));
        }
        criteria
    }
}

/// Structures that were compared, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OrderFacts {
    /// The structure that each criterion likes best, by the name of the criterion.
    pub best: BTreeMap<String, StructureFacts>,
    /// Ends of ranges at which criteria find their best.
    pub at_edge: Vec<EdgeFacts>,
    /// All structures.
    pub structures: Vec<StructureFacts>,
}

/// An ARX structure that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StructureFacts {
    /// Coefficients of outputs.
    pub na: usize,
    /// Coefficients of inputs.
    pub nb: usize,
    /// Delay, in samples.
    pub nk: usize,
    /// Coefficients in all.
    pub parameters: usize,
    /// Determinant of the mean square of the errors on the data of the estimate.
    #[serde(deserialize_with = "nan_if_null")]
    pub loss: f64,
    /// Fit of the prediction on unseen data, %; none where there are no such data.
    pub validation_fit_percent: Option<f64>,
    /// Information criteria.
    pub criteria: Criteria,
}

impl StructureFacts {
    fn of(s: &ScannedStructure) -> Self {
        StructureFacts {
            na: s.na,
            nb: s.nb,
            nk: s.nk,
            parameters: s.parameters,
            loss: s.loss,
            validation_fit_percent: s.validation_fit,
            criteria: s.criteria,
        }
    }
}

/// Structure that each criterion likes best.
fn best(table: &OrderTable, criteria: &[(&str, Criterion)]) -> Table {
    let mut best = Table::new(&[
        ("best by", Align::Left),
        ("na", Align::Right),
        ("nb", Align::Right),
        ("nk", Align::Right),
        ("loss", Align::Right),
        ("fit on unseen data", Align::Right),
    ]);
    for (name, criterion) in criteria {
        let s = table.best(*criterion);
        let fit = percent(s.validation_fit.unwrap_or(f64::NAN));
        let [na, nb, nk] = [s.na, s.nb, s.nk].map(|n| n.to_string());
        best.row([(*name).into(), na.into(), nb.into(), nk.into(), significant(s.loss).into(), fit.into()]);
    }
    best
}

/// An end of a range at which criteria find their best: what lies beyond may be better.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EdgeFacts {
    /// The option with this range.
    pub option: String,
    /// The end.
    pub at: usize,
    /// A wider range to try.
    pub wider: String,
    /// Names of these criteria.
    pub criteria: Vec<String>,
}

impl EdgeFacts {
    fn words(&self) -> String {
        let EdgeFacts { option, at, wider, criteria } = self;
        format!(
            "the best by {} is at the end of {option} ({at}); there may be better beyond: try {option} {wider}",
            criteria.join(", ")
        )
    }
}

/// The ends that are best. A range of one number is meant so; nothing lies below one but what is asked for.
fn edges(table: &OrderTable, criteria: &[(&str, Criterion)], ranges: &[RangeInclusive<usize>; 3]) -> Vec<EdgeFacts> {
    let mut found: Vec<EdgeFacts> = Vec::new();
    for (name, criterion) in criteria {
        let s = table.best(*criterion);
        for ((option, at), range) in [("--na", s.na), ("--nb", s.nb), ("--nk", s.nk)].into_iter().zip(ranges) {
            let (first, last) = (*range.start(), *range.end());
            let wider = match at {
                _ if first == last => continue,
                at if at == last => format!("{first}:{}", last + (last - first).clamp(2, 5)),
                at if at == first && first > 1 => format!("1:{last}"),
                _ => continue,
            };
            match found.iter_mut().find(|edge| edge.option == option && edge.at == at) {
                Some(edge) => edge.criteria.push((*name).to_owned()),
                None => {
                    found.push(EdgeFacts { option: option.to_owned(), at, wider, criteria: vec![(*name).to_owned()] });
                }
            }
        }
    }
    found
}

/// The least loss for each number of parameters.
fn loss_figure(table: &OrderTable) -> Figure {
    let most = table.structures().iter().map(|s| s.parameters).max().unwrap_or(0);
    let least = |value: fn(&ScannedStructure) -> Option<f64>| {
        let of = |d: usize| {
            let same = table.structures().iter().filter(|s| s.parameters == d).filter_map(value);
            Some((d as f64, same.min_by(f64::total_cmp)?))
        };
        (0..=most).filter_map(of).unzip::<f64, f64, Vec<_>, Vec<_>>()
    };
    let (x, fitted) = least(|s| Some(s.loss));
    let mut layers = vec![Layer::curve("estimation data", Style::Modelled, &x, &fitted)];
    let (x, unseen) = least(|s| s.validation_loss);
    if !x.is_empty() {
        layers.push(Layer::curve("unseen data", Style::Other, &x, &unseen));
    }
    let panel = Panel::new(Axis::log("least loss", ""), 220, layers);
    figure("Loss over the number of parameters", Axis::linear("parameters", ""), vec![panel])
}
