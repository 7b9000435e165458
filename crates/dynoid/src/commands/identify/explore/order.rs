//! `dynoid data order`: orders and delay of ARX models.

use std::ops::RangeInclusive;

use dataset::CommonClock;
use ident::{Criterion, OrderScan, OrderTable, ScannedStructure};
use page::{Align, Axis, Figure, Layer, Panel, Style, Table, Tone as Text};

use super::super::data::{Gaps, check_movement, check_plot, load_between_gaps};
use super::super::figures::figure;
use super::super::judge::{picture, written};
use super::super::words::significant;
use crate::cli::identify::OrderArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Structures compared, at most.
const MOST: usize = 100_000;

/// `dynoid data order`
pub(crate) fn order(arguments: &OrderArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.data.recordings])?;
    let ranges = [range("--na", &arguments.na)?, range("--nb", &arguments.nb)?, range("--nk", &arguments.nk)?];
    let [na, nb, nk] = ranges.clone();
    let scan = OrderScan::new(na, nb, nk);
    check_size(scan.structures(), arguments)?;
    let loaded = load_between_gaps(CommonClock::Slowest, Gaps::OfInputs, &arguments.data, terminal)?;
    check_movement(&loaded)?;
    let data = loaded.data;
    let failed = |source| CliError::identify("the order scan", source);
    let progress = terminal.long("comparing the structures");
    let told = |done: usize, all: usize| progress.told(done as u64, all as u64);
    let table = match arguments.split {
        Some(share) => {
            let split = data.split(share).map_err(failed)?;
            scan.run_told(&split.estimation, Some(&split.validation), told)
        }
        None => scan.run_told(&data, None, told),
    };
    let table = table.map_err(failed)?;
    drop(progress);
    picture(&arguments.result, "Order", || vec![loss_figure(&table)])?;
    let mut criteria = vec![
        ("AIC", Criterion::Aic),
        ("AICc", Criterion::Aicc),
        ("BIC", Criterion::Bic),
        ("FPE", Criterion::Fpe),
        ("MDL", Criterion::Mdl),
    ];
    if arguments.split.is_some() {
        criteria.push(("unseen data", Criterion::Validation));
    }
    if arguments.result.json {
        let one = |s: &ScannedStructure| {
            serde_json::json!({"na": s.na, "nb": s.nb, "nk": s.nk, "parameters": s.parameters, "loss": s.loss,
                "validation_fit_percent": s.validation_fit, "criteria": s.criteria})
        };
        let best: serde_json::Map<String, serde_json::Value> =
            criteria.iter().map(|(name, c)| ((*name).to_owned(), one(table.best(*c)))).collect();
        let all: Vec<_> = table.structures().iter().map(one).collect();
        let edges: Vec<_> = edges(&table, &criteria, &ranges).iter().map(Edge::json).collect();
        terminal.json(&serde_json::json!({"best": best, "at_edge": edges, "structures": all}))?;
    } else if !terminal.is_quiet() {
        terminal.table(&best(&table, &criteria));
        terminal.line(&format!("{} structures on {} samples", table.structures().len(), table.samples()));
        for edge in edges(&table, &criteria, &ranges) {
            terminal.item(("doubt:", Text::Caution), &edge.words());
        }
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

/// Refuses more structures than can be compared in good time.
fn check_size(structures: usize, arguments: &OrderArguments) -> Result<(), CliError> {
    if structures <= MOST {
        return Ok(());
    }
    let OrderArguments { na, nb, nk, .. } = arguments;
    let what = format!(
        "--na {na} --nb {nb} --nk {nk} are {structures} structures, and at most {MOST} are compared: find the delay first, \
         with `dynoid data delay`, and give a narrow --nk about it, or shorter ranges of orders"
    );
    Err(CliError::Usage { what })
}

/// What each criterion likes best.
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
        let fit = s.validation_fit.map_or("–".to_owned(), |f| format!("{f:.2} %"));
        let [na, nb, nk] = [s.na, s.nb, s.nk].map(|n| n.to_string());
        best.row([(*name).into(), na.into(), nb.into(), nk.into(), significant(s.loss).into(), fit.into()]);
    }
    best
}

/// An end of a range at which criteria find their best: what lies beyond may be better.
struct Edge {
    option: &'static str,
    at: usize,
    wider: String,
    by: Vec<String>,
}

impl Edge {
    fn words(&self) -> String {
        let Edge { option, at, wider, by } = self;
        format!(
            "the best by {} is at the end of {option} ({at}); there may be better beyond: try {option} {wider}",
            by.join(", ")
        )
    }

    fn json(&self) -> serde_json::Value {
        serde_json::json!({"option": self.option, "at": self.at, "wider": self.wider, "criteria": self.by})
    }
}

/// The ends that are best. A range of one number is meant so; nothing lies below one but what is asked for.
fn edges(table: &OrderTable, criteria: &[(&str, Criterion)], ranges: &[RangeInclusive<usize>; 3]) -> Vec<Edge> {
    let mut found: Vec<Edge> = Vec::new();
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
                Some(edge) => edge.by.push((*name).to_owned()),
                None => found.push(Edge { option, at, wider, by: vec![(*name).to_owned()] }),
            }
        }
    }
    found
}

fn range(option: &str, text: &str) -> Result<RangeInclusive<usize>, CliError> {
    let (first, last) = text.split_once(':').unwrap_or((text, text));
    match (first.trim().parse(), last.trim().parse()) {
        (Ok(first), Ok(last)) if first <= last => Ok(first..=last),
        _ => Err(CliError::Usage { what: format!("{option} {text}: give a number, or a range such as 1:6") }),
    }
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
